// Sines and cosines of four numbers, with the bits of elementary.cpp: the same operations in the same order.
#pragma once

#include <array>
#include <cstddef>

#include "base/double4.inl"
#include "base/elementary.hpp"
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
  return {high, low, reinterpret_cast<Mask4>(quarters)};
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
  return {high, (sum - high) + off, reinterpret_cast<Mask4>(shifted)};
}

inline SineCosine4 sine_cosine_of(const Double4& x, const Reduced4& r) {
  const Double4 one = splat(1.0);
  const Double4 z = r.high * r.high;
  const Double4 sine = r.high - (r.high * z * polynomial(sine_terms, z) - r.low * (one - 0.5 * z));
  const Double4 half = 0.5 * z;
  const Double4 near = one - half;
  const Double4 cosine = near + (((one - near) - half) + (z * z * polynomial(cosine_terms, z) - r.high * r.low));
  const Mask4 odd = (r.quadrant & splat_bits(1)) != 0;
  const Double4 s = odd ? cosine : sine;
  const Double4 c = odd ? sine : cosine;
  const Mask4 sign = reinterpret_cast<Mask4>(x) & splat_bits(static_cast<long long>(0x8000000000000000U));
  const Double4 sign_of_x = reinterpret_cast<Double4>(sign | reinterpret_cast<Mask4>(one));
  const Mask4 below = (r.quadrant & splat_bits(2)) != 0;
  const Mask4 left = ((r.quadrant + 1) & splat_bits(2)) != 0;
  return {sign_of_x * (below ? splat(0.0) - s : s), left ? splat(0.0) - c : c};
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

}  // namespace
}  // namespace dartcast::detail::DARTCAST_SIMD
DARTCAST_END_KERNEL
