// One implicit simplex: its corners, and the determinants that say where a point is.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dartcast/cell_complex.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/predicates.hpp"
#include "topology/facet_corners.hpp"

namespace dartcast {

inline Sign orient_facet(const Corners& v, unsigned facet, const Vec3& x) {
  const auto& f = facet_corners[facet];
  return orient3d(v[f[0]], v[f[1]], v[f[2]], x);
}
inline Sign orient_facet(const PlaneCorners& v, unsigned facet, const Vec3& x) {
  const auto& f = plane_facet_corners[facet];
  return orient2d(v[f[0]], v[f[1]], x);
}
inline Sign orient_facet_exact(const Corners& v, unsigned facet, const Vec3& x) {
  const auto& f = facet_corners[facet];
  return orient3d_exact(v[f[0]], v[f[1]], v[f[2]], x);
}
inline Sign orient_facet_exact(const PlaneCorners& v, unsigned facet, const Vec3& x) {
  const auto& f = plane_facet_corners[facet];
  return orient2d_exact(v[f[0]], v[f[1]], x);
}

inline double orient_facet_value(const Corners& v, unsigned facet, const Vec3& x) {
  const auto& f = facet_corners[facet];
  return orient3d_value(v[f[0]], v[f[1]], v[f[2]], x);
}
inline double orient_facet_value(const PlaneCorners& v, unsigned facet, const Vec3& x) {
  const auto& f = plane_facet_corners[facet];
  return orient2d_value(v[f[0]], v[f[1]], x);
}

/// The gradient of det_i: the facet's inner normal, with a length of twice its area (in the plane: its length).
inline Vec3 facet_gradient(const Corners& v, unsigned facet) {
  const auto& f = facet_corners[facet];
  return cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]]);
}
inline Vec3 facet_gradient(const PlaneCorners& v, unsigned facet) {
  const auto& f = plane_facet_corners[facet];
  const Vec3 along = v[f[1]] - v[f[0]];
  return {-along.y, along.x, 0.0};
}

/// The determinants det_i of a point x: that of the simplex with corner i replaced by x. All are positive inside a
/// valid simplex. They sum to six times its volume (in the plane twice its area). det_i over the sum is x's barycentric
/// coordinate i.
template <std::size_t N>
struct Determinants {
  std::array<double, N> value;
  double bound;  ///< largest error of each value; infinite if the filter does not apply
  Vec3 extent;   ///< of the differences

  Determinants(const std::array<Vec3, N>& v, const Vec3& x) {
    if constexpr (N == 4) {
      const Vec3 r0 = v[0] - x;
      const Vec3 r1 = v[1] - x;
      const Vec3 r2 = v[2] - x;
      const Vec3 r3 = v[3] - x;
      const Vec3 n01 = cross(r0, r1);
      const Vec3 n23 = cross(r2, r3);
      value = {dot(r1, n23), -dot(r0, n23), dot(r3, n01), -dot(r2, n01)};
      extent = extent_of(r0, r1, r2, r3);
      bound = filter_applies(extent) ? error() : std::numeric_limits<double>::infinity();
    } else {
      const Vec3 r0 = v[0] - x;
      const Vec3 r1 = v[1] - x;
      const Vec3 r2 = v[2] - x;
      const auto turn = [](const Vec3& a, const Vec3& b) { return a.x * b.y - a.y * b.x; };
      value = {turn(r1, r2), turn(r2, r0), turn(r0, r1)};
      extent = extent_of(r0, r1, r2);
      bound = plane_filter_applies(extent.x, extent.y) ? error() : std::numeric_limits<double>::infinity();
    }
  }

