// The simulation: particles, spheres, bodies and catheters in an environment that may deform and be edited.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, sections 7.2 to 7.4.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/cell_tally.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/dynamics.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/forces.hpp"
#include "dartcast/ranks.hpp"
#include "dartcast/remeshing.hpp"
#include "dartcast/response.hpp"
#include "dartcast/solids.hpp"
#include "dartcast/spheres.hpp"
#include "dartcast/vector_field.hpp"

namespace dartcast {

struct AdaptiveSubdivisionReport;
struct AdaptiveSubdivisionScene;
struct BodyScene;
struct CatheterScene;
struct SolidScene;
struct Event;
struct EventLog;
struct ParticlesScene;
struct RemeshScene;
struct ResolvedScene;
struct Scene;
struct SimulationState;
struct Statistics;
struct StatisticsOptions;

/// The limits of a step's duration in seconds. Speeds and displacements then neither overflow nor vanish.
inline constexpr double smallest_dt = 0x1p-100;
inline constexpr double largest_dt = 0x1p+100;
/// The limits of the spheres' density.
inline constexpr double smallest_density = 0x1p-100;
inline constexpr double largest_density = 0x1p+100;

/// Between spheres, and between spheres and bodies. At walls, restitution and friction are those of the responses.
struct CollisionOptions {
  double restitution = 0.0;          ///< in [0, 1]
  double friction = 0.0;             ///< Coulomb, >= 0
  double density = 1000.0;           ///< kg / m^3; in the plane of a disc, kg / m^2
  unsigned iterations = 10;          ///< > 0, of the solver
  unsigned position_iterations = 4;  ///< of the correction of overlaps
};

/// How the velocity of particles without mass (a field, and no drag) makes the way of a step.
enum class Integrator : std::uint8_t {
  euler,  ///< by the field at the start of the step, or of each segment: of first order in dt
  /// The classical Runge-Kutta scheme of fourth order. Its four stages walk from the particle; past a wall the field at
  /// the contact counts. It needs a field, no drag, no collisions and one segment a step.
  rk4
};

/// How points move in a step in which the walls move, too.
enum class WallMotion : std::uint8_t {
  carried,  ///< the cells carry them along first; then they walk among walls at rest (Environment::advance())
  /// Both move at the same time (SimultaneousStepper). For points alone, without collisions, in steps of one segment.
  simultaneous
};

/// How ranks share a scene.
enum class Partition : std::uint8_t {
  particles,  ///< each has the whole environment, and some of the particles
  /// Each has a part of the environment, and the particles in it. Not all scenes can be shared so (docs/howto/clusters.md).
  cells
};

/// SI units: seconds, metres per square second, 1 / second.
struct SimulationOptions {
  double dt = 1e-3;  ///< of a step
  Vec3 gravity = {0.0, 0.0, 0.0};
  double drag = 0.0;         ///< >= 0: the velocity relaxes to the field's (to 0 without one) as exp(-drag t)
  ForceOptions forces = {};  ///< with terms: laws for particles of a size and mass; then drag is 0
  /// m^2 / s, >= 0: each segment adds a random way to each particle's, with the variance 2 D dt along each axis. Velocities
  /// do not have it. Random numbers depend on the seed, the particle's id and the step alone. Not with collisions.
  double diffusion = 0.0;
  /// Instead: the name of a value that a scene samples at points (MotionScene::sample), at least 0. Each way gets the drift
  /// grad D dt, so that a uniform cloud stays uniform.
  std::string diffusivity = {};
  bool brownian_bridge = false;  ///< walls that absorb, let stick or escape also count touches within diffusion's ways
  TurbulenceOptions turbulence = {};                         ///< it needs a field
  WallResponse response = {};                                ///< what happens at walls: Reflect{0.5}, Slide{}, ...
  std::map<std::string, WallResponse> patch_responses = {};  ///< at the walls of these patches, by name
  unsigned substeps = 1;  ///< > 0: a step's way is a polyline of so many segments; vertices move with the first one
  Integrator integrator = Integrator::euler;
  WallMotion wall_motion = WallMotion::carried;
  std::uint64_t seed = 1;  ///< for all that is random
  StepOptions step = {};
  /// With it spheres meet each other and bodies, and rest on each other and on walls. Without it they pass through.
  std::optional<CollisionOptions> collisions = {};
  /// Between bodies. Without it they pass through each other.
  std::optional<BodyCollisionOptions> body_collisions = BodyCollisionOptions{};
  /// Names of numbers that each particle carries for its user (Simulation::user_data()). Output writes an array of each
  /// name. A name is not empty, not used twice, and none that output uses itself (id, radius, velocity, ...). In
  /// statistics a particle counts as often as its number `number` says, rounded down, and at least once.
  std::vector<std::string> user_data = {};
  /// The processes that share the particles, by their ids (Simulation); none: this one has all. They outlive it.
  Ranks* ranks = nullptr;
};

/// A particle that left at a wall.
struct LeftParticle {
  std::uint64_t id = 0;
  ParticleStatus status = ParticleStatus::escaped;  ///< or absorbed
  Vec3 position;
  std::uint32_t contact = 0;  ///< its last contact: an index into those of the step
};

/// The results of one step. On rank 0 these are of all particles; on other ranks, of their own. In a scene whose
/// output needs no contacts (contacts, statistics, report) it has its own alone; LeftParticle::contact is none then.
struct SimulationStep {
  double duration = 0.0;  ///< s
  /// Of the particles; it names them by their index during the step, and those of another rank by none (0xffffffff).
  StepReport report;
  std::vector<std::uint64_t> contact_ids;  ///< the id of each contact's particle
  /// The source of the cell at each contact's first wall. Edits at the end of the step may have replaced the cell.
  std::vector<std::uint32_t> contact_sources;
  /// One of each contact, if the statistics have hits, and impacts or numbers of particles; else empty.
  std::vector<Parcel> parcels;
  std::uint64_t injected = 0;
  std::uint64_t absorbed = 0;  ///< by edits before this step, too
  std::uint64_t escaped = 0;
  std::vector<LeftParticle> left;       ///< by id; without those that edits absorbed
  CollisionCounts collisions;           ///< of spheres with each other
  std::vector<SphereOverlap> overlaps;  ///< of spheres with walls

