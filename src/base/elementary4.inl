// Elementary functions of four numbers, with the bits of elementary.cpp: the same operations in the same order.
#pragma once

#include <array>
#include <cstddef>

#include "base/double4.inl"
#include "base/elementary.hpp"
#include "base/exponential_series.hpp"
#include "base/sine_series.hpp"

DARTCAST_BEGIN_KERNEL
namespace dartcast::detail::DARTCAST_SIMD {
namespace {

struct SineCosine4 {
  Double4 sine, cosine;
};

// Angles of `quadrant` right angles and high + low radians.
struct Reduced4 {
  Double4 high, low;
  Mask4 quadrant;
};

template <std::size_t N>
inline Double4 polynomial(const std::array<double, N>& terms, const Double4& x) {
  Double4 sum = splat(terms[N - 1]);
  for (std::size_t i = N - 1; i > 0; --i) sum = sum * x + splat(terms[i - 1]);
  return sum;
}

inline Reduced4 reduced_turns(const Double4& t) {
  const Double4 quarters = t * 4.0 + to_integer;
  const Double4 f = t - (quarters - to_integer) * 0.25;
  const Double4 high = f * radians_per_turn;
  const Double4 shifted = f * splitter;
  const Double4 f0 = shifted - (shifted - f);
  const Double4 f1 = f - f0;
  const Double4 low = ((f0 * turn_parts[0] - high) + (f0 * turn_parts[1] + f1 * turn_parts[0])) +
                      (f1 * turn_parts[1] + f * turn_parts[2]);
  return {high, low, bits_as<Mask4>(quarters)};
}

inline Reduced4 reduced_radians(const Double4& x) {
  const Double4 shifted = x * per_half_pi + to_integer;
  const Double4 k = shifted - to_integer;
  const Double4 first = x - k * half_pi_parts[0];
  const Double4 second = k * half_pi_parts[1];
  const Double4 sum = first - second;
  const Double4 taken = first - sum;
  const Double4 off = ((first - (sum + taken)) + (taken - second)) - k * half_pi_parts[2];
  const Double4 high = sum + off;
  return {high, (sum - high) + off, bits_as<Mask4>(shifted)};
}

inline SineCosine4 sine_cosine_of(const Double4& x, const Reduced4& r) {
  const Double4 one = splat(1.0);
  const Double4 z = r.high * r.high;
  const Double4 sine = r.high - (r.high * z * polynomial(sine_terms, z) - r.low * (one - 0.5 * z));
  const Double4 half = 0.5 * z;
  const Double4 near = one - half;
  const Double4 cosine = near + (((one - near) - half) + (z * z * polynomial(cosine_terms, z) - r.high * r.low));
  const Mask4 odd = (r.quadrant & splat_bits(1)) != 0;
  const Double4 s = choose(odd, cosine, sine);
  const Double4 c = choose(odd, sine, cosine);
  const Mask4 sign = bits_as<Mask4>(x) & splat_bits(static_cast<long long>(0x8000000000000000U));
  const Double4 sign_of_x = bits_as<Double4>(sign | bits_as<Mask4>(one));
  const Mask4 below = (r.quadrant & splat_bits(2)) != 0;
  const Mask4 left = ((r.quadrant + 1) & splat_bits(2)) != 0;
  return {sign_of_x * choose(below, splat(0.0) - s, s), choose(left, splat(0.0) - c, c)};
}

// For numbers that the reductions above are not for.
template <class Function>
inline SineCosine4 one_by_one(const Double4& x, Function&& function) {
  SineCosine4 all{};
  for (unsigned k = 0; k < 4; ++k) {
    const SineCosine one = function(x[k]);
    all.sine[k] = one.sine;
    all.cosine[k] = one.cosine;
  }
  return all;
}

// As dartcast::sine_cosine().
inline SineCosine4 sine_cosine(const Double4& x) {
  const Double4 a = magnitude(x);
  if (lanes_set(a < splat(many_radians)) == 15) return sine_cosine_of(x, reduced_radians(a));
  return one_by_one(x, dartcast::sine_cosine);
}

// As dartcast::sine_cosine_of_turns().
inline SineCosine4 sine_cosine_of_turns(const Double4& t) {
  const Double4 a = magnitude(t);
  if (lanes_set(a < splat(many_turns)) == 15) return sine_cosine_of(t, reduced_turns(a));
  return one_by_one(t, dartcast::sine_cosine_of_turns);
}

struct ExponentialParts4 {
  Double4 high, low;
  Double4 power;
};

inline ExponentialParts4 exponential_parts(const Double4& x) {
  const Mask4 sign = bits_as<Mask4>(x) & splat_bits(static_cast<long long>(0x8000000000000000U));
  const Double4 size = (magnitude(x) * per_ln2 + to_integer) - to_integer;
  const Double4 k = bits_as<Double4>(bits_as<Mask4>(size) | sign);
  const Double4 first = x - k * ln2_parts[0];
  const Double4 second = k * ln2_parts[1];
  const Double4 r = first - second;
  const Double4 off = (first - r) - second;
  return {r, (off + off * r) + r * r * polynomial(exponential_terms, r), k};
}

// x 2^k. Precondition: x is 0 or both are normal.
inline Double4 scaled(const Double4& x, const Double4& k) {
  const Mask4 bits = bits_as<Mask4>(x) + (bits_as<Mask4>(k + to_integer) << 52);
  return choose(x == 0.0, x, bits_as<Double4>(bits));
}

template <class Function>
inline Double4 each(const Double4& x, Function&& function) {
  return Double4{function(x[0]), function(x[1]), function(x[2]), function(x[3])};
}

// As dartcast::exponential().
inline Double4 exponential(const Double4& x) {
  if (lanes_set(magnitude(x) < splat(700.0)) != 15) return each(x, dartcast::exponential);
  const ExponentialParts4 e = exponential_parts(x);
  return scaled(splat(1.0) + (e.high + e.low), e.power);
}

// As dartcast::exponential_less_one(), for x <= 0.
inline Double4 exponential_less_one(const Double4& x) {
  const ExponentialParts4 e = exponential_parts(larger(x, splat(lowest_exponent)));
  const Double4 less_one = e.high + e.low;
  const Double4 sum = scaled(less_one, e.power) + (scaled(splat(1.0), e.power) - splat(1.0));
  return choose(x == 0.0, x, choose(e.power == 0.0, less_one, sum));
}

// As dartcast::logarithm().
inline Double4 logarithm(const Double4& x) {
  if (lanes_set((x >= splat(0x1p-1000)) & (x <= splat(0x1p+1000))) != 15) return each(x, dartcast::logarithm);
  const auto bits = bits_as<Bits4>(x);
  const Bits4 power = (bits - root_of_half_bits + (1024ULL << 52U)) >> 52;
  const Double4 f = bits_as<Double4>(bits - ((power - 1024ULL) << 52)) - splat(1.0);
  const Bits4 in_last_bits = power | 0x4330000000000000ULL;
  const Double4 k = bits_as<Double4>(in_last_bits) - splat(0x1p+52 + 1024.0);
  const Double4 s = f / (splat(2.0) + f);
  const Double4 z = s * s;
  const Double4 half = splat(0.5) * f * f;
  const Double4 off = half - (s * (half + z * polynomial(logarithm_terms, z)) + k * ln2_parts[1]);
  return k * ln2_parts[0] - (off - f);
}

// As dartcast::power(), for y > 0.
inline Double4 power(const Double4& x, double y) { return exponential(splat(y) * logarithm(x)); }

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
