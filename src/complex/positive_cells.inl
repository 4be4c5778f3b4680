// Filters the simplices of four cells of one shape, one cell in each lane. Compiled once for each instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/double4.inl"
#include "complex/positive_cells.hpp"
#include "dartcast/cell_shape.hpp"
#include "dartcast/predicates.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {

// All simplices of a shape have the same first corner. The points relative to it are differences as orient3d() takes
// them (dartcast/predicates.hpp). The bound is that of the whole cell's extent, for a larger m bounds no less.
unsigned proved_positive(const Shape& shape, const std::array<const std::uint32_t*, 4>& vertices,
                         const Vec3* positions) {
  const auto& simplices = shape.simplices();
  const auto& [v0, v1, v2, v3] = vertices;
  const std::uint16_t first = simplices[0].vertex[0];
  const Vec3x4 apex =
      load_vec3x4(positions[v0[first]], positions[v1[first]], positions[v2[first]], positions[v3[first]]);
  std::array<Vec3x4, max_filtered_points> points;
  Vec3x4 extent = {Double4{}, Double4{}, Double4{}};
  for (std::size_t i = 0; i < shape.point_count(); ++i) {
    points[i] = load_vec3x4(positions[v0[i]], positions[v1[i]], positions[v2[i]], positions[v3[i]]) - apex;
    extent = larger(extent, magnitude(points[i]));
  }
  // As filter_applies().
  Mask4 proved = (largest(extent) <= largest_decided_extent) & (smallest(extent) >= smallest_extent);
  const Double4 bound = determinant_error * (extent.x * extent.y * extent.z);
  for (const ImplicitSimplex& s : simplices)
    proved &= dot(points[s.vertex[1]], cross(points[s.vertex[2]], points[s.vertex[3]])) > bound;
  return lanes_set(proved);
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
