// The flow simulation: particles with velocities under gravity, drag or a velocity field, in an environment that may
// deform.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 7.2.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/remeshing.hpp"
#include "dartcast/response.hpp"
#include "dartcast/spheres.hpp"
#include "dartcast/velocity_field.hpp"
#include "dynamics/collider.hpp"
#include "dynamics/near_walls.hpp"
#include "simulation/seeding.hpp"
#include "simulation/sphere_bodies.hpp"

namespace dartcast {

class AdaptiveSubdivision;
struct AdaptiveSubdivisionReport;

/// The limits of a step's duration in seconds. Speeds and displacements then neither overflow nor vanish.
inline constexpr double smallest_dt = 0x1p-100;
inline constexpr double largest_dt = 0x1p+100;
/// The limits of the spheres' density.
inline constexpr double smallest_density = 0x1p-100;
inline constexpr double largest_density = 0x1p+100;

/// Between spheres. With walls, restitution and friction are those of the walls' responses.
struct CollisionOptions {
  double restitution = 0.0;          ///< in [0, 1]
  double friction = 0.0;             ///< Coulomb, >= 0
  double density = 1000.0;           ///< kg / m^3; in the plane of a disc, kg / m^2
  unsigned iterations = 10;          ///< > 0, of the solver (dynamics/contact_solver.hpp)
  unsigned position_iterations = 4;  ///< of what takes out overlaps
};

/// SI units: seconds, metres per square second, 1 / second.
struct SimulationOptions {
  double dt = 1e-3;  ///< of a step
  Vec3 gravity = {0.0, 0.0, 0.0};
  double drag = 0.0;       ///< >= 0: the velocity relaxes to the field's (to 0 without a field) as exp(-drag t)
  unsigned substeps = 1;   ///< > 0: a step's way is a polyline of so many segments; vertices move with the first one
  std::uint64_t seed = 1;  ///< for all that is random
  StepOptions step = {};
  /// With it spheres meet each other, and rest on each other and on walls; without they pass through each other.
  std::optional<CollisionOptions> collisions = {};
};

/// What happened in one step. `report.contacts` name particles by their index during the step; contact_ids are their
/// ids.
struct SimulationStep {
  double duration = 0.0;  ///< s
  StepReport report;
  std::vector<std::uint64_t> contact_ids;
  std::uint64_t injected = 0;
  std::uint64_t absorbed = 0;  ///< by edits before this step, too
  std::uint64_t escaped = 0;
  CollisionCounts collisions;           ///< of spheres with each other
  std::vector<SphereOverlap> overlaps;  ///< of spheres with walls
};

/// Sums over all steps so far.
struct SimulationTotals {
  std::uint64_t start = 0;  ///< particles added by add() and add_random()
  std::uint64_t injected = 0;
  std::uint64_t absorbed = 0;
  std::uint64_t escaped = 0;
  Counters counters;
  CollisionCounts collisions;
  std::uint64_t wall_overlaps = 0;
  double deepest_in_wall = 0.0;                  ///< of these
  std::vector<std::uint64_t> contacts_by_patch;  ///< by the number of the patch met first
  double seconds_detect = 0.0;                   ///< advancing particles, responses included
  double seconds_deform = 0.0;                   ///< computing and setting the vertices' positions
  double seconds_collide = 0.0;                  ///< pairs and impulses
  double seconds_respond = 0.0;                  ///< injecting, velocities and targets before, fates after
};

/// All that a flow goes on from after a step; what it was made with (mesh, options, field, inlets, ...) is not in it.
struct SimulationCheckpoint {
  struct Particle {
    std::uint64_t id = 0;
    ParticleState state;
    Weights held_weights{};
    Vec3 velocity;
    ParticleStatus fate = ParticleStatus::alive;
    std::uint32_t contacts = 0;
    double radius = 0.0;
  };
  std::uint64_t steps = 0;
  std::uint64_t next_id = 0;
  Random random = Random(0);
  std::vector<Particle> particles;
  SimulationTotals totals;
  StateHash gone;
  std::vector<CachedImpulse> impulses;  ///< that the next step's collisions start from
};

/// Of all particles. Without collisions particles have no mass: each counts as 1 kg. With them a sphere counts by its
/// mass, and a point, which has none, not at all.
struct SimulationEnergy {
  double kinetic = 0.0;    ///< J: the sum of m v^2 / 2
  double potential = 0.0;  ///< J: the sum of -m g.x, which is 0 at the origin
};

/// What an edit between two steps did.
struct SimulationEdit {
  ComplexEditReport edit;
  UpdateReport particles;
};

/// Carries particles through the steps of a simulation. Each step:
///  1. inlets inject; 2. vertices move; 3. velocities change: without a field, and with drag, dv/dt = gravity - drag (v
///  - u) is solved exactly for constant u (the field's velocity at the particle, or 0); with a field and no drag v = u,
///  and gravity is without effect; 4. particles advance by v dt, wall responses included; 5. those absorbed or escaped
///  leave.
/// With collisions the vertices move after 3 (velocities are those at the places before), and spheres are given
/// impulses before they move and advance: by each other, and by walls that reflect or let slide within a quarter of
/// their radius (these walls go on as in the last step). Walls met otherwise respond as they do to points. Bodies that
/// it is told of take part in these collisions. Results are the same bits for any number of threads.
class Simulation {
 public:
  /// `environment` outlives the flow, and is moved and edited by it alone. Throws InvalidArgument where an option is
  /// out of range. In the plane every vector given to a flow must have z = 0: gravity, velocities, fields, motions.
  Simulation(Environment& environment, const SimulationOptions& options, WallResponses responses = WallResponses{});
  Simulation(const Simulation&) = delete;  // nor moved: others keep references to it
  Simulation& operator=(const Simulation&) = delete;

