// The motion of a body's particles: its rigid part, and Runge-Kutta's method of order 4.
#pragma once

#include <span>

#include "dartcast/bodies.hpp"
#include "dynamics/mat3.hpp"

namespace dartcast {

/// Preconditions: sizes match, masses are positive. Cost: about 10 ns per particle.
RigidMotion rigid_motion(std::span<const double> masses, std::span<const Vec3> positions,
                         std::span<const Vec3> velocities);
/// The rigid motion with this velocity and angular momentum.
RigidMotion with_angular_momentum(std::span<const double> masses, std::span<const Vec3> positions, const Vec3& velocity,
                                  const Vec3& angular_momentum);

/// The inverse moment of inertia about the centre, without parts about an axis that all mass lies on. It gives the
/// angular velocity of an angular momentum. Symmetric, no eigenvalue below 0.
Mat3 inverse_inertia(std::span<const double> masses, std::span<const Vec3> positions, const Vec3& centre);

/// The changes that a body gets from outside over a step. Its particles take them as those of a rigid body.
struct BodyAction {
  Vec3 centre;            ///< of mass
  Vec3 velocity;          ///< change of its velocity, m / s
  Vec3 angular_velocity;  ///< change of its angular velocity, 1 / s
  Vec3 position_delta;    ///< further displacement, without a velocity, m
  Vec3 turn;              ///< further rotation likewise, rad

  [[nodiscard]] Vec3 velocity_at(const Vec3& x) const { return velocity + cross(angular_velocity, x - centre); }
  [[nodiscard]] Vec3 position_delta_at(const Vec3& x) const { return position_delta + cross(turn, x - centre); }
};

struct PointMotion {
  Vec3 position;
  Vec3 velocity;
};

/// A step of duration `dt` for x'' = acceleration(x, s), s in [0, 1] the share of the step.
template <class Acceleration>
PointMotion runge_kutta_4(const PointMotion& m, double dt, const Acceleration& acceleration) {
  const double half = 0.5 * dt;
  const Vec3 a1 = acceleration(m.position, 0.0);
  const Vec3 middle = m.position + m.velocity * half;
  const Vec3 a2 = acceleration(middle, 0.5);
  const Vec3 a3 = acceleration(middle + a1 * (half * half), 0.5);
  const Vec3 a4 = acceleration((m.position + m.velocity * dt) + a2 * (half * dt), 1.0);
  return {(m.position + m.velocity * dt) + ((a1 + a2) + a3) * (dt * dt / 6.0),
          m.velocity + ((a1 + a4) + (a2 + a3) * 2.0) * (dt / 6.0)};
}

}  // namespace dartcast
