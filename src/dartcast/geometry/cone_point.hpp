// Where to put the point of its own that a cell is coned from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/exact/vec3.hpp"

namespace dartcast::detail {

struct Triangle {
  Vec3 a, b, c;  ///< counterclockwise seen from the outside
};

/// The sum over the number, in the order given.
Vec3 mean(std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// The fan of a face: from its mean where it has a point of its own, else from its lowest-numbered vertex.
std::vector<Triangle> fan(std::span<const Vec3> points, std::span<const std::uint32_t> face, bool has_point);

/// Whether the apex makes a positive simplex with every triangle; exact.
bool all_positive(const Vec3& apex, std::span<const Triangle> triangles);

/// Weights over the corners, summing to 1, that give x but for rounding: the equal weights and the least correction.
std::vector<double> weights_for(const Vec3& x, std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// Weights over the corners, summing to 1, of a point from which all triangles are positive: equal ones where their
/// mean is such a point, or where none is found.
std::vector<double> cone_weights(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                                 std::span<const Triangle> triangles);

}  // namespace dartcast::detail
