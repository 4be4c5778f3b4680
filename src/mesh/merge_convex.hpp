// Convex cells out of triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/planar_triangulation.hpp"

namespace dartcast::detail {

/// Takes out edges that are no segments, longest first, as long as the cells are strictly convex and have at most
/// `max_corners` corners. No edge that is left could be taken out. For each half-edge the next one around its cell;
/// PlanarTriangulation::none for those taken out. Decided by exact signs; in n log n.
///
/// This work is based on S. Hertel and K. Mehlhorn, "Fast triangulation of simple polygons", 1983. Unless max_corners
/// keeps some, at most two edges remain for each corner that is not convex by itself. Two such corners need one edge at
/// least.
std::vector<std::uint32_t> merge_convex(const PlanarTriangulation& triangles, std::span<const Vec3> points,
                                        std::uint32_t max_corners);

}  // namespace dartcast::detail
