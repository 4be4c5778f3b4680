// Steiner points for cells without a positive pulling triangulation.
#pragma once

#include <vector>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

/// Steiner points that make cells positive, as far as they can be found.
struct SteinerSolution {
  SteinerPoints points;    ///< for the map
  SteinerWeights weights;  ///< in the order of the vertices' numbers
};

/// Looks for Steiner points for some cells (numbers in the mesh). A cell gets the mean of its corners, or a point of
/// its kernel. If a fan triangle of a face stays flat (a corner lies on an edge), the face gets a point, too. Both
/// its cells share that point, and each of them then has one. Cost: linear in these cells and their neighbours.
SteinerSolution find_steiner_points(const MeshData& mesh, const CombinatorialMap& plain, std::span<const Cell> cells);

}  // namespace dartcast
