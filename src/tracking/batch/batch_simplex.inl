// Four simplices and a point each, one in each lane: the signs that a step asks for. Part of the batch's kernel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/double4.inl"
#include "complex/simplex.hpp"
#include "dartcast/predicates.hpp"
#include "tracking/batch/coordinate_bounds.hpp"
#include "tracking/batch/particle_cache.hpp"
#include "tracking/space.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Sign of u . (v x w), evaluated as in src/predicates/predicates.cpp; 0 if the filter leaves it open.
inline int filtered_sign(const Vec3& u, const Vec3& v, const Vec3& w) {
  const auto largest = [](double a, double b, double c) { return std::max({std::abs(a), std::abs(b), std::abs(c)}); };
  const double x = largest(u.x, v.x, w.x);
  const double y = largest(u.y, v.y, w.y);
  const double z = largest(u.z, v.z, w.z);
  const double m = x * y * z;
  if (!filter_applies({x, y, z})) return 0;
  const double value = dot(u, cross(v, w));
  return value > determinant_error * m ? 1 : value < -determinant_error * m ? -1 : 0;
}

inline Corners corners_of(const Vec3* positions, const VertexNumbers& v) {
  return {positions[v[0]], positions[v[1]], positions[v[2]], positions[v[3]]};
}
inline Corners corners_of(const Between& positions, const VertexNumbers& v) {
  return {positions[Vertex{v[0]}], positions[Vertex{v[1]}], positions[Vertex{v[2]}], positions[Vertex{v[3]}]};
}

// As BatchDeterminants::far_away(), of one point.
inline bool is_far_away(const Determinants<4>& d, double coordinate = far_coordinate) {
  return *std::min_element(d.value.begin(), d.value.end()) < -coordinate * d.volume6();
}

struct Corners4 {
  Vec3x4 corner[4];

  Corners4() = default;
  [[gnu::always_inline]] Corners4(const Vec3* positions, const VertexNumbers& a, const VertexNumbers& b,
                                  const VertexNumbers& c, const VertexNumbers& d) {
    for (unsigned i = 0; i < 4; ++i)
      corner[i] = load_vec3x4(positions[a[i]], positions[b[i]], positions[c[i]], positions[d[i]]);
  }
};

// As Between in tracking/space.hpp: at the time s, 1 at most.
inline Vec3x4 between(const Vec3x4& from, const Vec3x4& to, const Double4& s) {
  return choose(s == 1.0, to, from + (to - from) * s);
}
[[gnu::always_inline]] inline Corners4 between(const Corners4& from, const Corners4& to, const Double4& s) {
  Corners4 v;
  for (unsigned i = 0; i < 4; ++i) v.corner[i] = between(from.corner[i], to.corner[i], s);
  return v;
}

// In each lane a bit for each facet.
inline Mask4 facet_bits(const Mask4& m0, const Mask4& m1, const Mask4& m2, const Mask4& m3) {
  return ((m0 & splat_bits(1)) | (m1 & splat_bits(2))) | ((m2 & splat_bits(4)) | (m3 & splat_bits(8)));
}

// The sides of a simplex's facets that one point is on, as bits: the signs of its determinants.
class FacetSigns4 {
 public:
  static constexpr long long valid = 1LL << 12;
  static constexpr long long exact = 1LL << 13;

  FacetSigns4() = default;  // uninitialized
  explicit FacetSigns4(long long bits) : bits_(static_cast<unsigned>(bits)) {}
  [[nodiscard]] unsigned negative() const { return bits_ & 15U; }
  [[nodiscard]] unsigned zero() const { return (bits_ >> 4U) & 15U; }
  [[nodiscard]] unsigned open() const { return (bits_ >> 8U) & 15U; }  // by the filter
  // Whether the simplex is proved positive, and the side of each of these facets is proved.
  [[nodiscard]] bool is_known(unsigned facets = 15) const {
    const bool proved = (open() & facets) == 0;
    return ((bits_ & valid) != 0) & (proved | ((bits_ & exact) != 0));  // no branches: lattices would mispredict them
  }
  [[nodiscard]] bool is_inside() const { return bits_ == unsigned{1} << 12U; }

 private:
  unsigned bits_;
};

// The determinants of complex/simplex.hpp, by the same operations, of four points, and the bounds of their errors.
struct BatchDeterminants {
  Vec3x4 relative[4];  // corners, to the points
  Vec3x4 extent;       // largest magnitudes of these
  Double4 value[4];
  Double4 bound;  // infinite if the filter does not apply

