// Triangles for a hole whose border need not be near a plane.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/vec3.hpp"
#include "surface/triangle_pairs.hpp"

namespace dartcast {

/// Triangles between the corners of a hole that cross and touch neither each other nor the surface, beyond corners and
/// edges in common. Their sense is that of the corners. Their area in all is the least (G. Barequet, M. Sharir, "Filling
/// gaps in the boundary of a polyhedron", 1995), if no two of the triangles with that area cross; else it is small. Empty:
/// none were found, or there are more than 300 corners. `surface`: the triangles around. Cost: the third power of the
/// corners, and linear in the surface.
std::vector<TriangleCorners> fill_hole(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                                       std::span<const TriangleCorners> surface);

}  // namespace dartcast
