// The environment: a complex that deforms, and the particles in it. What most programs use.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/step.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/trace.hpp"
#include "dartcast/validity.hpp"
#include "environment/cell_particle_index.hpp"
#include "tracking/batch/batch.hpp"
#include "tracking/locate.hpp"

namespace dartcast {

/// A set of particles: plain states, made and advanced by an Environment. Another environment refuses it. An empty set
/// fits any environment, at any time. A copy is a set of its own: it must be advanced and follow edits by itself.
class Particles {
 public:
  [[nodiscard]] std::size_t size() const { return states_.size(); }
  [[nodiscard]] std::span<const ParticleState> states() const { return states_; }
  [[nodiscard]] const ParticleState& operator[](std::size_t i) const { return states_[i]; }
  /// Barycentric coordinates of a held particle in its simplex.
  [[nodiscard]] const Weights& held_weights(std::size_t i) const { return weights_[i]; }

  // All four throw InvalidArgument, nothing changed, where a size does not match or an index names no particle.

  /// Removes the particles marked with 1; the others keep their order. `marks`: one per particle.
  void remove(std::span<const std::uint8_t> marks);
  /// Reorders: particle i becomes what particle order[i] was. `order`: a permutation.
  void reorder(std::span<const std::uint32_t> order);
  /// A set of these particles alone, in this order, as they are. `which`: indices.
  [[nodiscard]] Particles selected(std::span<const std::uint32_t> which) const;
  /// Puts particles that were selected() back in their places, as they are now. `which`: as it was then. It also throws
  /// where the sets are of different environments, or have not followed the same moves and edits.
  void replace(std::span<const std::uint32_t> which, const Particles& by);

 private:
  friend class Environment;
  friend class EditFollower;

  std::vector<ParticleState> states_;
  std::vector<Weights> weights_;
  std::vector<detail::VertexNumbers> vertices_;
  detail::CacheKind cache_kind_ = detail::CacheKind::none;
  detail::SimplexCache caches_;    // of these states, where there is a kind
  bool stood_still_ = false;       // the vertices, at the last step
  bool walls_changed_ = false;     // since then
  std::uint64_t environment_ = 0;  // its number; 0: of none yet
  std::uint64_t moves_ = 0;        // of the environment, that these states have followed
  std::uint64_t edits_ = 0;
  std::optional<detail::CellParticleIndex> index_;  // of these states; none where they have changed since
};

/// What came of a request to add one particle.
struct AddResult {
  Location location;
  std::uint32_t particle = 0xffffffffU;  ///< its index in the set; none (0xffffffff) unless the place is free
};

/// What becomes of a particle that an edit leaves in a blocked cell, or outside.
enum class OrphanPolicy : std::uint8_t {
  hold,      ///< held in the blocked cell, along with which it rides, until that is free again; outside: as relocate
  relocate,  ///< to the nearest point of the free cells (tracking/nearest_free.hpp); absorbed where there is none
  absorb     ///< removed from the set
};

struct OrphanedParticle {
  std::uint32_t particle = 0;    ///< its index before any was removed
  Place place = Place::outside;  ///< blocked or outside
  Vec3 position;                 ///< where it was left
  OrphanPolicy outcome = OrphanPolicy::hold;
  double distance = 0.0;  ///< that it was moved by
};

/// What an edit did to a set of particles.
struct UpdateReport {
  std::uint64_t touched = 0;               ///< in cells removed or marked, or at walls of these
  std::uint64_t located = 0;               ///< of these, located again in the cells that took the place of theirs
  std::vector<OrphanedParticle> orphaned;  ///< by particle
};

/// It can be neither copied nor moved: flows, bodies and catheters keep a reference to it.
///
/// Two rules hold for every set of particles that is not empty. Before the next move() it takes part in the last one:
/// by advance(), or by update_after_edit() where an edit was made after that move. Before the next edit() it follows
/// the last one, by update_after_edit(). Any order of calls that keeps these rules is allowed. A set that has missed a
/// move or an edit is refused by advance(), update_after_edit() and add(); its positions can be added to a new set.
class Environment {
 public:
  /// Builds the complex. Throws InvalidMesh where check_and_repair() finds a defect, or where a cell has a simplex that
  /// is not positive (with the first of them); `mesh` is not changed by repairs: call check_and_repair() first to see
  /// and keep them. Throws as set_threads().
  explicit Environment(MeshData mesh, Threads threads = {});
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

