// Exact numbers m 2^e, for tests: what doubles and their sums and products are. By Boost.Multiprecision alone.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <span>

#include "dartcast/vec3.hpp"

namespace dartcast::test {

class Dyadic {
 public:
  Dyadic() = default;
  explicit Dyadic(double x) {
    const double fraction = std::frexp(x, &exponent_);
    mantissa_ = static_cast<std::int64_t>(std::ldexp(fraction, 53));
    exponent_ -= 53;
  }

  static Dyadic power_of_two(int e) {
    Dyadic d(1.0);
    d.exponent_ += e;
    return d;
  }

  [[nodiscard]] int sign() const { return mantissa_.sign(); }
  [[nodiscard]] Dyadic abs() const { return sign() < 0 ? Dyadic() - *this : *this; }

  friend Dyadic operator*(Dyadic a, const Dyadic& b) {
    a.mantissa_ *= b.mantissa_;
    a.exponent_ += b.exponent_;
    return a;
  }
  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) {
    if (a.sign() == 0) return b;
    if (b.sign() == 0) return a;
    const bool a_is_finer = a.exponent_ <= b.exponent_;
    const Dyadic& fine = a_is_finer ? a : b;
    const Dyadic& coarse = a_is_finer ? b : a;
    Dyadic sum = fine;
    sum.mantissa_ += coarse.mantissa_ << static_cast<unsigned>(coarse.exponent_ - fine.exponent_);
    return sum;
  }
  friend Dyadic operator-(const Dyadic& a, Dyadic b) {
    b.mantissa_ = -b.mantissa_;
    return a + b;
  }
  friend bool operator<(const Dyadic& a, const Dyadic& b) { return (a - b).sign() < 0; }
  friend bool operator==(const Dyadic& a, const Dyadic& b) { return (a - b).sign() == 0; }

 private:
  boost::multiprecision::cpp_int mantissa_ = 0;
  int exponent_ = 0;
};

struct DyadicVec3 {
  Dyadic x, y, z;

  DyadicVec3() = default;
  DyadicVec3(Dyadic x_, Dyadic y_, Dyadic z_) : x(std::move(x_)), y(std::move(y_)), z(std::move(z_)) {}
  explicit DyadicVec3(const Vec3& a) : x(a.x), y(a.y), z(a.z) {}

  friend DyadicVec3 operator+(const DyadicVec3& a, const DyadicVec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend DyadicVec3 operator-(const DyadicVec3& a, const DyadicVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend DyadicVec3 operator*(const Dyadic& s, const DyadicVec3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

/// det[b - a, c - a, d - a], by cofactors along the first row.
inline Dyadic determinant(const DyadicVec3& a, const DyadicVec3& b, const DyadicVec3& c, const DyadicVec3& d) {
  const DyadicVec3 u = b - a;
  const DyadicVec3 v = c - a;
  const DyadicVec3 w = d - a;
  return u.x * (v.y * w.z - v.z * w.y) - u.y * (v.x * w.z - v.z * w.x) + u.z * (v.x * w.y - v.y * w.x);
}

inline Dyadic determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return determinant(DyadicVec3(a), DyadicVec3(b), DyadicVec3(c), DyadicVec3(d));
}

/// p + e w + (e^2, e^3, e^4) for e = 2^-bits, with w the sum of (opposite - p): a shift as predicates.hpp defines it,
/// small but not infinitesimal.
inline DyadicVec3 small_shift(const Vec3& p, std::span<const Vec3> opposite, int bits) {
  DyadicVec3 w;
  for (const Vec3& o : opposite) w = w + (DyadicVec3(o) - DyadicVec3(p));
  const DyadicVec3 rest(Dyadic::power_of_two(-2 * bits), Dyadic::power_of_two(-3 * bits),
                        Dyadic::power_of_two(-4 * bits));
  return Dyadic::power_of_two(-bits) * w + rest;
}

}  // namespace dartcast::test
