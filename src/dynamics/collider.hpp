// One step's collisions of the spheres in an environment: lists, pairs, contacts, impulses.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/dynamics.hpp"
#include "dartcast/particle_state.hpp"
#include "dynamics/cell_lists.hpp"
#include "dynamics/contact_solver.hpp"
#include "dynamics/sphere_pairs.hpp"
#include "dynamics/sphere_touch.hpp"

namespace dartcast {

/// Spheres at rest keep this share of the smaller radius between them, and from walls. Rounding and unfinished
/// iterations then make no contact.
inline constexpr double resting_gap = 0x1p-10;
/// Pairs count as near within this share of a radius and the motion of one of them, at most its radius. An impulse
/// elsewhere may bring them together within the step. Walls count within this share. Pairs that are further apart and
/// still meet overlap; the next steps part them.
inline constexpr double near_share = 0x1p-4;
/// The distance within which a sphere counts as near. An impulse may stop or turn it; another sphere that moves along
/// with it then comes nearer by its own motion.
inline double near_room(const SphereMotion& s) {
  return s.radius * near_share + std::min(norm(s.displacement), s.radius);
}

/// Whether a sphere comes so near to another in the step that both are solved together. `gap` is the contact's, without
/// the resting gap, and the velocities are those before impulses. Their directions do not matter, because walls turn them.
inline bool in_reach(double gap, const Vec3& a, const Vec3& b, double dt) { return gap <= (norm(a) + norm(b)) * dt; }

/// Removes the walls of lone spheres, which meet them by their own step, at the time of the contact. A sphere is lone
/// if `shared` is 0 (no other is in_reach()), and if it comes to no wall at the resting speed or slower. It must also
/// come to a wall faster, or leave one. `shared`: by sphere; changed. Gaps are without the resting gaps.
void leave_lone_spheres(std::span<const Vec3> velocities, const SolverOptions& options,
                        std::vector<std::uint8_t>& shared, std::vector<WallContact>& walls);

/// Time spent in all calls so far.
struct CollisionSeconds {
  double lists = 0.0;     ///< updating each cell's particles
  double pairs = 0.0;     ///< finding pairs whose swept boxes meet
  double contacts = 0.0;  ///< when and where they touch, walls in between
  double impulses = 0.0;
};

/// Spheres of an environment: entry i of each belongs to particle i.
struct CollidingSpheres {
  std::span<const ParticleState> states;
  std::span<const std::uint64_t> ids;      ///< distinct
  std::span<const double> radii;           ///< 0: it meets no sphere
  std::span<const double> inverse_masses;  ///< 0: nothing can push it
  std::span<const double> clearances;      ///< no wall is nearer to the centre; empty: unknown
  std::span<Vec3> velocities;              ///< in: after all other forces; out: after the collisions
  std::span<Vec3> displacements;           ///< out: of this step
  Vec3 gravity = {};  ///< its direction: impulses pass along it, so spheres are not divided across it
};

/// Keeps lists, impulses and memory from step to step.
class Collider {
 public:
  /// Finds the pairs and solves them together with `walls`, whose gaps are those of the geometry. This function
  /// subtracts the resting gaps, and leaves lone spheres to their own step (leave_lone_spheres()). Pairs with a wall
  /// between their centres do not meet. Precondition: the states are of the complex as it stands. Throws as
  /// ContactSolver::solve(). The result is the same for any number of threads and any order of particles.
  CollisionCounts collide(const CellComplex& complex, const CollidingSpheres& spheres,
                          std::span<const WallContact> walls, const SolverOptions& options, Threads threads);

  /// The walls to which spheres came in the last step (ContactSolver::new_walls()). Gaps are without the resting gaps.
  [[nodiscard]] std::span<const WallContact> new_walls() const { return new_walls_; }

  [[nodiscard]] ContactSolver& solver() { return solver_; }
  [[nodiscard]] const ContactSolver& solver() const { return solver_; }
  [[nodiscard]] const PairFinder& finder() const { return finder_; }
  [[nodiscard]] const CollisionSeconds& seconds() const { return seconds_; }

 private:
  struct Part {
    std::vector<PairContact> contacts;
    std::uint64_t overlaps = 0;
    double deepest = 0.0;
  };

  // The distance that a sphere can move from its centre, and the room around it in which another is near.
  struct Reach {
    Vec3 centre;
    double limit = 0.0;
    double room = 0.0;
  };

  void sweep(const CollidingSpheres& spheres, double dt, Threads threads);
  void divide(const CollidingSpheres& spheres);
  [[nodiscard]] bool surely_apart(std::uint32_t a, std::uint32_t b) const;
  void find_contacts(const CellComplex& complex, const CollidingSpheres& spheres,
                     std::span<const SpherePair> candidates, Threads threads, CollisionCounts& counts);
  void find_contacts(const CellComplex& complex, const CollidingSpheres& spheres,
                     std::span<const SpherePair> candidates, Part& part) const;

  CellLists lists_;
  PairFinder finder_;
  ContactSolver solver_;
  std::vector<SphereMotion> moving_;
  std::vector<SphereMotion> swept_;  // radii with the room in which they count as near
  std::vector<Reach> reaches_;
  std::vector<Part> parts_;  // by chunk of candidates
  std::vector<PairContact> pairs_;
  std::vector<WallContact> walls_;
  std::vector<WallContact> new_walls_;
  std::vector<std::uint8_t> shared_;   // by sphere
  std::vector<std::uint8_t> regions_;  // by sphere
  std::size_t region_count_ = 1;
  CollisionSeconds seconds_;
};

}  // namespace dartcast
