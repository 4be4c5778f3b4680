// Four triangles of the plane and their steps, one in each lane: where targets are, and which steps need no splitting.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "base/double4.inl"
#include "dartcast/predicates.hpp"
#include "tracking/batch/batch_records.inl"
#include "tracking/batch/plane_block.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// Points of the plane, or vectors.
struct Vec2x4 {
  Double4 x, y;

  Vec2x4 operator-(const Vec2x4& b) const { return {x - b.x, y - b.y}; }
  [[nodiscard]] Double4 square() const { return x * x + y * y; }
};
inline Double4 turn(const Vec2x4& a, const Vec2x4& b) { return a.x * b.y - a.y * b.x; }
inline Double4 sizes(const Vec2x4& a) { return magnitude(a.x) + magnitude(a.y); }

using Triangles4 = Vec2x4[3];

// As Determinants<3>, by the same operations.
struct PlaneDeterminants4 {
  Double4 value[3];
  Vec2x4 extent;
  Double4 bound;

  PlaneDeterminants4(const Triangles4& v, const Vec2x4& x) {
    const Vec2x4 r[3] = {v[0] - x, v[1] - x, v[2] - x};
    for (unsigned i = 0; i < 3; ++i) value[i] = turn(r[(i + 1) % 3], r[(i + 2) % 3]);
    extent.x = larger(larger(magnitude(r[0].x), magnitude(r[1].x)), magnitude(r[2].x));
    extent.y = larger(larger(magnitude(r[0].y), magnitude(r[1].y)), magnitude(r[2].y));
    const Mask4 applies =
        (larger(extent.x, extent.y) <= largest_decided_extent) & (smaller(extent.x, extent.y) >= smallest_extent);
    bound = choose(applies, plane_error * (extent.x * extent.y), splat(std::numeric_limits<double>::infinity()));
  }

  [[nodiscard]] Double4 sum() const { return (value[0] + value[1]) + value[2]; }
  [[nodiscard]] Mask4 all_positive() const { return (value[0] > bound) & (value[1] > bound) & (value[2] > bound); }
  [[nodiscard]] Mask4 any_negative() const { return (value[0] < -bound) | (value[1] < -bound) | (value[2] < -bound); }
  [[nodiscard]] Mask4 decided() const {
    return (sum() > 8.0 * bound) & (magnitude(value[0]) > bound) & (magnitude(value[1]) > bound) &
           (magnitude(value[2]) > bound);
  }
  [[nodiscard]] Mask4 behind() const {
    return ((value[0] < 0.0) & splat_bits(1)) | ((value[1] < 0.0) & splat_bits(2)) | ((value[2] < 0.0) & splat_bits(4));
  }
  [[nodiscard]] Mask4 proves_coordinates() const { return sum() > 0x1p+30 * bound; }
};

// Whether steps surely need no splitting (tracking/step.hpp): |A| |r| <= 2 tolerance edge. `was`: of p, in the triangles v
// before the move. `will`: of q, in w after it.
//
// |A| V, V and the edge are the doubles of the rule, up to a root and a quotient. Let d_i be the corners' displacements
// less q - p. Then -r is their mean, weighted by the particle's coordinates: |r| <= max |d_i|. The rule's r is off from
// that by at most m: its coordinates are right to 2^-26, and points are rounded. In squares, (a + b)^2 <= 17/16 a^2 +
// 17 b^2 bounds that. The last line excludes overflow and underflow.
inline Mask4 surely_one_slice(const Triangles4& v, const Triangles4& w, const PlaneDeterminants4& was,
                              const PlaneDeterminants4& will, const Vec2x4& p, const Vec2x4& q, double tolerance) {
  const Vec2x4 own = q - p;
  const Vec2x4 d0 = w[0] - v[0];
  const Vec2x4 d1 = w[1] - v[1];
  const Vec2x4 d2 = w[2] - v[2];
  const Double4 m = 0x1p-22 * (sizes(was.extent) + sizes(will.extent)) + 0x1p-48 * (sizes(q) + sizes(own));
  const Double4 farthest = larger(larger((d0 - own).square(), (d1 - own).square()), (d2 - own).square());
  const Double4 r2 = 0x1.1p+0 * farthest + 17.0 * m * m;
  const Vec2x4 e0 = v[1] - v[0];
  const Vec2x4 e1 = v[2] - v[0];
  const Vec2x4 u0 = d1 - d0;
  const Vec2x4 u1 = d2 - d0;
  const Vec2x4 ax = {e1.y * u0.x - e0.y * u1.x, e0.x * u1.x - e1.x * u0.x};
  const Vec2x4 ay = {e1.y * u0.y - e0.y * u1.y, e0.x * u1.y - e1.x * u0.y};
  const Double4 volume = turn(e0, e1);
  const Double4 limit = (1.98 * tolerance) * volume;
  const Double4 edge2 = smaller(smaller(e0.square(), e1.square()), (v[2] - v[1]).square());
  const Double4 right = limit * limit * edge2;
  return ((ax.square() + ay.square()) * r2 <= right) & (volume > 0x1p-200) & (r2 < 0x1p+200) & (right > 0x1p-700) &
         (right < 0x1p+1000);
}

