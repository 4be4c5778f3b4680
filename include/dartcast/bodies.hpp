// Solid bodies without a mesh: particles that a rest shape holds together, in an environment that may deform.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009, section 7.4.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bodies/body_collisions.hpp"
#include "bodies/body_contact.hpp"
#include "bodies/body_motion.hpp"
#include "bodies/body_rebound.hpp"
#include "bodies/shape_matching.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/response.hpp"
#include "dartcast/threads.hpp"
#include "dynamics/rigid_solver.hpp"

namespace dartcast {

/// Share of itself by which rounding, and the error of Runge-Kutta's method while nothing is met, may raise a body's
/// energy in a step.
inline constexpr double energy_slack = 0x1p-30;

/// SI units.
struct BodiesOptions {
  double dt = 1e-3;  ///< of a step, between 2^-100 and 2^100
  Vec3 gravity = {0.0, 0.0, 0.0};
  double drag = 0.0;  ///< 1 / s, >= 0: all velocities fall as exp(-drag t), as in a resting medium
  std::optional<BodyCollisionOptions> collisions =
      {};  ///< between bodies with radii; none: they pass through each other
  StepOptions step = {};
};

/// What a body is made of. SI units.
struct BodyOptions {
  double mass = 1.0;                ///< as is_mass(), in equal parts on the particles
  std::vector<double> masses = {};  ///< or of each particle; empty: `mass`
  /// Of each particle (is_radius()), for contacts with other bodies; walls are met by the centres.
  double radius = 0.0;
  /// Acceleration towards the goal per distance from it, 1 / s^2: at most 1 / dt^2; 0: just that.
  double stiffness = 0.0;
  double pull = 0.1;           ///< share of the way to its goal that the second pass pulls a particle, in [0, 1]
  double damping = 0.0;        ///< 1 / s: velocities relative to the rigid part of the motion fall as exp(-damping t)
  Vec3 velocity = {};          ///< of the centre of mass
  Vec3 angular_velocity = {};  ///< angular velocity, 1 / s
  MatchOptions match = {};
};

/// What came of a request to add a body.
struct AddBodyResult {
  std::uint32_t body = 0xffffffffU;    ///< its id; none (0xffffffff) where a point is in no free cell
  std::vector<std::uint32_t> refused;  ///< those points
};

/// Mechanical energy in joules. Potential: counted from the corner of the box around the environment's first positions
/// where it is least, so that no part is negative there.
struct BodyEnergy {
  double kinetic = 0.0;
  double potential = 0.0;
  double matching = 0.0;  ///< stiffness * (constant + sum m |x - goal|^2 / 2); see RestShape

  [[nodiscard]] double total() const { return (kinetic + potential) + matching; }
};

/// What happened in one step.
struct BodiesStep {
  StepReport motion;               ///< of the first pass; particles by their index during the step
  StepReport pull;                 ///< of the second pass
  BodyCollisionCounts collisions;  ///< between bodies
  /// Energy that moving walls and apply_impulse() gave, J; less than 0 where the latter took more. 0 where neither was
  /// there.
  double input = 0.0;
  std::uint64_t fallbacks = 0;      ///< rotations left to Eigen's SVD
  std::uint64_t repeated = 0;       ///< bodies whose first pass was repeated with limited targets
  std::vector<std::uint32_t> gone;  ///< ids of bodies that left at an absorbing or escape wall
};

/// Many bodies in one set of particles.
///
/// A step, after the environment may have moved:
///  1. Velocities and places by Runge-Kutta's method of order 4 under gravity and the matching forces, the fits
///  computed anew at each stage. Particles then go there by Environment::advance(). At a contact the velocity is that
///  of the moment; all incident walls at once turn it round with restitution (bouncing: the particle was not on that
///  face at the end of the last step, and comes faster than the acceleration makes it in two steps) or without
///  (sliding), and with friction (response/incident_walls.hpp); then the particle is integrated for the time left,
///  which goes along the walls that it would enter, with friction.
///  2. The fits are computed again, and particles are pulled towards their goals, by Environment::advance() again: by
///  places only, so that it takes out energy. To be exact they are pulled to where they would be at rest in the body:
///  where the matching force is in balance with the centrifugal one, or with gravity where the body has met a wall.
///  Damping and drag act on velocities between the passes.
/// The number of contacts in a pass is bounded by StepOptions::max_contacts.
///
/// Energy law: the total energy of a body never grows in a step by more than energy_slack of itself, plus
/// BodiesStep::input (docs/method.md says why); changes of velocities() between steps apart. The total is the kinetic,
/// the potential and the matching energy, none of them negative.
///
/// Walls answer by their patch's Response: reflect, slide, stick (the particle stays on the wall). A body leaves as a
/// whole when a wall absorbs one of its particles or lets it escape. Whatever else acts on bodies may change
/// velocities() between steps. Results are the same bits for any number of threads. A moved-from object has no bodies.
class Bodies {
 public:
  /// `environment` outlives the bodies; it may hold other sets of particles, and is moved and edited by its owner.
  /// Throws InvalidArgument where an option is out of range, or the environment is of the plane.
  Bodies(Environment& environment, const BodiesOptions& options, WallResponses responses = WallResponses{});

