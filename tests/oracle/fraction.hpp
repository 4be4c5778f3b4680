// Exact fractions and determinants of stored doubles. Included by the oracle alone: it needs CGAL and GMP.
#pragma once

#include <CGAL/Mpzf.h>

#include <array>
#include <utility>

#include "dartcast/vec3.hpp"

namespace dartcast::oracle {

using Exact = CGAL::Mpzf;

/// A fraction with a positive denominator.
class Fraction {
 public:
  explicit Fraction(int whole = 0) : above_(whole), below_(1) {}
  Fraction(Exact above, Exact below) : above_(std::move(above)), below_(std::move(below)) {
    if (CGAL::sign(below_) < 0) {
      above_ = -above_;
      below_ = -below_;
    }
  }

  [[nodiscard]] const Exact& above() const { return above_; }
  [[nodiscard]] const Exact& below() const { return below_; }
  [[nodiscard]] double rounded() const { return above_.to_double() / below_.to_double(); }

  friend int compare(const Fraction& a, const Fraction& b) {
    return static_cast<int>(CGAL::compare(a.above_ * b.below_, b.above_ * a.below_));
  }
  friend bool operator<(const Fraction& a, const Fraction& b) { return compare(a, b) < 0; }
  friend bool operator==(const Fraction& a, const Fraction& b) { return compare(a, b) == 0; }

 private:
  Exact above_;
  Exact below_;
};

/// det[b - a, c - a, d - a].
inline Exact determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto minus = [&](const Vec3& p) {
    return std::array<Exact, 3>{Exact(p.x) - Exact(a.x), Exact(p.y) - Exact(a.y), Exact(p.z) - Exact(a.z)};
  };
  const auto u = minus(b);
  const auto v = minus(c);
  const auto w = minus(d);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/// A function that changes linearly along a segment, by its values at the ends.
struct Linear {
  Exact at_p;
  Exact at_q;

  /// Sign at a time t.
  [[nodiscard]] int sign_at(const Fraction& t) const {
    return static_cast<int>(CGAL::sign(at_p * (t.below() - t.above()) + at_q * t.above()));
  }
};

/// The part of [0, 1] in which some linear functions are all >= 0.
class Clip {
 public:
  void keep_non_negative(const Linear& f) {
    const int p = static_cast<int>(CGAL::sign(f.at_p));
    const int q = static_cast<int>(CGAL::sign(f.at_q));
    if (p >= 0 && q >= 0) return;
    if (p < 0 && q < 0) {
      empty_ = true;
      return;
    }
    const Fraction zero(f.at_p, f.at_p - f.at_q);
    if (p < 0 && first_ < zero) first_ = zero;
    if (q < 0 && zero < last_) last_ = zero;
  }

  [[nodiscard]] bool empty() const { return empty_ || last_ < first_; }
  [[nodiscard]] const Fraction& first() const { return first_; }
  [[nodiscard]] const Fraction& last() const { return last_; }

 private:
  Fraction first_{0};
  Fraction last_{1};
  bool empty_ = false;
};

}  // namespace dartcast::oracle
