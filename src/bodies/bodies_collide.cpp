// Contacts between bodies, and impulses from outside.
#include <algorithm>

#include "bodies/bodies_impl.hpp"

namespace dartcast {

RigidMover Bodies::Impl::as_rigid(std::size_t body) const {
  const Body& b = bodies_[body];
  const std::span<const Vec3> positions(positions_.data() + b.first, b.shape.size());
  const RigidMotion rigid = rigid_motion_of(body);
  RigidMover mover;
  mover.centre = rigid.centre;
  mover.velocity = rigid.velocity;
  mover.angular_velocity = rigid.angular_velocity;
  mover.turns = true;
  for (std::size_t p = b.first; p < b.first + b.shape.size(); ++p) {
    if (fates_[p] != ParticleStatus::alive || particles_[p].held) return mover;
  }
  mover.inverse_mass = 1.0 / rigid.mass;
  mover.inverse_inertia = inverse_inertia(b.shape.masses(), positions, rigid.centre);
  return mover;
}

RigidMover Bodies::Impl::predicted_state(std::size_t body) const {
  RigidMover mover = as_rigid(body);
  mover.velocity += options_.gravity * options_.dt;
  return mover;
}

// The solver changes velocities at the start of a step, while forces act over the whole step and lead half as far. The
// other half becomes a displacement. Forces that only balance gravity get none, because gravity leads half as far, too.
void Bodies::Impl::apply_impulse(std::size_t body, const RigidMover& solved) {
  const RigidMover before = predicted_state(body);
  const double dt = options_.dt;
  const Vec3 fall = options_.gravity * dt;
  BodyAction action;
  action.centre = before.centre;
  action.velocity = solved.velocity - before.velocity;
  action.angular_velocity = solved.angular_velocity - before.angular_velocity;
  const double square = dot(fall, fall);
  const double carried = square > 0.0 ? std::clamp(-dot(action.velocity, fall) / square, 0.0, 1.0) : 0.0;
  action.position_delta =
      (solved.position_delta - before.velocity * dt) + (fall * carried - action.velocity) * (0.5 * dt);
  action.turn = (solved.rotation_delta - before.angular_velocity * dt) - action.angular_velocity * (0.5 * dt);
  bodies_[body].action = action;
}

void Bodies::Impl::spread_action(const Body& body) {
  const double rate = 1.0 / options_.dt;
  for (std::size_t p = body.first; p < body.first + body.shape.size(); ++p)
    outer_forces_[p] = body.action.velocity_at(positions_[p]) * rate;
}

BodyParticles Bodies::Impl::body_particles() const { return {body_of_, ids_, positions_, radii_, inverse_masses_}; }

// Finds the pairs of the next step now, while the particles and the environment are in the same state.
void Bodies::Impl::find_pairs() {
  if (!options_.collisions || environment_.awaits_advance(particles_)) return;
  for (std::size_t p = 0; p < ids_.size(); ++p) {
    const Body& body = bodies_[body_of_[p]];
    ids_[p] = (std::uint64_t{body.id} << 32U) | (p - body.first);
    inverse_masses_[p] = fates_[p] == ParticleStatus::alive && !particles_[p].held ? 1.0 / masses_[p] : 0.0;
    led_to_[p] = velocities_[p] + options_.gravity * options_.dt;
  }
  collisions_.find(environment_.complex(), particles_.states(), body_particles(), led_to_, options_.dt,
                   environment_.threads());
}

// Bodies that are about to hit each other take the velocities after the impact.
std::uint64_t Bodies::Impl::rebound() {
  if (!options_.collisions || !options_.collisions->restitution || collisions_.pairs().empty()) return 0;
  movers_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) movers_.push_back(as_rigid(b));
  const std::vector<RigidMover> before = movers_;
  const double resting = 2.0 * norm(options_.gravity) * options_.dt;
  const std::uint64_t impacts =
      rebounds_.solve(body_particles(), collisions_.pairs(), *options_.collisions, options_.dt, resting, movers_);
  if (impacts == 0) return 0;
  for (std::size_t p = 0; p < velocities_.size(); ++p) {
    const RigidMover& was = before[body_of_[p]];
    const RigidMover& is = movers_[body_of_[p]];
    velocities_[p] +=
        (is.velocity - was.velocity) + cross(is.angular_velocity - was.angular_velocity, positions_[p] - was.centre);
  }
  return impacts;
}

// Forces between bodies in this step. They lead to the velocities that the impulses give at its end.
void Bodies::Impl::collide() {
  const double dt = options_.dt;
  for (std::size_t p = 0; p < led_to_.size(); ++p) {
    sums_[p].last = velocities_[p] + potential_of(bodies_[body_of_[p]], p).acceleration(positions_[p]) * dt;
    led_to_[p] = sums_[p].last;
  }
  last_.collisions = collisions_.solve(body_particles(), *options_.collisions, dt, velocities_, led_to_, corrections_);
  for (std::size_t p = 0; p < led_to_.size(); ++p) {
    Body& body = bodies_[body_of_[p]];
    const Vec3 change = led_to_[p] - sums_[p].last;
    contact_forces_[p] += change * (1.0 / dt);
    if (change != Vec3{}) body.collided = true;
    if (corrections_[p] != Vec3{}) body.pushed = true;
  }
}

}  // namespace dartcast
