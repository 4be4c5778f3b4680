// One step's collisions of spheres with each other, with walls and with bodies in the same environment.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/bodies.hpp"
#include "dynamics/collider.hpp"
#include "dynamics/rigid_solver.hpp"

namespace dartcast {

/// As Collider, if bodies take part, too: their particles touch as spheres, and each body answers as a rigid one.
/// Keeps lists, impulses and memory from step to step.
class SphereBodyCollider {
 public:
  /// Finds the pairs of spheres, and of spheres and particles of bodies, and solves them together with `walls`, as
  /// Collider::collide(). The bodies get theirs by Bodies::apply_impulse(), for the step that they take after this one
  /// of the spheres; contacts between them are their own. Momentum changes at walls and because of rounding alone.
  /// Preconditions: all states are of the complex as it stands; the ids of spheres are below 2^63. The same for any
  /// number of threads.
  CollisionCounts collide(const CellComplex& complex, const CollidingSpheres& spheres,
                          std::span<const WallContact> walls, Bodies& bodies, const SolverOptions& options,
                          Threads threads);

  /// As Collider::new_walls().
  [[nodiscard]] std::span<const WallContact> new_walls() const { return new_walls_; }

  [[nodiscard]] RigidSolver& solver() { return solver_; }
  [[nodiscard]] const RigidSolver& solver() const { return solver_; }

 private:
  struct Part {
    std::vector<RigidContact> contacts;
    std::uint64_t overlaps = 0;
    double deepest = 0.0;
  };

  void gather(const CollidingSpheres& spheres, const Bodies& bodies, double dt);
  void add_particles(const Bodies& bodies, double dt);
  void find_contacts(const CellComplex& complex, const CollidingSpheres& spheres,
                     std::span<const SpherePair> candidates, const SolverOptions& options, Part& part) const;
  void find_contacts(const CellComplex& complex, const CollidingSpheres& spheres, const SolverOptions& options,
                     Threads threads, CollisionCounts& counts);
  void add_walls(const CollidingSpheres& spheres, std::span<const WallContact> walls, const SolverOptions& options);

  CellLists lists_;
  PairFinder finder_;
  RigidSolver solver_;
  // Spheres, then particles of bodies.
  std::vector<ParticleState> states_;
  std::vector<std::uint64_t> ids_;
  std::vector<std::uint32_t> mover_of_;
  std::vector<SphereMotion> moving_;
  std::vector<SphereMotion> swept_;  // radii with the room in which they count as near
  std::vector<RigidMover> movers_;   // spheres, then bodies
  std::vector<Part> parts_;          // by chunk of candidates
  std::vector<RigidContact> contacts_;
  std::vector<WallContact> walls_;
  std::vector<WallContact> new_walls_;
  std::vector<std::uint8_t> shared_;  // by mover
};

}  // namespace dartcast
