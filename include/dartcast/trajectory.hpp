// A particle's way through the cells as one list, for drawings and tables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/step.hpp"

namespace dartcast {

/// The reason why a point is on a particle's way.
enum class TrajectoryMark : std::uint8_t { start, crossing, contact, target, end };

/// A point of a particle's way.
struct TrajectoryPoint {
  TrajectoryMark mark = TrajectoryMark::start;
  std::size_t step = 0;  ///< index of the trace
  double time = 0.0;     ///< fraction of that step
  Vec3 point;
  Kind kind = Kind::vertex;  ///< of the cell of the map there: the paper's k
  Cell cell;                 ///< the particle's; at a crossing the one left, at a contact the one at the wall
  Cell next;                 ///< at a crossing: the one entered; else invalid
};

/// The points of a particle's way, in the order of time. The start comes first. Then follow, for each target, the
/// crossings and contacts on the way to it, and the target if it was reached. The last point is the end of the last
/// trace, where the particle arrived, stopped or was held.
std::vector<TrajectoryPoint> trajectory_points(std::span<const Trace> traces);

/// "vertex", "edge", "face", "volume".
std::string_view name_of(Kind kind);
/// "start", "crossing" and so on.
std::string_view name_of(TrajectoryMark mark);

// One trajectory as a table: a row for the start, for each crossing, contact and target, and for the end.

/// Columns: step, time, event, kind, x, y, z, cell and next. A step is a target, from 1 on; the time is a fraction of
/// it. Events are start, crossing, contact, target and end. The kind is that of the map's cell that the particle is in
/// or passes: vertex, edge, face or volume. Cells are indices in the mesh; `next` is the one entered at a crossing, else
/// empty. Numbers are the shortest that give
/// the same bits back, for any locale. `map`: the one that the traces were made in. Cost: linear.
std::string trajectory_csv(const CombinatorialMap& map, std::span<const Trace> traces);

// One trajectory in the plane as a drawing, in the manner of figures 5 and 6 of T. Jund, D. Cazier, J.-F. Dufourd, SPM
// 2009: cut where it passes from cell to cell, with the particle's state at each crossing.

/// SVG: the cells passed, tinted, and those around them, with blocked ones filled. The trajectory changes its colour at
/// each crossing. A dot and a letter mark the start, each crossing, each target and the end. The letter is the kind of
/// the map's cell that the particle is in there: f face, e edge, v vertex. A cross marks each contact. Titles describe
/// all of them. The size of the text depends on the cells passed, not on the scene. The longer side has 800
/// pixels; positions are rounded to 1/100 of a pixel. The bytes are the same for any locale.
///
/// `complex`: the one that the traces were made in, drawn as it stands. Throws InvalidArgument if there is no trace,
/// or if the complex is not of the plane. Cost: one look at each cell of the scene.
std::string trajectory_svg(const CellComplex& complex, std::span<const Trace> traces);

}  // namespace dartcast
