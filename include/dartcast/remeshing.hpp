// Where cells are not valid any more: local remeshing until they are, or the place is named and left.
//
// "Convexity": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection
// in deformable environments", SPM 2009, section 6.3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast {

struct RepairOptions {
  std::size_t max_cells = 64;  ///< the largest region that is merged
};

enum class Mending : std::uint8_t {
  point,  ///< the cell is coned from a point of its own
  moved,  ///< a vertex around which there are only cells of the region lies elsewhere (it is a new vertex)
  cut     ///< the region was merged, and cut into pyramids, in the plane triangles, around a new vertex
};

struct MendedRegion {
  Mending how = Mending::point;
  std::vector<std::uint32_t> sources;  ///< of its cells, sorted
  std::vector<Cell> cells;             ///< in their place
};

struct LeftCell {
  Cell cell;
  std::uint32_t source = 0;
  std::string reason;
};

struct RepairReport {
  std::vector<MendedRegion> mended;
  std::vector<LeftCell> left;  ///< as they were: no part of the edit
};

/// Mends cells that have a simplex that is not positive; others among those given are passed over. For each in turn the
/// first of these that makes all simplices positive, by exact signs:
///  - a point of its own in the mean of its corners;
///  - moving one of its corners, around which there are only cells of the same kind (free or blocked);
///  - merging and cutting again: the cell alone, then the cells around one of its corners, around several of them, then
///    all neighbours, and so on; only cells of the same kind, at most so many as the options say. The region's surface
///    must have a kernel (a point from which all of it is seen from the inside).
/// No vertex on the surface of a region moves, vertices inside it go. The outer faces keep their patches; a new cell
/// takes the source of the cell that had its outer face. Corners are tried in the order of how many such cells
/// they have around them, then of their numbers. Cells that are left are tried again after others were mended.
///
/// Where there are no such cells, or none can be mended, the map is as it was, to the last record. After edits in
/// the same ComplexEdit that have not been committed, cells are judged without the points that the commit gives them.
/// Throws InvalidArgument where there is no such cell. Cost: that of the largest regions tried, whatever the size of
/// the scene; where regions hang together, so often as this mends one.
RepairReport repair(ComplexEdit& edit, std::span<const Cell> cells, const RepairOptions& options = {});

}  // namespace dartcast
