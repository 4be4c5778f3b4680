// One implicit simplex in space: its corners, and the four determinants that say where a point is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "dartcast/base/ids.hpp"
#include "dartcast/exact/predicates.hpp"

namespace dartcast {

/// Names an implicit simplex: a cell and the number of one of its shape's simplices.
struct SimplexId {
  Cell cell;
  std::uint16_t simplex = 0;

  [[nodiscard]] constexpr bool valid() const { return cell.valid(); }
  constexpr auto operator<=>(const SimplexId&) const = default;
};

using Corners = std::array<Vec3, 4>;

/// The corners of the facet opposite to corner i, so that orient3d(a, b, c, x) is positive on the side of corner i.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> facet_corners = {
    {{2, 1, 3}, {0, 2, 3}, {1, 0, 3}, {0, 1, 2}}};

inline Sign orient_facet(const Corners& v, unsigned facet, const Vec3& x) {
  const auto& f = facet_corners[facet];
  return orient3d(v[f[0]], v[f[1]], v[f[2]], x);
}

/// det_i: the determinant of the simplex with corner i replaced by x. All four are positive inside a valid simplex, and
/// sum to six times its volume; det_i over the sum is x's barycentric coordinate i.
struct Determinants {
  std::array<double, 4> value;
  double bound;  ///< largest error of each value
  bool applies;  ///< whether the bound holds (everything finite and in range)

  Determinants(const Corners& v, const Vec3& x) {
    const Vec3 r0 = v[0] - x;
    const Vec3 r1 = v[1] - x;
    const Vec3 r2 = v[2] - x;
    const Vec3 r3 = v[3] - x;
    const Vec3 n01 = cross(r0, r1);
    const Vec3 n23 = cross(r2, r3);
    value = {dot(r1, n23), -dot(r0, n23), dot(r3, n01), -dot(r2, n01)};
    const auto largest = [](double a, double b, double c, double d) {
      return std::max(std::max(std::abs(a), std::abs(b)), std::max(std::abs(c), std::abs(d)));
    };
    const double mx = largest(r0.x, r1.x, r2.x, r3.x);
    const double my = largest(r0.y, r1.y, r2.y, r3.y);
    const double mz = largest(r0.z, r1.z, r2.z, r3.z);
    const double m = mx * my * mz;
    bound = determinant_error * m;
    applies = filter_applies(std::max(std::max(mx, my), mz), m);
  }

  [[nodiscard]] double volume6() const { return (value[0] + value[1]) + (value[2] + value[3]); }
  /// The four errors, and the rounding of three sums of values that are at most 6 m each (m = bound /
  /// determinant_error).
  [[nodiscard]] bool proves_positive() const { return applies && volume6() > 8.0 * bound; }
  /// x is strictly inside, and the simplex positive.
  [[nodiscard]] bool all_proved_positive() const {
    return applies && std::min(std::min(value[0], value[1]), std::min(value[2], value[3])) > bound;
  }
  [[nodiscard]] bool decides(unsigned i) const { return applies && std::abs(value[i]) > bound; }
};

/// Exact sign of det_i; `exact` counts the signs that the filter left open.
inline Sign sign_of(const Determinants& d, unsigned i, const Corners& v, const Vec3& x, std::uint64_t& exact) {
  if (d.decides(i)) return d.value[i] > 0.0 ? Sign::positive : Sign::negative;
  ++exact;
  const auto& f = facet_corners[i];
  return orient3d_exact(v[f[0]], v[f[1]], v[f[2]], x);
}

/// Exact sign of the simplex's volume.
inline Sign volume_sign(const Corners& v) { return orient3d(v[0], v[1], v[2], v[3]); }

}  // namespace dartcast
