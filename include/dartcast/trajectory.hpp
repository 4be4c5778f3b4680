// A particle's way through the cells as one list, for drawings and tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "dartcast/trace.hpp"

namespace dartcast {

enum class TrajectoryMark : std::uint8_t { start, crossing, contact, target, end };

struct TrajectoryPoint {
  TrajectoryMark mark = TrajectoryMark::start;
  std::size_t step = 0;  ///< index of the trace
  double time = 0.0;     ///< fraction of that step
  Vec3 point;
  Kind kind = Kind::vertex;  ///< of the place: the paper's k
  Cell cell;                 ///< the particle's; at a crossing the one left, at a contact the one at the wall
  Cell next;                 ///< at a crossing: the one entered; else invalid
};

/// From the start, through what happened on the way to each target (which it reached: `target`), to the end of the last
/// trace: at its target, or where the particle stopped or was held. In the order of time.
std::vector<TrajectoryPoint> trajectory_points(std::span<const Trace> traces);

/// "vertex", "edge", "face", "volume".
std::string_view name_of(Kind kind);
/// "start", "crossing" and so on.
std::string_view name_of(TrajectoryMark mark);

}  // namespace dartcast
