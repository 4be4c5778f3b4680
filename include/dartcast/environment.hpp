// The environment: a complex that deforms, and the particles in it. Most programs need only this header.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/cell_tally.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

namespace detail {
class StepDecider;
struct Tallied;
}  // namespace detail

class CellComplex;         // dartcast/cell_complex.hpp
class CombinatorialMap;    // dartcast/combinatorial_map.hpp
class ComplexEdit;         // dartcast/complex_edit.hpp
struct ComplexEditReport;  // dartcast/complex_edit.hpp
struct CellInversion;      // dartcast/validity.hpp
struct StepReplay;         // dartcast/step_replay.hpp
struct Validity;           // dartcast/validity.hpp

/// Receives a step that went wrong. It is called while the step is taken, and must not change the environment.
using ReplayHook = std::function<void(const StepReplay&)>;

/// A set of particles: plain states, made and advanced by an Environment. Another environment refuses it. An empty set
/// fits any environment, at any time. A copy is a set of its own: it must be advanced and follow edits by itself. A set
/// that was moved from is empty.
class Particles {
 public:
  Particles() noexcept;
  /// A set with these states that belongs to no environment, for example from a file: it can be read and copied.
  /// Environment::restored() makes one that moves. `weights`: held_weights() of each. Throws InvalidArgument if their
  /// numbers differ. Its vertex_numbers() are 0xffffffff.
  Particles(std::span<const ParticleState> states, std::span<const Weights> weights);
  Particles(const Particles& other);
  Particles(Particles&& other) noexcept;
  Particles& operator=(const Particles& other);
  Particles& operator=(Particles&& other) noexcept;
  ~Particles();

  [[nodiscard]] std::size_t size() const { return states_.size(); }
  [[nodiscard]] std::span<const ParticleState> states() const { return states_; }
  [[nodiscard]] const ParticleState& operator[](std::size_t i) const { return states_[i]; }
  /// Barycentric coordinates of a held particle in its simplex.
  [[nodiscard]] const Weights& held_weights(std::size_t i) const;
  /// Numbers of the vertices of each particle's simplex, in the order of CellComplex::vertices(). They are kept from
  /// step to step, so that values at vertices are interpolated without a look at the cell.
  [[nodiscard]] std::span<const std::array<std::uint32_t, 4>> vertex_numbers() const;

  // These throw InvalidArgument and change nothing if a size does not match or an index names no particle.

  /// Removes the particles marked with 1; the others keep their order. `marks`: one per particle.
  void remove(std::span<const std::uint8_t> marks);
  /// Keeps the first `count` particles alone; it does nothing if there are no more. Without memory of its own, so that
  /// it can undo an addition.
  void truncate(std::size_t count);
  /// Reorders: particle i is then the former particle order[i]. `order`: a permutation.
  void reorder(std::span<const std::uint32_t> order);
  /// A set of these particles alone, in this order, as they are. `which`: indices.
  [[nodiscard]] Particles selected(std::span<const std::uint32_t> which) const;
  /// Puts particles that were selected() back in their places, as they are now. `which`: as it was then. It also throws
  /// if the sets are of different environments, or have not followed the same moves and edits.
  void replace(std::span<const std::uint32_t> which, const Particles& by);

 private:
  friend class Environment;
  friend class EditFollower;
  friend class PartEnvironment;

  struct Details;  // src/environment/particle_details.hpp
  Details& details();
  [[nodiscard]] const Details& details() const;

  std::vector<ParticleState> states_;
  std::unique_ptr<Details> details_;  // none: those of an empty set
};

/// The answer to a request to add one particle.
struct AddResult {
  Location location;
  std::uint32_t particle = 0xffffffffU;  ///< its index in the set; none (0xffffffff) unless the place is free
};

/// The first wall that a ray meets: see Environment::cast_rays().
struct RayHit {
  Place origin = Place::outside;  ///< where the ray begins. Only a ray that begins in a free cell is cast
  bool hit = false;               ///< whether it meets a wall
  Kind kind = Kind::volume;       ///< of the place on the wall: face, edge or vertex
  CellFace face;                  ///< the wall, in the free cell in front of it
  std::uint16_t triangle = 0;     ///< of the face's fan
  Patch patch;
  double distance = std::numeric_limits<double>::infinity();  ///< from the origin
  Vec3 point;                                                 ///< on the wall
  Vec3 normal;                                                ///< of the wall, on its free side
  Cell invalid_cell;  ///< where the ray ends at an invalid cell instead (validity())
};

/// The cells that rays pass, from the one that holds the origin to the one at the wall, or where the ray ends.
struct RayCells {
  std::vector<Cell> cells;         ///< of all rays, one after another
  std::vector<double> lengths;     ///< of the way in each, rounded
  std::vector<std::size_t> first;  ///< of each ray, and at the end the number of cells
};

