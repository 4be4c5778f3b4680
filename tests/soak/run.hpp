// Runs a case, and makes a case that fails simpler.
#pragma once

#include <functional>
#include <string>

#include "soak/case.hpp"
#include "soak/seen.hpp"

namespace dartcast::soak {

/// The fault of a case: the step, who, in which way; empty: it has none.
std::string run_case(const Case& c, Seen& seen);

/// Gives the fault of a case in words; empty: it has none.
using Check = std::function<std::string(const Case&)>;

/// The simplest case that was found that fails, too: fewer cells, particles, steps, features.
Case shrunk(const Case& c, const Check& check);

}  // namespace dartcast::soak
