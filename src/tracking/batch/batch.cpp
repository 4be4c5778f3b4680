#include "tracking/batch/batch.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "tracking/batch/coordinate_bounds.hpp"
#include "tracking/carry.hpp"
#include "tracking/contact_geometry.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace dartcast::detail {

namespace {

// Four doubles. Where the instruction set has no such register, the compiler takes two of half the size.
using Double4 = double __attribute__((vector_size(32)));
// clang++ takes no notice of the alignment in an alias.
typedef double UnalignedDouble4 __attribute__((vector_size(32), aligned(8), may_alias));  // NOLINT(modernize-use-using)
using Double2 = double __attribute__((vector_size(16)));
typedef double UnalignedDouble2 __attribute__((vector_size(16), aligned(8), may_alias));  // NOLINT(modernize-use-using)
using Float4 = float __attribute__((vector_size(16)));
typedef float UnalignedFloat4 __attribute__((vector_size(16), aligned(4), may_alias));  // NOLINT(modernize-use-using)
using Mask4 = long long __attribute__((vector_size(32)));
typedef long long UnalignedMask4
    __attribute__((vector_size(32), aligned(8), may_alias));  // NOLINT(modernize-use-using)

// Sign of u . (v x w), evaluated as in src/predicates/predicates.cpp; 0 where the filter leaves it open.
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

namespace portable {

inline unsigned lanes_set(const Mask4& m) {
  const Mask4 bits = m & Mask4{1, 2, 4, 8};
  return static_cast<unsigned>((bits[0] | bits[1]) | (bits[2] | bits[3]));
}

inline Double4 widened(const Float4& x) { return __builtin_convertvector(x, Double4); }
inline Float4 narrowed(const Double4& x) { return __builtin_convertvector(x, Float4); }
// Two doubles from each of two places.
inline Double4 load_pairs(const double* a, const double* b) {
  const Double2 low = *reinterpret_cast<const UnalignedDouble2*>(a);
  const Double2 high = *reinterpret_cast<const UnalignedDouble2*>(b);
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
}
inline Double4 root(const Double4& x) {
  return Double4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

#define DARTCAST_TARGET
#include "tracking/batch/batch_kernel.inl"
#undef DARTCAST_TARGET

void step(const BatchScene& scene, const BatchSteps& steps, Counters& counters) {
  const std::uint64_t max_rounds = scene.complex->simplex_count();
  if (scene.moved) return Batch<CacheKind::previous_geometry>(scene, steps, counters).run(max_rounds);
  if (steps.caches.empty()) return Batch<CacheKind::none>(scene, steps, counters).run(max_rounds);
  Batch<CacheKind::barycentric>(scene, steps, counters).run(max_rounds);
}

}  // namespace portable

#if defined(__x86_64__)
namespace avx2 {

#define DARTCAST_TARGET __attribute__((target("avx2")))

DARTCAST_TARGET inline unsigned lanes_set(const Mask4& m) {
  return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(m)));
}

// The compiler makes two halves of __builtin_convertvector.
DARTCAST_TARGET inline Double4 widened(const Float4& x) { return _mm256_cvtps_pd(x); }
DARTCAST_TARGET inline Float4 narrowed(const Double4& x) { return _mm256_cvtpd_ps(x); }
// The compiler moves a half from register to register.
DARTCAST_TARGET inline Double4 load_pairs(const double* a, const double* b) {
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(a)), _mm_loadu_pd(b), 1);
}
DARTCAST_TARGET inline Double4 root(const Double4& x) { return _mm256_sqrt_pd(x); }

#include "tracking/batch/batch_kernel.inl"

DARTCAST_TARGET void step(const BatchScene& scene, const BatchSteps& steps, Counters& counters) {
  const std::uint64_t max_rounds = scene.complex->simplex_count();
  if (scene.moved) return Batch<CacheKind::previous_geometry>(scene, steps, counters).run(max_rounds);
  if (steps.caches.empty()) return Batch<CacheKind::none>(scene, steps, counters).run(max_rounds);
  Batch<CacheKind::barycentric>(scene, steps, counters).run(max_rounds);
}

#undef DARTCAST_TARGET

}  // namespace avx2
#endif

}  // namespace

SimplexCacheEntry cache_entry_of(CacheKind kind, std::span<const Vec3> positions, const VertexNumbers& vertices,
                                 const Vec3& p) {
  SimplexCacheEntry entry = unknown_entry();
  if (kind != CacheKind::previous_geometry) return entry;
  const Corners v = corners_of(positions.data(), vertices);
  const Determinants d(v, p);
  for (unsigned i = 0; i < 4; ++i) {
    const Vec3 relative = v[i] - p;
    entry.x[i] = static_cast<float>(relative.x);
    entry.y[i] = static_cast<float>(relative.y);
    entry.z[i] = static_cast<float>(relative.z);
  }
  if (d.proves_coordinates()) entry.w = d.value;
  return entry;
}

void step_batch(const BatchScene& scene, const BatchSteps& steps, Counters& counters,
                [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::step(scene, steps, counters);
#endif
  portable::step(scene, steps, counters);
}

bool all_as_decided(std::span<const Vec3> points) {
  if (points.empty()) return true;
  const double* x = &points[0].x;
#if defined(__x86_64__)
  if (best_instruction_set() == InstructionSet::avx2)
    return avx2::all_between(x, 3 * points.size(), smallest_magnitude, largest_magnitude);
#endif
  return portable::all_between(x, 3 * points.size(), smallest_magnitude, largest_magnitude);
}

}  // namespace dartcast::detail
