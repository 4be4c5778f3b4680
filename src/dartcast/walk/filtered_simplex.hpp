// Simplices in vectors. Part of walk/filtered_kernel.hpp: no include guard, no includes.

// The corners of a simplex: x, y, z and one double that means nothing.
struct Rows {
  Quad corner[4];

  DARTCAST_TARGET Rows(const Vec3* positions, const VertexNumbers& v)
      : corner{at(positions + v[0]), at(positions + v[1]), at(positions + v[2]), at(positions + v[3])} {}

 private:
  DARTCAST_TARGET static Quad at(const Vec3* row) { return *reinterpret_cast<const UnalignedQuad*>(row); }
};

DARTCAST_TARGET inline Vec3 vec_of(const Quad& row) { return {row[0], row[1], row[2]}; }
DARTCAST_TARGET inline Quad magnitude(const Quad& v) {
  constexpr long long all_but_sign = 0x7fffffffffffffff;
  return reinterpret_cast<Quad>(reinterpret_cast<Mask>(v) &
                                Mask{all_but_sign, all_but_sign, all_but_sign, all_but_sign});
}
DARTCAST_TARGET inline Quad larger(const Quad& a, const Quad& b) { return a > b ? a : b; }
DARTCAST_TARGET inline Quad smaller(const Quad& a, const Quad& b) { return a < b ? a : b; }

// The corners of a simplex relative to a point, one in each lane.
struct Lanes {
  Quad x, y, z;
};
DARTCAST_TARGET inline Quad square(const Lanes& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }
DARTCAST_TARGET inline Lanes operator-(const Lanes& u, const Lanes& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
// Each lane from the lane named.
template <int a, int b, int c, int d>
DARTCAST_TARGET inline Lanes lanes(const Lanes& v) {
  return {__builtin_shufflevector(v.x, v.x, a, b, c, d), __builtin_shufflevector(v.y, v.y, a, b, c, d),
          __builtin_shufflevector(v.z, v.z, a, b, c, d)};
}
DARTCAST_TARGET inline double sum(const Quad& v) { return (v[0] + v[1]) + (v[2] + v[3]); }
DARTCAST_TARGET inline double most(const Quad& v) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); }
DARTCAST_TARGET inline double least(const Quad& v) { return std::min(std::min(v[0], v[1]), std::min(v[2], v[3])); }

// The determinants of geometry/simplex.hpp, by the same operations, one in each lane; and their bound.
struct FilteredDeterminants {
  Quad value;
  Quad extent;  // largest magnitudes of x, y and z relative to the point
  double bound;
  bool applies;

  FilteredDeterminants() = default;
  DARTCAST_TARGET FilteredDeterminants(const Rows& v, const Quad& point) {
    Lanes ignored;
    *this = FilteredDeterminants(v, point, ignored);
  }
  // Leaves the corners relative to the point in `relative`.
  DARTCAST_TARGET FilteredDeterminants(const Rows& v, const Quad& point, Lanes& relative) {
    const Quad r0 = v.corner[0] - point;
    const Quad r1 = v.corner[1] - point;
    const Quad r2 = v.corner[2] - point;
    const Quad r3 = v.corner[3] - point;
    extent = larger(larger(magnitude(r0), magnitude(r1)), larger(magnitude(r2), magnitude(r3)));
    const double m = extent[0] * extent[1] * extent[2];
    bound = determinant_error * m;
    applies = (lanes_set(extent > 0x1p+301) & 7U) == 0 && m >= 0x1p-700;
    // Corners in lanes, as they are and with neighbours exchanged: (r1, r0, r3, r2).
    const Quad xz01 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6);
    const Quad xz23 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6);
    const Quad y01 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
    const Quad y23 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
    relative = {__builtin_shufflevector(xz01, xz23, 0, 1, 4, 5), __builtin_shufflevector(y01, y23, 0, 1, 4, 5),
                __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7)};
    const auto& [x, y, z] = relative;
    const auto [xs, ys, zs] = lanes<1, 0, 3, 2>(relative);
    // (n, -n, n', -n') with n = r0 x r1, n' = r2 x r3; then its halves exchanged.
    const Quad nx = y * zs - z * ys;
    const Quad ny = z * xs - x * zs;
    const Quad nz = x * ys - y * xs;
    const Quad mx = __builtin_shufflevector(nx, nx, 2, 3, 0, 1);
    const Quad my = __builtin_shufflevector(ny, ny, 2, 3, 0, 1);
    const Quad mz = __builtin_shufflevector(nz, nz, 2, 3, 0, 1);
    value = xs * mx + ys * my + zs * mz;
  }

  [[nodiscard]] DARTCAST_TARGET double volume6() const { return sum(value); }
  // Surely no more than six times the volume.
  [[nodiscard]] DARTCAST_TARGET double least_volume6() const { return volume6() - 8.0 * bound; }
  [[nodiscard]] DARTCAST_TARGET bool proves_positive() const { return applies && least_volume6() > 0.0; }
  [[nodiscard]] DARTCAST_TARGET bool proves_coordinates() const { return applies && volume6() > 0x1p+30 * bound; }
  // Bit i: value i is proved positive, or negative.
  [[nodiscard]] DARTCAST_TARGET unsigned positive() const { return lanes_set(value > bound); }
  [[nodiscard]] DARTCAST_TARGET unsigned negative() const { return lanes_set(value < -bound); }
  [[nodiscard]] DARTCAST_TARGET bool all_positive() const { return applies && positive() == 15U; }
};

DARTCAST_TARGET inline Corners corners_of(const Rows& v) {
  return {vec_of(v.corner[0]), vec_of(v.corner[1]), vec_of(v.corner[2]), vec_of(v.corner[3])};
}

// Whether the determinants' values are exact (rounds_nothing() in exact/predicates.hpp), where the filter applies.
DARTCAST_TARGET inline bool is_exact(const Rows& v, const Quad& point) {
  Quad extent = magnitude(v.corner[0] - point);
  for (unsigned i = 1; i < 4; ++i) extent = larger(extent, magnitude(v.corner[i] - point));
  const Quad unit = extent * 0x1p+37;
  const Quad m = magnitude(point);
  Mask rounded = ((m + unit) - unit) != m;
  for (const Quad& corner : v.corner) {
    const Quad c = magnitude(corner);
    rounded |= ((c + unit) - unit) != c;
  }
  return (lanes_set(rounded) & 7U) == 0;
}