  void set_field(VelocityField field) { field_ = std::move(field); }
  /// Throws InvalidArgument where it is not made for the environment's number of points, and in the plane as
  /// Deformation::check_plane().
  void set_deformation(Deformation deformation);
  /// Bodies that the spheres meet, with the options of CollisionOptions, where it has collisions; they outlive its
  /// last step. Their step() follows each of the flow's. Throws InvalidArgument where substeps are not 1, the
  /// bodies' steps are of another duration, or they are in another environment.
  void set_bodies(Bodies& bodies);
  /// Injects `rate` particles a second at random places of a patch, from the first step on. Throws InvalidArgument
  /// where the patch has no face at a free cell, the rate is negative or more than 2^31 particles a step, or the radius
  /// is out of range.
  void add_inlet(Patch patch, double rate, const Vec3& velocity, double radius = 0.0);

  /// Adds particles at these positions, as Environment::add(). `radius`: as is_radius(); a sphere that does not fit is
  /// moved out of walls by its first step, and out of other spheres little by little.
  std::vector<AddResult> add(std::span<const Vec3> positions, const Vec3& velocity, double radius = 0.0);
  /// Likewise, each with a velocity and a radius of its own. Throws InvalidArgument, nothing added, where the numbers
  /// do not match, too.
  std::vector<AddResult> add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                             std::span<const double> radii);
  /// Adds particles at random places of the free cells, uniformly by volume. Throws InvalidArgument where no cell is
  /// free.
  void add_random(std::size_t count, const Vec3& velocity, double radius = 0.0);

  const SimulationStep& step();

  /// Edits the environment between two steps, as Environment::edit(), and takes along all that depends on it: particles
  /// (by update_after_edit(); those absorbed count as such), the deformation, the field, and inlets: one whose patch
  /// has no face at a free cell any more is closed until it has. Throws as these, nothing changed. Cost: as these;
  /// linear in the cells where there are inlets.
  SimulationEdit edit(const std::function<void(ComplexEdit&)>& make, OrphanPolicy orphaned = OrphanPolicy::relocate);
  /// To be called at the end of each edit, with what becomes of particles that have no place: for other sets of
  /// particles in the environment, which must follow it before the next.
  void set_after_edit(std::function<void(OrphanPolicy)> after_edit) { after_edit_ = std::move(after_edit); }
  /// Remeshes cells that are not valid now (dartcast/remeshing.hpp), by edit(). Nothing happens where all are. Cost: a
  /// check of the scene, and the regions mended.
  RepairReport repair(const RepairOptions& options = {});
  /// Subdivides cells that hold many particles, and makes again those whose parts hold few, by edit().
  /// `adaptive_subdivision` keeps what it has subdivided; after other edits of the environment call its
  /// update_after_edit(). Cost: see AdaptiveSubdivision::adapt().
  AdaptiveSubdivisionReport adapt(AdaptiveSubdivision& adaptive_subdivision,
                                  OrphanPolicy orphaned = OrphanPolicy::relocate);
  /// Draws vertices along over the next `duration` seconds, on top of the deformation; they stay there. `displacement`:
  /// one per position of the environment. Throws as Deformation::add_pull(), and in the plane where one leaves it.
  void pull(std::span<const Vec3> displacement, double duration);

  [[nodiscard]] SimulationCheckpoint checkpoint() const;
  /// Goes on from a checkpoint of a flow made with the same environment, options, deformation, field, inlets, and edits
  /// (see go_to()): every later step is then the same to the last bit. Replaces all particles; vertices move to the
  /// checkpoint's time. Throws InvalidArgument, the particles unchanged, where a state does not hold in this
  /// environment.
  void restore(const SimulationCheckpoint& saved);
  /// Brings the vertices to where they are after so many steps, to make edits there again before restore(). Throws
  /// InvalidArgument where there are particles.
  void go_to(std::uint64_t steps);

