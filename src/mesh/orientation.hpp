// Orientation of cells, by exact signs of their corners. Cells that are inside out are mirrored.
#pragma once

#include <cstddef>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

enum class Orientation {
  positive,  ///< more positive corners than negative ones
  mirrored,  ///< it was inside out, and its corners have been reordered
  flat,      ///< every corner is exactly flat
  inverted,  ///< as many corners turn one way as the other: reordering does not help; in the plane: not convex
};

/// Orients cell c in place. For the standard types the exact signs of the corners' determinants decide by majority. For
/// a polyhedron those of its faces seen from its two extreme corners. A cell that is positive here may still have a
/// corner that is turned in. Whether it can be cut into positive simplices is tested in complex/. In the plane a cell
/// must be weakly convex: no corner turns the other way, and its edges go around once. Corners may be straight, but no
/// edge may have both ends at one place. Such a cell is mirrored if it runs clockwise. Preconditions:
/// connectivity is well formed, polyhedra are closed with consistent faces, coordinates in the exact range.
Orientation orient_cell(MeshData& mesh, std::size_t c);

}  // namespace dartcast
