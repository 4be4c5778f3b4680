// Exact signs in a coordinate plane.
#pragma once

#include <array>

#include "dartcast/exact/predicates.hpp"

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

/// Positive where a, b, c turn counterclockwise.
inline Sign orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  return orient3d({a.x, a.y, 0.0}, {b.x, b.y, 0.0}, {c.x, c.y, 0.0}, {a.x, a.y, 1.0});
}

}  // namespace dartcast
