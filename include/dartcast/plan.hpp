// Plans of runs by cells (Partition::cells) on many ranks, made on one machine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// The run and the machines that are meant.
struct PlanOptions {
  std::uint32_t ranks = 1;
  double particles = 1e5;   ///< of each rank, in the mean
  double cells = 0.0;       ///< of each rank, in the mean; 0: as the mesh has
  double step = 0.1;        ///< length of a particle's way in a step, in mean edges of a cell
  bool deforms = false;     ///< the vertices move in every step
  double latency = 2e-6;    ///< s: of a message between two ranks
  double bandwidth = 1e10;  ///< bytes / s: of a rank
  std::uint32_t samples =
      4;  ///< > 0: parts that are built and stepped to measure: the largest, and others at equal distances
};

/// A value of all ranks.
struct RankSpread {
  double mean = 0.0;
  double largest = 0.0;
};

/// The plan. Counts are of a rank; times are of one step, in s.
struct RunPlan {
  PlanOptions options;
  RankSpread cells;               ///< own ones
  RankSpread ghosts;              ///< cells of other ranks that share a point with an own cell
  RankSpread neighbours;          ///< ranks that have cells of this one as ghosts
  RankSpread bytes;               ///< memory of environment and particles
  RankSpread sent;                ///< particles that leave in a step
  double sent_bytes = 0.0;        ///< of each of these
  double rounds = 0.0;            ///< exchanges in a step
  double seconds_walk = 0.0;      ///< moving the vertices and advancing the particles, on the largest rank
  double seconds_pack = 0.0;      ///< packing and unpacking particles
  double seconds_messages = 0.0;  ///< between neighbours
  double seconds_all = 0.0;       ///< sums and gathers of all ranks
  double seconds_alone = 0.0;     ///< the step of one rank that has the mean share, and nobody beside it

  [[nodiscard]] double seconds() const { return seconds_walk + seconds_pack + seconds_messages + seconds_all; }
  /// Weak scaling: 1 would be a step as fast as that of one rank alone.
  [[nodiscard]] double efficiency() const { return seconds() > 0.0 ? seconds_alone / seconds() : 1.0; }
};

/// Divides the mesh as a run does (partition()), and counts cells, ghosts and neighbours of every part. Then builds
/// sample parts on this machine, one after another, and fills them with particles. It measures their memory, the time
/// of a step, and the particles that leave. docs/benchmark.md says how the other times follow. With `cells` of
/// another number than the mesh has, ghosts and particles that leave grow as the surface of a part. Throws
/// InvalidArgument if an option is out of range or there are fewer cells than ranks. Precondition:
/// check_and_repair() found the mesh valid, and it is of space. Cost: about 1 us a cell, and the samples.
RunPlan plan_run(const MeshData& mesh, const PlanOptions& options);

}  // namespace dartcast