/// How update_after_edit() treats an orphaned particle: one that is in a blocked cell, or outside, after an edit.
enum class OrphanPolicy : std::uint8_t {
  hold,      ///< held in the blocked cell, and carried along with it, until it is free again; outside: as relocate
  relocate,  ///< to the nearest point of the free cells; absorbed if there is none
  absorb     ///< removed from the set
};

/// A particle that an edit left in no free cell.
struct OrphanedParticle {
  std::uint32_t particle = 0;    ///< its index before any was removed
  Place place = Place::outside;  ///< blocked or outside
  Vec3 position;                 ///< where it was after the edit
  OrphanPolicy outcome = OrphanPolicy::hold;
  double distance = 0.0;  ///< from there to where it was relocated
};

/// The effect of an edit on a set of particles.
struct UpdateReport {
  std::uint64_t touched = 0;               ///< particles in cells removed or marked, or at walls of these
  std::uint64_t located = 0;               ///< of these, the particles located again in a cell that replaced theirs
  std::vector<OrphanedParticle> orphaned;  ///< by particle
};

/// A complex that deforms, and the operations on particles in it. It can be neither copied nor moved: simulations,
/// bodies and catheters keep a reference to it.
///
/// Two rules hold for every set of particles that is not empty:
/// - Before the next move() it takes part in the last one, by advance(). If an edit was made after that move, it does
///   so by update_after_edit().
/// - Before the next edit() it follows the last one, by update_after_edit().
///
/// Any order of calls that keeps these rules is allowed. advance(), update_after_edit() and add() refuse a set that has
/// missed a move or an edit. Its positions can be added to a new set.
class Environment {
 public:
  /// Builds the complex. Throws InvalidMesh if check_and_repair() finds a defect, or if a cell has a simplex that
  /// is not positive; the message names the first one. The repairs are not visible to the caller: call
  /// check_and_repair() first to see and keep them. Throws as set_threads().
  explicit Environment(MeshData mesh, Threads threads = {});
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment();

  // Cost of these three: a call. Loops take the result once.
  [[nodiscard]] const CellComplex& complex() const;
  [[nodiscard]] const CombinatorialMap& map() const;
  /// Those of the mesh's points.
  [[nodiscard]] std::span<const Vec3> positions() const;

  /// Where a point is. Throws InvalidArgument if it is not finite or outside the exact range. Precondition: no other
  /// thread calls it at the same time. Cost: the first call after a move makes a grid over all cells.
  [[nodiscard]] Location locate(const Vec3& x);
  /// Locates many points, in parallel. Throws as locate(), naming the point.
  [[nodiscard]] std::vector<Location> locate(std::span<const Vec3> points);

  /// The first wall that each ray meets within `max_distance` of its origin; infinite: within the scene. Rays see walls
  /// from their free side. Directions have any length. Every decision is exact for the segment whose end has been
  /// rounded: no ray passes between two faces or through an edge. `passed`: if not null, the cells on the way.
  /// Throws InvalidArgument, naming the ray, if locate() refuses its origin. It also throws if its direction is zero or
  /// not finite, or in the plane has a z that is not 0. So do an end out of the exact range, a distance that is
  /// negative or not a number, and numbers that differ. Precondition: as for locate(). Cost: locate() and a step for
  /// each ray, in parallel; with `passed` a second walk.
  [[nodiscard]] std::vector<RayHit> cast_rays(std::span<const Vec3> origins, std::span<const Vec3> directions,
                                              double max_distance = std::numeric_limits<double>::infinity(),
                                              RayCells* passed = nullptr);

  /// Adds a particle for every position in a free cell, in their order. Returns one result per position: those in a
  /// blocked cell or outside are not added. Throws as locate(), and InvalidArgument if the particles are of another
  /// environment or have missed a move or an edit; nothing is added then.
  std::vector<AddResult> add(Particles& particles, std::span<const Vec3> positions);
  /// Adds a particle without a search, if the caller knows the simplex. Returns false and adds nothing unless the
  /// position lies exactly in that closed simplex, and the simplex is positive and of a free cell. Throws
  /// InvalidArgument if the particles are of another environment or have missed a move or an edit. Cost: five exact
  /// signs.
  bool add(Particles& particles, SimplexId simplex, const Vec3& position);
  /// Adds a particle at barycentric coordinates in a simplex: in a positive one at a position there, or as near as
  /// positions can be. In another it is held, as if the last move had inverted the simplex with the particle in it. In
  /// the plane the fourth coordinate is not read. Returns false and adds nothing unless the cell is free. Throws
  /// InvalidArgument if a coordinate is not in [0, 1], and as the other add().
  bool add_at(Particles& particles, SimplexId simplex, const Weights& weights);

