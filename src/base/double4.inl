// Vectors of four doubles, and of four points: one item in each lane. The operations on four items
// are those on one, and give the same bits as doubles do, in every instruction set.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/register_pair.inl"
#include "base/simd_kernel.hpp"
#include "dartcast/vec3.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

using Double4 = DARTCAST_VECTOR(double);
using Mask4 = DARTCAST_VECTOR(long long);  // all bits of a lane, or none; or a lane's bits
using Bits4 = DARTCAST_VECTOR(unsigned long long);
using Double2 = double __attribute__((vector_size(16)));
using Float4 = float __attribute__((vector_size(16)));
// clang++ takes no notice of the alignment in an alias.
typedef double UnalignedDouble2 __attribute__((vector_size(16), aligned(8), may_alias));  // NOLINT(modernize-use-using)
typedef float UnalignedFloat4 __attribute__((vector_size(16), aligned(4), may_alias));    // NOLINT(modernize-use-using)

#if defined(DARTCAST_AVX2)
typedef double UnalignedDouble4 __attribute__((vector_size(32), aligned(8), may_alias));  // NOLINT(modernize-use-using)
// NOLINTNEXTLINE(modernize-use-using)
typedef long long UnalignedMask4 __attribute__((vector_size(32), aligned(8), may_alias));

// A bit for each lane that is set.
inline unsigned lanes_set(const Mask4& m) {
  return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(m)));
}
// The lanes of a where the mask is set, of b elsewhere.
inline Double4 choose(const Mask4& m, const Double4& a, const Double4& b) { return m ? a : b; }
// The blend itself takes the sign.
inline Mask4 by_sign(const Mask4& m) { return m < 0; }
// The same bits.
template <class To, class From>
inline To bits_as(const From& x) {
  return reinterpret_cast<To>(x);
}
// Lanes of a (0 to 3) and b (4 to 7).
template <int i, int j, int k, int l>
inline Double4 shuffled(const Double4& a, const Double4& b) {
  return __builtin_shufflevector(a, b, i, j, k, l);
}
// The compiler makes two halves of __builtin_convertvector.
inline Double4 widened(const Float4& x) { return _mm256_cvtps_pd(x); }
inline Float4 narrowed(const Double4& x) { return _mm256_cvtpd_ps(x); }
// Two doubles from each of two places. The compiler would move a half from register to register.
inline Double4 load_pairs(const double* a, const double* b) {
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(a)), _mm_loadu_pd(b), 1);
}
inline void store_pairs(const Double4& x, double* a, double* b) {
  _mm_storeu_pd(a, _mm256_castpd256_pd128(x));
  _mm_storeu_pd(b, _mm256_extractf128_pd(x, 1));
}
inline Double4 root(const Double4& x) { return _mm256_sqrt_pd(x); }
inline Double4 load_doubles(const double* in) { return *reinterpret_cast<const UnalignedDouble4*>(in); }
inline void store_doubles(const Double4& four, double* out) { *reinterpret_cast<UnalignedDouble4*>(out) = four; }
inline Mask4 load_bits(const void* in) { return *static_cast<const UnalignedMask4*>(in); }
inline void store_bits(const Mask4& four, long long* out) { *reinterpret_cast<UnalignedMask4*>(out) = four; }
#else
// A bit for each lane that is set.
inline unsigned lanes_set(const Mask4& m) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_pd(reinterpret_cast<__m128d>(m.low)) |
                               _mm_movemask_pd(reinterpret_cast<__m128d>(m.high)) << 2);
#else
  const auto bits = (m.low & Mask4::Half{1, 2}) | (m.high & Mask4::Half{4, 8});
  return static_cast<unsigned>(bits[0] | bits[1]);
