// Solid bodies without a mesh: particles that a rest shape holds together, in an environment that may deform.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 7.4.
// Shapes: M. Mueller, B. Heidelberger, M. Teschner, M. Gross, "Meshless deformations based on shape matching",
// SIGGRAPH 2005.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/dynamics.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/response.hpp"
#include "dartcast/solids.hpp"

namespace dartcast {

// Samples of a surface: the particles of a body.
//
// Random candidates, one in each piece of a fine division, are taken in random order. A candidate is dropped if a
// sample is nearer than the spacing ("dart throwing": R. L. Cook, "Stochastic sampling in computer graphics", 1986; on
// meshes: D. Cline, S. Jeschke, K. White, A. Razdan, P. Wonka, "Dart throwing on surfaces", 2009). Every piece has a
// candidate, so the gaps between the samples are bounded, too.

/// Lengths in the surface's unit.
struct SamplingOptions {
  double spacing = 0.0;            ///< > 0: no two samples are nearer to each other
  std::uint64_t seed = 1;          ///< the same samples for the same seed, surface and spacing
  std::size_t max_count = 100000;  ///< the largest number of samples that the caller accepts
};

/// The largest distance to the nearest sample, in spacings. `surface_cover`: from a point of the surface.
/// `volume_cover`: from a point inside that is deeper under the surface than `cell_diagonal`. `solid_cover`: from any
/// point inside, if samples are taken on the surface, too. Each is 1, plus the size of the pieces that hold a
/// candidate each, plus a hundredth or less for rounding.
inline constexpr double surface_cover = 1.26;
inline constexpr double cell_diagonal = 0.8661;  // of candidates' cubes, of half a spacing: sqrt(3) / 2
inline constexpr double volume_cover = 1.8661;
inline constexpr double solid_cover = 2.1261;

/// Samples on a surface, closed or open; at least one. Throws InvalidArgument if the spacing is not positive and
/// finite, or below 2^-30 of the largest coordinate (samples would be rounding). Throws it, too, if the surface
/// needs more than `max_count` samples (or 200 candidates for each of these); the message says which spacing to choose.
/// Throws InvalidMesh if check_and_repair_surface() refuses the surface. Cost: 64 to 128 candidates per spacing^2 of
/// area, one per triangle at least.
std::vector<Vec3> sample_surface(const MeshData& surface, const SamplingOptions& options);

/// Samples strictly inside a closed surface. A body thinner than the spacing may have none. Throws as sample_surface(),
/// and InvalidMesh, which names an edge, if the surface is open. Cost: 8 candidates per spacing^3 of the surface's
/// box; one exact decision of inside for each candidate that is not near a sample.
std::vector<Vec3> sample_volume(const MeshData& surface, const SamplingOptions& options);

/// A whole body: samples on its surface (the first `on_surface`), then inside. No two are nearer than the spacing.
struct SolidSamples {
  std::vector<Vec3> points;
  std::size_t on_surface = 0;
};
/// Throws and costs as sample_surface() and sample_volume() together.
SolidSamples sample_solid(const MeshData& surface, const SamplingOptions& options);

// Bodies: their options, and the records of a step.

/// Share of itself by which rounding, and the error of Runge-Kutta's method while nothing is met, may raise a body's
/// energy in a step.
inline constexpr double energy_slack = 0x1p-30;

/// Contacts between bodies: impulses between particles of different bodies that touch as spheres.
struct BodyCollisionOptions {
  /// In [0, 1]. Bodies that hit each other faster than 2 |gravity| dt rebound as rigid bodies, with this share of the
  /// speed. None: their matching forces alone part them.
  std::optional<double> restitution = {};
  double friction = 0.0;  ///< >= 0
  unsigned iterations = 10;
  double position_correction = 0.2;  ///< share of an overlap taken out in one step, in [0, 1]
};

/// Contacts between bodies in one step.
struct BodyCollisionCounts {
  std::uint64_t pairs_near = 0;      ///< given to the solver
  std::uint64_t pairs_touching = 0;  ///< given an impulse
  std::uint64_t impacts = 0;         ///< pairs that came together fast; 0 without restitution
  std::uint64_t overlaps = 0;
  double deepest = 0.0;  ///< the deepest overlap, m
};

/// SI units.
struct BodiesOptions {
  double dt = 1e-3;  ///< of a step, between 2^-100 and 2^100
  Vec3 gravity = {0.0, 0.0, 0.0};
  double drag = 0.0;  ///< 1 / s, >= 0: all velocities fall as exp(-drag t), as in a resting medium
  /// Between bodies with radii. None: they pass through each other.
  std::optional<BodyCollisionOptions> collisions = {};
  StepOptions step = {};
};

/// How a body is matched with its rest shape.
struct MatchOptions {
  /// Share of the best linear transformation in the goals, in [0, 1]; the rest is that of the best rotation.
  double linear = 0.0;
  /// The linear transformation is scaled to keep the volume (if the body is squeezed below an eighth of it, as if it
  /// were an eighth).
  bool keep_volume = true;
  /// Regions of the rest shape that are matched separately, for softer bodies. A particle's goal is the mean over its
  /// regions. Let them overlap, or the body falls apart. Empty: one region of all particles.
  std::vector<std::vector<std::uint32_t>> clusters = {};
};

/// Regions for MatchOptions::clusters: cubes of edge `size` on a lattice of half that spacing, those that hold
/// points. Every point is in at most 8. Throws InvalidArgument if a point is not finite or the size is not positive.
/// It also throws if the size is so small that lattice numbers exceed 2^20. Cost: n log n.
std::vector<std::vector<std::uint32_t>> overlapping_clusters(std::span<const Vec3> points, double size);

/// Properties of one body. SI units.
struct BodyOptions {
  double mass = 1.0;                ///< is_mass(), in equal parts on the particles
  std::vector<double> masses = {};  ///< or of each particle; empty: `mass`
  /// Of each particle (is_radius()), for contacts with other bodies. Walls are met by the centres.
  double radius = 0.0;
  /// Acceleration towards the goal per distance from it, 1 / s^2: at most 1 / dt^2; 0: 1 / dt^2.
  double stiffness = 0.0;
  double pull = 0.1;           ///< share of the way to its goal that the second pass moves a particle, in [0, 1]
  double damping = 0.0;        ///< 1 / s: velocities relative to the rigid part of the motion fall as exp(-damping t)
  Vec3 velocity = {};          ///< of the centre of mass
  Vec3 angular_velocity = {};  ///< 1 / s
  MatchOptions match = {};
  /// A surface (or lines) at rest, in the place of the points at rest, that the particles carry. Its edges and triangles never
  /// cross a wall. Each of its points follows some 12 of the particles next to it. Empty: particles alone meet walls.
  SolidMesh surface = {};
};

/// The answer to a request to add a body.
struct AddBodyResult {
  std::uint32_t body = 0xffffffffU;    ///< its id; none (0xffffffff) if it has no room
  std::vector<std::uint32_t> refused;  ///< points in no free cell
  SolidPlacement surface;              ///< where all points are: why its surface has no room, if it has none
};

/// Mechanical energy in joules. The potential energy is 0 at one corner of the box around the environment's first
/// positions. It is the lowest corner, so that no part is negative there.
struct BodyEnergy {
  double kinetic = 0.0;
  double potential = 0.0;
  double matching = 0.0;  ///< stiffness * (constant + sum m |x - goal|^2 / 2), with the constant of the fits

