// Impulses at the contacts of spheres with each other and with walls: restitution, Coulomb friction, no penetration.
//
// Sequential impulses (projected Gauss-Seidel) started from those of the last step: E. Catto, "Iterative dynamics with
// temporal coherence", 2005. Spheres do not rotate: friction acts on the velocities of the centres.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/exact/vec3.hpp"

namespace dartcast {

/// Two spheres near each other: their motion relative to each other along the normal must not be below -gap.
struct PairContact {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Vec3 normal;       ///< unit, from a to b
  double gap = 0.0;  ///< negative: they overlap
};

/// A sphere near a wall. A wall's mass is infinite.
struct WallContact {
  std::uint32_t sphere = 0;
  Vec3 normal;       ///< unit, from the wall to the centre
  double gap = 0.0;  ///< negative: they overlap
  Vec3 wall_velocity;
  double restitution = 0.0;
  double friction = 0.0;
};

struct SolverOptions {
  double dt = 1e-3;                 ///< duration of the step, > 0
  double restitution = 0.0;         ///< between spheres, in [0, 1]
  double friction = 0.0;            ///< between spheres, >= 0
  unsigned iterations = 10;         ///< over all contacts, for velocities
  unsigned push_iterations = 4;     ///< for displacements: what takes out penetration
  unsigned rebound_iterations = 4;  ///< for velocities after rebounds
  /// Contacts that approach slower than this do not rebound. Gravity alone makes g dt in a step at rest: 2 g dt is a
  /// good choice.
  double resting_speed = 0.0;
  double push = 0.2;  ///< share of a penetration taken out in one step, in [0, 1]
};

/// An impulse that the next step starts from.
struct KeptImpulse {
  std::uint64_t a = 0;  ///< ids of the spheres; of a wall's: that of the sphere, and none
  std::uint64_t b = 0;
  Vec3 normal;
  double along = 0.0;  ///< the normal
  Vec3 across;

  static constexpr std::uint64_t wall = ~std::uint64_t{0};
  bool operator==(const KeptImpulse&) const = default;
};

/// What acts on the spheres: entry i of each belongs to sphere i.
struct SolverSpheres {
  std::span<const std::uint64_t> ids;      ///< distinct; contacts are taken in their order
  std::span<const double> inverse_masses;  ///< 0: it cannot be pushed
  std::span<Vec3> velocities;              ///< in: after all other forces; out: after the impulses, with rebounds
  std::span<Vec3> displacements;  ///< out: of this step; that of the impulses without rebounds, which begin with the
                                  ///< next step, and with the penetration taken out
};

class ContactSolver {
 public:
  /// Each impulse is applied to both spheres, equal and opposite: momentum changes by rounding alone. Taking out
  /// penetration changes displacements, never velocities. A contact with approach speed u above the resting speed ends
  /// with restitution u along its normal if it was given an impulse (rebounds are solved once more over all contacts).
  /// The result depends on the contacts and ids, not on the order of spheres or contacts. Throws InvalidArgument where
  /// an option is out of range, spans differ in length, or a contact names no sphere; nothing changed. Cost: linear in
  /// the contacts times the iterations, after sorting; no allocation in steady state. Serial: some 20 ns a contact and
  /// iteration.
  void solve(std::span<const PairContact> pairs, std::span<const WallContact> walls, const SolverSpheres& spheres,
             const SolverOptions& options);

  /// Impulses of the last step: pairs by ids, then walls; set_kept() goes on from them as if there had been no break.
  [[nodiscard]] std::span<const KeptImpulse> kept() const { return kept_; }
  void set_kept(std::span<const KeptImpulse> kept);

  /// Numbers of contacts that the last step gave an impulse.
  [[nodiscard]] std::size_t loaded_pairs() const { return loaded_pairs_; }
  [[nodiscard]] std::size_t loaded_walls() const { return loaded_walls_; }

 private:
  // A contact while it is solved: what every iteration reads. Of a wall the sphere is b, and a is none.
  struct Row {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    Vec3 normal;
    double bound = 0.0;  // velocity along the normal that it must not fall below
    double mass = 0.0;   // effective
    double friction = 0.0;
    double along = 0.0;  // impulses so far
    Vec3 across;
  };
  struct Rest {
    double rebound = 0.0;  // velocity along the normal that it ends with, if it was given an impulse; 0: does not
    double push = 0.0;     // impulse of displacements
    double push_bound = 0.0;
    Vec3 wall_velocity;
  };
  class Sides;

  void add_row(Row row, double gap, double restitution, const Vec3& wall_velocity, const SolverSpheres& spheres,
               const SolverOptions& options);
  void make_rows(std::span<const PairContact> pairs, std::span<const WallContact> walls, const SolverSpheres& spheres,
                 const SolverOptions& options);
  void sort_pairs(std::span<const PairContact> pairs, std::span<const std::uint64_t> ids);
  void sort_walls(std::span<const WallContact> walls, std::span<const std::uint64_t> ids);
  void take_kept(const SolverSpheres& spheres);
  void solve_velocities(const SolverSpheres& spheres, unsigned iterations);
  void solve_pushes(const SolverSpheres& spheres, const SolverOptions& options);
  void rebound(const SolverSpheres& spheres, unsigned iterations);
  void keep(const SolverSpheres& spheres);

  std::vector<Row> rows_;   // pairs by ids, then walls by ids and normals
  std::vector<Rest> rest_;  // of rows
  std::size_t pair_rows_ = 0;
  std::vector<std::uint32_t> order_;
  std::vector<KeptImpulse> kept_;  // in the order of rows
  std::size_t kept_pairs_ = 0;
  std::size_t loaded_pairs_ = 0;
  std::size_t loaded_walls_ = 0;
};

}  // namespace dartcast
