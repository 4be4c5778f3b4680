// One implicit simplex in space: its corners, and the four determinants that say where a point is.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
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
  Vec3 extent;   ///< of the differences

  Determinants(const Corners& v, const Vec3& x) {
    const Vec3 r0 = v[0] - x;
    const Vec3 r1 = v[1] - x;
    const Vec3 r2 = v[2] - x;
    const Vec3 r3 = v[3] - x;
    const Vec3 n01 = cross(r0, r1);
    const Vec3 n23 = cross(r2, r3);
    value = {dot(r1, n23), -dot(r0, n23), dot(r3, n01), -dot(r2, n01)};
    extent = extent_of(r0, r1, r2, r3);
    const double m = extent.x * extent.y * extent.z;
    bound = determinant_error * m;
    applies = filter_applies(std::max(std::max(extent.x, extent.y), extent.z), m);
  }

  [[nodiscard]] double volume6() const { return (value[0] + value[1]) + (value[2] + value[3]); }
  /// The four errors, and the rounding of three sums of values that are at most 6 m each (m = bound /
  /// determinant_error).
  [[nodiscard]] bool proves_positive() const { return applies && volume6() > 8.0 * bound; }
  /// The values over their sum are the coordinates of a point of the simplex right to 2^-26: each value is off by at
  /// most the bound, the sum by eight times that.
  [[nodiscard]] bool proves_coordinates() const { return applies && volume6() > 0x1p+30 * bound; }
  /// x is strictly inside, and the simplex positive.
  [[nodiscard]] bool all_proved_positive() const {
    return applies && std::min(std::min(value[0], value[1]), std::min(value[2], value[3])) > bound;
  }
  [[nodiscard]] bool decides(unsigned i) const { return applies && std::abs(value[i]) > bound; }
  /// Whether the values are exact. `v`, `x`: those that the determinants are of.
  [[nodiscard]] bool exact(const Corners& v, const Vec3& x) const {
    return applies && rounds_nothing(extent, v[0], v[1], v[2], v[3], x);
  }
};

/// Of some of the four determinants: bit i is set where det_i is negative, or zero. In neither: positive, or
/// undecidable.
struct DeterminantSigns {
  unsigned negative = 0;
  unsigned zero = 0;
};

/// Exact signs of the determinants in the mask `asked`; `exact` counts the signs that the filter left open.
inline DeterminantSigns signs_of(const Determinants& d, const Corners& v, const Vec3& x, unsigned asked,
                                 std::uint64_t& exact) {
  DeterminantSigns signs;
  unsigned open = 0;
  for (unsigned i = 0; i < 4; ++i) {
    signs.negative |= d.value[i] < 0.0 ? 1U << i : 0U;
    signs.zero |= d.value[i] == 0.0 ? 1U << i : 0U;
    open |= d.decides(i) ? 0U : 1U << i;
  }
  open &= asked;
  signs.negative &= asked;
  signs.zero &= asked;
  if (open == 0) return signs;
  const bool exact_values = d.exact(v, x);
  if (!exact_values) {
    signs.negative &= ~open;
    signs.zero &= ~open;
  }
  for (; open != 0; open &= open - 1) {
    ++exact;
    if (exact_values) continue;
    const auto i = static_cast<unsigned>(std::countr_zero(open));
    const auto& f = facet_corners[i];
    const Sign s = orient3d_exact(v[f[0]], v[f[1]], v[f[2]], x);
    signs.negative |= s == Sign::negative ? 1U << i : 0U;
    signs.zero |= s == Sign::zero ? 1U << i : 0U;
  }
  return signs;
}

/// Exact sign of det_i; `exact` counts the signs that the filter left open.
inline Sign sign_of(const Determinants& d, unsigned i, const Corners& v, const Vec3& x, std::uint64_t& exact) {
  if (d.decides(i)) return d.value[i] > 0.0 ? Sign::positive : Sign::negative;
  ++exact;
  if (d.exact(v, x)) return d.value[i] > 0.0 ? Sign::positive : d.value[i] < 0.0 ? Sign::negative : Sign::zero;
  const auto& f = facet_corners[i];
  return orient3d_exact(v[f[0]], v[f[1]], v[f[2]], x);
}

/// Exact sign of the simplex's volume.
inline Sign volume_sign(const Corners& v) { return orient3d(v[0], v[1], v[2], v[3]); }

}  // namespace dartcast
