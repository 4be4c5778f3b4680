// Contacts of spheres with each other, with walls and with the particles of bodies, for one rigid solver.
#include "simulation/sphere_bodies.hpp"

#include <algorithm>

#include "base/parallel.hpp"

namespace dartcast {

namespace {

constexpr std::size_t pair_grain = 512;

// Above the ids of spheres.
constexpr std::uint64_t of_body = std::uint64_t{1} << 63U;

// Whether the balls without walls around the two centres hold the way between them. Clearances are distances that were
// rounded: a share of them is given up.
bool clear_between(std::span<const double> clearances, std::uint32_t a, std::uint32_t b, const Vec3& way) {
  if (a >= clearances.size() || b >= clearances.size()) return false;
  const double clear = (clearances[a] + clearances[b]) * (1.0 - 0x1p-20);
  return clear > 0.0 && dot(way, way) <= clear * clear;
}

}  // namespace

void SphereBodyCollider::gather(const CollidingSpheres& spheres, const Bodies& bodies, double dt) {
  const std::size_t count = spheres.states.size();
  states_.assign(spheres.states.begin(), spheres.states.end());
  ids_.assign(spheres.ids.begin(), spheres.ids.end());
  mover_of_.resize(count);
  movers_.assign(count, {});
  moving_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    mover_of_[i] = static_cast<std::uint32_t>(i);
    movers_[i].inverse_mass = spheres.inverse_masses[i];
    movers_[i].centre = spheres.states[i].position;
    movers_[i].velocity = spheres.velocities[i];
    moving_[i] = {spheres.states[i].position, spheres.velocities[i] * dt, spheres.radii[i]};
  }
  add_particles(bodies, dt);
  swept_ = moving_;
  for (std::size_t i = 0; i < swept_.size(); ++i) swept_[i].radius += near_room(moving_[i]);
}

void SphereBodyCollider::add_particles(const Bodies& bodies, double dt) {
  const auto states = bodies.particles().states();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto mover = static_cast<std::uint32_t>(movers_.size());
    movers_.push_back(bodies.predicted_state(b));
    for (std::size_t i = 0; i < bodies.particle_count(b); ++i) {
      const std::size_t p = bodies.first_particle(b) + i;
      const Vec3& x = states[p].position;
      states_.push_back(states[p]);
      ids_.push_back(of_body | std::uint64_t{bodies.id(b)} << 32U | i);
      mover_of_.push_back(mover);
      moving_.push_back({x, movers_[mover].velocity_at(x) * dt, states[p].held ? 0.0 : bodies.radii()[p]});
    }
  }
}

// A chunk of candidates: those that are near become contacts.
void SphereBodyCollider::find_contacts(const CellComplex& complex, const CollidingSpheres& spheres,
                                       std::span<const SpherePair> candidates, const SolverOptions& options,
                                       Part& part) const {
  const std::size_t count = spheres.states.size();
  for (const SpherePair& p : candidates) {
    if (p.a >= count && p.b >= count) continue;
    const bool swapped = ids_[p.a] > ids_[p.b];
    const std::uint32_t a = swapped ? p.b : p.a;
    const std::uint32_t b = swapped ? p.a : p.b;
    const Approach near = approach(moving_[a], moving_[b]);
    if (near.distance > std::max(near_room(moving_[a]), near_room(moving_[b]))) continue;
    const bool clear = clear_between(spheres.clearances, a, b, moving_[b].centre - moving_[a].centre);
    if (!clear && separated(complex, states_[a], states_[b])) continue;
    RigidContact c;
    c.a = mover_of_[a];
    c.b = mover_of_[b];
    c.a_id = ids_[a];
    c.b_id = ids_[b];
    c.normal = near.normal;
    c.point_a = moving_[a].centre;
    c.point_b = moving_[b].centre;
    c.gap = near.gap - resting_gap * std::min(moving_[a].radius, moving_[b].radius);
    c.restitution = options.restitution;
    c.friction = options.friction;
    part.contacts.push_back(c);
    if (near.distance >= 0.0) continue;
    ++part.overlaps;
    part.deepest = std::max(part.deepest, -near.distance);
  }
}

void SphereBodyCollider::find_contacts(const CellComplex& complex, const CollidingSpheres& spheres,
                                       const SolverOptions& options, Threads threads, CollisionCounts& counts) {
  lists_.update(complex.map(), states_);
  const std::span<const SpherePair> candidates = finder_.find(complex, lists_, states_, swept_, threads);
  parts_.resize(chunk_count(candidates.size(), pair_grain));
  parallel_for(candidates.size(), pair_grain, threads, [&](std::size_t begin, std::size_t end) {
    Part& part = parts_[begin / pair_grain];
    part.contacts.clear();
    part.overlaps = 0;
    part.deepest = 0.0;
    find_contacts(complex, spheres, candidates.subspan(begin, end - begin), options, part);
  });
  contacts_.clear();
  for (const Part& part : parts_) {
    contacts_.insert(contacts_.end(), part.contacts.begin(), part.contacts.end());
    counts.overlaps += part.overlaps;
    counts.deepest = std::max(counts.deepest, part.deepest);
  }
  counts.pairs_tested = candidates.size();
  counts.pairs_near = contacts_.size();
}

void SphereBodyCollider::add_walls(const CollidingSpheres& spheres, std::span<const WallContact> walls,
                                   const SolverOptions& options) {
  walls_.assign(walls.begin(), walls.end());
  for (WallContact& w : walls_) w.gap -= resting_gap * spheres.radii[w.sphere];
  shared_.assign(movers_.size(), 0);
  for (const RigidContact& c : contacts_) {
    if (in_reach(c.gap, movers_[c.a].velocity_at(c.point_a), movers_[c.b].velocity_at(c.point_b), options.dt))
      shared_[c.a] = shared_[c.b] = 1;
  }
  leave_lone_spheres(spheres.velocities, options, shared_, walls_);
  for (const WallContact& w : walls_) {
    RigidContact c;
    c.b = w.sphere;
    c.b_id = ids_[w.sphere];
    c.normal = w.normal;
    c.point_b = moving_[w.sphere].centre;
    c.gap = w.gap;
    c.restitution = w.restitution;
    c.friction = w.friction;
    c.wall_velocity = w.wall_velocity;
    contacts_.push_back(c);
  }
}

CollisionCounts SphereBodyCollider::collide(const CellComplex& complex, const CollidingSpheres& spheres,
                                            std::span<const WallContact> walls, Bodies& bodies,
                                            const SolverOptions& options, Threads threads) {
  CollisionCounts counts;
  const std::size_t count = spheres.states.size();
  gather(spheres, bodies, options.dt);
  find_contacts(complex, spheres, options, threads, counts);
  add_walls(spheres, walls, options);
  solver_.solve(contacts_, movers_, options);
  new_walls_.clear();
  for (const std::uint32_t c : solver_.new_walls())
    new_walls_.push_back(walls_[c - (contacts_.size() - walls_.size())]);
  for (std::size_t i = 0; i < count; ++i) {
    spheres.velocities[i] = movers_[i].velocity;
    spheres.displacements[i] = movers_[i].position_delta;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies.apply_impulse(b, movers_[count + b]);
  counts.pairs_touching = solver_.loaded_pairs();
  counts.walls_touching = solver_.loaded_walls();
  return counts;
}

}  // namespace dartcast