  /// By particle, then by time. Entry i is of the particle contact_ids[i].
  [[nodiscard]] std::span<const Contact> contacts() const { return report.contacts.contacts; }
};

/// Sums over all steps so far. If ranks share the particles, each has its own, but those of `start` and `injected`.
struct SimulationTotals {
  std::uint64_t start = 0;  ///< particles added by add() and add_random()
  std::uint64_t injected = 0;
  std::uint64_t absorbed = 0;
  std::uint64_t escaped = 0;
  Counters counters;
  CollisionCounts collisions;
  std::uint64_t wall_overlaps = 0;
  double deepest_in_wall = 0.0;                   ///< the deepest of these
  std::vector<std::uint64_t> contacts_by_patch;   ///< by the number of the patch met first
  std::vector<std::uint64_t> deposited_by_patch;  ///< absorbed or stuck, by the patch of the last contact; not by edits
  std::vector<std::uint64_t> escaped_by_patch;    ///< likewise
  double seconds_detect = 0.0;                    ///< advancing particles, responses included
  double seconds_deform = 0.0;                    ///< computing and setting the vertices' positions
  double seconds_collide = 0.0;                   ///< pairs and impulses
  double seconds_respond = 0.0;  ///< injection, velocities and targets before the walk, statuses after it
};

/// All that a simulation goes on from after a step. It does not hold what the simulation was made with: environment,
/// options, deformation, field, inlets, bodies, ... Copies share one state.
class SimulationCheckpoint {
 public:
  explicit SimulationCheckpoint(SimulationState state);
  [[nodiscard]] std::uint64_t steps() const;
  [[nodiscard]] const SimulationState& state() const { return *state_; }  ///< simulation/simulation_state.hpp

