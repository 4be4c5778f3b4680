// When a moving sphere first touches a moving triangle, to 40 digits and more: the roots of the polynomials in time of
// the triangle's inside, sides and corners, found between the roots of their derivatives. For tests only.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <optional>
#include <vector>

#include "dartcast/vec3.hpp"

namespace dartcast::oracle {

using Digits =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<200, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;

/// Coefficients, the constant one first.
using Polynomial = std::vector<Digits>;

inline Polynomial operator+(const Polynomial& a, const Polynomial& b) {
  Polynomial c(std::max(a.size(), b.size()), Digits(0));
  for (std::size_t i = 0; i < a.size(); ++i) c[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) c[i] += b[i];
  return c;
}
inline Polynomial operator-(const Polynomial& a, const Polynomial& b) {
  Polynomial c(std::max(a.size(), b.size()), Digits(0));
  for (std::size_t i = 0; i < a.size(); ++i) c[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) c[i] -= b[i];
  return c;
}
inline Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  Polynomial c(a.size() + b.size() - 1, Digits(0));
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  return c;
}
inline Digits value(const Polynomial& p, const Digits& t) {
  Digits sum = 0;
  for (std::size_t i = p.size(); i-- > 0;) sum = sum * t + p[i];
  return sum;
}
inline Digits size_of(const Polynomial& p) {
  Digits sum = 0;
  for (const Digits& c : p) sum += abs(c);
  return sum;
}

/// Roots in [0, 1], rising; one that is only touched counts where the value is within 2^-170 of the coefficients' sum.
inline std::vector<Digits> roots(Polynomial p) {
  const Digits none = size_of(p) * ldexp(Digits(1), -170);
  while (!p.empty() && abs(p.back()) <= none) p.pop_back();
  if (p.size() < 2) return {};
  if (p.size() == 2) {
    const Digits t = -p[0] / p[1];
    return t >= 0 && t <= 1 ? std::vector<Digits>{t} : std::vector<Digits>{};
  }
  Polynomial slope(p.size() - 1);
  for (std::size_t i = 1; i < p.size(); ++i) slope[i - 1] = p[i] * static_cast<unsigned>(i);
  std::vector<Digits> ends = {Digits(0)};
  for (const Digits& t : roots(slope)) ends.push_back(t);
  ends.emplace_back(1);
  std::vector<Digits> found;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (abs(value(p, ends[i])) <= none) found.push_back(ends[i]);
    if (i + 1 == ends.size()) break;
    Digits a = ends[i];
    Digits b = ends[i + 1];
    const bool rising = value(p, a) < 0;
    if (abs(value(p, a)) <= none || abs(value(p, b)) <= none || rising == (value(p, b) < 0)) continue;
    Digits t = (a + b) / 2;
    for (int k = 0; k < 250 && b - a > ldexp(Digits(1), -180); ++k) {
      const Digits v = value(p, t);
      ((v < 0) == rising ? a : b) = t;
      const Digits s = value(slope, t);
      const Digits newton = s != 0 ? Digits(t - v / s) : a;
      if (newton > a && newton < b && abs(newton - t) < ldexp(Digits(1), -170)) {
        t = newton;
        break;
      }
      t = newton > a && newton < b && k % 4 != 3 ? newton : Digits((a + b) / 2);
    }
    found.push_back(t);
  }
  return found;
}