  [[nodiscard]] double volume6() const {
    if constexpr (N == 4) return (value[0] + value[1]) + (value[2] + value[3]);
    return (value[0] + value[1]) + value[2];
  }
  /// Whether the sum exceeds its errors: those of the values, and the rounding of three sums of values of at most 6 m
  /// each (m = bound / determinant_error).
  [[nodiscard]] bool proves_positive() const { return volume6() > 8.0 * bound; }
  /// The values over their sum are the coordinates of a point of the simplex, accurate to 2^-26. Each value is off by
  /// at most the bound, and the sum by eight times that.
  [[nodiscard]] bool proves_coordinates() const { return volume6() > 0x1p+30 * bound_in_range(); }
  /// x is strictly inside, and the simplex positive.
  [[nodiscard]] bool all_proved_positive() const { return smallest() > bound; }
  /// The same for points that are known to be in the exact range.
  [[nodiscard]] bool all_positive_in_range() const { return smallest() > bound_in_range(); }
  [[nodiscard]] bool decides(unsigned i) const { return std::abs(value[i]) > bound; }
  /// The bound if the filter applies.
  [[nodiscard]] double error() const {
    if constexpr (N == 4) return determinant_error * (extent.x * extent.y * extent.z);
    return plane_error * (extent.x * extent.y);
  }
  /// Whether the values are exact. `v`, `x`: the simplex and the point of these determinants.
  [[nodiscard]] bool exact(const std::array<Vec3, N>& v, const Vec3& x) const {
    if (!(bound <= std::numeric_limits<double>::max())) return false;
    if constexpr (N == 4) return rounds_nothing(extent, v[0], v[1], v[2], v[3], x);
    return rounds_nothing(extent, v[0], v[1], v[2], x);
  }

 private:
  [[nodiscard]] double smallest() const { return *std::min_element(value.begin(), value.end()); }
  // For points in the exact range, the bound holds farther than the filter applies.
  [[nodiscard]] double bound_in_range() const {
    if (bound <= std::numeric_limits<double>::max()) return bound;
    const bool holds = N == 4 ? bound_holds(extent) : plane_bound_holds(extent.x, extent.y);
    return holds ? error() : bound;
  }
};
template <std::size_t N>
Determinants(const std::array<Vec3, N>&, const Vec3&) -> Determinants<N>;

/// Signs of some of the determinants. Bit i is set if det_i is negative, or if it is zero. If neither is set, it
/// is positive or undecidable.
struct DeterminantSigns {
  unsigned negative = 0;
  unsigned zero = 0;
};

/// Exact signs of the determinants in the mask `asked`; `exact` counts the signs that the filter left open.
template <std::size_t N>
DeterminantSigns signs_of(const Determinants<N>& d, const std::array<Vec3, N>& v, const Vec3& x, unsigned asked,
                          std::uint64_t& exact) {
  DeterminantSigns signs;
  unsigned open = 0;
  for (unsigned i = 0; i < N; ++i) {
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
    const Sign s = orient_facet_exact(v, i, x);
    signs.negative |= s == Sign::negative ? 1U << i : 0U;
    signs.zero |= s == Sign::zero ? 1U << i : 0U;
  }
  return signs;
}

/// Exact sign of det_i; `exact` counts the signs that the filter left open.
template <std::size_t N>
Sign sign_of(const Determinants<N>& d, unsigned i, const std::array<Vec3, N>& v, const Vec3& x, std::uint64_t& exact) {
  if (d.decides(i)) return d.value[i] > 0.0 ? Sign::positive : Sign::negative;
  ++exact;
  if (d.exact(v, x)) return d.value[i] > 0.0 ? Sign::positive : d.value[i] < 0.0 ? Sign::negative : Sign::zero;
  return orient_facet_exact(v, i, x);
}

/// The determinant as a double, accurate to 2^-49 of itself.
inline double volume_value(const Corners& v) { return orient3d_value(v[0], v[1], v[2], v[3]); }
inline double volume_value(const PlaneCorners& v) { return orient2d_value(v[0], v[1], v[2]); }

/// Exact sign of the simplex's volume, or area.
inline Sign volume_sign(const Corners& v) { return orient3d(v[0], v[1], v[2], v[3]); }
inline Sign volume_sign(const PlaneCorners& v) { return orient2d(v[0], v[1], v[2]); }

}  // namespace dartcast