 private:
  std::shared_ptr<const SimulationState> state_;
};

/// One checkpoint of those that the ranks of a simulation have saved after the same step. Else throws InvalidArgument.
SimulationCheckpoint joined(std::span<const SimulationCheckpoint> parts);

/// The energy of all particles. Without collisions particles have no mass: each counts as 1 kg. With collisions a
/// sphere counts by its mass. A point has no mass, and does not count.
struct SimulationEnergy {
  double kinetic = 0.0;    ///< J: the sum of m v^2 / 2
  double potential = 0.0;  ///< J: the sum of -m g.x, which is 0 at the origin
};

/// The effects of an edit between two steps.
struct SimulationEdit {
  ComplexEditReport edit;
  UpdateReport particles;
};

/// Runs any scene. Each step:
///  1. Events that are due edit the environment.
///  2. Inlets inject particles.
///  3. Vertices move.
///  4. Velocities change. Without a field, or with drag, dv/dt = g - drag (v - u) is solved exactly. g and u are those
///     at the start of the step or segment. Here g is gravity and the force's acceleration at the particle, and u is
///     the field's velocity there, or 0. With a field and no drag v = u, and g has no effect. Forces and laws
///     (dartcast/forces.hpp) act instead of drag, in two stages, of second order in dt.
///  5. Particles advance by v dt, wall responses included. Those absorbed or escaped leave.
///  6. Bodies step, then catheters. Statistics take what happened.
///  7. If it is due, invalid cells are remeshed and crowded cells are subdivided.
/// With collisions the vertices move after 4; velocities are those at the places before. Spheres get impulses before they
/// move and advance: from each other, from bodies and, at rest or among others, from walls within a quarter of their
/// radius that reflect or let slide. These go on as in the last step, and are contacts when a sphere comes to them. Other
/// walls respond as they do to points (docs/method.md). Results are the same bits for any number of threads.
/// In the plane every vector given to a simulation must have z = 0.
///
/// Ranks (SimulationOptions::ranks) share the particles. Each makes the same simulation with the same calls, and has the
/// particles of some ids. All else is repeated on each. Every call waits for the other ranks. Results are the same bits for
/// any number of them. Spheres that collide are refused. By cells (Partition) each has a part of the environment.
class Simulation {
 public:
  using AfterEdit = std::function<void(const Environment&)>;

  /// `environment` outlives the simulation, which alone moves and edits it. Throws InvalidArgument for a bad option.
  explicit Simulation(Environment& environment, const SimulationOptions& options = {});
  /// Makes the environment, and all that the scene has in it. The scene is plain data: files that it names have been
  /// read (load_scene_files() in dartcast/scene_file.hpp). Throws InvalidArgument if one has not been; InvalidMesh;
  /// Error that names the particles, body, catheter or event that cannot be used.
  explicit Simulation(const Scene& scene, Threads threads = {}, Ranks* ranks = nullptr,
                      Partition partition = Partition::particles);
  /// The same, but particles, bodies and catheters go on from a checkpoint of such a simulation. Throws as restore().
  /// `after_edit`: as set_after_edit(), for the edits that are made again, too.
  Simulation(const Scene& scene, const SimulationCheckpoint& saved, Threads threads = {}, AfterEdit after_edit = {},
             Ranks* ranks = nullptr, Partition partition = Partition::particles);
  Simulation(const Simulation&) = delete;  // nor moved: parts keep references to it
  Simulation& operator=(const Simulation&) = delete;
  ~Simulation();

