// Polygons in space as triangles, also if they are not convex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/vec3.hpp"
#include "surface/triangle_pairs.hpp"

namespace dartcast {

/// Twice the vector area of a polygon, rounded.
Vec3 vector_area(std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// Triangles with the corners of a polygon, in its sense of rotation, by cutting off ears. If the polygon does not
/// cross itself as seen along the axis nearest to its normal, the triangles do not overlap, by exact signs. If it does,
/// the result is a fan. Cost: the square of the corners. Precondition: at least three corners.
std::vector<TriangleCorners> ears(std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// Whether the triangles run counterclockwise, as ears() sees the polygon: then those of a fan, or of ears(), do not
/// overlap. Exact.
bool do_not_overlap(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                    std::span<const TriangleCorners> triangles);

/// The triangles of a polygon from one of its corners on.
std::vector<TriangleCorners> fan_from(std::span<const std::uint32_t> corners, std::size_t first);

}  // namespace dartcast
