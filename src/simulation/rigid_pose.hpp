// Rigid poses: a turn about the pivot, then a displacement.
#pragma once

#include "base/elementary.hpp"
#include "dartcast/vec3.hpp"
#include "dynamics/mat3.hpp"

namespace dartcast {

struct RigidPose {
  Vec3 displacement;
  Quaternion rotation;
};

/// The rotation by `turn`: axis times angle, rad.
inline Quaternion rotation_of(const Vec3& turn) {
  const double angle = norm(turn);
  if (!(angle > 0.0)) return {};
  const SineCosine half = sine_cosine(0.5 * angle);
  return {half.cosine, turn * (half.sine / angle)};
}

inline Vec3 rotated(const Quaternion& q, const Vec3& x) {
  const Vec3 twice = cross(q.v, x) * 2.0;
  return x + twice * q.w + cross(q.v, twice);
}

/// A pose on the way from a to b. Precondition: their rotations are less than a half turn apart.
inline RigidPose between(const RigidPose& a, const RigidPose& b, double share) {
  const double side = a.rotation.w * b.rotation.w + dot(a.rotation.v, b.rotation.v) < 0.0 ? -1.0 : 1.0;
  const Quaternion mixed = {a.rotation.w * (1.0 - share) + b.rotation.w * (side * share),
                            a.rotation.v * (1.0 - share) + b.rotation.v * (side * share)};
  return {a.displacement + (b.displacement - a.displacement) * share, normalized(mixed)};
}

}  // namespace dartcast
