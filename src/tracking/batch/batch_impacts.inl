// Where steps meet walls, of four particles in vectors: by the operations of tracking/contact_geometry.hpp and
// tracking/place_in_simplex.hpp, to the same bits, as far as doubles prove what they ask. Part of
// tracking/batch/batch_kernel.inl: no include guard, no includes.

// As Determinant in tracking/contact_geometry.hpp.
struct BoundedProducts {
  Quad value;
  Quad permanent;

  DARTCAST_TARGET BoundedProducts(const Points& u, const Points& v, const Points& w) : value(dot(u, cross(v, w))) {
    permanent = magnitude(u.x) * sum(v.y * w.z, v.z * w.y) + magnitude(u.y) * sum(v.z * w.x, v.x * w.z) +
                magnitude(u.z) * sum(v.x * w.y, v.y * w.x);
  }

  [[nodiscard]] DARTCAST_TARGET Mask exceed(double times) const { return exceed(value, permanent, times); }
  DARTCAST_TARGET static Quad sum(const Quad& a, const Quad& b) { return magnitude(a) + magnitude(b); }
  DARTCAST_TARGET static Mask exceed(const Quad& value, const Quad& permanent, double times) {
    return (permanent >= Determinant::smallest_permanent) &
           (magnitude(value) > (times * Determinant::error) * permanent);
  }
};

DARTCAST_TARGET inline Points without_tiny(const Points& x) {
  return {without_tiny(x.x), without_tiny(x.y), without_tiny(x.z)};
}
DARTCAST_TARGET inline Points choose(const Mask& m, const Points& a, const Points& b) {
  return {m ? a.x : b.x, m ? a.y : b.y, m ? a.z : b.z};
}

// A walk that has come to a wall's facet, with its target beyond.
struct AtWall {
  std::uint32_t particle;
  std::uint16_t begun;  // its number
  std::uint16_t facet;
  VertexNumbers corners;  // of the simplex at the wall

  [[nodiscard]] std::uint32_t corner(unsigned i) const { return corners[facet_corners[facet][i]]; }
};
using AtWalls = const AtWall* [4];

// Of the facets at the wall.
DARTCAST_TARGET inline Points load_corners(const Vec3* positions, const AtWalls& at, unsigned i) {
  return load_points(positions[at[0]->corner(i)], positions[at[1]->corner(i)], positions[at[2]->corner(i)],
                     positions[at[3]->corner(i)]);
}

class FourLandings {
 public:
  FilteredDeterminants there;  // of the simplices at the walls, of the particles' positions
  Points position;
  Mask known;

  DARTCAST_TARGET FourLandings(const AtWalls& at, const std::vector<Begun>& begun, const Vec3* positions,
                               const Vec3* targets)
      : corner_{without_tiny(load_corners(positions, at, 0)), without_tiny(load_corners(positions, at, 1)),
                without_tiny(load_corners(positions, at, 2))},
        facet_{at[0]->facet, at[1]->facet, at[2]->facet, at[3]->facet} {
    const auto& [a, b, c] = corner_;
    gradient_ = cross(b - a, c - a);
    const Quad square = dot(gradient_, gradient_);
    normal_ = gradient_ * (1.0 / root(square));
    known = (square > 0x1p-600) & (square < 0x1p+600);
    const auto p = [&](unsigned l) -> const Vec3& { return begun[at[l]->begun].from; };
    const auto q = [&](unsigned l) -> const Vec3& { return targets[at[l]->particle]; };
    pass(load_points(p(0), p(1), p(2), p(3)), load_points(q(0), q(1), q(2), q(3)));
  }

