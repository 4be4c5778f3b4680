// Elementary functions that give the same bits on every machine: the mathematical libraries of systems differ in the
// last bits. They use + - * / and square roots of doubles, and operations that are exact.
//
// Errors are below 1 ulp, but for exponential_less_one(), polar_angle() and hypotenuse(), which are below 2, and
// power() (tested against 113 bits). NaN, infinities and zeros give what the functions of <cmath> give. The rules
// sin(-x) = -sin(x) and cos(-x) = cos(x) hold to the last bit, and no sine is above 1.
#pragma once

#include <cmath>

namespace dartcast {

struct SineCosine {
  double sine, cosine;
};
/// The sine and cosine of x radians. Cost: some 10 ns below 1024.
SineCosine sine_cosine(double x);
/// The sine and cosine of 2 pi t. Exact at quarters: no rounding of pi is in them.
SineCosine sine_cosine_of_turns(double t);

/// exp(x), and exp(x) - 1 without loss of digits near 0.
double exponential(double x);
double exponential_less_one(double x);

/// ln(x).
double logarithm(double x);
/// x^y for x >= 0. The error is below 2 + 3 abs(y ln x) ulp. The logarithm is off by 1 ulp, the product by half of one.
/// The result's relative error from these is at most 1.5 2^-52 abs(y ln x), and the exponential adds 1 ulp.
double power(double x, double y);

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

}  // namespace dartcast
