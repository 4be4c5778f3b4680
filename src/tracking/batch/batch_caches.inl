// Simplex caches (tracking/batch/simplex_cache.hpp) of four particles, and what they prove. Part of the batch's kernel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/double4.inl"
#include "dartcast/particle_state.hpp"
#include "tracking/batch/batch_simplex.inl"
#include "tracking/batch/coordinate_bounds.hpp"
#include "tracking/batch/simplex_cache.hpp"
#include "tracking/representable_point.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Vectors of corner i.
inline Vec3x4 load_vectors(const SimplexCache4& caches, unsigned i) {
  return {load_floats(caches.x[i].data()), load_floats(caches.y[i].data()), load_floats(caches.z[i].data())};
}
inline void store_vectors(const Vec3x4& four, SimplexCache4& caches, unsigned i) {
  store_floats(four.x, caches.x[i].data());
  store_floats(four.y, caches.y[i].data());
  store_floats(four.z, caches.z[i].data());
}

// Stores the geometry that the next step needs as its previous one. d: relative to the particles.
inline void store_previous_geometry(const BatchDeterminants& d, SimplexCache4& caches) {
  const Mask4 known = d.proves_coordinates();
  for (unsigned i = 0; i < 4; ++i) {
    store_vectors(d.relative[i], caches, i);
    store_doubles(choose(known, d.value[i], splat(unknown)), caches.w[i].data());
  }
}

// Whether a number has no more than 29 bits: its product with a float is then exact. The sum x + 2^24 x is rounded to a
// multiple of the last place of 2^24 x, which is the 29th place of x.
inline Mask4 has_short_mantissa(const Double4& x) {
  const Double4 far = x * splat(0x1p+24);
  return (far + x) - far == x;
}

// Whether s, the rounded sum of a and b, is exact. The difference of s and the larger one is always exact.
inline Mask4 is_sum(const Double4& s, const Double4& a, const Double4& b) { return (s - a == b) & (s - b == a); }

// Whether g.q + w is zero and no operation rounds. Preconditions: g are floats, q has few bits.
inline Mask4 is_zero(const Vec3x4& g, const Double4& w, const Vec3x4& q) {
  const Double4 x = g.x * q.x;
  const Double4 y = g.y * q.y;
  const Double4 z = g.z * q.z;
  const Double4 xy = x + y;
  const Double4 xyz = xy + z;
  return (xyz + w == 0.0) & is_sum(xy, x, y) & is_sum(xyz, xy, z);
}

// Stores the barycentric coordinates of four simplices; d: relative to the particles p. The gradient of a coordinate is
// the inward normal of its facet over the volume.
//
// ask_exact: returns a bit for each lane in which the coordinates are exact. This holds for lanes in which p is in the
// closed simplex and the differences of p and the corners pass rounds_nothing() (dartcast/predicates.hpp).
// Then the normals are exact. The volume is exact, too: it is a sum of determinants, none of which is
// negative. A function is exact if it has the right gradient and is zero at a corner of the facet. Differences
// are below 2^16 units. If p is within 2^12 of the largest one, corners are below 2^29 units, and have few
// bits.
template <bool ask_exact>
inline unsigned store_barycentric(const BatchDeterminants& d, const Vec3x4& p, SimplexCache4& caches) {
  const Double4 volume = d.volume6();
  const Double4 share = 1.0 / volume;
  const Double4 extent = largest(d.extent);
  const Vec3x4 m = magnitude(p);
  const Double4 reach = largest(larger(d.extent, m * splat(1.0 / extents_from_origin)));
  Mask4 proved =
      d.proves_coordinates() & (volume >= min_volume * (extent * extent * extent)) & (extent <= farthest_corner);
  Mask4 exact{};
  if constexpr (ask_exact) {
    constexpr double close = 0x1p+12;
    exact = has_short_mantissa(volume) & (m.x <= close * d.extent.x) & (m.y <= close * d.extent.y) &
            (m.z <= close * d.extent.z);
  }
  Double4 at_origin[4];
  for (unsigned i = 0; i < 4; ++i) {
    const Vec3x4& a = d.relative[i ^ 1U];
    const Vec3x4 normal = cross(d.relative[3 - i] - a, d.relative[i ^ 2U] - a);
    store_vectors(normal * share, caches, i);
    const Vec3x4 g = load_vectors(caches, i);
    proved &= (magnitude(g.x) + magnitude(g.y) + magnitude(g.z)) * reach <= steepest_gradient;
    at_origin[i] = d.value[i] * share - dot(g, p);
    if constexpr (ask_exact)
      exact &= (g.x * volume == normal.x) & (g.y * volume == normal.y) & (g.z * volume == normal.z) &
               is_zero(g, at_origin[i], p + a);
  }
  for (unsigned i = 0; i < 4; ++i)
    store_doubles(choose(proved, at_origin[i], splat(proves_nothing)), caches.w[i].data());
  return ask_exact ? lanes_set(proved & exact) : 0;
}