  // As proved_inside(): where the point is next to a facet, it is the wall's.
  DARTCAST_TARGET void put(const Tetrahedra& simplex) {
    const FilteredDeterminants d(simplex, point_);
    const Mask inside = d.all_positive();
    Mask others = splat_bits(-1);
    Quad off{};
    for (unsigned i = 0; i < 4; ++i) {
      const Mask is_wall = facet_ == splat_bits(i);
      others &= is_wall | (d.value[i] > d.bound);
      off = is_wall ? d.value[i] : off;
    }
    const Points& a = corner_[0];
    const Points magnitudes = larger(magnitude(a), magnitude(point_));
    const Quad unit =
        larger(largest(magnitudes) * splat(std::numeric_limits<double>::epsilon()), splat(smallest_magnitude));
    const Quad steepest = largest(magnitude(gradient_));
    const Points direction = gradient_ * (1.0 / steepest);
    const Quad length = root(dot(direction, direction));
    const Quad distance = (2.0 * d.bound - off) / (steepest * length) + unit;
    const Mask as_it_is = inside | (others & level());
    position = choose(as_it_is, point_, without_tiny(point_ + direction * (distance / length)));
    there = FilteredDeterminants(simplex, position);
    known &= as_it_is | (others & (distance < most_units * unit) & there.all_positive());
  }

  // As wall_displacement().
  DARTCAST_TARGET void move_walls(const AtWalls& at, const Vec3* before) {
    Quad weight[3];
    for (unsigned i = 0; i < 3; ++i)
      weight[i] = larger(dot(normal_, cross(corner_[(i + 1) % 3] - point_, corner_[(i + 2) % 3] - point_)), Quad{});
    const Quad sum = weight[0] + weight[1] + weight[2];
    known &= sum > 0.0;
    for (unsigned i = 0; i < 3; ++i) {
      const Points was = load_corners(before, at, i);
      const Points m = magnitude(was);
      known &= (m.x <= largest_magnitude) & (m.y <= largest_magnitude) & (m.z <= largest_magnitude);
      const Points moved = corner_[i] - was;
      wall_displacement_ = wall_displacement_ + moved * (weight[i] / sum);
    }
  }

  [[nodiscard]] DARTCAST_TARGET Landing of(unsigned lane) const {
    const auto in_lane = [&](const Points& x) { return Vec3{x.x[lane], x.y[lane], x.z[lane]}; };
    return {in_lane(normal_), fraction_[lane], in_lane(point_), in_lane(position), in_lane(wall_displacement_)};
  }

 private:
  // As Passing: strictly through the facet, p off it.
  DARTCAST_TARGET void pass(const Points& p, const Points& q) {
    const Points a = corner_[0] - p;
    const Points b = corner_[1] - p;
    const Points c = corner_[2] - p;
    const Points way = q - p;
    const BoundedProducts height(a, c, b);
    const BoundedProducts sides[3] = {{way, c, b}, {way, a, c}, {way, b, a}};
    const Quad whole = sides[0].value + sides[1].value + sides[2].value;
    const Quad permanent = sides[0].permanent + sides[1].permanent + sides[2].permanent;
    known &= sides[0].exceed(1.0) & sides[1].exceed(1.0) & sides[2].exceed(1.0) &
             height.exceed(Determinant::for_fraction) &
             BoundedProducts::exceed(whole, permanent, Determinant::for_fraction);
    const Quad t = height.value / whole;
    const Quad from_0 = t < 0.0 ? Quad{} : t;
    fraction_ = from_0 > 1.0 ? splat(1.0) : from_0;
    point_ = without_tiny(p + way * fraction_);
  }

  // As on_level_facet().
  [[nodiscard]] DARTCAST_TARGET Mask level() const {
    const auto& [a, b, c] = corner_;
    return same(a.x, b.x, c.x, point_.x) | same(a.y, b.y, c.y, point_.y) | same(a.z, b.z, c.z, point_.z);
  }

  DARTCAST_TARGET static Mask same(const Quad& u, const Quad& v, const Quad& w, const Quad& x) {
    return (u == x) & (v == x) & (w == x);
  }

  Points corner_[3];  // of the walls' facets
  Mask facet_;
  Points gradient_;  // normals, as long as twice their areas
  Points normal_;
  Quad fraction_;
  Points point_;
  Points wall_displacement_{};
};
