// The check and the sums that both texts of a summary need.
#pragma once

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "dartcast/run.hpp"

namespace dartcast {

/// A summary may come from anywhere. Throws InvalidArgument if there are values for more patches than patch_names
/// has, or for more planes than options.
void check_summary(const Summary& summary);

/// The particles that ended at a patch.
struct Deposition {
  std::string patch;  ///< its name; empty: none
  std::uint64_t deposited = 0;
  std::uint64_t escaped = 0;
  double fraction = 0.0;  ///< of all particles of the run that were deposited here
  double area = 0.0;      ///< 0: not known
  double per_area = 0.0;
};
/// Those of all patches, and of walls without one if particles ended there.
std::vector<Deposition> depositions(const Summary& summary);
/// The same as a table.
std::string deposition_csv(const Summary& summary);

/// Whether the tests of all these steps were counted. Runs by cells count steps alone: the histogram then lacks them.
inline bool counts_tests(const Counters& c) {
  return std::accumulate(c.histogram.begin(), c.histogram.end(), std::uint64_t{0}) == c.particle_steps;
}
/// Whether the run had any whose steps seconds_solids counts.
inline bool has_solids(const Summary& s) { return !s.bodies.empty() || !s.catheters.empty() || !s.solids.empty(); }
inline double ratio(std::uint64_t a, std::uint64_t b) { return static_cast<double>(a) / static_cast<double>(b); }
/// All that the steps cost counts, but neither output nor the audit.
inline double ns_per_particle_step(const Summary& s) {
  const SimulationTotals& t = s.totals;
  const double seconds = t.seconds_detect + t.seconds_deform + t.seconds_collide + t.seconds_respond +
                         s.seconds_solids + (s.statistics ? s.statistics->seconds : 0.0);
  return seconds * 1e9 / static_cast<double>(t.counters.particle_steps);
}
inline std::uint64_t sum(const std::vector<std::uint64_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

}  // namespace dartcast