  /// Adds a body in its rest shape at these points; where one of them is in no free cell, nothing. Throws
  /// InvalidArgument where an option is out of range (a stiffness above 1 / dt^2 is: with the largest dt for it), or as
  /// RestShape and Environment::add().
  AddBodyResult add(std::span<const Vec3> points, const BodyOptions& options);

  /// One step; once after each Environment::move(). Throws as Environment::advance(). Cost: about 0.5 us per particle.
  const BodiesStep& step();

  /// A body as a rigid one, with its velocity at the end of the next step if it meets nothing; it cannot be pushed
  /// where a wall holds one of its particles. Cost: about 20 ns per particle.
  [[nodiscard]] RigidMover predicted_state(std::size_t body) const;
  /// What contacts with others than bodies made of predicted_state(): forces in the next step lead to that change of
  /// momentum, and the body goes as far as was answered. What this gives is BodiesStep::input.
  void apply_impulse(std::size_t body, const RigidMover& solved);

  /// Takes the bodies along after an edit of the environment. A body of which the edit absorbs a particle leaves.
  /// Throws as Environment::update_after_edit().
  UpdateReport update_after_edit(OrphanPolicy orphaned = OrphanPolicy::relocate);

  [[nodiscard]] const Environment& environment() const { return environment_; }
  [[nodiscard]] const BodiesOptions& options() const { return options_; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] std::size_t size() const { return bodies_.size(); }
  [[nodiscard]] std::uint32_t id(std::size_t body) const { return bodies_[body].id; }
  /// Its particles are [first_particle, first_particle + particle_count).
  [[nodiscard]] std::size_t first_particle(std::size_t body) const { return bodies_[body].first; }
  [[nodiscard]] std::size_t particle_count(std::size_t body) const { return bodies_[body].shape.size(); }
  [[nodiscard]] const RestShape& shape(std::size_t body) const { return bodies_[body].shape; }
  [[nodiscard]] std::span<const Fit> fits(std::size_t body) const { return bodies_[body].fits; }
  [[nodiscard]] BodyEnergy energy(std::size_t body) const;
  [[nodiscard]] RigidMotion rigid_motion_of(std::size_t body) const;

  // Of all particles, body by body.
  [[nodiscard]] const Particles& particles() const { return particles_; }
  [[nodiscard]] std::span<const Vec3> positions() const { return positions_; }
  [[nodiscard]] std::span<const Vec3> velocities() const { return velocities_; }
  /// For impulses between steps.
  [[nodiscard]] std::span<Vec3> velocities() { return velocities_; }
  [[nodiscard]] std::span<const double> masses() const { return masses_; }
  [[nodiscard]] std::span<const double> radii() const { return radii_; }
  /// Index of the body of each particle.
  [[nodiscard]] std::span<const std::uint32_t> body_of() const { return body_of_; }
  [[nodiscard]] std::span<const ParticleStatus> fates() const { return fates_; }

  /// Sums over all steps, both passes; `steps` times particles are counted once for each pass.
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Of all particles in the scene, by body id and number in the body.
  [[nodiscard]] StateHash state_hash() const;

  /// All that the bodies go on from after a step; what they were made with is not in it.
  struct Checkpoint {
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
  };
  [[nodiscard]] Checkpoint checkpoint() const;
  /// Goes on from a checkpoint, where the same bodies have been added to an environment that stands as it did then.
  /// Every later step is then the same to the last bit. Throws InvalidArgument, nothing changed, where bodies or sizes
  /// do not match, or as Environment::restored().
  void restore(const Checkpoint& saved);

 private:
  struct Body {
    std::uint32_t id;
    std::size_t first;
    RestShape shape;
    double stiffness;
    double pull;
    double kept;  // share of velocities relative to the rigid motion that a step keeps
    std::vector<Fit> fits;
    double constant = 0.0;  // of the energy for `fits`

