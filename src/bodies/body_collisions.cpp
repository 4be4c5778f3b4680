// Contacts between bodies: pairs from swept spheres, impulses from the contact solver.
#include "bodies/body_collisions.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/collider.hpp"
#include "dynamics/sphere_touch.hpp"

namespace dartcast {

void BodyCollisions::sweep(const BodyParticles& particles, std::span<const Vec3> velocities, double dt) {
  swept_.resize(particles.radii.size());
  for (std::size_t i = 0; i < swept_.size(); ++i)
    swept_[i] = {particles.positions[i], velocities[i] * dt, particles.radii[i] * (1.0 + near_share)};
}

// Leaves out the particles of bodies whose bounding spheres meet no other.
void BodyCollisions::leave_out_lonely(const BodyParticles& particles, Threads threads) {
  bounds_.clear();
  for (std::size_t i = 0; i < swept_.size();) {
    const std::uint32_t body = particles.body_of[i];
    const Vec3 centre = swept_[i].centre;  // any point of the body will do
    double reach = 0.0;
    for (; i < swept_.size() && particles.body_of[i] == body; ++i) {
      const SphereMotion& s = swept_[i];
      if (s.radius > 0.0) reach = std::max(reach, norm(s.centre - centre) + norm(s.displacement) + s.radius);
    }
    bounds_.push_back({centre, {}, reach * (1.0 + 0x1p-40)});
  }
  meets_.assign(bounds_.size(), 0);
  for (const SpherePair& p : body_finder_.find(bounds_, threads)) meets_[p.a] = meets_[p.b] = 1;
  for (std::size_t i = 0; i < swept_.size(); ++i) {
    if (meets_[particles.body_of[i]] == 0) swept_[i].radius = 0.0;
  }
}

void BodyCollisions::find(const CellComplex& complex, std::span<const ParticleState> states,
                          const BodyParticles& particles, std::span<const Vec3> velocities, double dt,
                          Threads threads) {
  pairs_.clear();
  sweep(particles, velocities, dt);
  leave_out_lonely(particles, threads);
  if (std::find(meets_.begin(), meets_.end(), 1) == meets_.end()) return;
  lists_.update(complex.map(), states);
  for (const SpherePair& p : finder_.find(complex, lists_, states, swept_, threads)) {
    if (particles.body_of[p.a] == particles.body_of[p.b] || separated(complex, states[p.a], states[p.b])) continue;
    pairs_.push_back(p);
  }
}

BodyCollisionCounts BodyCollisions::solve(const BodyParticles& particles, const BodyCollisionOptions& options,
                                          double dt, std::span<const Vec3> velocities, std::span<Vec3> led_to,
                                          std::span<Vec3> corrections) {
  BodyCollisionCounts counts;
  std::fill(corrections.begin(), corrections.end(), Vec3{});
  contacts_.clear();
  for (const SpherePair& p : pairs_) {
    const double r = std::min(particles.radii[p.a], particles.radii[p.b]);
    const Vec3 way_a = (velocities[p.a] + led_to[p.a]) * (0.5 * dt);
    const Vec3 way_b = (velocities[p.b] + led_to[p.b]) * (0.5 * dt);
    const Approach near = approach({particles.positions[p.a], way_a, particles.radii[p.a]},
                                   {particles.positions[p.b], way_b, particles.radii[p.b]});
    // A pair that parts at the start may come back to the same place: then the force between them does no work.
    const double parting = std::max(0.0, dot(velocities[p.b] - velocities[p.a], near.normal)) * dt;
    contacts_.push_back({p.a, p.b, near.normal, (near.gap - resting_gap * r) + parting});
    if (near.distance >= 0.0) continue;
    ++counts.overlaps;
    counts.deepest = std::max(counts.deepest, -near.distance);
    const double mobility = particles.inverse_masses[p.a] + particles.inverse_masses[p.b];
    if (!(mobility > 0.0)) continue;
    const Vec3 apart = near.normal * (-near.distance * options.position_correction / mobility);
    corrections[p.a] -= apart * particles.inverse_masses[p.a];
    corrections[p.b] += apart * particles.inverse_masses[p.b];
  }
  displacements_.resize(led_to.size());
  SolverOptions solver;
  solver.dt = dt;
  solver.friction = options.friction;
  solver.iterations = options.iterations;
  solver.position_iterations = 0;  // overlaps are taken out by `corrections`
  solver_.solve(contacts_, {}, {particles.ids, particles.inverse_masses, led_to, displacements_}, solver);
  counts.pairs_near = contacts_.size();
  counts.pairs_touching = solver_.loaded_pairs();
  return counts;
}

}  // namespace dartcast
