// The timed loop: dartcast and its competitors on the very same segments and triangles, in turns.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/competitors.hpp"
#include "bench/workload.hpp"
#include "dartcast/step.hpp"

namespace dartcast::bench {

/// How one competitor did.
struct Series {
  std::string name;
  std::vector<double> step_ns;      ///< per step, of all its particles: refitting and casting
  std::uint64_t disagreements = 0;  ///< segments where it answers otherwise than dartcast
  std::uint64_t at_start = 0;       ///< of these: the segment starts on a wall, just met or met by it alone
  std::uint64_t failed = 0;         ///< of these: it finds no answer
  std::uint64_t through = 0;        ///< of these: it passes through a wall
  std::uint64_t stopped = 0;        ///< of these: it stops where no wall is
  std::uint64_t wrong_cells = 0;    ///< arrives, but in a cell that does not hold the target; where it knows cells
  std::uint64_t tests = 0;          ///< orientation tests; 0 where it makes none

  /// Median over up to 50 blocks of steps, per particle. Blocks of more than eight steps are multiples of eight, in
  /// which the steps of W4 repeat.
  [[nodiscard]] double ns_per_particle_step(std::size_t particles) const;
  /// All steps, per particle.
  [[nodiscard]] double mean_ns_per_particle_step(std::size_t particles) const;
  /// A quantile of the times of single steps, ns. `share` 0.5: the median, 1: the longest.
  [[nodiscard]] double quantile_ns(double share) const;
};

/// One workload with one number of threads.
struct Row {
  WorkloadOptions workload;
  unsigned threads = 1;
  std::size_t cells = 0;
  std::size_t wall_triangles = 0;
  std::vector<Series> all_series;  ///< dartcast first
  Counters counters;               ///< dartcast's

  [[nodiscard]] const Series* series(std::string_view name) const;
};

/// Runs a workload: a row for each number of threads. In the plane only competitors that have an answer there take
/// part. dartcast leads, in blocks of up to 100 steps; a twin then takes the same steps and writes them down, and each
/// competitor answers the block's segments, every block another one first. The first block is not counted. So each
/// works with its own data in the caches, but for what computing the new positions has driven out, where the scene
/// deforms; what disturbs one disturbs all.
///
/// A competitor disagrees on a segment where one of the two meets a wall and the other does not, or where both do and
/// neither the triangle nor the time (within 1e-4 of a cell) is the same. The scene continues with dartcast's answers.
std::vector<Row> compare(const WorkloadOptions& options, std::span<const PeerKind> kinds);

}  // namespace dartcast::bench
