// Cases in processes of their own, so that a crash or a loop without an end is a failure like any other.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "soak/case.hpp"
#include "soak/seen.hpp"

namespace dartcast::soak {

/// A case that fails, and how.
struct Failure {
  Case c;
  std::string wrong;
};

/// Runs one case in a child process. A case that takes longer than `limit` seconds fails. `file`: unless empty, gets the
/// replay of the step that fails, if there is one.
std::string run_apart(const Case& c, double limit, const std::string& file = {});

/// Which cases to run, and how long.
struct SoakOptions {
  double seconds = 60.0;
  std::uint64_t cases = ~std::uint64_t{0};                 ///< at most
  std::uint64_t seed = 1;                                  ///< of the first case
  unsigned jobs = 1;                                       ///< processes
  double limit = 120.0;                                    ///< seconds for a case
  std::function<void(Case&)> change;                       ///< of each case drawn
  std::function<void(double seconds, const Counts&)> say;  ///< from time to time
};

/// Runs one case after another, until one fails, or the time or the number of cases is over.
struct SoakResult {
  Counts counts;
  double seconds = 0.0;
  std::vector<Failure> failures;
};
SoakResult soak(const SoakOptions& options);

}  // namespace dartcast::soak
