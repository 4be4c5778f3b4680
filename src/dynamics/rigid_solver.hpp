// Impulses at the contacts of rigid bodies and spheres, with each other and with walls.
//
// As dynamics/contact_solver.hpp (E. Catto, "Iterative dynamics with temporal coherence", 2005), but a body also
// turns. Friction then changes the velocity along the normal, so it is solved first, from the impulse of the
// iteration before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dynamics/contact_solver.hpp"
#include "dynamics/mat3.hpp"

namespace dartcast {

/// Two movers near each other, or one and a wall: their motion relative to each other along the normal must not be
/// below -gap.
struct RigidContact {
  static constexpr std::uint32_t wall = 0xffffffffU;

  std::uint32_t a = wall;
  std::uint32_t b = 0;
  std::uint64_t a_id =
      CachedImpulse::wall;  ///< of the sphere, or of the body's particle, that touches; a_id < b_id in a pair
  std::uint64_t b_id = 0;
  Vec3 normal;   ///< unit, from a to b
  Vec3 point_a;  ///< where impulses act on each
  Vec3 point_b;
  double gap = 0.0;  ///< negative: they overlap
  double restitution = 0.0;
  double friction = 0.0;
  Vec3 wall_velocity;
};

class RigidSolver {
 public:
  /// Each impulse acts on both sides, equal and opposite: momentum changes because of rounding alone. Options as in
  /// ContactSolver::solve(), but each contact has its own restitution and friction. Contacts are taken in the order
  /// of ids; the result does not depend on the order of contacts or movers. Preconditions: options in range, contacts
  /// name movers. Serial.
  void solve(std::span<const RigidContact> contacts, std::span<RigidMover> movers, const SolverOptions& options);

  /// Impulses of the last step, in the order of ids; set_cached_impulses() continues from them.
  [[nodiscard]] std::span<const CachedImpulse> cached_impulses() const { return cached_; }
  void set_cached_impulses(std::span<const CachedImpulse> cached_impulses) {
    cached_.assign(cached_impulses.begin(), cached_impulses.end());
  }

  /// Numbers of contacts that got an impulse in the last step.
  [[nodiscard]] std::size_t loaded_pairs() const { return loaded_pairs_; }
  [[nodiscard]] std::size_t loaded_walls() const { return loaded_walls_; }
  /// As ContactSolver::new_walls(): indices into the contacts.
  [[nodiscard]] std::span<const std::uint32_t> new_walls() const { return new_walls_; }

 private:
  struct Row {
    const RigidContact* contact = nullptr;
    Vec3 lever_a;  // from the centres to the points
    Vec3 lever_b;
    double bound = 0.0;           // velocity along the normal that it must not fall below
    double position_bound = 0.0;  // likewise, of displacements
    double mass = 0.0;            // effective, along the normal
    double mass_across = 0.0;     // at most the effective one in any direction
    double rebound = 0.0;  // velocity along the normal that it ends with, if it was given an impulse; 0: does not
    double normal_impulse = 0.0;  // impulses so far
    Vec3 tangent_impulse;
    double position_correction = 0.0;
    bool loaded = false;  // starts with an impulse of the last step
  };

  void make_rows(std::span<const RigidContact> contacts, std::span<const RigidMover> movers,
                 const SolverOptions& options);
  void load_cached_impulses();
  void solve_row(Row& row, double bound, std::span<RigidMover> movers);
  void correct_positions(std::span<RigidMover> movers, const SolverOptions& options);
  void rebound(std::span<RigidMover> movers, const SolverOptions& options);
  void rebound_lone_spheres(std::span<RigidMover> movers, const SolverOptions& options);
  void keep(std::span<const RigidContact> contacts);

  std::vector<Row> rows_;
  std::vector<CachedImpulse> cached_;
  std::size_t loaded_pairs_ = 0;
  std::size_t loaded_walls_ = 0;
  std::vector<std::uint32_t> new_walls_;
  std::vector<std::uint8_t> rows_of_;  // by mover: 0, 1, or 2 for more
};

}  // namespace dartcast
