// One step's collisions of spheres: swept spheres, pairs, contacts, impulses.
#include "dynamics/collider.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

constexpr std::size_t collide_grain = 512;

void check_spheres(const CollidingSpheres& s) {
  const std::size_t count = s.states.size();
  if (s.ids.size() != count || s.radii.size() != count || s.inverse_masses.size() != count ||
      s.velocities.size() != count || s.displacements.size() != count ||
      (!s.clearances.empty() && s.clearances.size() != count))
    throw InvalidArgument("collide: one id, radius, mass, velocity and displacement per particle are needed");
}

// Impulses may stop or turn a sphere. Another one that moves along with it then comes nearer by its own motion.
double room_of(const SphereMotion& s) { return s.radius * near_share + std::min(norm(s.displacement), s.radius); }

// Whether the balls without walls around the two centres hold the way between them. A share of each clearance is
// given up, because it is a rounded distance.
bool in_clear(const CollidingSpheres& s, std::uint32_t a, std::uint32_t b) {
  if (s.clearances.empty()) return false;
  const double clear = (s.clearances[a] + s.clearances[b]) * (1.0 - 0x1p-20);
  const Vec3 way = s.states[b].position - s.states[a].position;
  return clear > 0.0 && dot(way, way) <= clear * clear;
}

}  // namespace

CollisionCounts& CollisionCounts::operator+=(const CollisionCounts& other) {
  pairs_tested += other.pairs_tested;
  pairs_near += other.pairs_near;
  pairs_touching += other.pairs_touching;
  walls_touching += other.walls_touching;
  overlaps += other.overlaps;
  deepest = std::max(deepest, other.deepest);
  return *this;
}

// Whether two spheres stay apart in whatever direction they move so far, as most pairs whose boxes meet do. The
// margin is more than rounding, so that approach() agrees.
bool Collider::surely_apart(std::uint32_t a, std::uint32_t b) const {
  const Reach& first = reaches_[a];
  const Reach& second = reaches_[b];
  const Vec3 way = second.centre - first.centre;
  const double limit = first.limit + second.limit + std::max(first.room, second.room);
  return dot(way, way) > limit * limit * (1.0 + 0x1p-30);
}

// A chunk of candidates: those that are near become contacts.
void Collider::find_contacts(const CellComplex& complex, const CollidingSpheres& spheres,
                             std::span<const SpherePair> candidates, Part& part) const {
  for (const SpherePair& p : candidates) {
    if (surely_apart(p.a, p.b)) continue;
    const bool swapped = spheres.ids[p.a] > spheres.ids[p.b];
    const std::uint32_t first = swapped ? p.b : p.a;
    const std::uint32_t second = swapped ? p.a : p.b;
    const Approach near = approach(moving_[first], moving_[second]);
    const double smaller = std::min(spheres.radii[first], spheres.radii[second]);
    if (near.distance > std::max(reaches_[first].room, reaches_[second].room)) continue;
    if (!in_clear(spheres, first, second) && separated(complex, spheres.states[first], spheres.states[second]))
      continue;
    part.contacts.push_back({first, second, near.normal, near.gap - resting_gap * smaller});
    if (near.distance >= 0.0) continue;
    ++part.overlaps;
    part.deepest = std::max(part.deepest, -near.distance);
  }
}

void Collider::sweep(const CollidingSpheres& spheres, double dt) {
  moving_.resize(spheres.states.size());
  swept_.resize(spheres.states.size());
  reaches_.resize(spheres.states.size());
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    moving_[i] = {spheres.states[i].position, spheres.velocities[i] * dt, spheres.radii[i]};
    swept_[i] = moving_[i];
    const double room = room_of(moving_[i]);
    swept_[i].radius += room;
    reaches_[i] = {moving_[i].centre, moving_[i].radius + norm(moving_[i].displacement), room};
  }
}

void Collider::find_contacts(const CellComplex& complex, const CollidingSpheres& spheres,
                             std::span<const SpherePair> candidates, Threads threads, CollisionCounts& counts) {
  parts_.resize(chunk_count(candidates.size(), collide_grain));
  parallel_for(candidates.size(), collide_grain, threads, [&](std::size_t begin, std::size_t end) {
    Part& part = parts_[begin / collide_grain];
    part.contacts.clear();
    part.overlaps = 0;
    part.deepest = 0.0;
    find_contacts(complex, spheres, candidates.subspan(begin, end - begin), part);
  });
  pairs_.clear();
  for (const Part& part : parts_) {
    pairs_.insert(pairs_.end(), part.contacts.begin(), part.contacts.end());
    counts.overlaps += part.overlaps;
    counts.deepest = std::max(counts.deepest, part.deepest);
  }
  counts.pairs_tested = candidates.size();
  counts.pairs_near = pairs_.size();
}

CollisionCounts Collider::collide(const CellComplex& complex, const CollidingSpheres& spheres,
                                  std::span<const WallContact> walls, const SolverOptions& options, Threads threads) {
  check_spheres(spheres);
  CollisionCounts counts;
  auto last = std::chrono::steady_clock::now();
  const auto took = [&last](double& seconds) {
    const auto now = std::chrono::steady_clock::now();
    seconds += std::chrono::duration<double>(now - last).count();
    last = now;
  };
  lists_.update(complex.map(), spheres.states);
  took(seconds_.lists);
  sweep(spheres, options.dt);
  const auto candidates = finder_.find(complex, lists_, spheres.states, swept_, threads);
  took(seconds_.pairs);
  find_contacts(complex, spheres, candidates, threads, counts);
  took(seconds_.contacts);
  walls_.assign(walls.begin(), walls.end());
  for (WallContact& w : walls_) w.gap -= resting_gap * spheres.radii[w.sphere];
  solver_.solve(pairs_, walls_, {spheres.ids, spheres.inverse_masses, spheres.velocities, spheres.displacements},
                options);
  took(seconds_.impulses);
  counts.pairs_touching = solver_.loaded_pairs();
  counts.walls_touching = solver_.loaded_walls();
  return counts;
}

}  // namespace dartcast