#endif
}
inline Mask4 by_sign(const Mask4& m) { return m; }
// Lanes of a (0 to 3) and b (4 to 7).
template <int i, int j, int k, int l>
inline Double4 shuffled(const Double4& a, const Double4& b) {
  const auto half = [&](int lane) { return lane < 2 ? a.low : lane < 4 ? a.high : lane < 6 ? b.low : b.high; };
  return {__builtin_shufflevector(half(i), half(j), i % 2, 2 + j % 2),
          __builtin_shufflevector(half(k), half(l), k % 2, 2 + l % 2)};
}
#if defined(__SSE2__)
inline Double4 widened(const Float4& x) { return {_mm_cvtps_pd(x), _mm_cvtps_pd(_mm_movehl_ps(x, x))}; }
inline Float4 narrowed(const Double4& x) { return _mm_movelh_ps(_mm_cvtpd_ps(x.low), _mm_cvtpd_ps(x.high)); }
inline Double4 root(const Double4& x) { return {_mm_sqrt_pd(x.low), _mm_sqrt_pd(x.high)}; }
#else
inline Double4 widened(const Float4& x) { return {Double2{x[0], x[1]}, Double2{x[2], x[3]}}; }
inline Float4 narrowed(const Double4& x) {
  return Float4{static_cast<float>(x.low[0]), static_cast<float>(x.low[1]), static_cast<float>(x.high[0]),
                static_cast<float>(x.high[1])};
}
inline Double4 root(const Double4& x) {
  return {Double2{std::sqrt(x.low[0]), std::sqrt(x.low[1])}, Double2{std::sqrt(x.high[0]), std::sqrt(x.high[1])}};
}
#endif
// Two doubles from each of two places.
inline Double4 load_pairs(const double* a, const double* b) {
  const Double2 low = *reinterpret_cast<const UnalignedDouble2*>(a);
  const Double2 high = *reinterpret_cast<const UnalignedDouble2*>(b);
  return {low, high};
}
inline void store_pairs(const Double4& x, double* a, double* b) {
  *reinterpret_cast<UnalignedDouble2*>(a) = x.low;
  *reinterpret_cast<UnalignedDouble2*>(b) = x.high;
}
inline Double4 load_doubles(const double* in) { return load_pairs(in, in + 2); }
inline void store_doubles(const Double4& four, double* out) { store_pairs(four, out, out + 2); }
inline Mask4 load_bits(const void* in) { return bits_as<Mask4>(load_doubles(static_cast<const double*>(in))); }
inline void store_bits(const Mask4& four, long long* out) {
  store_doubles(bits_as<Double4>(four), reinterpret_cast<double*>(out));
}
#endif

inline bool any(const Mask4& m) { return lanes_set(m) != 0; }

inline Double4 splat(double x) { return Double4{x, x, x, x}; }
inline Mask4 splat_bits(long long x) { return Mask4{x, x, x, x}; }
inline Double4 magnitude(const Double4& v) {
  return bits_as<Double4>(bits_as<Mask4>(v) & splat_bits(0x7fffffffffffffff));
}
inline Double4 larger(const Double4& a, const Double4& b) { return choose(a > b, a, b); }
inline Double4 smaller(const Double4& a, const Double4& b) { return choose(a < b, a, b); }

inline Double4 load_floats(const float* in) {
  const Float4 four = *reinterpret_cast<const UnalignedFloat4*>(in);
  return widened(four);
}
inline void store_floats(const Double4& four, float* out) { *reinterpret_cast<UnalignedFloat4*>(out) = narrowed(four); }

// A point in each lane.
struct Vec3x4 {
  Double4 x, y, z;
};
inline Vec3x4 splat(const Vec3& v) { return {splat(v.x), splat(v.y), splat(v.z)}; }
inline Vec3x4 operator+(const Vec3x4& a, const Vec3x4& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3x4 operator-(const Vec3x4& a, const Vec3x4& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3x4 operator*(const Vec3x4& a, const Double4& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Double4 dot(const Vec3x4& a, const Vec3x4& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3x4 cross(const Vec3x4& a, const Vec3x4& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Double4 square(const Vec3x4& a) { return dot(a, a); }
inline Vec3x4 magnitude(const Vec3x4& a) { return {magnitude(a.x), magnitude(a.y), magnitude(a.z)}; }
inline Vec3x4 larger(const Vec3x4& a, const Vec3x4& b) {
  return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
}
inline Double4 largest(const Vec3x4& a) { return larger(larger(a.x, a.y), a.z); }
inline Double4 smallest(const Vec3x4& a) { return smaller(smaller(a.x, a.y), a.z); }
inline Vec3x4 choose(const Mask4& m, const Vec3x4& a, const Vec3x4& b) {
  return {choose(m, a.x, b.x), choose(m, a.y, b.y), choose(m, a.z, b.z)};
}

inline Vec3x4 load_vec3x4(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Double4 xy02 = load_pairs(&a.x, &c.x);
  const Double4 xy13 = load_pairs(&b.x, &d.x);
  const Double4 yz02 = load_pairs(&a.y, &c.y);
  const Double4 yz13 = load_pairs(&b.y, &d.y);
  return {shuffled<0, 4, 2, 6>(xy02, xy13), shuffled<1, 5, 3, 7>(xy02, xy13), shuffled<1, 5, 3, 7>(yz02, yz13)};
}
// Points in a row.
inline Vec3x4 load_vec3x4(const Vec3* p) {
  const Double4 xy02 = load_pairs(&p[0].x, &p[2].x);
  const Double4 zx02 = load_pairs(&p[0].z, &p[2].z);  // z and the next one's x
  const Double4 yz13 = load_pairs(&p[1].y, &p[3].y);
  return {shuffled<0, 5, 2, 7>(xy02, zx02), shuffled<1, 4, 3, 6>(xy02, yz13), shuffled<0, 5, 2, 7>(zx02, yz13)};
}

// The numbers of four items.
struct Index4 {
  std::uint32_t at[4];
};
// Four of `size` items in a row; at their end the last one again in the remaining lanes.
inline Index4 index4_from(std::uint32_t i, std::uint32_t size) {
  const std::uint32_t last = size - 1;
  return {{i, std::min(i + 1, last), std::min(i + 2, last), std::min(i + 3, last)}};
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
