// Contacts between bodies: impulses between particles of different bodies that touch as spheres.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dynamics/cell_lists.hpp"
#include "dynamics/contact_solver.hpp"
#include "dynamics/sphere_pairs.hpp"

namespace dartcast {

/// Particles do not rebound from each other.
struct BodyCollisionOptions {
  /// In [0, 1]: bodies that hit each other faster than 2 |gravity| dt part as rigid ones, at this share of the speed.
  /// None: they part by their matching forces, as these happen to.
  std::optional<double> restitution = {};
  double friction = 0.0;  ///< >= 0
  unsigned iterations = 10;
  double position_correction = 0.2;  ///< share of an overlap taken out in one step, in [0, 1]
};

/// What happened in one step.
struct BodyCollisionCounts {
  std::uint64_t pairs_near = 0;      ///< given to the solver
  std::uint64_t pairs_touching = 0;  ///< given an impulse
  std::uint64_t impacts = 0;         ///< pairs that came together fast; 0 without restitution
  std::uint64_t overlaps = 0;
  double deepest = 0.0;  ///< of these, m
};

/// Particles of all bodies; entry i of each belongs to particle i.
struct BodyParticles {
  std::span<const std::uint32_t> body_of;
  std::span<const std::uint64_t> ids;
  std::span<const Vec3> positions;
  std::span<const double> radii;  ///< 0: meets nobody
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

  /// Impulses for the pairs found. `velocities`: at the begin of the step; `led_to`: those that its forces would lead
  /// to; out with the impulses. Pairs that stay apart on the way, at the mean of both, get none. `corrections`: out, by
  /// how much the overlaps are to be taken out. Throws as ContactSolver::solve().
  BodyCollisionCounts solve(const BodyParticles& particles, const BodyCollisionOptions& options, double dt,
                            std::span<const Vec3> velocities, std::span<Vec3> led_to, std::span<Vec3> corrections);

  /// Those found; sorted.
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