  [[nodiscard]] const CellComplex& complex() const { return complex_; }
  [[nodiscard]] const CombinatorialMap& map() const { return complex_.map(); }
  [[nodiscard]] std::span<const Vec3> positions() const { return complex_.positions().first(complex_.point_count()); }

  /// Where a point is. Throws InvalidArgument where it is not finite or outside the exact range. The first call after a
  /// move makes a grid over all cells; not to be called from several threads at once.
  [[nodiscard]] Location locate(const Vec3& x);
  /// Locates many points, in parallel. Throws as locate(), naming the point.
  [[nodiscard]] std::vector<Location> locate(std::span<const Vec3> points);

  /// Adds a particle for every position in a free cell, in their order, and reports on every position: one in a blocked
  /// cell or outside is not added, and says so. Throws as locate(), and InvalidArgument where the particles are of
  /// another environment or have missed a move or an edit; nothing is added then.
  std::vector<AddResult> add(Particles& particles, std::span<const Vec3> positions);
  /// Adds a particle where the caller knows the simplex, without a search: false, and nothing added, unless the
  /// position lies exactly in that closed simplex, which is positive and of a free cell. Throws InvalidArgument where
  /// the particles are of another environment or have missed a move or an edit. Cost: five exact signs.
  bool add(Particles& particles, SimplexId simplex, const Vec3& position);

  /// Particles with these states, as if they had been here since the last move: for those saved from an equal
  /// environment. `weights`: one per state, read where it is held. Throws InvalidArgument, naming the first state that
  /// does not hold here: guarantee G3, or a wall touched that is none.
  [[nodiscard]] Particles restored(std::span<const ParticleState> states, std::span<const Weights> weights) const;

  /// Where to write the next positions of all the mesh's points before move(). The content is what it was two moves
  /// ago. In the plane z is not read. Write there only when every set of particles has taken part in the last move:
  /// until then they need the old content. An edit ends the validity of the result.
  [[nodiscard]] std::span<Vec3> next_positions() { return complex_.next_positions(); }
  /// Makes the positions written current, at no cost per cell: every set of particles must then be advanced once, or
  /// update_after_edit() an edit made after this move, before the next move. advance() takes targets relative to
  /// positions before the move.
  void move();
  /// Copies new positions of all the mesh's points, then move(). Throws InvalidArgument, nothing moved, where the
  /// number does not match, or in the plane a z is not 0.
  void move(std::span<const Vec3> positions);
  /// The first simplex that is flattened while the vertices go to `positions`, those of all the mesh's points, on
  /// straight lines; nothing where all stay positive. It tells what of the environment meets itself, when and how.
  /// Nothing is moved. Throws and costs as dartcast/validity.hpp.
  [[nodiscard]] std::optional<CellInversion> first_inversion(std::span<const Vec3> positions) const;
  /// move() to `positions` where nothing is flattened on the straight way there; else as far as `share`, in [0, 1], of
  /// the way to the first flattening, so that every simplex stays positive. Returns the fraction of the way made.
  /// Precondition: the scene is valid as it stands, or nothing is moved (0). Throws as move().
  double move_until_inverted(std::span<const Vec3> positions, double share = 1.0);

  /// Edits the topology: `make` is given an edit of the complex (dartcast/complex_edit.hpp; dartcast/map_edits.hpp has
  /// the edits), which is then committed. Every set of particles must then update_after_edit() before it is advanced,
  /// and before the next edit. positions() may have become more: so must arrays given at the points
  /// (dartcast::update_after_edit()). Throws what `make` throws, and EditRefused as ComplexEdit::commit(); then nothing
  /// is changed. Cost: that of the cells touched.
  ComplexEditReport edit(const std::function<void(ComplexEdit&)>& make);
  [[nodiscard]] std::uint64_t edit_count() const { return edits_; }
  /// What the last edit did; empty where there was none.
  [[nodiscard]] const ComplexEditReport& last_edit() const { return last_edit_; }
  /// Takes a set of particles along after an edit: those in cells that were replaced are located again, exactly, among
  /// the cells that took their place; those that have no place in a free cell become what `orphaned` says; all others
  /// keep their state bit for bit. Where particles are absorbed, those after them move up, as by remove().
  ///
  /// Where the edit was made after a move, and the particles have not been advanced since, they first ride along with
  /// the vertices, as by advance() without a motion of their own. They have then taken part in the move: the next
  /// advance() takes walls as at rest, and targets relative to positions() as they are now. Where the edit was made
  /// before the last move, particles follow it in the positions before that move. They then await advance(), as after
  /// any move.
  ///
  /// Throws InvalidArgument, nothing changed, where the particles are of another environment, or missed a move or an
  /// earlier edit. Cost: the particles touched and the cells added; the first time after the particles have changed,
  /// linear in the particles (20 ns each). After a move that the particles have not followed: that of advance(), or,
  /// where the move came last, a copy of the complex.
  UpdateReport update_after_edit(Particles& particles, OrphanPolicy orphaned = OrphanPolicy::relocate) const;