// The cache of steps in scenes of either kind, of simplices with these determinants of the particles p.
template <bool moved>
[[gnu::always_inline]] inline void store_cache(const BatchDeterminants& d, const Vec3x4& p, SimplexCache4& caches) {
  if constexpr (moved)
    store_previous_geometry(d, caches);
  else
    store_barycentric<false>(d, p, caches);
}

// Coordinate i of q.
inline Double4 coordinate_of(const SimplexCache4& caches, unsigned i, const Vec3x4& q) {
  return dot(load_vectors(caches, i), q) + load_doubles(caches.w[i].data());
}

// Bits of the facets that q is proved to lie on. Precondition: the coordinates are exact.
inline Mask4 proved_zeros(const SimplexCache4& caches, const Vec3x4& q) {
  Mask4 zero[4];
  for (unsigned i = 0; i < 4; ++i) zero[i] = is_zero(load_vectors(caches, i), load_doubles(caches.w[i].data()), q);
  return has_short_mantissa(q.x) & has_short_mantissa(q.y) & has_short_mantissa(q.z) &
         facet_bits(zero[0], zero[1], zero[2], zero[3]);
}

inline bool has_coordinates(const SimplexCache4* caches, std::uint32_t i) {
  return !std::isnan(caches[i / 4].w[0][i % 4]);
}
inline void forget(SimplexCache4* caches, CacheFlags* marks, std::uint32_t i) {
  for (auto& of_corner : caches[i / 4].w) of_corner[i % 4] = unknown;
  marks[i] = 0;
}

// As flushed() in tracking/representable_point.hpp.
inline Double4 without_tiny(const Double4& x) { return choose(magnitude(x) < smallest_magnitude, Double4{}, x); }
inline Vec3x4 without_tiny(const Vec3x4& x) { return {without_tiny(x.x), without_tiny(x.y), without_tiny(x.z)}; }

// As combine() in tracking/carry.hpp: the points of simplices whose coordinates are proportional to w.
inline Vec3x4 combined(const Double4 (&w)[4], const Corners4& v) {
  Double4 share[4];
  for (unsigned i = 0; i < 4; ++i) share[i] = larger(w[i], Double4{});
  const Double4 sum = ((share[0] + share[1]) + share[2]) + share[3];
  for (Double4& s : share) s = s / sum;
  return (v.corner[0] * share[0] + v.corner[1] * share[1]) + (v.corner[2] * share[2] + v.corner[3] * share[3]);
}

// As carried() there: the same points, as decisions see them.
inline Vec3x4 carry_along(const Double4 (&w)[4], const Corners4& now) { return without_tiny(combined(w, now)); }

// The coordinates that these determinants are proportional to.
inline Weights shares_of(Weights w) {
  for (double& share : w) share = std::max(share, 0.0);
  const double sum = ((w[0] + w[1]) + w[2]) + w[3];
  for (double& share : w) share /= sum;
  return w;
}

