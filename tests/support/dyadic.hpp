// Exact numbers m 2^e: what doubles, their sums and products are. By Boost.Multiprecision alone, which dyadic.cpp
// includes and no test.
#pragma once

#include <compare>
#include <memory>
#include <span>

#include "dartcast/vec3.hpp"
#include "support/exact_vectors.hpp"

namespace dartcast::test {

class Dyadic {
 public:
  Dyadic() = default;
  Dyadic(double x);  // NOLINT(google-explicit-constructor): exact, as a literal is
  static Dyadic power_of_two(int e);

  [[nodiscard]] int sign() const;
  [[nodiscard]] Dyadic abs() const { return sign() < 0 ? -*this : *this; }

  Dyadic& operator+=(const Dyadic& b) { return *this = *this + b; }
  Dyadic& operator-=(const Dyadic& b) { return *this = *this - b; }
  friend Dyadic operator-(const Dyadic& a);
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b);
  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) { return sum(a, b, false); }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return sum(a, b, true); }
  friend std::strong_ordering operator<=>(const Dyadic& a, const Dyadic& b) { return (a - b).sign() <=> 0; }
  friend bool operator==(const Dyadic& a, const Dyadic& b) { return (a - b).sign() == 0; }

 private:
  struct Mantissa;
  static Dyadic sum(const Dyadic& a, const Dyadic& b, bool minus);

  std::shared_ptr<const Mantissa> mantissa_;  // never changed; none: zero
  int exponent_ = 0;
};

inline Exact3<Dyadic> exact(const Vec3& v) { return {v.x, v.y, v.z}; }

/// det[b - a, c - a, d - a], six times the volume of a tetrahedron.
Dyadic determinant(const Exact3<Dyadic>& a, const Exact3<Dyadic>& b, const Exact3<Dyadic>& c, const Exact3<Dyadic>& d);
Dyadic determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The sign of determinant(): by doubles where 10 times the rounding error cannot change it, else exactly.
int exact_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// e w + (e^2, e^3, e^4) for e = 2^-bits, with w the sum of (opposite - p): a shift as predicates.hpp defines it, small
/// but not infinitesimal.
Exact3<Dyadic> small_shift(const Vec3& p, std::span<const Vec3> opposite, int bits);

}  // namespace dartcast::test