  /// Advances every particle towards its target; after a move(), along with the vertices (see docs/method.md). Without
  /// `respond` a particle stops at its first contact. Results are the same bits for any number of threads and order of
  /// particles. Throws InvalidArgument, nothing changed, where a target is not finite or outside the exact range, the
  /// sizes do not match, an option is not positive, the particles are of another environment or missed a move or an
  /// edit, or a response throws or returns such a displacement. Cost: a few orientation tests per particle, whatever
  /// the size of the scene.
  StepReport advance(Particles& particles, std::span<const Vec3> targets, const ContactCallback& respond = {},
                     const StepOptions& options = {});

  /// Throws as advance() would for these particles and options, whatever the targets.
  void check_advance(const Particles& particles, const StepOptions& options, const char* caller = "advance") const;

  /// What one particle would do on its way to each of these targets in turn, its crossings from cell to cell too, while
  /// the particle stays as it is: the states and contacts that advance() gives, to the same bits. It ends with the
  /// first target before which the particle is stopped or held. After a move() the first step is along with the
  /// vertices, as the next advance(); those that follow are not. Throws as advance(), and where there is no such
  /// particle. Cost: as one step for each target, and some exact determinants for each crossing.
  [[nodiscard]] std::vector<Trace> trace(const Particles& particles, std::size_t particle,
                                         std::span<const Vec3> targets, const ContactCallback& respond = {},
                                         const StepOptions& options = {}) const;

  /// Checks every simplex of the scene; exact, parallel, streaming.
  [[nodiscard]] Validity validity(std::size_t max_count = 10) const {
    return check_validity(complex_, threads_, max_count);
  }

  /// Whether the next advance() of these particles is the one along with the vertices after a move().
  [[nodiscard]] bool awaits_advance(const Particles& particles) const { return particles.moves_ != moves_; }

  /// Throws Error, nothing changed, as check_threads().
  void set_threads(Threads threads);
  [[nodiscard]] Threads threads() const { return threads_; }

 private:
  void check_positions(std::span<const Vec3> positions) const;
  [[nodiscard]] std::vector<Vec3> with_steiner_points(std::span<const Vec3> positions) const;
  static std::uint64_t next_id();
  void take_in(Particles& particles) const;
  void check_known(const Particles& particles, const char* call) const;
  void check_edit_followed(const Particles& particles, const char* call) const;
  void check_current(Particles& particles) const;
  // Returns the targets as decisions see them; nothing where that is what they are.
  [[nodiscard]] std::vector<Vec3> check_targets(const Particles& particles, std::span<const Vec3> targets) const;
  void add_to(Particles& particles, SimplexId simplex, const Vec3& position) const;
  struct Steps;
  [[nodiscard]] detail::CacheKind cache_kind(const Particles& particles, bool moved) const;
  void step_chunk(const Steps& steps, std::size_t begin, std::size_t end, StepReport& part) const;
  void step_all(const Steps& steps, std::vector<StepReport>& parts) const;

  CellComplex complex_;
  Threads threads_;
  std::uint64_t id_ = next_id();
  std::uint64_t moves_ = 0;
  std::uint64_t edits_ = 0;
  std::uint64_t moves_at_edit_ = 0;  // when the last edit was made
  ComplexEditReport last_edit_;
  std::unique_ptr<Locator> locator_;  // of the current positions, when it was asked for
};

}  // namespace dartcast
