// Whether two triangles of a surface cross or touch where they should not. All signs are exact.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast {

using TriangleCorners = std::array<std::uint32_t, 3>;

/// Whether two triangles have a point in common beyond the corners, or the edge, that they share by number. Two with the
/// same corners do. Precondition: both have an area, and their corners are in the exact range.
bool cross_or_touch(std::span<const Vec3> points, const TriangleCorners& a, const TriangleCorners& b);

/// All such pairs, the lower number first, in increasing order; at most `limit`. Cost: n log n, and the pairs with boxes
/// that overlap.
std::vector<std::pair<std::uint32_t, std::uint32_t>> crossing_pairs(std::span<const Vec3> points,
                                                                    std::span<const TriangleCorners> triangles,
                                                                    std::size_t limit);

}  // namespace dartcast
