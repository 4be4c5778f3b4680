// What is kept of simplices, in vectors (walk/memo.hpp). Part of walk/filtered_kernel.hpp: no include guard, no
// includes.

DARTCAST_TARGET inline void store_floats(const Quad& four, std::array<float, 4>& out) {
  *reinterpret_cast<UnalignedFloats*>(out.data()) = narrowed(four);
}
DARTCAST_TARGET inline Quad load_floats(const std::array<float, 4>& in) {
  const Floats four = *reinterpret_cast<const UnalignedFloats*>(in.data());
  return widened(four);
}
DARTCAST_TARGET inline Quad load_four(const std::array<double, 4>& numbers) {
  return *reinterpret_cast<const UnalignedQuad*>(numbers.data());
}
DARTCAST_TARGET inline void store_four(const Quad& four, std::array<double, 4>& out) {
  *reinterpret_cast<UnalignedQuad*>(out.data()) = four;
}
DARTCAST_TARGET inline Quad four(double x) { return Quad{x, x, x, x}; }
// The trail of the particle that the corners are relative to, d being its determinants.
DARTCAST_TARGET inline void leave_trail(const Lanes& relative, const FilteredDeterminants& d, Memo& memo) {
  store_floats(relative.x, memo.x);
  store_floats(relative.y, memo.y);
  store_floats(relative.z, memo.z);
  store_four(d.proves_coordinates() ? d.value : four(unknown), memo.w);
}

// The coordinates of the simplex, from a particle p that the corners are relative to, d being its determinants: their
// gradients are the normals of the facets, inwards, over the volume.
DARTCAST_TARGET inline void leave_coordinates(const Lanes& relative, const FilteredDeterminants& d, const Quad& p,
                                              Memo& memo) {
  const Lanes a = lanes<1, 0, 3, 2>(relative);
  const Lanes e = lanes<3, 2, 1, 0>(relative) - a;
  const Lanes f = lanes<2, 3, 0, 1>(relative) - a;
  const double volume = d.volume6();
  const Quad share = four(1.0 / volume);
  const Lanes g = {(e.y * f.z - e.z * f.y) * share, (e.z * f.x - e.x * f.z) * share, (e.x * f.y - e.y * f.x) * share};
  store_floats(g.x, memo.x);
  store_floats(g.y, memo.y);
  store_floats(g.z, memo.z);
  const Lanes stored = {load_floats(memo.x), load_floats(memo.y), load_floats(memo.z)};
  const double extent = std::max(std::max(d.extent[0], d.extent[1]), d.extent[2]);
  const Quad m = larger(d.extent, magnitude(p) * (1.0 / extents_from_origin));
  const double reach = std::max(std::max(m[0], m[1]), m[2]);
  const Quad steepness = (magnitude(stored.x) + magnitude(stored.y) + magnitude(stored.z)) * four(reach);
  const bool proved = d.proves_coordinates() && volume >= least_volume * (extent * extent * extent) &&
                      extent <= largest_extent && lanes_set(steepness <= steepest_gradient) == 15U;
  const Quad at_origin = d.value * share - (stored.x * four(p[0]) + stored.y * four(p[1]) + stored.z * four(p[2]));
  store_four(proved ? at_origin : four(proves_nothing), memo.w);
}

// The coordinates of q.
DARTCAST_TARGET inline Quad coordinates_of(const Memo& memo, const Vec3& q) {
  return load_floats(memo.x) * four(q.x) + load_floats(memo.y) * four(q.y) + load_floats(memo.z) * four(q.z) +
         load_four(memo.w);
}

// The corners before the move, relative to where the particle was.
DARTCAST_TARGET inline Lanes corners_before(const Memo& trail) {
  return {load_floats(trail.x), load_floats(trail.y), load_floats(trail.z)};
}