  void set_field(VelocityField field);
  /// Accelerations of all particles (m / s^2), on top of gravity. They have no effect if there is a field and no drag.
  void set_force(VectorField force);
  /// Throws InvalidArgument if it is made for another number of points, and as Deformation::check_plane().
  void set_deformation(Deformation deformation);
  /// Calls this law in each stage of a step, twice, for all particles at once. It acts with the forces of the options, and
  /// needs no drag. Throws InvalidArgument as a simulation with forces would. If the law throws, or gives values that are not
  /// finite or a rate below 0, step() throws. The step is then not complete: go on from a checkpoint.
  void set_law(ParticleLaw law);
  /// Injects `rate` particles a second at random places of a patch, from the next step on. Throws as add(). Throws
  /// InvalidArgument if the patch has no face at a free cell, or the rate is negative or above 2^31 a step.
  void add_inlet(Patch patch, double rate, const Vec3& velocity, double radius = 0.0,
                 std::span<const double> user_data = {}, const Material& material = {});

  /// Adds particles at these positions, as Environment::add(). `radius`: as is_radius(). A sphere that does not fit is
  /// moved out of walls by its first step, and out of other spheres little by little. `user_data`: of each of these
  /// particles, a number for each name in the options; empty: zeros. `material`: forces need some of it. Throws
  /// InvalidArgument, nothing added, for a bad value.
  std::vector<AddResult> add(std::span<const Vec3> positions, const Vec3& velocity, double radius = 0.0,
                             std::span<const double> user_data = {}, const Material& material = {});
  std::vector<AddResult> add(std::initializer_list<Vec3> positions, const Vec3& velocity, double radius = 0.0);
  /// The same, with a velocity and a radius for each particle, and one material for all or one each. Throws if the numbers
  /// do not match, too.
  std::vector<AddResult> add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                             std::span<const double> radii, std::span<const double> user_data = {},
                             std::span<const Material> materials = {});
  /// Adds particles at random places of the free cells, uniformly by volume. Throws InvalidArgument if no cell is
  /// free or the count is beyond 2^31, or as add().
  void add_random(std::size_t count, const Vec3& velocity, double radius = 0.0, std::span<const double> user_data = {},
                  const Material& material = {});

  /// Adds a body of these particles, as Bodies::add(). Throws as that, and InvalidArgument if collisions have substeps.
  AddBodyResult add_body(std::span<const Vec3> points, const BodyOptions& options);
  /// Adds a group of particles or an inlet (dartcast/scene.hpp), as add(), add_random() and add_inlet(). Throws as these,
  /// and InvalidArgument, nothing added, if a member is out of range, or it needs a field and there is none.
  void add(const ParticlesScene& group);
  /// Adds a body or a catheter that is plain data. Throws Error that names it if it does not fit in.
  void add(const BodyScene& body);
  void add(const CatheterScene& catheter);
  /// Likewise a solid. From then on the solids move with the vertices of the environment, and can stop these.
  void add(const SolidScene& solid);

  /// Edits at given times, from now on; they replace those set before. Throws InvalidArgument if a time is negative
  /// or beyond 2^53 steps, or in the plane an event is not a ligature.
  void set_events(std::vector<Event> events);
  /// Checks cells, and remeshes those that are not valid, every so many steps.
  void set_remeshing(const RemeshScene& remeshing);
  /// Subdivides crowded cells every so many steps, and merges the parts again once they hold few particles. Throws
  /// InvalidArgument if an option is out of range, in the plane, and if cells are subdivided already.
  void set_adaptive_subdivision(const AdaptiveSubdivisionScene& subdivision);

  /// Keeps these statistics (dartcast/statistics.hpp) from now on; those kept before are dropped. A checkpoint holds
  /// them, too. Throws InvalidArgument, nothing changed, if an option is out of range.
  void set_statistics(const StatisticsOptions& options);

  /// Throws as Environment::advance(), and Error that names the event that cannot be carried out (Event::required). Throws
  /// as Deformation::load_frames(), nothing changed: the step may be repeated.
  const SimulationStep& step();

