// Impacts between bodies: the impulses without rebound, enlarged by the restitution, island by island.
#include "bodies/body_rebound.hpp"

#include <algorithm>

#include "dynamics/collider.hpp"
#include "dynamics/sphere_touch.hpp"

namespace dartcast {

namespace {

// The solver starts again from its last result, so many times at most, until no pair approaches faster than this share
// of the fastest approach. Faces that meet flat need hundreds of iterations.
constexpr unsigned max_rounds = 100;
constexpr double left_share = 0x1p-32;

Vec3 relative_velocity(const RigidContact& c, std::span<const RigidMover> movers) {
  return movers[c.b].velocity_at(c.point_b) - movers[c.a].velocity_at(c.point_a);
}

}  // namespace

// Pairs that touch within the step count as touching now.
void BodyRebounds::find_contacts(const BodyParticles& particles, std::span<const SpherePair> pairs, double friction,
                                 double dt, std::span<const RigidMover> movers) {
  contacts_.clear();
  for (const SpherePair& p : pairs) {
    RigidContact c;
    c.a = particles.body_of[p.a];
    c.b = particles.body_of[p.b];
    const auto motion = [&](std::uint32_t particle, std::uint32_t mover) {
      const Vec3& x = particles.positions[particle];
      return SphereMotion{x, movers[mover].velocity_at(x) * dt, particles.radii[particle]};
    };
    const SphereMotion a = motion(p.a, c.a);
    const SphereMotion b = motion(p.b, c.b);
    const Approach near = approach(a, b);
    if (near.distance > resting_gap * std::min(a.radius, b.radius)) continue;
    c.a_id = particles.ids[p.a];
    c.b_id = particles.ids[p.b];
    c.normal = near.normal;
    // One point for both, so that the pair of impulses has no moment.
    c.point_a = ((a.centre + c.normal * a.radius) + (b.centre - c.normal * b.radius)) * 0.5;
    c.point_b = c.point_a;
    c.friction = friction;
    contacts_.push_back(c);
  }
}

std::uint32_t BodyRebounds::root_of(std::uint32_t mover) const {
  while (islands_[mover].root != mover) mover = islands_[mover].root;
  return mover;
}

// A body that nothing can push joins no island.
BodyRebounds::Island& BodyRebounds::island_of(const RigidContact& contact) {
  return islands_[root_of(before_[contact.a].inverse_mass > 0.0 ? contact.a : contact.b)];
}

std::uint64_t BodyRebounds::join(double resting_speed) {
  islands_.assign(before_.size(), {});
  for (std::uint32_t i = 0; i < islands_.size(); ++i) islands_[i].root = i;
  for (const RigidContact& c : contacts_) {
    if (!(before_[c.a].inverse_mass > 0.0 && before_[c.b].inverse_mass > 0.0)) continue;
    const std::uint32_t a = root_of(c.a);
    const std::uint32_t b = root_of(c.b);
    islands_[std::max(a, b)].root = std::min(a, b);
  }
  std::uint64_t impacts = 0;
  for (const RigidContact& c : contacts_) {
    if (-dot(relative_velocity(c, before_), c.normal) <= resting_speed) continue;
    island_of(c).impact = true;
    ++impacts;
  }
  return impacts;
}

// With impulses P at contacts whose velocities are u before and u' after: slope P u, bend P (u' - u).
void BodyRebounds::measure(std::span<const RigidMover> after) {
  auto cached_impulses = solver_.cached_impulses().begin();
  for (const RigidContact& c : contacts_) {
    if (cached_impulses == solver_.cached_impulses().end() || cached_impulses->a != c.a_id ||
        cached_impulses->b != c.b_id)
      continue;
    const Vec3 impulse = cached_impulses->normal * cached_impulses->normal_impulse + cached_impulses->tangent_impulse;
    const Vec3 u = relative_velocity(c, before_);
    Island& island = island_of(c);
    island.slope += dot(impulse, u);
    island.bend += dot(impulse, relative_velocity(c, after) - u);
    ++cached_impulses;
  }
}

// Solves until no contact approaches.
void BodyRebounds::hold_back(const BodyCollisionOptions& options, double dt, std::span<RigidMover> movers) {
  SolverOptions solver;
  solver.dt = dt;
  solver.iterations = options.iterations;
  solver.position_iterations = 0;
  solver_.set_cached_impulses({});
  const auto fastest = [&](std::span<const RigidMover> now) {
    double speed = 0.0;
    for (const RigidContact& c : contacts_) speed = std::max(speed, -dot(relative_velocity(c, now), c.normal));
    return speed;
  };
  const double limit = left_share * fastest(before_);
  for (unsigned round = 0; round < max_rounds; ++round) {
    std::copy(before_.begin(), before_.end(), movers.begin());
    solver_.solve(contacts_, movers, solver);
    if (fastest(movers) <= limit) return;
  }
}

std::uint64_t BodyRebounds::solve(const BodyParticles& particles, std::span<const SpherePair> pairs,
                                  const BodyCollisionOptions& options, double dt, double resting_speed,
                                  std::span<RigidMover> movers) {
  find_contacts(particles, pairs, options.friction, dt, movers);
  if (contacts_.empty()) return 0;
  before_.assign(movers.begin(), movers.end());
  const std::uint64_t impacts = join(resting_speed);
  if (impacts == 0) return 0;
  hold_back(options, dt, movers);
  measure(movers);
  for (std::uint32_t i = 0; i < movers.size(); ++i) {
    const Island& island = islands_[root_of(i)];
    const bool given = island.impact && island.slope < 0.0 && island.bend > 0.0;
    const double lowest = given ? std::min(1.0, -island.slope / island.bend) : 0.0;
    const double share = (1.0 + *options.restitution) * lowest;
    movers[i].velocity = before_[i].velocity + (movers[i].velocity - before_[i].velocity) * share;
    movers[i].angular_velocity =
        before_[i].angular_velocity + (movers[i].angular_velocity - before_[i].angular_velocity) * share;
  }
  return impacts;
}

}  // namespace dartcast