using PolynomialVec3 = std::array<Polynomial, 3>;
inline PolynomialVec3 operator-(const PolynomialVec3& a, const PolynomialVec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Polynomial dot(const PolynomialVec3& a, const PolynomialVec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline PolynomialVec3 cross(const PolynomialVec3& a, const PolynomialVec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Corners and centre on straight lines.
class TouchOracle {
 public:
  TouchOracle(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to, const Vec3& centre_from,
              const Vec3& centre_to) {
    const auto line = [](double a, double b, double c, double d) {
      const Digits start = Digits(a) - Digits(c);
      return Polynomial{start, (Digits(b) - Digits(d)) - start};
    };
    for (unsigned i = 0; i < 3; ++i) {
      d_[i] = {line(from[i].x, to[i].x, centre_from.x, centre_to.x),
               line(from[i].y, to[i].y, centre_from.y, centre_to.y),
               line(from[i].z, to[i].z, centre_from.z, centre_to.z)};
    }
  }

  struct Touch {
    Digits time;
    int dimension;  ///< of the corner 0, side 1 or inside 2 touched
  };
  /// The first time in [0, 1] at which the distance is `radius`, coming from more. Precondition: it is more at 0.
  [[nodiscard]] std::optional<Touch> first(double radius) const {
    std::optional<Touch> first;
    const auto take = [&](const Digits& t, int dimension) {
      if (!first || t < first->time) first = Touch{t, dimension};
    };
    const Polynomial square = {Digits(radius) * Digits(radius)};
    for (unsigned i = 0; i < 3; ++i) {
      for (const Digits& t : roots(dot(d_[i], d_[i]) - square)) take(t, 0);
      const PolynomialVec3 e = d_[(i + 1) % 3] - d_[i];
      const Polynomial ee = dot(e, e);
      const Polynomial along = Polynomial{Digits(0)} - dot(d_[i], e);
      const PolynomialVec3 moment = cross(d_[i], e);
      for (const Digits& t : roots(dot(moment, moment) - square * ee))
        if (value(ee, t) > 0 && value(along, t) >= 0 && value(along, t) <= value(ee, t)) take(t, 1);
    }
    const PolynomialVec3 n = cross(d_[1] - d_[0], d_[2] - d_[0]);
    const Polynomial height = dot(d_[0], n);
    for (const Digits& t : roots(height * height - square * dot(n, n))) {
      const auto positive = [&](unsigned i, unsigned j) { return value(dot(n, cross(d_[i], d_[j])), t) >= 0; };
      if (value(dot(n, n), t) > 0 && positive(0, 1) && positive(1, 2) && positive(2, 0)) take(t, 2);
    }
    return first;
  }

  /// The distance at a time.
  [[nodiscard]] Digits distance(const Digits& t) const {
    std::array<std::array<Digits, 3>, 3> d;
    for (unsigned i = 0; i < 3; ++i)
      for (unsigned k = 0; k < 3; ++k) d[i][k] = value(d_[i][k], t);
    const auto inner = [](const auto& a, const auto& b) { return Digits(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]); };
    const auto minus = [](const auto& a, const auto& b) {
      return std::array<Digits, 3>{Digits(a[0] - b[0]), Digits(a[1] - b[1]), Digits(a[2] - b[2])};
    };
    const auto outer = [](const auto& a, const auto& b) {
      return std::array<Digits, 3>{Digits(a[1] * b[2] - a[2] * b[1]), Digits(a[2] * b[0] - a[0] * b[2]),
                                   Digits(a[0] * b[1] - a[1] * b[0])};
    };
    Digits least = inner(d[0], d[0]);
    for (unsigned i = 0; i < 3; ++i) {
      const auto e = minus(d[(i + 1) % 3], d[i]);
      const Digits ee = inner(e, e);
      if (ee == 0) continue;
      const Digits w = std::clamp(Digits(-inner(d[i], e) / ee), Digits(0), Digits(1));
      const std::array<Digits, 3> x = {Digits(d[i][0] + e[0] * w), Digits(d[i][1] + e[1] * w),
                                       Digits(d[i][2] + e[2] * w)};
      least = std::min(least, inner(x, x));
    }
    const auto n = outer(minus(d[1], d[0]), minus(d[2], d[0]));
    const auto inside = [&](unsigned i, unsigned j) { return inner(n, outer(d[i], d[j])) >= 0; };
    const Digits nn = inner(n, n);
    if (nn > 0 && inside(0, 1) && inside(1, 2) && inside(2, 0)) {
      const Digits height = inner(n, d[0]);
      least = std::min(least, Digits(height * height / nn));
    }
    return sqrt(least);
  }

 private:
  std::array<PolynomialVec3, 3> d_;
};

}  // namespace dartcast::oracle
