// The volume of a simplex with corners on straight lines as a polynomial over the integers, and its roots by Sturm's
// theorem: independent of the library. By Boost.Multiprecision alone.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "complex/simplex.hpp"

namespace dartcast::test {

using Integer = boost::multiprecision::cpp_int;
using Polynomial = std::vector<Integer>;  // by rising powers; no leading zeros

inline Polynomial trimmed(Polynomial p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
  return p;
}

inline Polynomial combined(const Polynomial& a, const Polynomial& b, int factor) {
  Polynomial sum(std::max(a.size(), b.size()));
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) sum[i] += factor * b[i];
  return trimmed(sum);
}
inline Polynomial operator+(const Polynomial& a, const Polynomial& b) { return combined(a, b, 1); }
inline Polynomial operator-(const Polynomial& a, const Polynomial& b) { return combined(a, b, -1); }
inline Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  if (a.empty() || b.empty()) return {};
  Polynomial product(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) product[i + j] += a[i] * b[j];
  }
  return trimmed(product);
}

inline Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  for (std::size_t i = 1; i < p.size(); ++i) d.push_back(p[i] * i);
  return d;
}

/// The remainder of a by b times some positive number.
inline Polynomial remainder(Polynomial a, const Polynomial& b) {
  const Integer lead = b.back();
  while (a.size() >= b.size()) {
    const Integer top = a.back() * lead;
    const std::size_t shift = a.size() - b.size();
    for (Integer& c : a) c *= lead * lead;
    for (std::size_t i = 0; i < b.size(); ++i) a[i + shift] -= top * b[i];
    a = trimmed(a);
  }
  return a;
}

/// A time: above / 2^bits.
struct DyadicTime {
  Integer above;
  unsigned bits = 0;

  static DyadicTime of(double t) {  // t in [0, 1], a multiple of 2^-60
    return {Integer(static_cast<std::int64_t>(std::ldexp(t, 60))), 60};
  }
};

inline int sign_at(const Polynomial& p, const DyadicTime& t) {
  Integer value = 0;
  for (std::size_t i = p.size(); i-- > 0;)
    value = value * t.above + (p[i] << static_cast<unsigned>(t.bits * (p.size() - 1 - i)));
  return value.sign();
}

/// Each axis is measured in a power of two of its own: it changes no sign.
class MovingSimplex {
 public:
  using Point = std::array<Polynomial, 3>;  // linear in time

  MovingSimplex(const Corners& before, const Corners& after) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto at = [axis](const Vec3& p) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
      std::array<double, 8> x;
      for (std::size_t i = 0; i < 4; ++i) {
        x[2 * i] = at(before[i]);
        x[2 * i + 1] = at(after[i]);
      }
      const int lowest = lowest_exponent(x);
      for (std::size_t i = 0; i < 4; ++i) corners_[i][axis] = line(x[2 * i], x[2 * i + 1], lowest);
    }
    volume_ = dot(edge(1), cross(edge(2), edge(3)));
    chain_ = {volume_, derivative(volume_)};
    while (!chain_.back().empty()) chain_.push_back(Polynomial() - remainder(chain_[chain_.size() - 2], chain_.back()));
  }

  [[nodiscard]] int sign_of_volume(const DyadicTime& t) const { return sign_at(volume_, t); }

  /// Whether the volume, positive at 0, has a root in (0, t].
  [[nodiscard]] bool has_root_by(const DyadicTime& t) const {
    if (sign_of_volume(t) <= 0) return true;
    return changes(DyadicTime{}) != changes(t);
  }

  /// The last multiple of 2^-bits before the first root. Precondition: there is one in (0, 1].
  [[nodiscard]] DyadicTime last_before_root(unsigned bits) const {
    Integer low = 0;
    Integer high = Integer(1) << bits;
    while (high - low > 1) {
      const Integer middle = (low + high) / 2;
      (has_root_by({middle, bits}) ? high : low) = middle;
    }
    return {low, bits};
  }

  /// Signs of the facets' area vectors at a time, along the longest of them: -1, 0 or 1 for each corner.
  [[nodiscard]] std::array<int, 4> facet_signs(const DyadicTime& t) const {
    std::array<std::array<Integer, 3>, 4> w;
    const auto add = [&](std::size_t i, const Point& area) {
      for (std::size_t k = 0; k < 3; ++k) {
        w[i][k] = value(area[k], t);
        w[0][k] -= w[i][k];
      }
    };
    add(1, cross(edge(2), edge(3)));
    add(2, cross(edge(3), edge(1)));
    add(3, cross(edge(1), edge(2)));
    const auto product = [](const auto& a, const auto& b) { return Integer(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]); };
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 4; ++i) {
      if (product(w[i], w[i]) > product(w[longest], w[longest])) longest = i;
    }
    std::array<int, 4> signs;
    for (std::size_t i = 0; i < 4; ++i) signs[i] = product(w[i], w[longest]).sign();
    return signs;
  }

 private:
  static int lowest_exponent(const std::array<double, 8>& numbers) {
    int lowest = 2000;
    for (const double x : numbers) lowest = x == 0.0 ? lowest : std::min(lowest, std::ilogb(x) - 52);
    return lowest;
  }

  static Integer scaled(double x, int lowest) {
    if (x == 0.0) return 0;
    const int exponent = std::ilogb(x) - 52;
    return Integer(static_cast<std::int64_t>(std::ldexp(x, -exponent))) << static_cast<unsigned>(exponent - lowest);
  }

  static Polynomial line(double from, double to, int lowest) {
    const Integer a = scaled(from, lowest);
    return trimmed({a, scaled(to, lowest) - a});
  }

  [[nodiscard]] Point edge(std::size_t i) const {
    return {corners_[i][0] - corners_[0][0], corners_[i][1] - corners_[0][1], corners_[i][2] - corners_[0][2]};
  }
  static Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static Polynomial dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  // A polynomial of degree at most 2 at a time, times 4^bits.
  static Integer value(const Polynomial& p, const DyadicTime& t) {
    Integer sum = 0;
    Integer power = 1;
    for (std::size_t i = 0; i < p.size(); ++i, power *= t.above)
      sum += (p[i] * power) << static_cast<unsigned>(t.bits * (2 - i));
    return sum;
  }

  [[nodiscard]] int changes(const DyadicTime& t) const {
    int count = 0;
    int last = 0;
    for (const Polynomial& p : chain_) {
      const int sign = p.empty() ? 0 : sign_at(p, t);
      if (sign == 0) continue;
      count += last != 0 && sign != last ? 1 : 0;
      last = sign;
    }
    return count;
  }

  std::array<Point, 4> corners_;
  Polynomial volume_;
  std::vector<Polynomial> chain_;
};

}  // namespace dartcast::test