  /// Particles with these states, which were saved from an equal environment. They have taken part in the last move and
  /// edit. `weights`: one per state, read if it is held. Throws InvalidArgument, naming the first state that is not
  /// one of this environment: it breaks guarantee G3, or touches a face that is no wall.
  [[nodiscard]] Particles restored(std::span<const ParticleState> states, std::span<const Weights> weights) const;

  /// Where to write the next positions of all the mesh's points before move(). The content is what it was two moves
  /// ago. In the plane z is not read. Write there only when every set of particles has taken part in the last move:
  /// until then they need the old content. An edit ends the validity of the result.
  [[nodiscard]] std::span<Vec3> next_positions();
  /// Makes the positions written current, at no cost per cell. Before the next move, every set of particles must be
  /// advanced once, or follow an edit made after this move with update_after_edit(). Targets of advance() are relative
  /// to positions before the move. Throws InvalidArgument, nothing moved, if a corner of a periodic pair comes farther
  /// off its partner than PeriodicPair::tolerance allows; it names both vertices.
  void move();
  /// Copies new positions of all the mesh's points, then move(). Throws InvalidArgument, nothing moved, if the
  /// number does not match, or in the plane a z is not 0.
  void move(std::span<const Vec3> positions);
  /// The first simplex that inverts while the vertices go on straight lines to `positions`, those of all the mesh's
  /// points; nothing if all stay positive. The answer has the time and the features that meet. Nothing is moved.
  /// Throws and costs as dartcast/validity.hpp.
  [[nodiscard]] std::optional<CellInversion> first_inversion(std::span<const Vec3> positions) const;
  /// Moves as move() to `positions` if no simplex inverts on the straight way there. Otherwise it goes `share`, in [0,
  /// 1], of the way to the first inversion, so that every simplex stays positive. Returns the fraction of the way made:
  /// 0, and nothing is moved, if the scene is not valid as it stands. Throws as move().
  double move_until_inverted(std::span<const Vec3> positions, double share = 1.0);

  /// Edits the topology. `make` gets an edit of the complex (dartcast/complex_edit.hpp; the single edits are in
  /// dartcast/map_edits.hpp), which is committed when it returns. Every set of particles must then update_after_edit()
  /// before it is advanced, and before the next edit. There may be more positions() than before: arrays with values at
  /// the points must follow (dartcast::update_after_edit()). Throws what `make` throws, and EditRefused as
  /// ComplexEdit::commit(); then nothing is changed. Cost: that of the cells touched.
  ComplexEditReport edit(const std::function<void(ComplexEdit&)>& make);
  /// Replaces the mesh by another one of the same dimension. It counts as an edit: every set of particles must then
  /// update_after_edit(). Each particle is located exactly among all cells of the new mesh, and keeps its position. One on a
  /// wall stays on its side. One that is in no free cell is orphaned. Nothing else follows: arrays at points, fields and
  /// tallies must be made anew, and a tally in use ends. Walls have no velocity across a replacement: particles meet
  /// them in their next step. A set that has not taken part in the last move cannot follow. Throws as the constructor, and
  /// InvalidArgument for a mesh of another dimension; then nothing is changed. Cost: that of the constructor, and of
  /// locate() for each particle.
  void replace(MeshData mesh);
  [[nodiscard]] std::uint64_t edit_count() const;
  /// The report of the last edit; empty if there was none.
  [[nodiscard]] const ComplexEditReport& last_edit() const;
  /// Makes a set of particles follow the last edit. Particles in cells that were replaced are located again, exactly,
  /// among the cells that replaced them. Those that have no place in a free cell are treated as `orphaned` says. All
  /// others keep their state bit for bit. If particles are absorbed, those after them move up, as by remove().
  ///
  /// Suppose that the edit was made after a move, and the particles have not been advanced since. Then the vertices
  /// first carry them along, as by advance() without a motion of their own. They have then taken part in the move. For
  /// the next advance() the walls are at rest, and targets are relative to positions() as they are now. Suppose that
  /// the edit was made before the last move. Then the particles follow it in the positions before that move, and await
  /// advance(), as after any move.
  ///
  /// Throws InvalidArgument, nothing changed, if the particles are of another environment, or missed a move or an
  /// earlier edit. Cost: the particles touched and the cells added; the first time after the particles have changed,
  /// linear in the particles (20 ns each). After a move that the particles have not followed: that of advance(), or,
  /// if the move came last, a copy of the complex.
  UpdateReport update_after_edit(Particles& particles, OrphanPolicy orphaned = OrphanPolicy::relocate) const;