  /// Edits the environment between two steps, as Environment::edit(), and updates all that depends on it: particles
  /// (those absorbed count as such), bodies, catheters, the deformation, the field, and inlets. An inlet whose patch
  /// has no face at a free cell any more is closed until it has one. Throws as these, nothing changed. Cost: as these;
  /// linear in the cells if there are inlets.
  SimulationEdit edit(const std::function<void(ComplexEdit&)>& make, OrphanPolicy orphaned = OrphanPolicy::relocate);
  void set_after_edit(AfterEdit after_edit);  ///< called at the end of each edit
  /// Remeshes cells that are not valid now (dartcast/remeshing.hpp), by edit(). Nothing happens if all are. Cost: a
  /// check of all cells, and the regions repaired.
  RepairReport repair(const RepairOptions& options = {});
  /// Subdivides and merges cells now, as set_adaptive_subdivision() says, by edit().
  AdaptiveSubdivisionReport adapt();
  /// Pulls vertices along over the next `duration` seconds, on top of the deformation; they stay there. `displacement`:
  /// one per position of the environment. Throws as Deformation::add_pull(), and in the plane if one leaves it.
  void pull(std::span<const Vec3> displacement, double duration);
  /// Moves a catheter by hand: by this input in each step from the next on, in place of its scene's moves, until the next call.
  /// A checkpoint does not hold it. Throws as Catheter::step(), and InvalidArgument if there is no such catheter.
  void steer(std::size_t catheter, const CatheterInput& input);
  /// Likewise a solid: velocity in m / s, turn in rad / s, as those of SolidScene::Move. Throws InvalidArgument, nothing changed,
  /// if there is no such solid, a number is not finite, or it turns too far in a step (Simulation::add()).
  void steer_solid(std::size_t solid, const Vec3& velocity, const Vec3& turn = {});

  [[nodiscard]] SimulationCheckpoint checkpoint() const;  ///< each rank has its own; joined() makes them one
  /// Goes on from a checkpoint of a simulation made in the same way: every later step is then the same to the last bit. Repeats
  /// those edits by events that this simulation has not made yet. The caller makes other edits before (go_to()). Replaces all
  /// particles; vertices move to the checkpoint's time. Throws InvalidArgument if a state does not hold in this environment, and
  /// if edits must be repeated but there are particles. The particles are then unchanged; edits that it has repeated remain. Each
  /// rank takes its own particles out of a checkpoint, which any number of ranks has saved.
  void restore(const SimulationCheckpoint& saved);
  /// Moves the vertices to their positions after so many steps, to repeat edits there before restore(). Throws
  /// InvalidArgument if there are particles.
  void go_to(std::uint64_t steps);

  [[nodiscard]] const SimulationOptions& options() const;
  [[nodiscard]] double time() const { return static_cast<double>(steps()) * options().dt; }
  [[nodiscard]] std::uint64_t steps() const;
  [[nodiscard]] const Environment& environment() const;
  [[nodiscard]] bool deforms() const;
  void set_replay_hook(ReplayHook hook);  ///< Environment::set_replay_hook()

  // Particles in the scene; entry i of each belongs to the same particle. Ids persist, in the order of adding from 0.
  [[nodiscard]] const Particles& particles() const;
  [[nodiscard]] std::span<const std::uint64_t> ids() const;
  [[nodiscard]] std::span<const Vec3> velocities() const;
  [[nodiscard]] std::span<const ParticleStatus> statuses() const;
  [[nodiscard]] std::span<const std::uint32_t> contact_counts() const;  ///< they stop at 2^32 - 1
  [[nodiscard]] std::span<const double> radii() const;
  [[nodiscard]] std::span<const double> diameters() const;  ///< Material, as the two below
  [[nodiscard]] std::span<const double> densities() const;
  [[nodiscard]] std::span<const double> charges_per_mass() const;
  /// 1 for those that were held in the last step: they moved along with their cell instead of on their own.
  [[nodiscard]] std::span<const std::uint8_t> held() const;
  /// A number for each name in SimulationOptions::user_data. It stays with the particle. Precondition: there is one.
  [[nodiscard]] std::span<const double> user_data(std::size_t particle) const;
  [[nodiscard]] std::span<double> user_data(std::size_t particle);
  /// The places that particles would have without periodic pairs. The number image_A of their user data counts crossings of
  /// the pair of the patches A and B. Rotations about different lines must not be mixed: counts do not know their order.
  [[nodiscard]] std::vector<Vec3> unwrapped() const;

