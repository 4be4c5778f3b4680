// Impulses at the contacts of spheres with each other and with walls: restitution, Coulomb friction, no penetration.
//
// Sequential impulses (projected Gauss-Seidel) started from those of the last step: E. Catto, "Iterative dynamics with
// temporal coherence", 2005. Spheres do not rotate: friction acts on the velocities of the centres.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/dynamics.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/storage.hpp"
#include "dartcast/vec3.hpp"
#include "dynamics/contact_packets.hpp"

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
  CellFace face = {};  ///< of the free cell; the solver does not read it, nor the fan triangle
  std::uint16_t triangle = 0;
};

/// Iterations for velocities after rebounds.
inline constexpr unsigned rebound_iterations = 4;

struct SolverOptions {
  double dt = 1e-3;                  ///< duration of the step, > 0
  double restitution = 0.0;          ///< between spheres, in [0, 1]
  double friction = 0.0;             ///< between spheres, >= 0
  unsigned iterations = 10;          ///< over all contacts, for velocities
  unsigned position_iterations = 4;  ///< for displacements, which take out penetration
  /// Contacts that approach slower than this do not rebound. Gravity alone makes g dt in a step at rest: 2 g dt is a
  /// good choice.
  double resting_speed = 0.0;
  double position_correction = 0.2;  ///< share of a penetration taken out in one step, in [0, 1]
  Vec3 acceleration;  ///< that the velocities of all spheres have got in this step; only lone rebounds use it
};

/// A rebound at a contact whose two sides have no other, at its time within the step. If one side does not move, the
/// speed of the other keeps the energy of this moment, as for a particle at a wall (docs/method.md, "Reflection").
/// `bound`: the velocity along the normal, from a to b, that just comes to the contact in the step, <= 0. `impulse`: on
/// b; the velocities hold it already. Returns the displacements of a and b.
std::array<Vec3, 2> rebound_alone(const Vec3& normal, double bound, const Vec3& impulse, detail::ContactBody& a,
                                  detail::ContactBody& b, const SolverOptions& options);

/// Data of the spheres: entry i of each belongs to sphere i.
struct SolverSpheres {
  std::span<const std::uint64_t> ids;      ///< distinct; contacts are taken in their order
  std::span<const double> inverse_masses;  ///< 0: nothing can push it
  std::span<Vec3> velocities;              ///< in: after all other forces; out: after the impulses, with rebounds
  /// Out: of this step, with the penetration taken out. Rebounds start with the next step, but lone ones at their time.
  std::span<Vec3> displacements;
  std::span<const std::uint8_t> regions = {};  ///< threads share the work by regions; empty: there is one
  std::size_t region_count = 1;
};

class ContactSolver {
 public:
  /// Each impulse is applied to both spheres, equal and opposite: momentum changes because of rounding alone.
  /// Taking out penetration changes displacements, never velocities. If a contact with approach speed u above
  /// the resting speed was given an impulse, it ends with restitution u along its normal. Rebounds are solved
  /// once more over all contacts, or by rebound_alone() for a contact that is the only one of its sides. The
  /// result depends on the contacts and ids, not on the order of spheres or contacts. Throws InvalidArgument if
  /// an option is out of range, spans differ in length, or a contact names no sphere; nothing changed. It
  /// depends on the regions, too, but not on the number of threads. Cost: linear in the contacts times the
  /// iterations, after sorting. Four contacts at once: some 10 ns a contact and iteration on one thread, the
  /// sorting included.
  void solve(std::span<const PairContact> pairs, std::span<const WallContact> walls, const SolverSpheres& spheres,
             const SolverOptions& options, Threads threads = {1});

  /// Impulses of the last step: pairs by ids, then walls; set_cached_impulses() continues from them exactly.
  [[nodiscard]] std::span<const CachedImpulse> cached_impulses() const { return cached_; }
  void set_cached_impulses(std::span<const CachedImpulse> cached_impulses);

  /// Numbers of contacts that got an impulse in the last step.
  [[nodiscard]] std::size_t loaded_pairs() const { return loaded_pairs_; }
  [[nodiscard]] std::size_t loaded_walls() const { return loaded_walls_; }
  /// The walls of the last step that got an impulse and started without one: the spheres came to them. Indices into
  /// the walls, by the ids of their spheres.
  [[nodiscard]] std::span<const std::uint32_t> new_walls() const { return new_walls_; }

 private:
  struct PairKey {
    std::uint64_t low = 0;  // ids
    std::uint64_t high = 0;
    std::uint32_t pair = 0;

    auto operator<=>(const PairKey&) const = default;
  };
  struct Surface {
    Vec3 normal;  // from a to b
    double gap = 0.0;
    double restitution = 0.0;
    double friction = 0.0;
  };
  // The counts of a chunk of rows.
  struct KeptCounts {
    std::size_t loaded_pairs = 0;
    std::size_t loaded_walls = 0;
    std::size_t pairs = 0;
    std::size_t walls = 0;
    std::size_t begin = 0;  // of those kept, in cached_
  };
  class ImpulseCacheReader;

  void make_bodies(std::span<const WallContact> walls, const SolverSpheres& spheres, Threads threads);
  void order_pairs(std::span<const PairContact> pairs, const SolverSpheres& spheres);
  void order_walls(std::span<const WallContact> walls, const SolverSpheres& spheres);
  void list_pairs(std::span<const PairContact> pairs, std::span<const std::uint64_t> ids, const SolverOptions& options,
                  Threads threads);
  void list_walls(std::span<const WallContact> walls, std::span<const std::uint64_t> ids, const SolverOptions& options,
                  Threads threads);
  void give_bodies_to_fixed_spheres(std::size_t spheres);
  void set_row(std::size_t row, detail::ContactEnds ends, const Surface& surface, const CachedImpulse* cached_impulses,
               const SolverOptions& options);
  void position_correction(const SolverSpheres& spheres, const SolverOptions& options, Threads threads);
  void rebound(const SolverSpheres& spheres, const SolverOptions& options, Threads threads);
  void keep(std::span<const std::uint64_t> ids, std::span<const WallContact> walls, Threads threads);
  [[nodiscard]] bool is_kept(std::size_t row) const;

  // Rows are contacts in the order of the solver: pairs by ids, then walls by ids and normals. In a wall's row the
  // sphere is b.
  std::vector<detail::ContactEnds> ends_;      // by row
  AlignedVector<detail::ContactTerms> terms_;  // by row, as at the start
  std::size_t pair_rows_ = 0;
  detail::ContactPackets packets_;  // of rows
  // Spheres, walls, a fixed sphere for each of its pairs, and those that fill packets.
  AlignedVector<detail::ContactBody> bodies_;
  AlignedVector<detail::ContactBody> pushed_;  // the same, for displacements
  std::vector<PairKey> pair_order_;            // by row
  std::vector<std::uint32_t> wall_order_;      // by row behind those
  std::vector<KeptCounts> kept_;               // by chunk of rows
  std::vector<CachedImpulse> cached_;          // in the order of rows
  std::size_t cached_pairs_ = 0;
  std::size_t loaded_pairs_ = 0;
  std::size_t loaded_walls_ = 0;
  std::vector<std::uint32_t> new_walls_;
  std::vector<std::uint8_t> rows_of_;  // by body: 0, 1, or 2 for more
};

}  // namespace dartcast