// The coordinates of walk/ride.hpp, and the point that has them in the moved simplex. False where the filter does not
// prove that the simplexes are positive, and the point inside.
DARTCAST_TARGET inline bool ride_along(const Memo& trail, const Rows& now, Vec3& ridden) {
  if (is_unknown(trail)) return false;
  const Quad w = larger(load_four(trail.w), Quad{});
  const Quad share = w / (((w[0] + w[1]) + w[2]) + w[3]);
  const Quad x =
      (now.corner[0] * share[0] + now.corner[1] * share[1]) + (now.corner[2] * share[2] + now.corner[3] * share[3]);
  ridden = flushed(vec_of(x));
  return FilteredDeterminants(now, load_row(ridden)).all_positive();
}

// Whether a step relative to moving vertices surely needs no splitting (walk/step.hpp): |A| |r| <= 2 tolerance edge.
//
// The corners' displacements d_i, less the particle's own q - p, have -r as a mean: |r| <= max |d_i|. With
// u_i = d_i - d_0 and n_i the cross products of the old edges e_i from corner 0, A = sum of u_i n_i^T / V, so that
// |A|^2 V^2 <= sum of |u_i|^2 times sum of |n_i|^2. Squares are compared. L is the old distance of the farthest corner:
// floats rounded the old corners by 2^-24 L, and the rule's own doubles round u_i by as much at most, as |q - p| and
// |d_i| are below 2^28 L. So the coordinates of d_i, u_i, n_i and the edges are off by 2^-24 L, 3 2^-24 L, 2^-20 L^2
// and 2^-23 L; squares count that as (a + b)^2 <= 17/16 a^2 + 17 b^2. Products reach L^12: with L in [2^-70, 2^70]
// those on the left neither overflow nor underflow.
class OnePart {
 public:
  // `after`: the moved corners relative to the target q; p: where the particle was.
  DARTCAST_TARGET OnePart(const Memo& trail, const Lanes& after, const Quad& p, const Quad& q, double tolerance)
      : before_(corners_before(trail)) {
    const Lanes d = after - before_;
    const Lanes u = d - lanes<0, 0, 0, 0>(d);
    l2_ = most(square(before_));
    const double farthest = most(square(d));
    const double r2 = 0x1.1p+0 * farthest + 0x1p-42 * l2_;
    const double u2 = 0x1.1p+0 * sum(square(u)) + 0x1p-37 * l2_;
    const Quad own = q - p;
    in_range_ = l2_ > 0x1p-140 && l2_ < 0x1p+140 && farthest < 0x1p+56 * l2_ &&
                (lanes_set(own * own < 0x1p+56 * l2_) & 7U) == 7U;
    u2_r2_ = u2 * r2;
    volume_ = sum(load_four(trail.w));  // NaN: then nothing is less
    limit_ = 1.98 * tolerance * volume_;
  }

  // By L alone: |e_i| <= 2 L, sum of |n_i|^2 <= 48 L^4, edge >= V / (4 L^2).
  [[nodiscard]] DARTCAST_TARGET bool by_size() const {
    const double limit = limit_ * volume_;
    const double l4 = l2_ * l2_;
    constexpr double rounding = 1.01;
    return in_range_ && u2_r2_ * (rounding * 48.0 * 16.0) * (l4 * l4) <= limit * limit;
  }

  // By the simplex's own faces and edges.
  [[nodiscard]] DARTCAST_TARGET bool by_shape() const {
    const Lanes e = before_ - lanes<0, 0, 0, 0>(before_);
    const Lanes f = lanes<0, 2, 3, 1>(e);
    const Lanes n = {e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
    const Quad edges =
        smaller(square(before_ - lanes<1, 2, 3, 0>(before_)), square(before_ - lanes<2, 3, 0, 1>(before_)));
    const double n2 = 0x1.1p+0 * sum(square(n)) + 0x1p-32 * l2_ * l2_;
    const double edge2 = 0.94 * (least(edges) - 0x1p-40 * l2_);
    return in_range_ && u2_r2_ * n2 <= limit_ * limit_ * edge2;
  }

 private:
  Lanes before_;
  double l2_;
  double u2_r2_;
  double volume_;
  double limit_;
  bool in_range_;
};
