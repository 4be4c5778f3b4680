// Normal deviates for four items, with the bits of normal_deviates.hpp: the same operations in the same order.
#pragma once

#include <array>
#include <cstdint>

#include "base/elementary4.inl"
#include "base/keyed_random.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

inline Bits4 splat_word(std::uint32_t word) { return Bits4{word, word, word, word}; }

// The products of the lower halves.
inline Bits4 product_of_words(const Bits4& a, std::uint32_t factor) {
#if defined(DARTCAST_AVX2)
  return bits_as<Bits4>(_mm256_mul_epu32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(splat_word(factor))));
#else
  return (a & 0xffffffffULL) * std::uint64_t{factor};
#endif
}

// As RandomMoment::bits(): words in the lower halves, and anything in the upper ones.
inline std::array<Bits4, 4> random_bits(const RandomMoment& moment, const Bits4& ids, std::uint32_t draw) {
  const std::array<std::uint32_t, 2> common = moment.counter(draw);
  std::array<std::uint32_t, 2> key = moment.key();
  std::array<Bits4, 4> c = {splat_word(common[0]), splat_word(common[1]), ids, ids >> 32};
  for (int round = 0; round < 10; ++round) {
    const Bits4 a = product_of_words(c[0], 0xd2511f53U);
    const Bits4 b = product_of_words(c[2], 0xcd9e8d57U);
    c = {(b >> 32) ^ c[1] ^ splat_word(key[0]), b, (a >> 32) ^ c[3] ^ splat_word(key[1]), a};
    key[0] += 0x9e3779b9U;
    key[1] += 0xbb67ae85U;
  }
  return c;
}

// The middles of pieces of [0, 1].
inline Double4 middle_of_piece(const Bits4& word) {
  const Bits4 in_last_bits = (word & 0xffffffffULL) | 0x4330000000000000ULL;
  return (bits_as<Double4>(in_last_bits) - splat(0x1p+52) + splat(0.5)) * splat(0x1p-32);
}

// A pair of each item.
inline SineCosine4 normal_pair(const Bits4& size_bits, const Bits4& direction_bits) {
  const Double4 size = root(splat(-2.0) * logarithm(middle_of_piece(size_bits)));
  const SineCosine4 direction = sine_cosine_of_turns(middle_of_piece(direction_bits));
  return {size * direction.sine, size * direction.cosine};
}

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
