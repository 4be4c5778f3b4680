// Cells and patch faces with corners that coincide by their numbers.
#pragma once

#include <cstddef>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Whether a corner repeats in cell c; of a polyhedron, in a face. Precondition: the cell's connectivity is well formed.
bool repeats_corner(const MeshData& mesh, std::size_t c);

/// Gives cells and patch faces with repeated corners the type that they have without. A hexahedron with an edge in one
/// point becomes a prism, with a face in one point a pyramid. Those that have no such type stay. A repair of kind
/// "collapsed" reports them. Precondition: the connectivity of all cells is well formed.
void retype_collapsed(MeshData& mesh, MeshReport& report);

}  // namespace dartcast
