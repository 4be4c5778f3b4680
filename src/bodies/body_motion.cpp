// The rigid part of the motion of some particles: momentum, inertia, angular velocity.
#include "bodies/body_motion.hpp"

#include <Eigen/Dense>

namespace dartcast {

namespace {

// A principal moment of inertia below this share of the greatest one is 0: all mass is on an axis, up to rounding.
constexpr double no_inertia_share = 0x1p-40;

using PrincipalAxes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

PrincipalAxes principal_axes(const Mat3& inertia) {
  Eigen::Matrix3d m;
  m << inertia.x.x, inertia.y.x, inertia.z.x, inertia.x.y, inertia.y.y, inertia.z.y, inertia.x.z, inertia.y.z,
      inertia.z.z;
  return PrincipalAxes(m);
}

Mat3 inertia_of(std::span<const double> masses, std::span<const Vec3> positions, const Vec3& centre) {
  Mat3 inertia = zero_matrix();
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const Vec3 at = positions[i] - centre;
    const double m = masses[i] * dot(at, at);
    inertia = inertia + (Mat3{{m, 0.0, 0.0}, {0.0, m, 0.0}, {0.0, 0.0, m}} - outer(at * masses[i], at));
  }
  return inertia;
}

// The angular velocity of least energy with this angular momentum.
Vec3 spin_of(const Mat3& inertia, const Vec3& momentum) {
  const PrincipalAxes solver = principal_axes(inertia);
  const Eigen::Vector3d& values = solver.eigenvalues();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  const Eigen::Vector3d l(momentum.x, momentum.y, momentum.z);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = solver.eigenvectors().col(i);
    if (values[i] > no_inertia_share * values[2]) angular_velocity += e * (e.dot(l) / values[i]);
  }
  return {angular_velocity.x(), angular_velocity.y(), angular_velocity.z()};
}

Vec3 centre_of(std::span<const double> masses, std::span<const Vec3> positions) {
  Vec3 sum;
  double mass = 0.0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    mass += masses[i];
    sum += (positions[i] - positions[0]) * masses[i];
  }
  return masses.empty() ? Vec3{} : positions[0] + sum * (1.0 / mass);
}

}  // namespace

RigidMotion rigid_motion(std::span<const double> masses, std::span<const Vec3> positions,
                         std::span<const Vec3> velocities) {
  const Vec3 centre = centre_of(masses, positions);
  double mass = 0.0;
  Vec3 momentum;
  Vec3 angular;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const Vec3 p = velocities[i] * masses[i];
    mass += masses[i];
    momentum += p;
    angular += cross(positions[i] - centre, p);
  }
  return with_angular_momentum(masses, positions, masses.empty() ? Vec3{} : momentum * (1.0 / mass), angular);
}

RigidMotion with_angular_momentum(std::span<const double> masses, std::span<const Vec3> positions, const Vec3& velocity,
                                  const Vec3& angular_momentum) {
  RigidMotion r;
  r.centre = centre_of(masses, positions);
  r.velocity = velocity;
  r.angular_momentum = angular_momentum;
  for (const double m : masses) r.mass += m;
  r.angular_velocity = spin_of(inertia_of(masses, positions, r.centre), angular_momentum);
  return r;
}

Mat3 inverse_inertia(std::span<const double> masses, std::span<const Vec3> positions, const Vec3& centre) {
  const PrincipalAxes solver = principal_axes(inertia_of(masses, positions, centre));
  const Eigen::Vector3d& values = solver.eigenvalues();
  Mat3 inverse = zero_matrix();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d v = solver.eigenvectors().col(i);
    const Vec3 e = {v.x(), v.y(), v.z()};
    if (values[i] > no_inertia_share * values[2]) inverse = inverse + outer(e * (1.0 / values[i]), e);
  }
  return inverse;
}

}  // namespace dartcast