// As carried(): where the triangles carry points that had these determinants.
inline Vec2x4 carry(const PlaneDeterminants4& was, const Triangles4& now) {
  const auto not_negative = [](const Double4& c) { return choose(c < 0.0, Double4{}, c); };
  const Double4 c[3] = {not_negative(was.value[0]), not_negative(was.value[1]), not_negative(was.value[2])};
  const Double4 sum = (c[0] + c[1]) + c[2];
  const Double4 w[3] = {c[0] / sum, c[1] / sum, c[2] / sum};
  return {without_tiny((now[0].x * w[0] + now[1].x * w[1]) + now[2].x * w[2]),
          without_tiny((now[0].y * w[0] + now[1].y * w[1]) + now[2].y * w[2])};
}

template <class PointOf>
Vec2x4 load_points(const Index4& i, const PointOf& point_of) {
  const Vec3x4 x = load_vec3x4(point_of(i.at[0]), point_of(i.at[1]), point_of(i.at[2]), point_of(i.at[3]));
  return {x.x, x.y};
}
inline void load_triangles(const Vec3* positions, const VertexNumbers* vertices, const Index4& i, Triangles4& out) {
  for (unsigned c = 0; c < 3; ++c)
    out[c] = load_points(i, [&](std::uint32_t k) -> const Vec3& { return positions[vertices[k][c]]; });
}

// Held particles do not go; those that touch walls are not inside, because they must leave these.
// `unusual`: the bits of both.
inline void leave_out(std::uint32_t unusual, const ParticleState* states, PlaneBlock& block, std::uint32_t& going) {
  for (; unusual != 0; unusual &= unusual - 1) {
    const std::uint32_t lowest = unusual & (0U - unusual);
    (states[std::countr_zero(unusual)].held ? going : block.inside) &= ~lowest;
  }
}

}  // namespace

PlaneBlock look_at_triangles(const PlaneVertices& vertices, const BatchSteps& steps, std::uint32_t first,
                             std::uint32_t count, double tolerance) {
  PlaneBlock block;
  std::uint32_t going = 0;  // neither held nor at rest
  const std::uint32_t all = all_of(count);
  const std::uint32_t unusual = all & held_or_touching(steps.states.data() + first, count);
  for (std::uint32_t k = 0; k < count; k += 4) {
    const Index4 four = index4_from(first + k, first + count);
    Triangles4 now;
    load_triangles(vertices.now, steps.vertices.data(), four, now);
    const Vec2x4 p = load_points(four, [&](std::uint32_t i) -> const Vec3& { return steps.states[i].position; });
    const Vec2x4 q = load_points(four, [&](std::uint32_t i) -> const Vec3& { return steps.targets[i]; });
    const PlaneDeterminants4 d(now, q);
    Mask4 goes = (p.x != q.x) | (p.y != q.y);
    const unsigned inside = lanes_set(d.all_positive());
    if (vertices.before != nullptr) {
      Triangles4 before;
      load_triangles(vertices.before, steps.vertices.data(), four, before);
      const PlaneDeterminants4 was(before, p);
      goes = was.proves_coordinates() & surely_one_slice(before, now, was, d, p, q, tolerance);
      if (inside != 15U || ((unusual >> k) & 15U) != 0) {
        const Vec2x4 x = carry(was, now);
        const Mask4 rests = (x.x == q.x) & (x.y == q.y);
        block.carried_inside |= lanes_set(PlaneDeterminants4(now, x).all_positive() & ~rests) << k;
        block.left_behind |= lanes_set(PlaneDeterminants4(now, p).any_negative()) << k;
        for (unsigned l = 0; l < 4; ++l) block.carried[k + l] = {x.x[l], x.y[l]};
      }
    }
    going |= lanes_set(goes) << k;
    block.inside |= inside << k;
    block.decided |= lanes_set(d.decided()) << k;
    const Mask4 behind = d.behind();
    for (unsigned l = 0; l < 4; ++l) block.behind[k + l] = static_cast<std::uint8_t>(behind[l]);
  }
  leave_out(unusual, &steps.states[first], block, going);
  block.deferred = all & ~going;
  block.inside &= all & going;
  return block;
}

}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
