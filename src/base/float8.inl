// Vectors of eight floats, one item in each lane. The operations on eight items are those on one, and give the same
// bits as floats do, in every instruction set.
#pragma once

#include <cstdint>

#include "base/double4.inl"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

using Float8 = DARTCAST_VECTOR(float);
using Mask8 = DARTCAST_VECTOR(int);  // all bits of a lane, or none; or a lane's bits

#if defined(DARTCAST_AVX2)
inline Float8 choose(const Mask8& m, const Float8& a, const Float8& b) { return m ? a : b; }
inline Mask8 choose(const Mask8& m, const Mask8& a, const Mask8& b) { return m ? a : b; }
#endif

inline Mask8 splat_int(int x) { return Mask8{x, x, x, x, x, x, x, x}; }

// One bit for each lane, or four, numbers 0 to 3. Lane l of number i has the bit 16 (l / 4) + 4 i + l % 4. One alone is
// number 0.
using Bits8 = std::uint32_t;
constexpr Bits8 bits_of_number_0 = 0x000f000fU;

// The bits of number i in each lane.
inline Mask8 lane_bits(unsigned i) {
  const Mask8 bits = {1, 2, 4, 8, 1 << 16, 1 << 17, 1 << 18, 1 << 19};
  return bits << static_cast<int>(4 * i);
}
inline Mask8 lanes_with(Bits8 bits, unsigned i) {
  return (splat_int(static_cast<int>(bits)) & lane_bits(i)) == lane_bits(i);
}

// The signs of four vectors: set if negative, as all bits of a mask are.
#if defined(DARTCAST_AVX2)
inline Bits8 negative_bits(const Mask8& a, const Mask8& b, const Mask8& c, const Mask8& d) {
  const __m256i ab = _mm256_packs_epi32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b));
  const __m256i cd = _mm256_packs_epi32(reinterpret_cast<__m256i>(c), reinterpret_cast<__m256i>(d));
  return static_cast<Bits8>(_mm256_movemask_epi8(_mm256_packs_epi16(ab, cd)));
}
inline Bits8 negative_bits(const Mask8& a) {
  const auto bits = static_cast<Bits8>(_mm256_movemask_ps(reinterpret_cast<__m256>(a)));
  return (bits | bits << 12U) & bits_of_number_0;
}
#elif defined(__SSE2__)
inline Bits8 negative_bits(const Mask8& a, const Mask8& b, const Mask8& c, const Mask8& d) {
  const auto half = [](const auto& i, const auto& j, const auto& k, const auto& l) {
    const __m128i ij = _mm_packs_epi32(reinterpret_cast<__m128i>(i), reinterpret_cast<__m128i>(j));
    const __m128i kl = _mm_packs_epi32(reinterpret_cast<__m128i>(k), reinterpret_cast<__m128i>(l));
    return static_cast<Bits8>(_mm_movemask_epi8(_mm_packs_epi16(ij, kl)));
  };
  return half(a.low, b.low, c.low, d.low) | half(a.high, b.high, c.high, d.high) << 16U;
}
inline Bits8 negative_bits(const Mask8& a) {
  return static_cast<Bits8>(_mm_movemask_ps(reinterpret_cast<__m128>(a.low)) |
                            _mm_movemask_ps(reinterpret_cast<__m128>(a.high)) << 16);
}
#else
inline Bits8 negative_bits(const Mask8& a, const Mask8& b, const Mask8& c, const Mask8& d) {
  const Mask8 bits =
      ((a < 0) & lane_bits(0)) | ((b < 0) & lane_bits(1)) | ((c < 0) & lane_bits(2)) | ((d < 0) & lane_bits(3));
  const auto all = bits.low | bits.high;
  return static_cast<Bits8>((all[0] | all[1]) | (all[2] | all[3]));
}
inline Bits8 negative_bits(const Mask8& a) { return negative_bits(a, Mask8{}, Mask8{}, Mask8{}); }
#endif

// Number i + 1 in place of number i, and 0 in place of 3.
inline Bits8 next_numbers(Bits8 bits) { return ((bits >> 4U) & 0x0fff0fffU) | ((bits << 12U) & 0xf000f000U); }
inline Bits8 number_of(Bits8 bits, unsigned i) { return (bits >> (4 * i)) & bits_of_number_0; }
// In any of the four, and in two of them at least.
inline Bits8 in_any_of_4(Bits8 bits) {
  bits |= bits >> 8U;
  return (bits | bits >> 4U) & bits_of_number_0;
}
inline Bits8 in_two_of_4(Bits8 bits) {
  const Bits8 two = bits | bits >> 8U;
  const Bits8 both = bits & bits >> 8U;
  return (both | both >> 4U | (two & two >> 4U)) & bits_of_number_0;
}
// Bit l for lane l.
inline unsigned in_a_row(Bits8 bits) { return (bits | bits >> 12U) & 255U; }

inline Float8 splat_float(float x) { return Float8{x, x, x, x, x, x, x, x}; }
inline Float8 magnitude(const Float8& v) { return bits_as<Float8>(bits_as<Mask8>(v) & splat_int(0x7fffffff)); }
inline Float8 larger(const Float8& a, const Float8& b) { return choose(a > b, a, b); }
inline Float8 smaller(const Float8& a, const Float8& b) { return choose(a < b, a, b); }
inline Float8 narrowed(const Double4& low, const Double4& high) {
#if defined(DARTCAST_AVX2)
  return __builtin_shufflevector(narrowed(low), narrowed(high), 0, 1, 2, 3, 4, 5, 6, 7);
#else
  return {narrowed(low), narrowed(high)};
#endif
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
