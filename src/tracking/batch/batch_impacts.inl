// Where four steps meet walls, computed by the operations of tracking/contact_geometry.hpp and
// tracking/place_in_simplex.hpp, to the same bits, if doubles prove all that they ask. Part of the batch's kernel.
#pragma once

#include <cstdint>
#include <limits>

#include "base/double4.inl"
#include "tracking/batch/batch_caches.inl"
#include "tracking/batch/batch_records.inl"
#include "tracking/batch/batch_simplex.inl"
#include "tracking/contact_geometry.hpp"
#include "tracking/step_state.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

// As Determinant in tracking/contact_geometry.hpp.
struct BoundedProducts {
  Double4 value;
  Double4 permanent;

  BoundedProducts(const Vec3x4& u, const Vec3x4& v, const Vec3x4& w) : value(dot(u, cross(v, w))) {
    permanent = magnitude(u.x) * sum(v.y * w.z, v.z * w.y) + magnitude(u.y) * sum(v.z * w.x, v.x * w.z) +
                magnitude(u.z) * sum(v.x * w.y, v.y * w.x);
  }

  [[nodiscard]] Mask4 exceed(double times) const { return exceed(value, permanent, times); }
  static Double4 sum(const Double4& a, const Double4& b) { return magnitude(a) + magnitude(b); }
  static Mask4 exceed(const Double4& value, const Double4& permanent, double times) {
    return (permanent >= Determinant::smallest_permanent) &
           (magnitude(value) > (times * Determinant::error) * permanent);
  }
};

// Four walks at walls.
struct AtWalls {
  const AtWall* walls[4];
  const StepState* steps;

  const AtWall* operator[](unsigned l) const { return walls[l]; }
  [[nodiscard]] const StepState& step(unsigned l) const { return steps[walls[l]->partial]; }
  [[nodiscard]] Index4 particles() const {
    return {{walls[0]->particle, walls[1]->particle, walls[2]->particle, walls[3]->particle}};
  }
  [[nodiscard]] Double4 slices() const {
    return Double4{double(step(0).slices), double(step(1).slices), double(step(2).slices), double(step(3).slices)};
  }
  // The times at which the vertices are where the walks find them.
  [[nodiscard]] Double4 times() const { return 1.0 / slices(); }
  [[nodiscard]] [[gnu::always_inline]] Corners4 simplices(const Vec3* positions) const {
    return Corners4(positions, walls[0]->corners, walls[1]->corners, walls[2]->corners, walls[3]->corners);
  }
  // Corner i of the facets at the walls.
  [[nodiscard]] [[gnu::always_inline]] Vec3x4 corners(const Vec3* positions, unsigned i) const {
    return load_vec3x4(positions[walls[0]->corner(i)], positions[walls[1]->corner(i)], positions[walls[2]->corner(i)],
                       positions[walls[3]->corner(i)]);
  }
};

class WallImpact4 {
 public:
  BatchDeterminants there;  // of the simplices at the walls, of the particles' positions
  Vec3x4 position;
  Mask4 known;

  // `facets`: corner i of the facets at the walls.
  [[gnu::always_inline]] WallImpact4(const AtWalls& at, const Vec3x4 (&facets)[3], const Vec3x4& targets)
      : corner_{without_tiny(facets[0]), without_tiny(facets[1]), without_tiny(facets[2])},
        facet_{at[0]->facet, at[1]->facet, at[2]->facet, at[3]->facet} {
    // From the corners as they are: facet_normal() has the same signs of zeros.
    gradient_ = cross(facets[1] - facets[0], facets[2] - facets[0]);
    const Double4 square = dot(gradient_, gradient_);
    normal_ = gradient_ * (1.0 / root(square));
    known = (square > 0x1p-600) & (square < 0x1p+600);
    pass(load_vec3x4(at.step(0).walk_start, at.step(1).walk_start, at.step(2).walk_start, at.step(3).walk_start),
         targets);
  }

