// Elementary functions by series and exact reductions. elementary4.inl repeats some for four numbers.
#include "base/elementary.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/exponential_series.hpp"
#include "base/sine_series.hpp"
#include "base/wide_integer.hpp"

namespace dartcast {

namespace {

using detail::cosine_terms;
using detail::exponential_terms;
using detail::half_pi_parts;
using detail::ln2_parts;
using detail::logarithm_terms;
using detail::lowest_exponent;
using detail::many_radians;
using detail::many_turns;
using detail::per_half_pi;
using detail::per_ln2;
using detail::radians_per_turn;
using detail::sine_terms;
using detail::splitter;
using detail::to_integer;
using detail::turn_parts;

constexpr double infinity = std::numeric_limits<double>::infinity();

// The polynomial's value at x; the constant term first.
template <std::size_t N>
double polynomial(const std::array<double, N>& terms, double x) {
  double sum = terms[N - 1];
  for (std::size_t i = N - 1; i > 0; --i) sum = sum * x + terms[i - 1];
  return sum;
}

// An angle of `quadrant` right angles and high + low radians, in [-pi / 4, pi / 4].
struct Reduced {
  double high, low;
  std::uint64_t quadrant;
};

// An angle of f turns in radians. The product of the halves of f and 2 pi is exact (T. J. Dekker, 1971).
Reduced in_radians(double f, std::uint64_t quadrant) {
  const double high = f * radians_per_turn;
  const double shifted = f * splitter;
  const double f0 = shifted - (shifted - f);
  const double f1 = f - f0;
  const double low = ((f0 * turn_parts[0] - high) + (f0 * turn_parts[1] + f1 * turn_parts[0])) +
                     (f1 * turn_parts[1] + f * turn_parts[2]);
  return {high, low, quadrant};
}

// For 0 <= t < many_turns: t less its quarters is exact.
Reduced reduced_turns(double t) {
  const double shifted = t * 4.0 + to_integer;
  return in_radians(t - (shifted - to_integer) * 0.25, std::bit_cast<std::uint64_t>(shifted));
}

// For 0 <= x < many_radians. The first difference is exact; the sum of the others is kept in two parts.
Reduced reduced_radians(double x) {
  const double shifted = x * per_half_pi + to_integer;
  const double k = shifted - to_integer;
  const double first = x - k * half_pi_parts[0];
  const double second = k * half_pi_parts[1];
  const double sum = first - second;
  const double taken = first - sum;
  const double off = ((first - (sum + taken)) + (taken - second)) - k * half_pi_parts[2];
  const double high = sum + off;
  return {high, (sum - high) + off, std::bit_cast<std::uint64_t>(shifted)};
}

// The bits of 1 / (2 pi) after the binary point, behind 64 zeros.
constexpr std::array<std::uint64_t, 22> turns_per_radian = {
    0x0000000000000000U, 0x28be60db9391054aU, 0x7f09d5f47d4d3770U, 0x36d8a5664f10e410U, 0x7f9458eaf7aef158U,
    0x6dc91b8e909374b8U, 0x01924bba82746487U, 0x3f877ac72c4a69cfU, 0xba208d7d4baed121U, 0x3a671c09ad17df90U,
    0x4e64758e60d4ce7dU, 0x272117e2ef7e4a0eU, 0xc7fe25fff7816603U, 0xfbcbc462d6829b47U, 0xdb4d9fb3c9f2c26dU,
    0xd3d18fd9a797fa8bU, 0x5d49eeb1faf97c5eU, 0xcf41ce7de294a4baU, 0x9afed7ec47e35742U, 0x1580cc11bf1edaeaU,
    0xfc33ef0826bd0d87U, 0x6a78e45857b986c2U};

// 64 of these bits, from one on.
std::uint64_t bits_from(std::size_t bit) {
  const std::size_t word = bit / 64;
  const std::size_t shift = bit % 64;
  if (shift == 0) return turns_per_radian[word];
  return (turns_per_radian[word] << shift) | (turns_per_radian[word + 1] >> (64 - shift));
}

// For finite x >= many_radians: x / (2 pi) less its whole turns, in 192 bits (M. H. Payne, R. N. Hanek, 1983). No double
// is so near to a multiple of pi / 2 that fewer than 115 of them count.
Reduced reduced_many_radians(double x) {
  const int exponent = std::ilogb(x) - 52;
  const auto integer = static_cast<std::uint64_t>(std::ldexp(x, -exponent));
  const int bit = 64 + exponent;
  const auto first = static_cast<std::size_t>(bit);
  const WideProduct low = wide_product(integer, bits_from(first + 128));
  const WideProduct middle = wide_product(integer, bits_from(first + 64));
  const std::uint64_t m = middle.low + low.high;
  const std::uint64_t carry = m < middle.low ? 1U : 0U;
  const std::uint64_t top = integer * bits_from(first) + middle.high + carry;
  // Less the nearest quarter: a signed number of 128 bits, whose unit is 2^-128 turns.
  const std::uint64_t quadrant = (top + (1ULL << 61U)) >> 62U;
  std::uint64_t h = top - (quadrant << 62U);
  std::uint64_t l = m;
  const bool negative = (h >> 63U) != 0;
  if (negative) {
    l = ~l + 1U;
    h = ~h + (l == 0 ? 1U : 0U);
  }
  // Its leading 64 bits, and those behind them.
  const auto zeros = static_cast<unsigned>(h != 0 ? std::countl_zero(h) : 64 + std::countl_zero(l));
  const std::uint64_t rest = negative ? ~low.low + 1U : low.low;
  std::uint64_t lead = h;
  std::uint64_t next = l;
  if (zeros >= 64) lead = l, next = rest;
  if (zeros % 64 != 0) {
    lead = (lead << (zeros % 64)) | (next >> (64 - zeros % 64));
    next = (next << (zeros % 64)) | (zeros >= 64 ? 0U : rest >> (64 - zeros % 64));
  }
  const double sign = negative ? -1.0 : 1.0;
  const int unit = -64 - static_cast<int>(zeros);
  Reduced r = in_radians(sign * std::ldexp(static_cast<double>(lead >> 11U), unit + 11), quadrant);
  const std::uint64_t behind = ((lead & 0x7ffU) << 42U) | (next >> 22U);
  r.low += sign * std::ldexp(static_cast<double>(behind), unit - 42) * radians_per_turn;
  return r;
}

SineCosine sine_cosine_of(double x, const Reduced& r) {
  const double z = r.high * r.high;
  const double sine = r.high - (r.high * z * polynomial(sine_terms, z) - r.low * (1.0 - 0.5 * z));
  const double half = 0.5 * z;
  const double near = 1.0 - half;
  const double cosine = near + (((1.0 - near) - half) + (z * z * polynomial(cosine_terms, z) - r.high * r.low));
  const bool odd = (r.quadrant & 1U) != 0;
  const double s = odd ? cosine : sine;
  const double c = odd ? sine : cosine;
  return {std::copysign(1.0, x) * ((r.quadrant & 2U) != 0 ? 0.0 - s : s), ((r.quadrant + 1U) & 2U) != 0 ? 0.0 - c : c};
}

constexpr SineCosine no_angle = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

}  // namespace

SineCosine sine_cosine(double x) {
  const double a = std::abs(x);
  if (a < many_radians) return sine_cosine_of(x, reduced_radians(a));
  return std::isfinite(x) ? sine_cosine_of(x, reduced_many_radians(a)) : no_angle;
}

SineCosine sine_cosine_of_turns(double t) {
  const double a = std::abs(t);
  if (a < many_turns) return sine_cosine_of(t, reduced_turns(a));
  return std::isfinite(t) ? sine_cosine_of(t, reduced_turns(std::fmod(a, 1.0))) : no_angle;
}

namespace {

// The value exp(x) is 2^power (1 + high + low).
struct ExponentialParts {
  double high, low;
  int power;
};

// For |x| < 1000.
ExponentialParts exponential_parts(double x) {
  const double k = std::copysign((std::abs(x) * per_ln2 + to_integer) - to_integer, x);
  const double first = x - k * ln2_parts[0];
  const double second = k * ln2_parts[1];
  const double r = first - second;
  const double off = (first - r) - second;
  return {r, (off + off * r) + r * r * polynomial(exponential_terms, r), static_cast<int>(k)};
}

}  // namespace

double exponential(double x) {
  if (!(x < 1000.0)) return x > 0.0 ? infinity : x;
  if (x < -1000.0) return 0.0;
  const ExponentialParts e = exponential_parts(x);
  return std::ldexp(1.0 + (e.high + e.low), e.power);
}

double exponential_less_one(double x) {
  if (x == 0.0 || std::isnan(x)) return x;
  if (x > 50.0) return exponential(x);
  if (x < lowest_exponent) return -1.0;
  const ExponentialParts e = exponential_parts(x);
  const double less_one = e.high + e.low;
  return e.power == 0 ? less_one : std::ldexp(less_one, e.power) + (std::ldexp(1.0, e.power) - 1.0);
}

// As in fdlibm (K. C. Ng, 1993): x = 2^k (1 + f), s = f / (2 + f), and ln(1 + f) = f - (h - s (h + r)) with h = f^2 / 2.
// The difference f is exact.
double logarithm(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -infinity : std::numeric_limits<double>::quiet_NaN();
  if (x == infinity) return x;
  const bool tiny = x < std::numeric_limits<double>::min();
  const auto bits = std::bit_cast<std::uint64_t>(tiny ? x * 0x1p+54 : x);
  const std::uint64_t power = (bits - detail::root_of_half_bits + (std::uint64_t{1024} << 52U)) >> 52U;
  const double f = std::bit_cast<double>(bits - ((power - 1024U) << 52U)) - 1.0;
  const double k = static_cast<double>(power) - (tiny ? 1078.0 : 1024.0);
  const double s = f / (2.0 + f);
  const double z = s * s;
  const double half = 0.5 * f * f;
  const double off = half - (s * (half + z * polynomial(logarithm_terms, z)) + k * ln2_parts[1]);
  return k * ln2_parts[0] - (off - f);
}

double power(double x, double y) { return y == 0.0 ? 1.0 : exponential(y * logarithm(x)); }

namespace {

// The series of (x - atan x) / x^3 in x^2. It alternates: for |x| < 0.24 the rest is below 2^-58.
constexpr std::array arc_terms = {1.0 / 3.0,  -1.0 / 5.0,  1.0 / 7.0,  -1.0 / 9.0,  1.0 / 11.0, -1.0 / 13.0,
                                  1.0 / 15.0, -1.0 / 17.0, 1.0 / 19.0, -1.0 / 21.0, 1.0 / 23.0, -1.0 / 25.0};

struct TwoParts {
  double high, low;
};
// The arcs of 0, 1/2 and 1; taken from pi / 2; from pi; added to pi / 2.
constexpr std::array<std::array<TwoParts, 3>, 4> arcs = {{
    {{{0.0, 0.0}, {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56}, {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}}},
    {{{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},
      {0x1.1b6e192ebbe44p+0, 0x1.b1b466a88828ep-54},
      {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}}},
    {{{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53},
      {0x1.56c6e7397f5aep+1, 0x1.660b64ece6f4bp-53},
      {0x1.2d97c7f3321d2p+1, 0x1.a79394c9e8a0ap-54}}},
    {{{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},
      {0x1.0468a8ace4df6p+1, 0x1.0620bf7406affp-55},
      {0x1.2d97c7f3321d2p+1, 0x1.a79394c9e8a0ap-54}}},
}};

}  // namespace

double polar_angle(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return x + y;
  double large = std::abs(x);
  double small = std::abs(y);
  const bool steep = small > large;
  if (steep) std::swap(large, small);
  if (small == infinity) large = small = 1.0;
  // So that halves and sums are exact or finite.
  const double scale = large > 0x1p+1000 ? 0x1p-10 : large < 0x1p-900 ? 0x1p+100 : 1.0;
  if (large < infinity) large *= scale, small *= scale;
  double slope = 0.0;  // relative to that of the arc in the table
  std::size_t arc = 0;
  if (small <= 0.236 * large) {
    slope = small == 0.0 ? 0.0 : small / large;
  } else if (small <= 0.72 * large) {
    slope = (small - 0.5 * large) / (large + 0.5 * small);
    arc = 1;
  } else {
    slope = (small - large) / (large + small);
    arc = 2;
  }
  const double z = slope * slope;
  const double angle = slope - slope * z * polynomial(arc_terms, z);
  const bool back = std::signbit(x);
  const TwoParts& from = arcs[(back ? 2U : 0U) + (steep ? 1U : 0U)][arc];
  const double turned = from.high + (steep != back ? from.low - angle : from.low + angle);
  return std::copysign(turned, y);
}

double cube_root(double x) {
  const double a = std::abs(x);
  if (a == 0.0 || !std::isfinite(a)) return x;
  const int exponent = std::ilogb(a);
  const int third = (exponent - ((exponent % 3) + 3) % 3) / 3;
  const double m = std::ldexp(a, -3 * third);  // in [1, 8)
  double t = 0.93 + 0.14 * m;
  for (int i = 0; i < 3; ++i) {  // Halley's method: three times as many digits each
    const double cube = t * t * t;
    t *= (cube + 2.0 * m) / (2.0 * cube + m);
  }
  // A step more from 26 bits of t, whose square is exact.
  const double shifted = t * splitter;
  const double t0 = shifted - (shifted - t);
  const double ratio = m / (t0 * t0);
  return std::copysign(std::ldexp(t0 + t0 * ((ratio - t0) / (2.0 * t0 + ratio)), third), x);
}

double detail::scaled_hypotenuse(double x, double y, double z) {
  if (std::isinf(x) || std::isinf(y) || std::isinf(z)) return infinity;
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (largest == 0.0 || std::isnan(x + y + z)) return std::abs(x) + std::abs(y) + std::abs(z);
  const int exponent = std::ilogb(largest);
  const double a = std::ldexp(x, -exponent);
  const double b = std::ldexp(y, -exponent);
  const double c = std::ldexp(z, -exponent);
  return std::ldexp(std::sqrt(a * a + b * b + c * c), exponent);
}

}  // namespace dartcast
