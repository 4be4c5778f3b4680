// Weights that bring values at cells, or at faces of patches, to the points of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// For each point the items around it and their weights, which sum to 1; none: nothing is around it.
///
/// Weights are inverse distances to the items' centres. Those of cells are corrected so that a linear field comes out
/// exactly. They are not if a weight would turn negative, as at most points of the boundary. So no value at a point
/// leaves the range of those around it. A point's weights depend on the items around it and their order alone. So a
/// part of a mesh gives points with all their cells the same bits as the whole.
struct PointWeights {
  std::vector<std::size_t> offsets = {0};  ///< points + 1
  std::vector<std::uint32_t> items;
  std::vector<double> weights;

  [[nodiscard]] std::size_t points() const { return offsets.size() - 1; }
};

/// From cells, by the centres of their volumes; in the plane of their areas. Precondition: well-formed connectivity. Cost:
/// linear, about 0.1 us for each cell at a point.
PointWeights weights_of_cells(const MeshData& mesh);

/// From patch faces, by the means of their corners.
PointWeights weights_of_patch_faces(const MeshData& mesh);

/// The values at the points, `components` each; 0 at points with nothing around them. `values`: as many of each item. Equal
/// values come out to the bit.
std::vector<double> values_at_points(const PointWeights& weights, std::span<const double> values,
                                     std::size_t components);

/// The volume's centre of each cell, in the plane the area's. If it has no size: the mean of its faces' corners.
std::vector<Vec3> cell_centres(const MeshData& mesh);

}  // namespace dartcast