// Whether steps relative to moving vertices surely need no splitting (tracking/step.hpp): |A| |r| <= 2 tolerance edge.
//
// The displacements d_i of the corners, less the particle's own q - p, have -r as a mean: |r| <= max |d_i|. Let u_i be
// d_i - d_0, and n_i the cross products of the old edges e_i from corner 0. Then A = sum of u_i n_i^T / V, so that
// |A|^2 V^2 <= sum of |u_i|^2 times sum of |n_i|^2. Squares are compared.
//
// Let L be the old distance of the farthest corner. Floats round the old corners by 2^-24 L. The doubles of the rule
// round u_i by at most as much, as |q - p| and |d_i| are below 2^28 L. So the coordinates of d_i, u_i, n_i and the
// edges are off by 2^-24 L, 3 2^-24 L, 2^-20 L^2 and 2^-23 L. In squares, (a + b)^2 <= 17/16 a^2 + 17 b^2 bounds that.
// The rule's r is off by 2^-49 |q| as well, which is less than an eighth of 2^-24 L. The d_i add as much. Products
// reach L^12: with L in [2^-70, 2^70] those on the left neither overflow nor underflow.
class OnePart {
 public:
  // `after`: the moved corners relative to the targets q; p: where the particles were.
  OnePart(const SimplexCache4& previous_caches, const Vec3x4 (&after)[4], const Vec3x4& p, const Vec3x4& q,
          double tolerance)
      : before_{load_vectors(previous_caches, 0), load_vectors(previous_caches, 1), load_vectors(previous_caches, 2),
                load_vectors(previous_caches, 3)} {
    const Vec3x4 d0 = after[0] - before_[0];
    l2_ = square(before_[0]);
    Double4 farthest = square(d0);
    Double4 u2{};
    for (unsigned i = 1; i < 4; ++i) {
      const Vec3x4 d = after[i] - before_[i];
      l2_ = larger(l2_, square(before_[i]));
      farthest = larger(farthest, square(d));
      u2 += square(d - d0);
    }
    const Double4 r2 = 0x1.1p+0 * farthest + 0x1p-42 * l2_;
    u2_r2_ = (0x1.1p+0 * u2 + 0x1p-37 * l2_) * r2;
    const Vec3x4 own = q - p;
    const Double4 far = 0x1p+56 * l2_;
    in_range_ =
        (l2_ > 0x1p-140) & (l2_ < 0x1p+140) & (farthest < far) & (square(own) < far) & (square(q) < 0x1p+44 * l2_);
    // Not a number if the previous geometry is unknown: then every comparison is false.
    volume_ = (load_doubles(previous_caches.w[0].data()) + load_doubles(previous_caches.w[1].data())) +
              (load_doubles(previous_caches.w[2].data()) + load_doubles(previous_caches.w[3].data()));
    limit_ = 1.98 * tolerance * volume_;
  }

  // By L alone: |e_i| <= 2 L, sum of |n_i|^2 <= 48 L^4, edge >= V / (4 L^2).
  [[nodiscard]] Mask4 by_size() const {
    const Double4 limit = limit_ * volume_;
    const Double4 l4 = l2_ * l2_;
    constexpr double rounding = 1.01;
    return in_range_ & (u2_r2_ * (rounding * 48.0 * 16.0) * (l4 * l4) <= limit * limit);
  }

  // By the faces and edges of the simplex.
  [[nodiscard]] Mask4 by_shape() const {
    const Vec3x4 e1 = before_[1] - before_[0];
    const Vec3x4 e2 = before_[2] - before_[0];
    const Vec3x4 e3 = before_[3] - before_[0];
    const Double4 faces = square(cross(e1, e2)) + square(cross(e2, e3)) + square(cross(e3, e1));
    const Double4 at_first = smaller(smaller(square(e1), square(e2)), square(e3));
    const Double4 others = smaller(smaller(square(before_[1] - before_[2]), square(before_[2] - before_[3])),
                                   square(before_[3] - before_[1]));
    const Double4 n2 = 0x1.1p+0 * faces + 0x1p-32 * l2_ * l2_;
    const Double4 edge2 = 0.94 * (smaller(at_first, others) - 0x1p-40 * l2_);
    return in_range_ & (u2_r2_ * n2 <= limit_ * limit_ * edge2);
  }

 private:
  Vec3x4 before_[4];
  Double4 l2_;
  Double4 u2_r2_;
  Double4 volume_;
  Double4 limit_;
  Mask4 in_range_;
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
