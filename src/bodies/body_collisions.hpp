// Contacts between bodies: impulses between particles of different bodies that touch as spheres.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dynamics/cell_lists.hpp"
#include "dynamics/contact_solver.hpp"
#include "dynamics/sphere_pairs.hpp"

namespace dartcast {

/// Particles of all bodies; entry i of each belongs to particle i.
struct BodyParticles {
  std::span<const std::uint32_t> body_of;
  std::span<const std::uint64_t> ids;
  std::span<const Vec3> positions;
  std::span<const double> radii;  ///< 0: it meets no other
  std::span<const double> inverse_masses;
};

/// Keeps pairs, impulses and memory from step to step.
class BodyCollisions {
 public:
  /// Finds the pairs that may meet in the next step: particles of different bodies, no wall in between, whose spheres'
  /// swept boxes meet. Precondition: the states are of the complex as it stands. Cost: about 1 us per particle of
  /// bodies whose bounding spheres meet, little for the others.
  void find(const CellComplex& complex, std::span<const ParticleState> states, const BodyParticles& particles,
            std::span<const Vec3> velocities, double dt, Threads threads);

  /// Impulses for the pairs found. `velocities`: at the start of the step. `led_to`: in, the velocities that its forces
  /// would lead to; out, with the impulses. Pairs that stay apart at the mean of both get no impulse. `corrections`:
  /// out, the displacements that take out overlaps. Throws as ContactSolver::solve().
  BodyCollisionCounts solve(const BodyParticles& particles, const BodyCollisionOptions& options, double dt,
                            std::span<const Vec3> velocities, std::span<Vec3> led_to, std::span<Vec3> corrections);

  /// The pairs of the last find(), sorted.
  [[nodiscard]] std::span<const SpherePair> pairs() const { return pairs_; }
  [[nodiscard]] ContactSolver& solver() { return solver_; }
  [[nodiscard]] const ContactSolver& solver() const { return solver_; }

 private:
  void sweep(const BodyParticles& particles, std::span<const Vec3> velocities, double dt);
  void leave_out_lonely(const BodyParticles& particles, Threads threads);

  CellLists lists_;
  PairFinder finder_;
  PairFinder body_finder_;
  ContactSolver solver_;
  std::vector<SphereMotion> swept_;
  std::vector<SphereMotion> bounds_;  // of bodies
  std::vector<std::uint8_t> meets_;   // by body
  std::vector<SpherePair> pairs_;
  std::vector<PairContact> contacts_;
  std::vector<Vec3> displacements_;
};

}  // namespace dartcast