  /// None if no body has been added. Their velocities() may be changed between steps; the simulation calls step().
  [[nodiscard]] const Bodies* bodies() const;
  [[nodiscard]] Bodies* bodies();
  [[nodiscard]] const BodiesStep& bodies_step() const;  ///< the last one
  [[nodiscard]] std::size_t catheter_count() const;
  [[nodiscard]] const Catheter& catheter(std::size_t i) const;
  [[nodiscard]] const CatheterStep& catheter_step(std::size_t i) const;  ///< the last one

  [[nodiscard]] const SolidSet* solids() const;        ///< none if no solid has been added
  [[nodiscard]] const SolidStep& solids_step() const;  ///< the last one

  [[nodiscard]] const SimulationTotals& totals() const;
  /// The sums over all ranks that share the particles. Collective, and so is alive().
  [[nodiscard]] SimulationTotals totals_of_all() const;
  [[nodiscard]] std::uint64_t alive() const;  ///< the number of particles in the scene
  [[nodiscard]] const StatisticsOptions& statistics_options() const;
  [[nodiscard]] const Statistics& statistics() const;  ///< empty if none are kept
  /// The sums by cell of all ranks; none without StatisticsOptions::cells. Its steps are `dt / substeps` long. Cost: linear
  /// in the cells. Collective.
  [[nodiscard]] std::optional<CellTally> cell_tally() const;
  /// StatisticsOptions::cells as arrays of all cells, in the order of CombinatorialMap::cells(); for class k NAME_k.
  [[nodiscard]] std::vector<DataArray> cell_arrays(const CellTally& tally) const;
  [[nodiscard]] double seconds_solids() const;  ///< steps of bodies, catheters and solids so far
  [[nodiscard]] const EventLog& event_log() const;
  [[nodiscard]] std::vector<BodySummary> body_summaries() const;  ///< by id, those that left included
  [[nodiscard]] std::vector<CatheterSummary> catheter_summaries() const;
  [[nodiscard]] std::vector<SolidSummary> solid_summaries() const;
  /// At the particles' places and velocities now. The same bits for any threads and ranks. Cost: linear, parallel.
  [[nodiscard]] SimulationEnergy energy() const;
  [[nodiscard]] Audit audit() const;  ///< of all particles, those of bodies and catheters included
  /// The hash of every particle that there has been. Particles that left count with their last state.
  [[nodiscard]] StateHash state_hash() const;

  struct Parts;  ///< for the library: simulation/simulation_view.hpp shows them
  [[nodiscard]] const Parts& parts() const { return *parts_; }

 private:
  void build(ResolvedScene& scene);
  std::unique_ptr<Parts> parts_;
};

/// Adds particles at random points of the free cells, of equal likelihood by volume (in the plane by area). A particle's point
/// depends on the seed and its index in the set alone. An empty simulation of the same scene and seed adds the same ones. Throws
/// InvalidArgument, nothing added, if no cell is free or the count is beyond 2^31. So do particles of another environment, or
/// that have missed a move or an edit. Cost: linear in the cells, and about 1 us for each particle.
void add_random(Environment& environment, Particles& particles, std::size_t count, std::uint64_t seed = 1);

}  // namespace dartcast
