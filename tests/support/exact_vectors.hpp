// Vectors of exact numbers: integers of the lattice, or rationals.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>

#include "dartcast/vec3.hpp"

namespace dartcast::test {

template <class T>
using Exact3 = std::array<T, 3>;
using Rational = boost::multiprecision::cpp_rational;

inline Exact3<Rational> exact(const Vec3& v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }

template <class T>
Exact3<T> minus(const Exact3<T>& a, const Exact3<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Exact3<T> cross(const Exact3<T>& a, const Exact3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
T dot(const Exact3<T>& a, const Exact3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Six times the volume of a tetrahedron.
inline Rational exact_volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Exact3<Rational> origin = exact(a);
  return dot(minus(exact(b), origin), cross(minus(exact(c), origin), minus(exact(d), origin)));
}

}  // namespace dartcast::test
