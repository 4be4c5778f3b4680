#include "complex/positive_cells.hpp"

#include <cstddef>

#include "dartcast/predicates.hpp"

namespace dartcast::detail {

namespace {

// How vectors are passed does not matter: everything here is inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

// Four doubles. Where the instruction set has no such register, the compiler takes two of half the size.
using Double4 = double __attribute__((vector_size(32)));
using Mask4 = long long __attribute__((vector_size(32)));
// clang++ takes no notice of the alignment in an alias.
typedef double UnalignedPair __attribute__((vector_size(16), aligned(8), may_alias));  // NOLINT(modernize-use-using)

struct Vec3x4 {
  Double4 x, y, z;
};

constexpr std::size_t max_points = 64;

// Inlined into functions for one instruction set each.
#define DARTCAST_INLINE inline __attribute__((always_inline))

// Two doubles each of two points, side by side.
DARTCAST_INLINE Double4 pairs(const double& a, const double& b) {
  return __builtin_shufflevector(*reinterpret_cast<const UnalignedPair*>(&a),
                                 *reinterpret_cast<const UnalignedPair*>(&b), 0, 1, 2, 3);
}

DARTCAST_INLINE Vec3x4 in_lanes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Double4 xy_ac = pairs(a.x, c.x);
  const Double4 xy_bd = pairs(b.x, d.x);
  return {__builtin_shufflevector(xy_ac, xy_bd, 0, 4, 2, 6), __builtin_shufflevector(xy_ac, xy_bd, 1, 5, 3, 7),
          __builtin_shufflevector(pairs(a.y, c.y), pairs(b.y, d.y), 1, 5, 3, 7)};
}

DARTCAST_INLINE Vec3x4 operator-(const Vec3x4& a, const Vec3x4& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
DARTCAST_INLINE Double4 magnitude(const Double4& a) {
  return reinterpret_cast<Double4>(reinterpret_cast<Mask4>(a) & (Mask4{} + 0x7fffffffffffffffLL));
}
DARTCAST_INLINE Double4 larger(const Double4& a, const Double4& b) { return a < b ? b : a; }
DARTCAST_INLINE Double4 smaller(const Double4& a, const Double4& b) { return a < b ? a : b; }
DARTCAST_INLINE Vec3x4 larger(const Vec3x4& a, const Vec3x4& b) {
  return {larger(a.x, magnitude(b.x)), larger(a.y, magnitude(b.y)), larger(a.z, magnitude(b.z))};
}

// All simplices of a shape have the same first corner: the points relative to it are differences as orient3d() takes
// them (dartcast/predicates.hpp), and the bound is that of the whole cell's extent, for a larger m bounds no less.
DARTCAST_INLINE unsigned all_proved(const Shape& shape, const std::array<const std::uint32_t*, 4>& vertices,
                                    const Vec3* positions) {
  const auto& simplices = shape.simplices();
  const auto& [v0, v1, v2, v3] = vertices;
  const std::uint16_t first = simplices[0].vertex[0];
  const Vec3x4 apex = in_lanes(positions[v0[first]], positions[v1[first]], positions[v2[first]], positions[v3[first]]);
  std::array<Vec3x4, max_points> points;
  Vec3x4 extent = {Double4{}, Double4{}, Double4{}};
  for (std::size_t i = 0; i < shape.point_count(); ++i) {
    points[i] = in_lanes(positions[v0[i]], positions[v1[i]], positions[v2[i]], positions[v3[i]]) - apex;
    extent = larger(extent, points[i]);
  }
  const Double4 m = extent.x * extent.y * extent.z;
  Mask4 proved = (larger(larger(extent.x, extent.y), extent.z) <= largest_decided_extent) &
                 (smaller(smaller(extent.x, extent.y), extent.z) >= smallest_extent);  // filter_applies()
  const Double4 bound = determinant_error * m;
  for (const ImplicitSimplex& s : simplices) {
    const Vec3x4& u = points[s.vertex[1]];
    const Vec3x4& v = points[s.vertex[2]];
    const Vec3x4& w = points[s.vertex[3]];
    const Double4 value = u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x);
    proved &= value > bound;
  }
  const Mask4 bits = proved & Mask4{1, 2, 4, 8};
  return static_cast<unsigned>((bits[0] | bits[1]) | (bits[2] | bits[3]));
}

#undef DARTCAST_INLINE

#if defined(__x86_64__)
__attribute__((target("avx2"))) unsigned with_avx2(const Shape& shape,
                                                   const std::array<const std::uint32_t*, 4>& vertices,
                                                   const Vec3* positions) {
  return all_proved(shape, vertices, positions);
}
#endif

}  // namespace

unsigned not_proved_positive(const Shape& shape, const std::array<const std::uint32_t*, 4>& vertices,
                             const Vec3* positions, [[maybe_unused]] InstructionSet set) {
  constexpr unsigned all = 0xf;
  if (shape.point_count() > max_points) return all;
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return with_avx2(shape, vertices, positions) ^ all;
#endif
  return all_proved(shape, vertices, positions) ^ all;
}

}  // namespace dartcast::detail
