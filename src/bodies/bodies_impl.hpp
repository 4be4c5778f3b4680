// The members of Bodies, and the functions of its step.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/parallel.hpp"
#include "bodies/body_collisions.hpp"
#include "bodies/body_contact.hpp"
#include "bodies/body_motion.hpp"
#include "bodies/body_rebound.hpp"
#include "bodies/body_surfaces.hpp"
#include "bodies/carried_surface.hpp"
#include "bodies/shape_matching.hpp"
#include "dartcast/bodies.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

struct Bodies::Impl final : MovePartner {
  struct Body {
    std::uint32_t id;
    std::size_t first;  // particle
    RestShape shape;
    double stiffness;
    double pull;
    double kept;  // share of velocities relative to the rigid motion that a step keeps
    std::vector<Fit> fits;
    double constant = 0.0;                       // of the energy for `fits`
    std::optional<CarriedSurface> carried = {};  // how its surface follows the particles; none without edges

    // Scratch of one step.
    std::vector<Fit> trial = {};  // fits of a stage, or not accepted yet
    double trial_constant = 0.0;
    double budget = 0.0;     // total energy that the body may have
    double before = 0.0;     // total energy at the start
    double moving = 0.0;     // kinetic energy of its motion
    double input = 0.0;      // energy from moving walls and apply_impulse()
    double work = 0.0;       // work of other bodies on it
    double allowed = 0.0;    // part of the budget that remains for motion
    RigidMotion rigid = {};  // after the first pass
    unsigned fallbacks = 0;
    bool accepted = false;  // the trial fits become the fits
    bool pays = false;      // its energy covers the positions of its particles
    bool limited = false;   // the first pass limits its targets
    bool met = false;       // a particle met a wall
    bool slides = false;    // in the second pass
    bool pushed = false;    // the second pass moves it off other bodies
    bool collided = false;  // another body gave it an impulse
    BodyAction action = {};
    double lift = 0.0;  // potential energy that the displacement in `action` may need, at most

    // Whether the second pass changes anything.
    [[nodiscard]] bool changes() const { return pull > 0.0 || kept < 1.0 || pushed; }
  };

  Impl(Environment& environment, const BodiesOptions& options, WallResponses responses);

  // bodies_impl.cpp: bodies that come and go, and their state.
  AddBodyResult add(std::span<const Vec3> points, const BodyOptions& options);
  UpdateReport update_after_edit(OrphanPolicy orphaned);
  [[nodiscard]] BodyEnergy energy(std::size_t body) const;
  [[nodiscard]] RigidMotion rigid_motion_of(std::size_t body) const;
  [[nodiscard]] StateHash state_hash() const;
  [[nodiscard]] BodiesCheckpoint checkpoint() const;
  void restore(const BodiesCheckpoint& saved);
  void check(const BodyOptions& options) const;
  void resize_arrays(double radius);
  [[nodiscard]] double potential(const Body& body, std::span<const Vec3> positions) const;
  [[nodiscard]] double kinetic(const Body& body) const;
  void remove_gone();
  void remove_bodies(std::span<const std::uint8_t> leaving);

  // bodies_step.cpp: the phases of a step.
  const BodiesStep& step();
  void first_pass();
  void start(Body& body);
  void integrate(Body& body);
  void set_legs(Body& body);
  void limit_targets(const Body& body);
  void stay(const Body& body);
  void hold_stuck();
  StepReport advance(bool pulls);
  void second_pass();
  void aim_pull(Body& body);
  static void charge_lift(Body& body);
  void damp(Body& body);

  // bodies_collide.cpp: contacts between bodies, and impulses from outside.
  [[nodiscard]] RigidMover predicted_state(std::size_t body) const;
  void apply_impulse(std::size_t body, const RigidMover& solved);
  [[nodiscard]] RigidMover as_rigid(std::size_t body) const;
  void spread_action(const Body& body);
  [[nodiscard]] BodyParticles body_particles() const;
  void find_pairs();
  std::uint64_t rebound();
  void collide();

  // bodies_edges.cpp: the surfaces that bodies carry.
  SolidPlacement add_surface(const SolidMesh& mesh);
  [[nodiscard]] std::vector<std::uint32_t> bodies_with_surface() const;
  [[nodiscard]] std::span<const Vec3> surface(std::size_t body) const;
  [[nodiscard]] std::vector<Vec3> surface_targets(std::vector<Vec3>& places, std::span<const Vec3> from) const;
  void check_surfaces(const char* caller) const;
  void check_move() const;
  void move_surfaces();
  [[nodiscard]] SurfaceRow row_of(const SolidContact& contact, const Body& body) const;
  void answer_surfaces(std::span<const std::vector<SurfaceRow>> rows, std::span<const std::uint8_t> stuck);
  void put_back(std::span<const std::uint32_t> which, const Particles& before);
  double move_with(std::span<const Vec3> positions);
  double plan(const VertexMotion& walls) override;
  bool shorten(double share, const VertexMotion& walls) override;
  void after_move() override;

  // bodies_energy.cpp: the limits of energy.
  void measure();
  [[nodiscard]] double action_work(const Body& body) const;
  [[nodiscard]] double given(const Body& body) const;
  void fit(Body& body);
  void accept(Body& body);
  void limit_energy(Body& body);
  [[nodiscard]] bool lacks_motion(const Body& body);
  void limit_energy_together();
  void cut_together(std::span<const std::uint32_t> group);
  void share_energy();

  // Threads take groups of about this many particles.
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
  // The potential that a particle moves in during the first pass.
  [[nodiscard]] PotentialEnergy potential_of(const Body& body, std::size_t particle) const {
    return {body.stiffness, goals_[particle], options_.gravity + contact_forces_[particle]};
  }

  Environment& environment_;
  BodiesOptions options_;
  WallResponses responses_;
  Vec3 lowest_;  // potential energy counts from here
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
  // Scratch of one step.
  struct Sums {
    Vec3 earlier;  // acceleration of the stage before the last one
    Vec3 last;
    Vec3 way;    // sum of accelerations, for the position
    Vec3 speed;  // for the velocity
  };
  std::vector<Sums> sums_;
  std::vector<Vec3> goals_;  // of the fits at the start of the pass
  std::vector<Vec3> trial_goals_;
  std::vector<Vec3> targets_;
  std::vector<Vec3> reached_;
  std::vector<Leg> legs_;
  BodySurfaces surfaces_;
  MovePartner* partner_ = nullptr;  // the surfaces, in a joint move
  // Collisions.
  BodyCollisions collisions_;
  BodyRebounds rebounds_;
  std::vector<RigidMover> movers_;
  std::vector<std::uint64_t> ids_;
  std::vector<double> inverse_masses_;
  std::vector<Vec3> led_to_;  // velocities that the forces lead to
  std::vector<Vec3> corrections_;
  std::vector<Vec3> outer_forces_;    // from apply_impulse() in this step, per mass
  std::vector<Vec3> contact_forces_;  // outer_forces_ and the forces between bodies, per mass
  std::vector<TouchedFaces> next_on_;
  std::vector<PassBody> pass_bodies_;
};

}  // namespace dartcast
