#include "dartcast/bodies/body_motion.hpp"

#include <Eigen/Dense>

namespace dartcast {

namespace {

// A principal moment of inertia below this share of the greatest one is 0: all mass is on an axis, up to rounding.
constexpr double no_inertia_share = 0x1p-40;

// The spin of least energy with this angular momentum.
Vec3 spin_of(const Mat3& inertia, const Vec3& momentum) {
  Eigen::Matrix3d m;
  m << inertia.x.x, inertia.y.x, inertia.z.x, inertia.x.y, inertia.y.y, inertia.z.y, inertia.x.z, inertia.y.z,
      inertia.z.z;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  const Eigen::Vector3d& values = solver.eigenvalues();
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  const Eigen::Vector3d l(momentum.x, momentum.y, momentum.z);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = solver.eigenvectors().col(i);
    if (values[i] > no_inertia_share * values[2]) spin += e * (e.dot(l) / values[i]);
  }
  return {spin.x(), spin.y(), spin.z()};
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
  Mat3 inertia = zero_matrix();
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const Vec3 at = positions[i] - r.centre;
    const double m = masses[i] * dot(at, at);
    r.mass += masses[i];
    inertia = inertia + (Mat3{{m, 0.0, 0.0}, {0.0, m, 0.0}, {0.0, 0.0, m}} - outer(at * masses[i], at));
  }
  r.spin = spin_of(inertia, angular_momentum);
  return r;
}

}  // namespace dartcast
