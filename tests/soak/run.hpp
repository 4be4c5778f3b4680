// Runs a case, and makes a case that fails simpler.
#pragma once

#include <functional>
#include <string>

#include "soak/case.hpp"
#include "soak/seen.hpp"

namespace dartcast::soak {

/// What is wrong: the step, who, what; empty: nothing.
std::string run_case(const Case& c, Seen& seen);

/// What is wrong with a case, in words; empty: nothing.
using Check = std::function<std::string(const Case&)>;

/// The simplest case that was found that fails, too: fewer cells, particles, steps, features.
Case shrunk(const Case& c, const Check& check);

}  // namespace dartcast::soak