  /// Advances every particle towards its target. After a move() the vertices also carry it along (docs/method.md).
  /// Without `respond` a particle stops at its first contact. Results are the same bits for any number of threads and
  /// any order of particles. Throws InvalidArgument, nothing changed, if a target is not finite or outside the exact
  /// range, or the sizes do not match. It does so, too, if an option is not positive, or the particles are of another
  /// environment or missed a move or an edit. And it throws what a response throws, and if a response returns a
  /// displacement that is not finite. If one leads out of the exact range, the particle stops at the wall: the report
  /// names it, and Counters::unfinished counts it. Cost: a few orientation tests per particle,
  /// whatever the size of the scene.
  StepReport advance(Particles& particles, std::span<const Vec3> targets, const ContactCallback& respond = {},
                     const StepOptions& options = {});

  /// Advances as advance(), but asks in rounds. Every particle stops at its next contact, and one call answers all of
  /// them. The particles then continue against the walls as these move in the step. Round k has the k-th contact of
  /// each particle that has so many. The rounds end when no particle has a contact to answer. So there are at most
  /// StepOptions::max_contacts rounds, and none if no particle meets a wall.
  ///
  /// Results are the bits of advance() with a ContactCallback that gives the same answers: states, and the whole report
  /// with all counts. An empty function stops particles as in advance(). Throws as advance(), nothing changed. Cost: that
  /// of advance(), and for each round some microseconds and a copy of the walls that its particles have met so far.
  StepReport advance_in_rounds(Particles& particles, std::span<const Vec3> targets, const RoundCallback& respond,
                               const StepOptions& options = {});

  /// Throws as advance() would for these particles and options, whatever the targets.
  void check_advance(const Particles& particles, const StepOptions& options, const char* caller = "advance") const;

  /// The steps that one particle would take to each of these targets in turn, with its crossings from cell to cell. The
  /// particle stays as it is. States and contacts are those of advance(), to the same bits. The traces end with the
  /// first target before which the particle is stopped or held. After a move() the vertices carry the particle along in
  /// the first step, as in the next advance(), and stand still in the others. Throws as advance(), and if there is
  /// no such particle. Cost: as one step for each target, and some exact determinants for each crossing.
  [[nodiscard]] std::vector<Trace> trace(const Particles& particles, std::size_t particle,
                                         std::span<const Vec3> targets, const ContactCallback& respond = {},
                                         const StepOptions& options = {}) const;

  /// Watches all later steps, by advance(), advance_in_rounds(), and SimultaneousStepper: after each, every particle is
  /// checked as by audit(). The hook gets the step of the first particle that fails, and any that throws InternalError,
  /// with the cells around. Write it to a file with write_replay() (dartcast/replay.hpp). An empty hook ends this.
  /// Results stay the same bits. Cost: some 1.3 us a particle and step.
  void set_replay_hook(ReplayHook hook);
  [[nodiscard]] const ReplayHook& replay_hook() const;
  /// The step that a particle would take to a target, as a replay. Throws as trace().
  [[nodiscard]] StepReplay record(const Particles& particles, std::size_t particle, const Vec3& target,
                                  const ContactCallback& respond = {}, const StepOptions& options = {}) const;

  /// Calls this at each periodic crossing in later steps by advance() and advance_in_rounds(). An empty one ends this.
  void set_crossing_callback(CrossingCallback crossed);

  /// Adds all later steps by advance() to a tally of complex(); null ends this. It must outlive its use, and follow each
  /// edit: advance() throws InvalidArgument if it has no place for a cell. `particles`: read in each advance(), which throws
  /// if it has values for more or fewer, or such as TalliedParticles does not allow.
  /// advance_in_rounds() with a response refuses to step then. States and reports stay the same bits. If a response
  /// throws, the tally is as before. Cost: a second walk for each step that leaves its simplex; and if a response may
  /// throw, a copy of the tally.
  void set_tally(CellTally* tally, const TalliedParticles& particles = {});
  [[nodiscard]] CellTally* tally() const;

  /// Checks every simplex of the scene; exact, parallel, streaming.
  [[nodiscard]] Validity validity(std::size_t max_count = 10) const;

  /// Whether the particles have not yet taken part in the last move(): the next advance() carries them along.
  [[nodiscard]] bool awaits_advance(const Particles& particles) const;

  /// Throws Error, nothing changed, as check_threads().
  void set_threads(Threads threads);
  [[nodiscard]] Threads threads() const;

 private:
  friend class PartEnvironment;
  friend class SimultaneousStepper;
  friend class SphereTally;
  friend std::unique_ptr<Environment> environment_as_it_is(const MeshData& mesh);
  using MakeDecider = std::function<std::unique_ptr<detail::StepDecider>(const ContactCallback&)>;
  StepReport advance_by(const MakeDecider& make, Particles& particles, std::span<const Vec3> targets,
                        const ContactCallback& respond, const StepOptions& options);

  detail::Tallied set_tallied(const detail::Tallied& tallied);  // returns the former one

  struct Members;  // src/environment/environment_members.hpp
  explicit Environment(std::unique_ptr<Members> members);
  std::unique_ptr<Members> members_;
};

}  // namespace dartcast
