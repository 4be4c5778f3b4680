#include "dartcast/walk/filtered.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "dartcast/walk/ride.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace dartcast::detail {

namespace {

// How vectors are passed does not matter: no function here is called from elsewhere.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

// Four doubles. Where the instruction set has no such register, the compiler takes two of half the size.
using Quad = double __attribute__((vector_size(32)));
using Mask = long long __attribute__((vector_size(32)));

// Sign of u . (v x w), evaluated as in exact/predicates.cpp; 0 where the filter leaves it open.
inline int filtered_sign(const Vec3& u, const Vec3& v, const Vec3& w) {
  const auto largest = [](double a, double b, double c) { return std::max({std::abs(a), std::abs(b), std::abs(c)}); };
  const double x = largest(u.x, v.x, w.x);
  const double y = largest(u.y, v.y, w.y);
  const double z = largest(u.z, v.z, w.z);
  const double m = x * y * z;
  if (!filter_applies(std::max({x, y, z}), m)) return 0;
  const double value = dot(u, cross(v, w));
  return value > determinant_error * m ? 1 : value < -determinant_error * m ? -1 : 0;
}

namespace portable {

inline unsigned lanes_set(const Mask& m) {
  const Mask bits = m & Mask{1, 2, 4, 8};
  return static_cast<unsigned>((bits[0] | bits[1]) | (bits[2] | bits[3]));
}

inline Quad load_row(const Vec3& x) { return Quad{x.x, x.y, x.z, x.z}; }

#define DARTCAST_TARGET
#include "dartcast/walk/filtered_kernel.hpp"
#undef DARTCAST_TARGET

void step(const FilteredScene& scene, std::span<State> states, std::span<const Vec3> targets,
          std::span<std::uint8_t> left, Counters& counters) {
  Batch(scene, states, targets, left, counters)
      .run(static_cast<std::uint32_t>(states.size()), scene.complex->simplex_count());
}

}  // namespace portable

#if defined(__x86_64__)
namespace avx2 {

#define DARTCAST_TARGET __attribute__((target("avx2")))

DARTCAST_TARGET inline unsigned lanes_set(const Mask& m) {
  return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(m)));
}

DARTCAST_TARGET inline Quad load_row(const Vec3& x) { return _mm256_maskload_pd(&x.x, __m256i{-1, -1, -1, 0}); }

#include "dartcast/walk/filtered_kernel.hpp"

DARTCAST_TARGET void step(const FilteredScene& scene, std::span<State> states, std::span<const Vec3> targets,
                          std::span<std::uint8_t> left, Counters& counters) {
  Batch(scene, states, targets, left, counters)
      .run(static_cast<std::uint32_t>(states.size()), scene.complex->simplex_count());
}

#undef DARTCAST_TARGET

}  // namespace avx2
#endif

}  // namespace

void step_filtered(const FilteredScene& scene, std::span<State> states, std::span<const Vec3> targets,
                   std::span<std::uint8_t> left, Counters& counters) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return avx2::step(scene, states, targets, left, counters);
#endif
  portable::step(scene, states, targets, left, counters);
}

}  // namespace dartcast::detail