  // As proved_inside(). The point is next to the wall's facet.
  void put(const Corners4& simplex) {
    const BatchDeterminants d(simplex, point_);
    const Mask4 inside = d.all_positive();
    Mask4 others = splat_bits(-1);
    Double4 off{};
    for (unsigned i = 0; i < 4; ++i) {
      const Mask4 is_wall = facet_ == splat_bits(i);
      others &= is_wall | (d.value[i] > d.bound);
      off = choose(is_wall, d.value[i], off);
    }
    const Vec3x4& a = corner_[0];
    const Vec3x4 magnitudes = larger(magnitude(a), magnitude(point_));
    const Double4 unit =
        larger(largest(magnitudes) * splat(std::numeric_limits<double>::epsilon()), splat(smallest_magnitude));
    const Double4 steepest = largest(magnitude(gradient_));
    const Vec3x4 direction = gradient_ * (1.0 / steepest);
    const Double4 length = root(dot(direction, direction));
    const Double4 distance = (2.0 * d.bound - off) / (steepest * length) + unit;
    const Mask4 as_it_is = inside | (others & level());
    position = choose(as_it_is, point_, without_tiny(point_ + direction * (distance / length)));
    there = BatchDeterminants(simplex, position);
    known &= as_it_is | (others & (distance < max_units * unit) & there.all_positive());
  }

  // As wall_displacement().
  void move_walls(const AtWalls& at, const Vec3* before, const Vec3* now) {
    Double4 weight[3];
    for (unsigned i = 0; i < 3; ++i)
      weight[i] = larger(dot(normal_, cross(corner_[(i + 1) % 3] - point_, corner_[(i + 2) % 3] - point_)), Double4{});
    const Double4 sum = weight[0] + weight[1] + weight[2];
    known &= sum > 0.0;
    for (unsigned i = 0; i < 3; ++i) {
      const Vec3x4 was = at.corners(before, i);
      const Vec3x4 is = at.corners(now, i);
      known &= in_range(was) & in_range(is);
      const Vec3x4 moved = is - was;
      wall_displacement_ = wall_displacement_ + moved * (weight[i] / sum);
    }
  }

  [[nodiscard]] WallImpact of(unsigned lane) const {
    const auto in_lane = [&](const Vec3x4& x) { return Vec3{x.x[lane], x.y[lane], x.z[lane]}; };
    return {in_lane(normal_), fraction_[lane], in_lane(point_), in_lane(position), in_lane(wall_displacement_)};
  }

 private:
  // As SegmentHit: the segment passes strictly through the facet, and p is not on it.
  void pass(const Vec3x4& p, const Vec3x4& q) {
    const Vec3x4 a = corner_[0] - p;
    const Vec3x4 b = corner_[1] - p;
    const Vec3x4 c = corner_[2] - p;
    const Vec3x4 way = q - p;
    const BoundedProducts height(a, c, b);
    const BoundedProducts sides[3] = {{way, c, b}, {way, a, c}, {way, b, a}};
    const Double4 whole = sides[0].value + sides[1].value + sides[2].value;
    const Double4 permanent = sides[0].permanent + sides[1].permanent + sides[2].permanent;
    known &= sides[0].exceed(1.0) & sides[1].exceed(1.0) & sides[2].exceed(1.0) &
             height.exceed(Determinant::for_fraction) &
             BoundedProducts::exceed(whole, permanent, Determinant::for_fraction);
    const Double4 t = height.value / whole;
    const Double4 from_0 = choose(t < 0.0, Double4{}, t);
    fraction_ = choose(from_0 > 1.0, splat(1.0), from_0);
    point_ = without_tiny(p + way * fraction_);
  }

  // Not so if a component is not a number.
  static Mask4 in_range(const Vec3x4& x) {
    const Vec3x4 m = magnitude(x);
    return (m.x <= largest_magnitude) & (m.y <= largest_magnitude) & (m.z <= largest_magnitude);
  }

  // As on_level_facet().
  [[nodiscard]] Mask4 level() const {
    const auto& [a, b, c] = corner_;
    return same(a.x, b.x, c.x, point_.x) | same(a.y, b.y, c.y, point_.y) | same(a.z, b.z, c.z, point_.z);
  }

  static Mask4 same(const Double4& u, const Double4& v, const Double4& w, const Double4& x) {
    return (u == x) & (v == x) & (w == x);
  }

  Vec3x4 corner_[3];  // of the walls' facets
  Mask4 facet_;
  Vec3x4 gradient_;  // normals, as long as twice their areas
  Vec3x4 normal_;
  Double4 fraction_;
  Vec3x4 point_;
  Vec3x4 wall_displacement_{};
};

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
