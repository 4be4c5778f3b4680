// Double-double numbers: an unevaluated sum of two doubles, with twice the digits of one.
//
// After Y. Hida, X. S. Li, D. H. Bailey, "Algorithms for quad-double precision floating point arithmetic", ARITH 2001.
// Each operation is accurate to DoubleDouble::rounding of its result, if nothing overflows or falls below the smallest
// double.
#pragma once

#include <cmath>

#include "predicates/expansion.hpp"

namespace dartcast::detail {

struct DoubleDouble {
  double high = 0.0;
  double low = 0.0;

  static constexpr double rounding = 0x1p-100;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double h) : high(h) {}  // NOLINT(google-explicit-constructor): a double is one, as it is
  constexpr explicit DoubleDouble(TwoTerms t) : high(t.high), low(t.low) {}
  explicit operator double() const { return high + low; }

  friend DoubleDouble operator-(const DoubleDouble& a) {
    DoubleDouble r(-a.high);
    r.low = -a.low;
    return r;
  }
  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const TwoTerms s = two_sum(a.high, b.high);
    const TwoTerms t = two_sum(a.low, b.low);
    const TwoTerms u = fast_two_sum(s.high, s.low + t.high);
    return DoubleDouble(fast_two_sum(u.high, u.low + t.low));
  }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const TwoTerms p = two_product(a.high, b.high);
    return DoubleDouble(fast_two_sum(p.high, p.low + (a.high * b.low + a.low * b.high)));
  }
  /// The first quotient, corrected by that of the remainder.
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.high / b.high;
    const DoubleDouble rest = a - b * DoubleDouble(first);
    const double second = rest.high / b.high;
    const double third = (rest - b * DoubleDouble(second)).high / b.high;
    return DoubleDouble(fast_two_sum(first, second)) + DoubleDouble(third);
  }
  friend bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high < b.high || (a.high == b.high && a.low < b.low);
  }
  friend bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
  friend bool operator<=(const DoubleDouble& a, const DoubleDouble& b) {
    return a.high < b.high || (a.high == b.high && a.low <= b.low);
  }
};

/// Newton's correction of the root in doubles. Precondition: a is not negative.
inline DoubleDouble square_root(const DoubleDouble& a) {
  if (!(a.high > 0.0)) return {};
  const double root = std::sqrt(a.high);
  const DoubleDouble rest = a - DoubleDouble(two_product(root, root));
  const DoubleDouble better = DoubleDouble(root) + DoubleDouble(rest.high / (2.0 * root));
  return better + DoubleDouble((a - better * better).high / (2.0 * root));
}
inline double square_root(double a) { return std::sqrt(a); }

/// a - b, exactly if Real is DoubleDouble.
template <class Real>
Real exact_difference(double a, double b) {
  if constexpr (requires(Real r) { r.low; })
    return Real(two_sum(a, -b));
  else
    return a - b;
}

}  // namespace dartcast::detail
