// Frames along a curve, without twist.
#pragma once

#include <cmath>

#include "dartcast/vec3.hpp"

namespace dartcast {

/// v at unit length; `otherwise` if it has none.
inline Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double length = norm(v);
  return length > 0.0 && std::isfinite(length) ? v * (1.0 / length) : otherwise;
}

/// A unit vector perpendicular to a unit vector; the same one for the same bits.
inline Vec3 any_normal(const Vec3& t) {
  const double x = std::abs(t.x);
  const double y = std::abs(t.y);
  const double z = std::abs(t.z);
  const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return unit_or(cross(t, axis), {1, 0, 0});
}

/// A normal of the unit tangent a, turned with the smallest rotation that takes a to b (R. L. Bishop, "There is more
/// than one way to frame a curve", 1975). Made of two reflections (W. Wang, B. Juettler, D. Zheng, Y. Liu, "Computation
/// of rotation minimizing frames", 2008). A unit normal of b; if b is -a, it is unchanged.
inline Vec3 transported(const Vec3& normal, const Vec3& a, const Vec3& b) {
  const Vec3 sum = a + b;
  const double length = dot(sum, sum);
  // Reflected on the plane across a, then on the one across a + b: a goes to -a, and to b.
  const Vec3 moved = length > 0.0 ? normal - sum * (2.0 * dot(sum, normal) / length) : normal;
  return unit_or(moved - b * dot(moved, b), any_normal(b));
}

}  // namespace dartcast