  [[nodiscard]] double total() const { return (kinetic + potential) + matching; }
};

/// The rigid motion with the same momentum and angular momentum as some particles. SI units.
struct RigidMotion {
  double mass = 0.0;
  Vec3 centre;            ///< of mass
  Vec3 velocity;          ///< of the centre
  Vec3 angular_momentum;  ///< about the centre
  Vec3 angular_velocity;  ///< without a part about an axis that all mass lies on

  [[nodiscard]] Vec3 velocity_at(const Vec3& x) const { return velocity + cross(angular_velocity, x - centre); }
  /// Never more than the particles have. The difference is the energy of their velocities relative to this motion.
  [[nodiscard]] double kinetic_energy() const {
    return 0.5 * (mass * dot(velocity, velocity) + dot(angular_velocity, angular_momentum));
  }
};

/// How a region of the rest shape lies in space. A plain record.
struct Fit {
  Quaternion rotation;  ///< of length 1: the best one
  Vec3 centre;          ///< of the region's mass
  Mat3 transform;       ///< of rest positions relative to the rest centre of mass: goal = centre + transform * rest
  double strain = 0.0;  ///< part of the matching energy that the particles' positions do not change, per stiffness
};

/// Wall faces that a particle met last in a step.
struct TouchedFaces {
  std::array<CellFace, 3> face{};
  std::uint8_t count = 0;

