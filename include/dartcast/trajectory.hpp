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

/// The points of a particle's way, in the order of time: the start; the crossings and contacts on the way to each
/// target, and the target if it was reached; the end of the last trace, where the particle arrived, stopped or was
/// held.
std::vector<TrajectoryPoint> trajectory_points(std::span<const Trace> traces);

/// "vertex", "edge", "face", "volume".
std::string_view name_of(Kind kind);
/// "start", "crossing" and so on.
std::string_view name_of(TrajectoryMark mark);

// One trajectory as a table: a row for the start, for each crossing, contact and target, and for the end.

/// Columns: step (from 1, one for each target), time (fraction of the step), event (start, crossing, contact, target,
/// end), kind (vertex, edge, face, volume: of the cell of the map that the particle is in, or passes), x, y, z, cell
/// and next (indices in the mesh; next: the one entered at a crossing, else empty). Numbers are the shortest that give
/// the same bits back, for any locale. `map`: the one that the traces were made in. Cost: linear.
std::string trajectory_csv(const CombinatorialMap& map, std::span<const Trace> traces);

// One trajectory in the plane as a drawing, in the manner of figures 5 and 6 of T. Jund, D. Cazier, J.-F. Dufourd, SPM
// 2009: cut where it passes from cell to cell, with the particle's state at each crossing.

/// SVG: the cells around those passed (these tinted, blocked ones filled), the trajectory in pieces of alternating
/// colours (one more than there are crossings), a dot and a letter at the start, each crossing, target and the end (f
/// face, e edge, v vertex: the cell of the map that the particle is in there), a cross at each contact. Their
/// titles describe them. The size of the text depends on the cells passed, not on the scene. The longer side has 800
/// pixels; positions are rounded to 1/100 of a pixel. The bytes are the same for any locale.
///
/// `complex`: the one that the traces were made in, drawn as it stands. Throws InvalidArgument where there is no trace,
/// or where the complex is not of the plane. Cost: one look at each cell of the scene.
std::string trajectory_svg(const CellComplex& complex, std::span<const Trace> traces);

// One trajectory as a page that turns in the browser, in the plane and in space.

/// HTML in one file, in the style of the report of a run (docs/report.md): the walls of the scene, the cells passed as a
/// patch of its own, the way as a line with its crossings and contacts, a time line of them, and the table of
/// trajectory_csv(). Walls are those of the whole scene; beyond 200,000 faces those around the cells passed. If there are
/// more than 2,000 points, the page shows an even choice of them and says so.
///
/// `complex`: the one that the traces were made in, drawn as it stands. Throws InvalidArgument where there is no trace.
/// Cost: one look at each cell of the scene.
std::string trajectory_html(const CellComplex& complex, std::span<const Trace> traces);

}  // namespace dartcast
