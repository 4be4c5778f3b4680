// The place of the Steiner point that a cell is coned from.
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

/// The triangle over an edge of a planar polygon. A point of the plane is behind it exactly if it is on the left of the
/// edge.
inline ConeTriangle upright(const Vec3& a, const Vec3& b) { return {a, b, {a.x, a.y, a.z + norm(b - a)}}; }

/// The mean: the sum, in the given order, over the number.
Vec3 mean(std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// Adds the fan of a face: around its Steiner point if it has one, else around its lowest-numbered vertex. `at(v)`: the
/// position of the vertex with that number.
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
  triangles.reserve(face.size());
  add_fan(triangles, face, point, [&](std::uint32_t v) { return points[v]; });
  return triangles;
}

/// Whether the apex makes a positive simplex with every triangle; exact.
bool all_positive(const Vec3& apex, std::span<const ConeTriangle> triangles);

/// Weights over the corners, with sum 1, that give x up to rounding: equal weights and the smallest correction.
std::vector<double> weights_for(const Vec3& x, std::span<const Vec3> points, std::span<const std::uint32_t> corners);

/// Weights over the corners, with sum 1, of a point from which all triangles are positive. They are equal if the mean
/// is such a point, or if none is found.
std::vector<double> cone_weights(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                                 std::span<const ConeTriangle> triangles);

}  // namespace dartcast::detail