  [[nodiscard]] bool has(CellFace f) const;
  /// Takes the faces of a contact, the first three at most.
  void set(std::span<const WallHit> walls);
};

/// Report of one step.
struct BodiesStep {
  StepReport motion;               ///< of the first pass; particles by their index during the step
  StepReport pull;                 ///< of the second pass
  BodyCollisionCounts collisions;  ///< between bodies
  /// Energy from moving walls and from apply_impulse(), J; below 0 if the latter took more than both gave.
  double input = 0.0;
  std::uint64_t fallbacks = 0;      ///< rotations left to Eigen's SVD
  std::uint64_t repeated = 0;       ///< bodies whose first pass was repeated with limited targets
  std::vector<std::uint32_t> gone;  ///< ids of bodies that left at an absorbing or escape wall
  /// Of surfaces with walls: those that changed the motion, by body. `solid` is the body's index during the step.
  std::vector<SolidContact> edges;
  std::vector<std::uint32_t> stuck;  ///< ids of bodies that stayed, as an edit made a wall in their surfaces
};

/// The state of all bodies after a step. The mesh, the options and the bodies' shapes are not in it.
struct BodiesCheckpoint {
  /// One particle of a body.
  struct Particle {
    ParticleState state;
    Weights held_weights{};
    Vec3 velocity;
    ParticleStatus fate = ParticleStatus::alive;
    TouchedFaces on;
  };
  std::uint64_t steps = 0;
  Counters counters;
  std::vector<std::uint32_t> ids;  ///< of the bodies still there
  std::vector<Fit> fits;           ///< body by body
  std::vector<CachedImpulse> impulses;
  std::vector<Particle> particles;
  SolidCheckpoint surfaces;
};

/// Many bodies in one set of particles.
///
/// A step, after the environment may have moved:
///  1. Motion. Runge-Kutta's method of order 4 gives velocities and positions under gravity and the matching forces;
///  each stage computes the fits anew. Environment::advance() then moves the particles there. A contact sees the
///  velocity of its moment. All incident walls answer at once, with friction (response/incident_walls.hpp). A wall
///  answers with restitution if two things hold. The particle was not on that face at the end of the last step. Two
///  steps of its acceleration do not explain its speed. The particle is then integrated for the rest of the step, along
///  the walls that it would enter.
///  2. Pull. The fits are computed again, and Environment::advance() moves the particles towards their goals. Positions
///  alone change. This takes out energy. The exact goal is the place of rest in the body. There the matching force is
///  in balance with the centrifugal force, or with gravity if the body has met a wall. Damping and drag act on
///  velocities between the passes.
///  3. Edges, for bodies with a surface. Its targets are where the particles carry it. SolidSet::advance() takes it there,
///  so that no edge and no triangle crosses a wall. If it meets walls, the particles give way, as far as walls and
///  energy let them, and lose the velocity towards these walls. There is no rebound from an edge.
/// StepOptions::max_contacts bounds the contacts of a particle in a pass.
///
/// Energy law: in a step the total energy of a body never grows by more than energy_slack of itself, plus
/// BodiesStep::input (docs/method.md gives the reason). Changes of velocities() between steps are not counted. The
/// total is the kinetic, the potential and the matching energy, none of them negative.
///
/// Walls answer by their patch's response: reflect, slide, stick (the particle stays on the wall). A body leaves as a
/// whole when a wall absorbs one of its particles or lets it escape, or its surface meets such a wall. A caller may change velocities() between steps.
/// Results are the same bits for any number of threads. A moved-from object has no bodies and can be used again.
class Bodies {
 public:
  using Checkpoint = BodiesCheckpoint;

  /// `environment` outlives the bodies. It may hold other sets of particles; its owner moves and edits it. Throws
  /// InvalidArgument if an option is out of range, or the environment is of the plane.
  Bodies(Environment& environment, const BodiesOptions& options, WallResponses responses = WallResponses{});
  ~Bodies();
  Bodies(const Bodies& other);
  Bodies(Bodies&& other);  // NOLINT(performance-noexcept-move-constructor): it gives the other one new members
  Bodies& operator=(const Bodies&) = delete;
  Bodies& operator=(Bodies&&) = delete;

  /// Adds a body whose rest shape is these points. Adds nothing if one of them is in no free cell, or its surface meets or
  /// encloses a wall.
  /// Throws InvalidArgument if an option is out of range; the message about a stiffness above 1 / dt^2 gives the
  /// largest dt. Throws it if there is no point, or a mass is not is_mass(). And if a cluster is empty, names a
  /// missing point or one twice, or leaves a point in none. Throws as Environment::add(); with a surface also as SolidSet::add(), and InvalidArgument if fewer
  /// than four points or points in a plane carry it.
  AddBodyResult add(std::span<const Vec3> points, const BodyOptions& options);