  [[nodiscard]] double time() const { return static_cast<double>(steps_) * options_.dt; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] const Environment& environment() const { return environment_; }
  [[nodiscard]] bool deforms() const { return deformation_.has_value(); }

  // Particles in the scene; entry i of each belongs to the same particle. Ids persist, in the order of adding from 0.
  [[nodiscard]] const Particles& particles() const { return particles_; }
  [[nodiscard]] std::span<const std::uint64_t> ids() const { return ids_; }
  [[nodiscard]] std::span<const Vec3> velocities() const { return velocities_; }
  [[nodiscard]] std::span<const ParticleStatus> fates() const { return fates_; }
  [[nodiscard]] std::span<const std::uint32_t> contact_counts() const { return contact_counts_; }
  [[nodiscard]] std::span<const double> radii() const { return radii_; }
  /// 1 for those that were held in the last step: they rode along with their cell instead of moving on their own.
  [[nodiscard]] std::span<const std::uint8_t> held() const { return held_; }

  [[nodiscard]] const Collider& collider() const { return collider_; }

  [[nodiscard]] const SimulationTotals& totals() const { return totals_; }
  /// At the particles' places and velocities now. The same bits for any number of threads. Cost: linear, parallel.
  [[nodiscard]] SimulationEnergy energy() const;
  /// Of every particle that there has been: those that left count with their last state.
  [[nodiscard]] StateHash state_hash() const;

 private:
  struct Inlet {
    Patch patch;
    std::optional<PatchSampler> sampler;  // none while it is closed
    double rate;
    Vec3 velocity;
    double radius;
  };
  struct Aim {
    Vec3 velocity;
    Vec3 target;
  };

  void inject();
  void check_motion(const Vec3& velocity, double radius, std::string_view whose) const;
  void move_vertices();
  void stand_at(std::uint64_t steps);
  void move_vertices_to(std::uint64_t steps);
  void advance_segment(unsigned segment);
  void aim(double dt, bool moving);
  [[nodiscard]] Aim aim_at(std::size_t i, double dt, bool moving) const;
  [[nodiscard]] Vec3 accelerated(const Vec3& v, const Vec3& flow, double dt) const;
  [[nodiscard]] Acceleration acceleration(double dt) const;
  void count_contacts();
  void mark_held();
  void remove_absorbed(const UpdateReport& report, std::span<const ParticleState> before);
  void remove_marked(std::span<const std::uint8_t> marks);
  void complete(const Vec3& velocity, double radius);
  void complete_next(const Vec3& velocity, double radius);
  void count_spheres();
  // With collisions, in flow_collide.cpp.
  [[nodiscard]] bool collides() const { return options_.collisions && spheres_ > 0; }
  [[nodiscard]] double mass(std::size_t i) const;
  [[nodiscard]] bool meets_bodies() const { return bodies_ != nullptr && bodies_->size() > 0; }
  void collide(double dt, bool moving);
  void weigh();
  void find_walls(double dt, bool moving);
  [[nodiscard]] double clearance(std::size_t i) const;
  void walls_of(std::size_t i, double dt, bool moving, NearWalls& near, std::vector<WallContact>& found);
  void aim_stuck(double dt);
  void reopen_inlets();
  void remove_gone();
  template <class Sampler>
  void add_sampled(const Sampler& sampler, std::size_t count, const Vec3& velocity, double radius);

  Environment& environment_;
  SimulationOptions options_;
  WallResponses responses_;
  std::optional<VelocityField> field_;
  std::optional<Deformation> deformation_;
  std::vector<Inlet> inlets_;
  std::function<void(OrphanPolicy)> after_edit_;
  Random random_;

  Particles particles_;
  std::vector<std::uint64_t> ids_;
  std::vector<Vec3> velocities_;
  std::vector<ParticleStatus> fates_;
  std::vector<std::uint32_t> contact_counts_;
  std::vector<double> radii_;
  std::vector<std::uint8_t> held_;
  std::size_t spheres_ = 0;  // of a radius above 0
  std::vector<Vec3> targets_;
  SphereStepper stepper_;
  Collider collider_;
  Bodies* bodies_ = nullptr;
  SphereBodyCollider body_collider_;  // in place of the other one while there are bodies
  std::vector<double> met_radii_;     // in collisions: 0 for those that meet nobody
  std::vector<double> inverse_masses_;
  struct Clear {  // no wall is nearer to this place
    Vec3 centre;
    double distance = 0.0;
  };
  std::vector<Clear> clear_;  // by particle; until walls move or are edited
  std::vector<double> clearances_;
  std::vector<Vec3> displacements_;
  std::vector<NearWalls> near_;  // by chunk
  std::vector<std::vector<WallContact>> near_contacts_;
  std::vector<WallContact> walls_;
  std::uint64_t next_id_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t absorbed_between_ = 0;  // by edits since the last step
  SimulationStep last_;
  SimulationTotals totals_;
  StateHash gone_;
};

}  // namespace dartcast
