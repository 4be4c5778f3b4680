// Interior points for cells whose pulling triangulation is not positive.
#pragma once

#include <vector>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

/// Interior points that make cells positive, as far as they can be found.
struct SteinerSolution {
  SteinerPoints points;    ///< for the map
  SteinerWeights weights;  ///< in the order of the vertices' numbers
};

/// Looks for interior points for the cells given (numbers in the mesh). A cell takes a point of its own: the mean of
/// its corners, or a point of its kernel; where a fan triangle of a face stays flat (a corner that lies on an edge),
/// the face takes a point, too, shared by both its cells, which then have a point each. Cost: linear in these cells and
/// their neighbours.
SteinerSolution find_steiner_points(const MeshData& mesh, const CombinatorialMap& plain, std::span<const Cell> cells);

}  // namespace dartcast