  BatchDeterminants() = default;
  [[gnu::always_inline]] BatchDeterminants(const Corners4& v, const Vec3x4& x)
      : relative{v.corner[0] - x, v.corner[1] - x, v.corner[2] - x, v.corner[3] - x},
        extent(larger(larger(magnitude(relative[0]), magnitude(relative[1])),
                      larger(magnitude(relative[2]), magnitude(relative[3])))) {
    const Vec3x4 n01 = cross(relative[0], relative[1]);
    const Vec3x4 n23 = cross(relative[2], relative[3]);
    value[0] = dot(relative[1], n23);
    value[1] = -dot(relative[0], n23);
    value[2] = dot(relative[3], n01);
    value[3] = -dot(relative[2], n01);
    const Mask4 applies = (largest(extent) <= largest_decided_extent) & (smallest(extent) >= smallest_extent);
    bound = choose(applies, determinant_error * (extent.x * extent.y * extent.z),
                   splat(std::numeric_limits<double>::infinity()));
  }

  [[nodiscard]] Double4 volume6() const { return (value[0] + value[1]) + (value[2] + value[3]); }
  // Whether the points are some simplices away: a coordinate is below minus this.
  [[nodiscard]] Mask4 far_away(double coordinate = far_coordinate) const {
    const Double4 lowest = smaller(smaller(value[0], value[1]), smaller(value[2], value[3]));
    return lowest < -coordinate * volume6();
  }
  [[nodiscard]] Mask4 proves_positive() const { return volume6() > 8.0 * bound; }
  [[nodiscard]] Mask4 proves_coordinates() const { return volume6() > 0x1p+30 * bound; }
  [[nodiscard]] Mask4 all_positive() const {
    return ((value[0] > bound) & (value[1] > bound)) & ((value[2] > bound) & (value[3] > bound));
  }
  [[nodiscard]] Mask4 any_negative() const {
    return ((value[0] < -bound) | (value[1] < -bound)) | ((value[2] < -bound) | (value[3] < -bound));
  }

  // The bits of FacetSigns4 in each lane. `v`, `x`: the corners and points of the determinants.
  [[nodiscard]] [[gnu::always_inline]] Mask4 signs(const Corners4& v, const Vec3x4& x) const {
    Mask4 negative = facet_bits(value[0] < -bound, value[1] < -bound, value[2] < -bound, value[3] < -bound);
    const Mask4 positive = facet_bits(value[0] > bound, value[1] > bound, value[2] > bound, value[3] > bound);
    const Mask4 open = (negative | positive) ^ splat_bits(15);
    const Mask4 is_valid = (positive == splat_bits(15)) | (volume6() - 8.0 * bound > 0.0);
    Mask4 bits = (open << 8) | (is_valid & splat_bits(FacetSigns4::valid));
    if (lanes_set(open != 0) != 0) {
      negative |= open & facet_bits(value[0] < 0.0, value[1] < 0.0, value[2] < 0.0, value[3] < 0.0);
      const Mask4 zero = open & facet_bits(value[0] == 0.0, value[1] == 0.0, value[2] == 0.0, value[3] == 0.0);
      bits |= (zero << 4) | (are_exact(v, x) & (open != 0) & splat_bits(FacetSigns4::exact));
    }
    return bits | negative;
  }

 private:
  // Whether the values are exact (rounds_nothing() in dartcast/predicates.hpp), if the filter applies.
  [[nodiscard]] Mask4 are_exact(const Corners4& v, const Vec3x4& x) const {
    const Vec3x4 unit = extent * splat(0x1p+37);
    const Vec3x4 m = magnitude(x);
    Mask4 rounded = is_rounded(m.x, unit.x) | is_rounded(m.y, unit.y) | is_rounded(m.z, unit.z);
    for (const Vec3x4& corner : v.corner) {
      const Vec3x4 c = magnitude(corner);
      rounded |= is_rounded(c.x, unit.x) | is_rounded(c.y, unit.y) | is_rounded(c.z, unit.z);
    }
    return ~rounded;
  }
  static Mask4 is_rounded(const Double4& m, const Double4& unit) { return ((m + unit) - unit) != m; }
};

[[gnu::always_inline]] inline BatchDeterminants choose(const Mask4& m, const BatchDeterminants& a,
                                                       const BatchDeterminants& b) {
  BatchDeterminants d;
  for (unsigned i = 0; i < 4; ++i) {
    d.relative[i] = choose(m, a.relative[i], b.relative[i]);
    d.value[i] = choose(m, a.value[i], b.value[i]);
  }
  d.extent = choose(m, a.extent, b.extent);
  d.bound = choose(m, a.bound, b.bound);
  return d;
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
