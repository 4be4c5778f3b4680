// Rigid poses, which are a turn about the pivot and then a displacement, and the ways between them.
#pragma once

#include <cmath>

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

/// First the rotation, then the turn.
inline Quaternion turned(const Quaternion& rotation, const Vec3& turn) {
  return normalized(rotation_of(turn) * rotation);
}

/// The turn from a to b the shorter way, of at most a half turn; exactly 0 if they are equal.
inline Vec3 turn_between(const Quaternion& a, const Quaternion& b) {
  const Quaternion q = b * Quaternion{a.w, -a.v};
  const double sine = norm(q.v);
  if (!(sine > 0.0)) return {};
  return q.v * ((q.w < 0.0 ? -2.0 : 2.0) * polar_angle(sine, std::abs(q.w)) / sine);
}

/// A way at constant velocities, of the pivot and around it.
struct RigidWay {
  RigidPose from;
  RigidPose to;
  Vec3 turn;  ///< from the one to the other: axis times angle, which may be several turns

  [[nodiscard]] RigidPose at(double share) const {
    if (share == 0.0) return from;
    if (share == 1.0) return to;
    return {from.displacement + (to.displacement - from.displacement) * share, turned(from.rotation, turn * share)};
  }
};

/// How far a way of this angle is off its chord at any time, at most, for all points within `arm` of the axis.
///
/// If it takes the time 1, the acceleration of such a point is at most angle^2 arm. A chord interpolates the way linearly.
inline double bend_of(double angle, double arm) { return angle * angle * arm / 8.0; }

}  // namespace dartcast
