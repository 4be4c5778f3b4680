// The arithmetic of audits: points as integers of any length.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "dartcast/vec3.hpp"

namespace dartcast::detail {

using AuditInteger = boost::multiprecision::cpp_int;
using AuditPoint = std::array<AuditInteger, 3>;

/// A double is digits * 2^exponent.
struct Digits {
  std::int64_t digits = 0;
  int exponent = 0;

  explicit Digits(double x) {
    const double fraction = std::frexp(x, &exponent);
    digits = static_cast<std::int64_t>(std::ldexp(fraction, 53));
    exponent -= 53;
  }
};

// The rule for coordinates (dartcast/predicates.hpp), in words of its own: no point is above 2^300. No particle is
// between 0 and 2^-300, and a corner that is there counts as 0.
inline bool is_in_range(const Vec3& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 0x1.0000000000001p+300 && p == p;
}
inline Vec3 counted(const Vec3& p) {
  const auto number = [](double x) { return std::abs(x) < 0x1p-300 ? 0.0 : x; };
  return {number(p.x), number(p.y), number(p.z)};
}

/// Points as integers: coordinates over one power of two. Precondition: they are finite.
template <std::size_t N>
std::array<AuditPoint, N> to_integers(const std::array<Vec3, N>& points) {
  int lowest = std::numeric_limits<int>::max();
  const auto coordinates = [](const Vec3& p) { return std::array<double, 3>{p.x, p.y, p.z}; };
  for (const Vec3& p : points) {
    for (const double x : coordinates(p)) {
      if (x != 0.0) lowest = std::min(lowest, Digits(x).exponent);
    }
  }
  std::array<AuditPoint, N> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = coordinates(points[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      if (x[k] == 0.0) continue;
      const Digits d(x[k]);
      result[i][k] = AuditInteger(d.digits) << static_cast<unsigned>(d.exponent - lowest);
    }
  }
  return result;
}

inline AuditPoint difference(const AuditPoint& a, const AuditPoint& b) {
  return {AuditInteger(a[0] - b[0]), AuditInteger(a[1] - b[1]), AuditInteger(a[2] - b[2])};
}
inline AuditInteger dot(const AuditPoint& u, const AuditPoint& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }
inline AuditPoint cross(const AuditPoint& u, const AuditPoint& v) {
  return {AuditInteger(u[1] * v[2] - u[2] * v[1]), AuditInteger(u[2] * v[0] - u[0] * v[2]),
          AuditInteger(u[0] * v[1] - u[1] * v[0])};
}
/// Six times the volume of a tetrahedron.
inline AuditInteger volume6(const AuditPoint& a, const AuditPoint& b, const AuditPoint& c, const AuditPoint& d) {
  return dot(difference(b, a), cross(difference(c, a), difference(d, a)));
}

}  // namespace dartcast::detail
