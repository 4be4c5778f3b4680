// Simplices of four particles in vectors, one particle in each lane: what a step asks of a particle is asked of four
// by the same operations. Part of tracking/batch/batch_kernel.inl: no include guard, no includes.

DARTCAST_TARGET inline Double4 splat(double x) { return Double4{x, x, x, x}; }
DARTCAST_TARGET inline Mask4 splat_bits(long long x) { return Mask4{x, x, x, x}; }
DARTCAST_TARGET inline Double4 magnitude(const Double4& v) {
  return reinterpret_cast<Double4>(reinterpret_cast<Mask4>(v) & splat_bits(0x7fffffffffffffff));
}
DARTCAST_TARGET inline Double4 larger(const Double4& a, const Double4& b) { return a > b ? a : b; }
DARTCAST_TARGET inline Double4 smaller(const Double4& a, const Double4& b) { return a < b ? a : b; }

// A point of each particle.
struct Vec3x4 {
  Double4 x, y, z;
};
DARTCAST_TARGET inline Vec3x4 operator+(const Vec3x4& a, const Vec3x4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
DARTCAST_TARGET inline Vec3x4 operator-(const Vec3x4& a, const Vec3x4& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
DARTCAST_TARGET inline Vec3x4 operator*(const Vec3x4& a, const Double4& s) { return {a.x * s, a.y * s, a.z * s}; }
DARTCAST_TARGET inline Double4 dot(const Vec3x4& a, const Vec3x4& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
DARTCAST_TARGET inline Vec3x4 cross(const Vec3x4& a, const Vec3x4& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
DARTCAST_TARGET inline Double4 square(const Vec3x4& a) { return dot(a, a); }
DARTCAST_TARGET inline Vec3x4 magnitude(const Vec3x4& a) { return {magnitude(a.x), magnitude(a.y), magnitude(a.z)}; }
DARTCAST_TARGET inline Vec3x4 larger(const Vec3x4& a, const Vec3x4& b) {
  return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
}
DARTCAST_TARGET inline Double4 largest(const Vec3x4& a) { return larger(larger(a.x, a.y), a.z); }
DARTCAST_TARGET inline Double4 smallest(const Vec3x4& a) { return smaller(smaller(a.x, a.y), a.z); }

DARTCAST_TARGET inline Vec3x4 load_vec3x4(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Double4 xy02 = load_pairs(&a.x, &c.x);
  const Double4 xy13 = load_pairs(&b.x, &d.x);
  const Double4 yz02 = load_pairs(&a.y, &c.y);
  const Double4 yz13 = load_pairs(&b.y, &d.y);
  return {__builtin_shufflevector(xy02, xy13, 0, 4, 2, 6), __builtin_shufflevector(xy02, xy13, 1, 5, 3, 7),
          __builtin_shufflevector(yz02, yz13, 1, 5, 3, 7)};
}
// Of points in a row.
DARTCAST_TARGET inline Vec3x4 load_vec3x4(const Vec3* p) {
  const Double4 xy02 = load_pairs(&p[0].x, &p[2].x);
  const Double4 zx02 = load_pairs(&p[0].z, &p[2].z);  // z and the next one's x
  const Double4 yz13 = load_pairs(&p[1].y, &p[3].y);
  return {__builtin_shufflevector(xy02, zx02, 0, 5, 2, 7), __builtin_shufflevector(xy02, yz13, 1, 4, 3, 6),
          __builtin_shufflevector(zx02, yz13, 0, 5, 2, 7)};
}

struct Corners4 {
  Vec3x4 corner[4];

  [[gnu::always_inline]] DARTCAST_TARGET Corners4(const Vec3* positions, const VertexNumbers& a, const VertexNumbers& b,
                                                  const VertexNumbers& c, const VertexNumbers& d) {
    for (unsigned i = 0; i < 4; ++i)
      corner[i] = load_vec3x4(positions[a[i]], positions[b[i]], positions[c[i]], positions[d[i]]);
  }
};

// A bit for each facet, in each lane.
DARTCAST_TARGET inline Mask4 facet_bits(const Mask4& m0, const Mask4& m1, const Mask4& m2, const Mask4& m3) {
  return ((m0 & splat_bits(1)) | (m1 & splat_bits(2))) | ((m2 & splat_bits(4)) | (m3 & splat_bits(8)));
}

// What determinants say of one point, in the bits of its lane.
class FacetSigns4 {
 public:
  static constexpr long long valid = 1LL << 12;
  static constexpr long long exact = 1LL << 13;

  FacetSigns4() = default;  // left as it is
  explicit FacetSigns4(long long bits) : bits_(static_cast<unsigned>(bits)) {}
  [[nodiscard]] unsigned negative() const { return bits_ & 15U; }
  [[nodiscard]] unsigned zero() const { return (bits_ >> 4U) & 15U; }
  [[nodiscard]] unsigned open() const { return (bits_ >> 8U) & 15U; }  // by the filter
  // The simplex is proved positive, and on which sides of these facets the point is.
  [[nodiscard]] bool is_known(unsigned facets = 15) const {
    const bool proved = (open() & facets) == 0;
    return ((bits_ & valid) != 0) & (proved | ((bits_ & exact) != 0));  // no branches: on lattices, none is likely
  }
  [[nodiscard]] bool is_inside() const { return bits_ == unsigned{1} << 12U; }

 private:
  unsigned bits_;
};

// The determinants of complex/simplex.hpp, by the same operations, of four points; and their bounds.
struct BatchDeterminants {
  Vec3x4 relative[4];  // corners, to the points
  Vec3x4 extent;       // largest magnitudes of these
  Double4 value[4];
  Double4 bound;  // infinite where the filter does not apply

  BatchDeterminants() = default;
  [[gnu::always_inline]] DARTCAST_TARGET BatchDeterminants(const Corners4& v, const Vec3x4& x)
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
    bound =
        applies ? determinant_error * (extent.x * extent.y * extent.z) : splat(std::numeric_limits<double>::infinity());
  }

  [[nodiscard]] DARTCAST_TARGET Double4 volume6() const { return (value[0] + value[1]) + (value[2] + value[3]); }
  [[nodiscard]] DARTCAST_TARGET Mask4 proves_coordinates() const { return volume6() > 0x1p+30 * bound; }
  [[nodiscard]] DARTCAST_TARGET Mask4 all_positive() const {
    return ((value[0] > bound) & (value[1] > bound)) & ((value[2] > bound) & (value[3] > bound));
  }
  [[nodiscard]] DARTCAST_TARGET Mask4 any_negative() const {
    return ((value[0] < -bound) | (value[1] < -bound)) | ((value[2] < -bound) | (value[3] < -bound));
  }

  // The Signs of each lane. `v`, `x`: those that the determinants are of.
  [[nodiscard]] DARTCAST_TARGET Mask4 signs(const Corners4& v, const Vec3x4& x) const {
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
  // Whether the values are exact (rounds_nothing() in dartcast/predicates.hpp), where the filter applies.
  [[nodiscard]] DARTCAST_TARGET Mask4 are_exact(const Corners4& v, const Vec3x4& x) const {
    const Vec3x4 unit = extent * splat(0x1p+37);
    const Vec3x4 m = magnitude(x);
    Mask4 rounded = is_rounded(m.x, unit.x) | is_rounded(m.y, unit.y) | is_rounded(m.z, unit.z);
    for (const Vec3x4& corner : v.corner) {
      const Vec3x4 c = magnitude(corner);
      rounded |= is_rounded(c.x, unit.x) | is_rounded(c.y, unit.y) | is_rounded(c.z, unit.z);
    }
    return ~rounded;
  }
  DARTCAST_TARGET static Mask4 is_rounded(const Double4& m, const Double4& unit) { return ((m + unit) - unit) != m; }
};

// Whether every number is 0 or between the two magnitudes.
DARTCAST_TARGET inline bool all_between(const double* x, std::size_t count, double low, double high) {
  Mask4 between = splat_bits(-1);
  std::size_t i = 0;
#pragma GCC unroll 4
  for (; i + 4 <= count; i += 4) {
    const Double4 numbers = *reinterpret_cast<const UnalignedDouble4*>(x + i);
    const Double4 m = magnitude(numbers);
    between &= ((m >= low) & (m <= high)) | (m == 0.0);
  }
  bool rest = true;
  for (; i < count; ++i) rest = rest && (x[i] == 0.0 || (std::abs(x[i]) >= low && std::abs(x[i]) <= high));
  return rest && lanes_set(between) == 15U;
}
