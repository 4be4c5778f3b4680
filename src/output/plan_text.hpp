// Plans of runs on many ranks, for people and for programs.
#pragma once

#include <string>

#include "dartcast/plan.hpp"

namespace dartcast {

std::string plan_text(const RunPlan& plan);
/// One JSON object.
std::string plan_json(const RunPlan& plan);

}  // namespace dartcast
