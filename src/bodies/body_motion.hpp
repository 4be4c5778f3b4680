// How particles of a body move: the rigid part of their motion, and Runge-Kutta's method of order 4.
#pragma once

#include <span>

#include "base/mat3.hpp"

namespace dartcast {

/// The rigid motion with the same momentum and angular momentum as some particles. SI units.
struct RigidMotion {
  double mass = 0.0;
  Vec3 centre;            ///< of mass
  Vec3 velocity;          ///< of the centre
  Vec3 angular_momentum;  ///< about the centre
  Vec3 angular_velocity;  ///< angular velocity; no part about an axis that all mass lies on

  [[nodiscard]] Vec3 velocity_at(const Vec3& x) const { return velocity + cross(angular_velocity, x - centre); }
  /// Never more than that of the particles; what they have beyond it is that of their velocities relative to it.
  [[nodiscard]] double kinetic_energy() const {
    return 0.5 * (mass * dot(velocity, velocity) + dot(angular_velocity, angular_momentum));
  }
};

/// Preconditions: sizes match, masses are positive. Cost: about 10 ns per particle.
RigidMotion rigid_motion(std::span<const double> masses, std::span<const Vec3> positions,
                         std::span<const Vec3> velocities);
/// With this angular momentum instead of that of the velocities.
RigidMotion with_angular_momentum(std::span<const double> masses, std::span<const Vec3> positions, const Vec3& velocity,
                                  const Vec3& angular_momentum);

/// Of the moment of inertia about the centre, without parts about an axis that all mass lies on: for an angular
/// momentum it gives the spin. Symmetric, no eigenvalue below 0.
Mat3 inverse_inertia(std::span<const double> masses, std::span<const Vec3> positions, const Vec3& centre);

/// What a body is given from outside over a step, spread over its particles as over those of a rigid body.
struct BodyAction {
  Vec3 centre;            ///< of mass
  Vec3 velocity;          ///< change of its velocity, m / s
  Vec3 angular_velocity;  ///< of the angular one, 1 / s
  Vec3 position_delta;    ///< displacement on top, without a velocity, m
  Vec3 turn;              ///< turn likewise, rad

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
