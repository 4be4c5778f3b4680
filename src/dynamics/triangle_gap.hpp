// The nearest point of a triangle to the origin, in doubles or in double-double.
#pragma once

#include <array>
#include <cstdint>

#include "predicates/double_double.hpp"

namespace dartcast::detail {

template <class Real>
struct Vector {
  Real x{}, y{}, z{};

  friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vector operator*(const Vector& a, const Real& s) { return {a.x * s, a.y * s, a.z * s}; }
};
template <class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
Vector<Real> cross(const Vector<Real>& a, const Vector<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Corners, relative to the origin.
template <class Real>
using TriangleOf = std::array<Vector<Real>, 3>;

/// Points from the origin to the nearest point: `direction` has a length of 1, or is 0 if the distance is.
template <class Real>
struct NearestTo {
  Vector<Real> direction;
  Real distance{};
  std::array<Real, 3> weights{};
  std::uint8_t corners = 0;  ///< bit i: corner i has a weight
};

/// The point is inside if the foot of the origin is; else on the nearest side. Sides suffice if the triangle is
/// flat.
template <class Real>
NearestTo<Real> nearest_to_origin(const TriangleOf<Real>& d) {
  const Real zero(0.0);
  const Real one(1.0);
  const Vector<Real> e1 = d[1] - d[0];
  const Vector<Real> e2 = d[2] - d[0];
  const Vector<Real> n = cross(e1, e2);
  const Real nn = dot(n, n);
  if (nn > zero) {
    const Real w0 = dot(n, cross(d[1], d[2] - d[1]));
    const Real w1 = dot(n, cross(e2, d[0]));
    const Real w2 = dot(n, cross(d[0], e1));
    if (w0 > zero && w1 > zero && w2 > zero) {
      const Real length = square_root(nn);
      const Real height = dot(n, d[0]) / length;
      const bool below = height < zero;
      const Vector<Real> unit = n * ((below ? -one : one) / length);
      const Real sum = w0 + w1 + w2;
      return {unit, below ? -height : height, {w0 / sum, w1 / sum, w2 / sum}, 7};
    }
  }
  NearestTo<Real> nearest;
  Vector<Real> point = d[0];
  Real square = dot(point, point);
  nearest.weights[0] = one;  // if rounding finds no point on a side, in a triangle that is almost a point
  nearest.corners = 1;
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned j = (i + 1) % 3;
    const Vector<Real> e = d[j] - d[i];
    const Real ee = dot(e, e);
    const Real along = -dot(d[i], e);
    Vector<Real> at = d[i];
    Real w(0.0);
    auto corners = static_cast<std::uint8_t>(1U << i);
    if (along > zero && along < ee) {
      w = along / ee;
      at = at + e * w;
      corners = static_cast<std::uint8_t>(corners | 1U << j);
    } else if (along > zero) {
      continue;  // the next side starts at that corner
    }
    const Real here = dot(at, at);
    if (!(here < square)) continue;
    square = here;
    point = at;
    nearest.weights = {};
    nearest.weights[i] = one - w;
    nearest.weights[j] = nearest.weights[j] + w;
    nearest.corners = corners;
  }
  nearest.distance = square_root(square);
  if (nearest.distance > zero) nearest.direction = point * (one / nearest.distance);
  return nearest;
}

}  // namespace dartcast::detail
