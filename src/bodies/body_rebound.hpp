// Impacts between bodies, as between rigid ones.
//
// J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988: an impact is the one without
// rebound, its impulses enlarged by 1 + restitution.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bodies/body_collisions.hpp"
#include "dynamics/rigid_solver.hpp"
#include "dynamics/sphere_pairs.hpp"

namespace dartcast {

/// Keeps its memory from step to step.
class BodyRebounds {
 public:
  /// Finds the pairs that come together within a step, faster than `resting_speed`, and gives the bodies that they
  /// join the impulses of an impact. `pairs`: as found by BodyCollisions. `movers`: the bodies with their velocities;
  /// out: those after the impact. Returns the number of such pairs. Rounding alone changes momentum and angular
  /// momentum, and rounding alone lets the kinetic energy of joined bodies grow, however far the solver came. Reason:
  /// the energy is a quadratic function of the share of the impulses that is given. It is least at some share, and the
  /// share given is at most twice that. Preconditions: options are in range, restitution is set, pairs are sorted and
  /// their ids ascend.
  std::uint64_t solve(const BodyParticles& particles, std::span<const SpherePair> pairs,
                      const BodyCollisionOptions& options, double dt, double resting_speed,
                      std::span<RigidMover> movers);

 private:
  struct Island {
    std::uint32_t root = 0;  // root of the bodies that contacts join
    bool impact = false;
    double slope = 0.0;  // energy by the share s of the impulses: slope s + bend s^2 / 2
    double bend = 0.0;
  };

  void find_contacts(const BodyParticles& particles, std::span<const SpherePair> pairs, double friction, double dt,
                     std::span<const RigidMover> movers);
  [[nodiscard]] std::uint32_t root_of(std::uint32_t mover) const;
  [[nodiscard]] Island& island_of(const RigidContact& contact);
  std::uint64_t join(double resting_speed);
  void hold_back(const BodyCollisionOptions& options, double dt, std::span<RigidMover> movers);
  void measure(std::span<const RigidMover> after);

  RigidSolver solver_;
  std::vector<RigidContact> contacts_;
  std::vector<Island> islands_;  // by mover; those of roots count
  std::vector<RigidMover> before_;
};

}  // namespace dartcast
