// Elementary functions that give the same bits on every machine: the mathematical libraries of systems differ in the
// last bits. They use + - * / and square roots of doubles, and operations that are exact.
//
// Errors are below 1 ulp, but for exponential_less_one(), polar_angle() and hypotenuse(), which are below 2 (tested
// against 113 bits). NaN, infinities and zeros give what the functions of <cmath> give. sin(-x) = -sin(x) and
// cos(-x) = cos(x) hold to the last bit, and no sine is above 1.
#pragma once

#include <array>
#include <cmath>

namespace dartcast {

struct SineCosine {
  double sine, cosine;
};
/// The sine and cosine of x radians. Cost: some 10 ns below 1024, where vectors have it, too (elementary4.inl).
SineCosine sine_cosine(double x);
/// The sine and cosine of 2 pi t. Exact at quarters: no rounding of pi is in them.
SineCosine sine_cosine_of_turns(double t);

/// exp(x), and exp(x) - 1 without loss of digits near 0.
double exponential(double x);
double exponential_less_one(double x);

/// The angle of (x, y) from the x axis, in [-pi, pi], as atan2().
double polar_angle(double y, double x);

double cube_root(double x);

namespace detail {
double scaled_hypotenuse(double x, double y, double z);
}  // namespace detail

/// sqrt(x^2 + y^2 + z^2) without overflow or underflow in between.
inline double hypotenuse(double x, double y, double z = 0.0) {
  const double square = x * x + y * y + z * z;
  return square > 0x1p-900 && square < 0x1p+1000 ? std::sqrt(square) : detail::scaled_hypotenuse(x, y, z);
}

// For the functions of one number and those of four lanes alike: the same operations in the same order.
namespace detail {

/// x + to_integer - to_integer is x rounded to an integer, ties to even; the last bits of x + to_integer are those of the
/// integer. For 0 <= x < 2^51.
inline constexpr double to_integer = 0x1.8p+52;

/// Above this turns lose their whole ones first.
inline constexpr double many_turns = 0x1p+40;
/// 2 pi: 26 bits, the rest, and the rest of that. Half of a number's 53 bits times the first is exact.
inline constexpr std::array turn_parts = {0x1.921fb5p+2, 0x1.110b4611a6263p-24, 0x1.8a2e03707344ap-79};
inline constexpr double radians_per_turn = 0x1.921fb54442d18p+2;
inline constexpr double splitter = 0x1p+27 + 1.0;

/// Angles below this are reduced by the parts of pi / 2: up to 2^10 times the first two, of 42 bits each, is exact.
inline constexpr double many_radians = 1024.0;
inline constexpr std::array half_pi_parts = {0x1.921fb544428p+0, 0x1.4611a62633p-42, 0x1.45c06e0e68948p-86};
inline constexpr double per_half_pi = 0x1.45f306dc9c883p-1;

/// The series of (x - sin x) / x^3 and of (cos x - 1 + x^2 / 2) / x^4 in x^2. They alternate: in [-pi / 4, pi / 4] the
/// first term that is left out bounds the error: 2^-62 and 2^-58.
inline constexpr std::array sine_terms = {
    1.0 / 6.0,        -1.0 / 120.0,        1.0 / 5040.0,          -1.0 / 362880.0,
    1.0 / 39916800.0, -1.0 / 6227020800.0, 1.0 / 1307674368000.0, -1.0 / 355687428096000.0};
inline constexpr std::array cosine_terms = {
    1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,         -1.0 / 3628800.0,
    1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};

}  // namespace detail
}  // namespace dartcast
