// How long single steps take in a surgical simulation, and whether any takes too long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dartcast::bench {

struct LatencyOptions {
  std::size_t steps = 10000;     ///< of a millisecond each
  std::size_t cut_every = 1000;  ///< steps
};

/// One step.
struct StepTime {
  double ms = 0.0;  ///< processor time of the thread
  bool cut = false;
};

struct Latency {
  /// Bounds of a step, ms.
  static constexpr double bound = 5.0;
  static constexpr double cut_bound = 10.0;

  std::size_t cells = 0;           ///< at the start
  std::size_t particles = 0;       ///< on average
  std::size_t cells_replaced = 0;  ///< by a cut, on average
  std::vector<StepTime> steps;

  /// A quantile of the times of all steps with a cut, or of all without, ms. 0.5: the median, 1: the longest.
  [[nodiscard]] double quantile(bool cut, double share) const;
  [[nodiscard]] std::size_t count(bool cut) const;
  /// The number of the longest of these steps, from 1; 0 where there is none.
  [[nodiscard]] std::size_t longest_step(bool cut) const;
  [[nodiscard]] std::size_t over_bound(bool cut) const;
  [[nodiscard]] bool kept() const { return over_bound(false) + over_bound(true) == 0; }
};

/// The scene of bench/latency.toml on one thread: 1,000 particles, a catheter and a body in a vessel that deforms. A
/// blade of 2 mm is drawn over 2 mm of the tissue before each step whose number is a multiple of `cut_every`. Its place
/// is random, and the same in each run.
Latency measure_latency(const LatencyOptions& options);

std::string latency_text(const Latency& latency);
std::string latency_json(const Latency& latency);
/// The time of each step, over the steps, as SVG.
std::string latency_svg(const Latency& latency);

}  // namespace dartcast::bench