    // Of one step.
    std::vector<Fit> trial = {};  // of a stage, or not accepted yet
    double trial_constant = 0.0;
    double budget = 0.0;     // total energy that it may have
    double before = 0.0;     // total energy at the begin
    double moving = 0.0;     // what it needs for motion
    double input = 0.0;      // from walls that move
    double work = 0.0;       // of other bodies
    double allowed = 0.0;    // of both, what is left for motion
    RigidMotion rigid = {};  // after the first pass
    unsigned fallbacks = 0;
    bool accepted = false;  // the trial fits
    bool pays = false;      // for its places
    bool limited = false;   // targets of the first pass
    bool met = false;       // a wall
    bool slides = false;    // in the second pass
    bool pushed = false;    // off other bodies, there
    bool collided = false;  // with another body
    BodyAction action = {};
    double lift = 0.0;  // of the displacement in it: what the wells would take for it, at most

    [[nodiscard]] bool changes() const { return pull > 0.0 || kept < 1.0 || pushed; }  // in the second pass
  };

  void check(const BodyOptions& options) const;
  void resize_arrays(double radius);
  // Handed to threads in groups of about so many particles.
  static constexpr std::size_t particles_in_group = 2048;
  template <class Work>
  void for_each_body(const Work& work) {
    const std::size_t share = bodies_.size() * particles_in_group / std::max<std::size_t>(positions_.size(), 1);
    parallel_for(bodies_.size(), std::max<std::size_t>(share, 1), environment_.threads(),
                 [&](std::size_t first, std::size_t end) {
                   for (std::size_t b = first; b < end; ++b) work(bodies_[b]);
                 });
  }
  template <class T>
  [[nodiscard]] std::span<T> of(const Body& body, std::vector<T>& values) const {
    return std::span<T>(values).subspan(body.first, body.shape.size());
  }
  [[nodiscard]] double potential(const Body& body, std::span<const Vec3> positions) const;
  [[nodiscard]] double kinetic(const Body& body) const;

  void first_pass();
  void begin(Body& body);
  // What a particle moves in during the first pass.
  [[nodiscard]] PotentialEnergy potential_of(const Body& body, std::size_t particle) const {
    return {body.stiffness, goals_[particle], options_.gravity + contact_forces_[particle]};
  }
  [[nodiscard]] BodyParticles body_particles() const;
  [[nodiscard]] RigidMover as_rigid(std::size_t body) const;
  void find_pairs();
  std::uint64_t rebound();
  void spread_action(const Body& body);
  [[nodiscard]] double action_work(const Body& body) const;
  void collide();
  void integrate(Body& body);
  void set_legs(Body& body);
  void limit_targets(const Body& body);
  void stay(const Body& body);
  void hold_stuck();
  StepReport advance(bool pulls);
  void measure();
  [[nodiscard]] double given(const Body& body) const;
  void fit(Body& body);
  void accept(Body& body);
  void limit_energy(Body& body);
  void second_pass();
  void share_energy();
  [[nodiscard]] bool lacks_motion(const Body& body);
  void limit_energy_together();
  void cut_together(std::span<const std::uint32_t> group);
  void aim_pull(Body& body);
  static void charge_lift(Body& body);
  void damp(Body& body);
  void remove_gone();
  void remove_bodies(std::span<const std::uint8_t> leaving);

  Environment& environment_;
  BodiesOptions options_;
  WallResponses responses_;
  Vec3 lowest_;
  std::uint64_t steps_ = 0;
  std::uint32_t next_id_ = 0;
  Counters counters_;
  BodiesStep last_;

  std::vector<Body> bodies_;
  Particles particles_;
  // One entry per particle in each.
  std::vector<Vec3> positions_;
  std::vector<Vec3> velocities_;
  std::vector<double> masses_;
  std::vector<double> radii_;
  std::vector<std::uint32_t> body_of_;
  std::vector<ParticleStatus> fates_;
  std::vector<TouchedFaces> on_;  // faces met in the last step
  // Of one step.
  struct Sums {
    Vec3 earlier;  // acceleration of the stage before the last one
    Vec3 last;
    Vec3 way;    // sum of accelerations, for the place
    Vec3 speed;  // for the velocity
  };
  std::vector<Sums> sums_;
  std::vector<Vec3> goals_;  // of the fits at the begin of the pass
  std::vector<Vec3> trial_goals_;
  std::vector<Vec3> targets_;
  std::vector<Vec3> reached_;
  std::vector<Leg> legs_;
  // Of collisions.
  BodyCollisions collisions_;
  BodyRebounds rebounds_;
  std::vector<RigidMover> movers_;
  std::vector<std::uint64_t> ids_;
  std::vector<double> inverse_masses_;
  std::vector<Vec3> led_to_;  // velocities that forces lead to
  std::vector<Vec3> corrections_;
  std::vector<Vec3> outer_forces_;    // of what acts on bodies from outside in this step, per mass
  std::vector<Vec3> contact_forces_;  // with those between bodies
  std::vector<TouchedFaces> next_on_;
  std::vector<PassBody> pass_bodies_;
};

}  // namespace dartcast