  /// One step; once after each move. Throws as Environment::advance(), and InvalidArgument if a body has a surface and
  /// missed a move. Cost: about 0.5 us per particle; for a surface 0.6 us per vertex, mean of a body that rests.
  const BodiesStep& step();

  /// Moves the environment straight to these positions of all the mesh's points. Cells carry particles and surfaces
  /// along. Surfaces that walls would run into give way. If they cannot, walls and surfaces stop at the same share of
  /// their ways, which is returned. Other particles must then be advanced, as after Environment::move(). Without any
  /// surface it is Environment::move(), and the owner may call that in its place. Throws as Environment::move(). Throws
  /// InvalidArgument if the bodies missed a move or an edit, or no step() came after the last move. Nothing is changed
  /// then.
  double move_with(std::span<const Vec3> positions);

  /// A body as a rigid one, with its velocity at the end of the next step if it has no contacts. Its inverse mass is
  /// 0 if a wall holds one of its particles. Cost: about 20 ns per particle.
  [[nodiscard]] RigidMover predicted_state(std::size_t body) const;
  /// Gives a body an impulse. `solved`: the predicted_state() after contacts with others than bodies changed it. In the
  /// next step forces make that change of momentum, and the body moves by the displacement in `solved`.
  /// BodiesStep::input counts the energy.
  void apply_impulse(std::size_t body, const RigidMover& solved);

  /// To be called after each edit of the environment. A body leaves if the edit absorbs one of its particles. One with a
  /// wall of the edit in its surface is stuck: it stays until a later edit frees it. Throws
  /// as Environment::update_after_edit(), and as SolidSet::update_after_edit().
  UpdateReport update_after_edit(OrphanPolicy orphaned = OrphanPolicy::relocate);

  [[nodiscard]] const Environment& environment() const;
  [[nodiscard]] const BodiesOptions& options() const;
  [[nodiscard]] std::uint64_t steps() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::uint32_t id(std::size_t body) const;
  /// The body's particles are [first_particle, first_particle + particle_count).
  [[nodiscard]] std::size_t first_particle(std::size_t body) const;
  [[nodiscard]] std::size_t particle_count(std::size_t body) const;
  /// One fit per region of its rest shape.
  [[nodiscard]] std::span<const Fit> fits(std::size_t body) const;
  [[nodiscard]] BodyEnergy energy(std::size_t body) const;
  [[nodiscard]] RigidMotion rigid_motion_of(std::size_t body) const;

  /// The points of its surface now. Empty without one.
  [[nodiscard]] std::span<const Vec3> surface(std::size_t body) const;
  /// As SolidSet::audit(), for all surfaces.
  [[nodiscard]] SolidAudit audit() const;

  // All particles, body by body.
  [[nodiscard]] const Particles& particles() const;
  [[nodiscard]] std::span<const Vec3> positions() const;
  [[nodiscard]] std::span<const Vec3> velocities() const;
  /// For impulses between steps.
  [[nodiscard]] std::span<Vec3> velocities();
  [[nodiscard]] std::span<const double> masses() const;
  [[nodiscard]] std::span<const double> radii() const;
  /// Index of the body of each particle.
  [[nodiscard]] std::span<const std::uint32_t> body_of() const;
  [[nodiscard]] std::span<const ParticleStatus> statuses() const;

  /// Sums over all steps and both passes. Each pass counts `steps` times particles.
  [[nodiscard]] const Counters& counters() const;
  /// The hash of all particles and points of surfaces in the scene, by body id and number in the body.
  [[nodiscard]] StateHash state_hash() const;

  /// The state now, for restore(). Cost: linear in the particles.
  [[nodiscard]] BodiesCheckpoint checkpoint() const;
  /// Goes on from a checkpoint, if the same bodies have been added to an environment in the same state as then.
  /// Every later step is the same to the last bit. Throws InvalidArgument, nothing changed, if bodies or sizes do
  /// not match, or as Environment::restored().
  void restore(const BodiesCheckpoint& saved);

 private:
  friend struct BodiesMoves;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The state of a body, and sums over its steps.
struct BodySummary {
  std::string name;
  std::size_t particles = 0;
  bool gone = false;  ///< it left at a wall; the fields below then say nothing
  Vec3 centre;
  BodyEnergy energy;
};

}  // namespace dartcast
