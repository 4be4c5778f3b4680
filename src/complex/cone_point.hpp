// Where to put the point of its own that a cell is coned from.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast::detail {

struct ConeTriangle {
  Vec3 a, b, c;  ///< counterclockwise seen from the outside
};

/// Over an edge of a polygon in the plane: a point of the plane is behind it as it is on the left of the edge.
inline ConeTriangle upright(const Vec3& a, const Vec3& b) { return {a, b, {a.x, a.y, a.z + norm(b - a)}}; }

/// The sum over the number, in the order given.
Vec3 mean(std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// Adds the fan of a face: from its own point where it has one, else from its lowest-numbered vertex. `at(v)`: where
/// the vertex with that number is.
template <class At>
void add_fan(std::vector<ConeTriangle>& triangles, std::span<const std::uint32_t> face,
             const std::optional<Vec3>& point, At&& at) {
  const std::size_t k = face.size();
  const auto lowest = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  const auto corner = [&](std::size_t i) { return at(face[(lowest + i) % k]); };
  if (point) {
    for (std::size_t i = 0; i < k; ++i) triangles.push_back({*point, corner(i), corner(i + 1)});
  } else {
    for (std::size_t i = 1; i + 1 < k; ++i) triangles.push_back({corner(0), corner(i), corner(i + 1)});
  }
}

/// The fan of one face.
inline std::vector<ConeTriangle> fan(std::span<const Vec3> points, std::span<const std::uint32_t> face,
                                     const std::optional<Vec3>& point = {}) {
  std::vector<ConeTriangle> triangles;
  add_fan(triangles, face, point, [&](std::uint32_t v) { return points[v]; });
  return triangles;
}

/// Whether the apex makes a positive simplex with every triangle; exact.
bool all_positive(const Vec3& apex, std::span<const ConeTriangle> triangles);

/// Weights over the corners, summing to 1, that give x but for rounding: the equal weights and the least correction.
std::vector<double> weights_for(const Vec3& x, std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// Weights over the corners, summing to 1, of a point from which all triangles are positive: equal ones where their
/// mean is such a point, or where none is found.
std::vector<double> cone_weights(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                                 std::span<const ConeTriangle> triangles);

}  // namespace dartcast::detail
