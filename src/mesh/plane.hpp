// Exact signs in a coordinate plane.
#pragma once

#include <cmath>

#include "dartcast/predicates.hpp"

namespace dartcast {

/// A point with one coordinate dropped.
struct Vec2 {
  double x = 0.0;
  double y = 0.0;
};

/// Drops the coordinate `axis` (0, 1, 2) so that a turn keeps its sense seen from the positive side of that axis.
constexpr Vec2 drop(const Vec3& p, int axis) {
  if (axis == 0) return {p.y, p.z};
  if (axis == 1) return {p.z, p.x};
  return {p.x, p.y};
}

/// Positive if a, b, c turn counterclockwise. The two products decide if their rounding (each difference, product
/// and the sum: less than 2^-50 of them together) cannot matter and none came near the smallest double.
inline Sign orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double ux = b.x - a.x;
  const double uy = b.y - a.y;
  const double vx = c.x - a.x;
  const double vy = c.y - a.y;
  const double left = ux * vy;
  const double right = uy * vx;
  const bool left_zero = ux == 0.0 || vy == 0.0;
  const bool right_zero = uy == 0.0 || vx == 0.0;
  if (left_zero && right_zero) return Sign::zero;
  const double size = std::abs(left) + std::abs(right);
  if (std::abs(left - right) > 0x1p-50 * size && size > 0x1p-900) return left > right ? Sign::positive : Sign::negative;
  return orient3d({a.x, a.y, 0.0}, {b.x, b.y, 0.0}, {c.x, c.y, 0.0}, {a.x, a.y, 1.0});
}

}  // namespace dartcast
