// One step's collisions of spheres: swept spheres, pairs, contacts, impulses.
#include "dynamics/collider.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

constexpr std::size_t collide_grain = 512;

// Regions are slices of about this many spheres, so that few contacts are between them. Fewer spheres are one region:
// its contacts take less time than the threads to come.
constexpr std::size_t spheres_in_region = 4096;
constexpr std::size_t max_regions = 16;

void check_spheres(const CollidingSpheres& s) {
  const std::size_t count = s.states.size();
  if (s.ids.size() != count || s.radii.size() != count || s.inverse_masses.size() != count ||
      s.velocities.size() != count || s.displacements.size() != count ||
      (!s.clearances.empty() && s.clearances.size() != count))
    throw InvalidArgument("collide: one id, radius, mass, velocity and displacement per particle are needed");
}

// Whether the balls without walls around the two centres hold the way between them. A share of each clearance is
// given up, because it is a rounded distance.
bool in_clear(const CollidingSpheres& s, std::uint32_t a, std::uint32_t b) {
  if (s.clearances.empty()) return false;
  const double clear = (s.clearances[a] + s.clearances[b]) * (1.0 - 0x1p-20);
  const Vec3 way = s.states[b].position - s.states[a].position;
  return clear > 0.0 && dot(way, way) <= clear * clear;
}

// The longest axis; that of gravity only if it is much longer than the others. A heap's weight then passes through
// one region down to the floor.
double Vec3::*axis_to_divide(const Vec3& extent, const Vec3& gravity) {
  constexpr double upright = 0.25;
  constexpr std::array<double Vec3::*, 3> axes = {&Vec3::x, &Vec3::y, &Vec3::z};
  double Vec3::*down = axes[0];
  for (double Vec3::*const a : axes) {
    if (std::abs(gravity.*a) > std::abs(gravity.*down)) down = a;
  }
  const auto length = [&](double Vec3::*a) {
    return a == down && gravity.*down != 0.0 ? upright * (extent.*a) : extent.*a;
  };
  return *std::max_element(axes.begin(), axes.end(), [&](auto a, auto b) { return length(a) < length(b); });
}

}  // namespace

void leave_lone_spheres(std::span<const Vec3> velocities, const SolverOptions& options,
                        std::vector<std::uint8_t>& shared, std::vector<WallContact>& walls) {
  constexpr std::uint8_t solved = 1;
  constexpr std::uint8_t own = 2;
  for (const WallContact& w : walls) {
    const double nearing = -dot(velocities[w.sphere] - w.wall_velocity, w.normal);
    const bool leaves = !(nearing > 0.0);
    if (!leaves && nearing * options.dt <= w.gap) continue;
    shared[w.sphere] |= leaves || nearing > options.resting_speed ? own : solved;
  }
  std::erase_if(walls, [&](const WallContact& w) { return shared[w.sphere] == own; });
}

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

void Collider::sweep(const CollidingSpheres& spheres, double dt, Threads threads) {
  moving_.resize(spheres.states.size());
  swept_.resize(spheres.states.size());
  reaches_.resize(spheres.states.size());
  parallel_for(moving_.size(), 4 * collide_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      moving_[i] = {spheres.states[i].position, spheres.velocities[i] * dt, spheres.radii[i]};
      swept_[i] = moving_[i];
      const double room = near_room(moving_[i]);
      swept_[i].radius += room;
      reaches_[i] = {moving_[i].centre, moving_[i].radius + norm(moving_[i].displacement), room};
    }
  });
}

// Divides the spheres into slices across one axis, about as many in each. The bins of a histogram are never divided, so
// the result depends on the positions alone.
void Collider::divide(const CollidingSpheres& spheres) {
  constexpr std::size_t bins = 1024;
  const std::size_t count = spheres.states.size();
  region_count_ = std::clamp<std::size_t>(count / spheres_in_region, 1, max_regions);
  regions_.assign(count, 0);
  if (region_count_ == 1) return;
  Vec3 low = spheres.states[0].position;
  Vec3 high = low;
  for (const ParticleState& s : spheres.states) {
    low = {std::min(low.x, s.position.x), std::min(low.y, s.position.y), std::min(low.z, s.position.z)};
    high = {std::max(high.x, s.position.x), std::max(high.y, s.position.y), std::max(high.z, s.position.z)};
  }
  double Vec3::*const axis = axis_to_divide(high - low, spheres.gravity);
  const double bins_per_length = static_cast<double>(bins - 1) / (high.*axis - low.*axis);
  if (!std::isfinite(bins_per_length)) return;
  const auto bin_of = [&](const ParticleState& s) {
    return static_cast<std::size_t>((s.position.*axis - low.*axis) * bins_per_length);
  };
  std::array<std::size_t, bins> before{};  // the number of spheres in the bin, then in those before
  for (const ParticleState& s : spheres.states) ++before[bin_of(s)];
  std::exclusive_scan(before.begin(), before.end(), before.begin(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i)
    regions_[i] = static_cast<std::uint8_t>(before[bin_of(spheres.states[i])] * region_count_ / count);
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
  sweep(spheres, options.dt, threads);
  const auto candidates = finder_.find(complex, lists_, spheres.states, swept_, threads);
  took(seconds_.pairs);
  find_contacts(complex, spheres, candidates, threads, counts);
  took(seconds_.contacts);
  walls_.assign(walls.begin(), walls.end());
  for (WallContact& w : walls_) w.gap -= resting_gap * spheres.radii[w.sphere];
  shared_.assign(spheres.states.size(), 0);
  for (const PairContact& p : pairs_) {
    if (in_reach(p.gap, spheres.velocities[p.a], spheres.velocities[p.b], options.dt)) shared_[p.a] = shared_[p.b] = 1;
  }
  leave_lone_spheres(spheres.velocities, options, shared_, walls_);
  divide(spheres);
  solver_.solve(
      pairs_, walls_,
      {spheres.ids, spheres.inverse_masses, spheres.velocities, spheres.displacements, regions_, region_count_},
      options, threads);
  new_walls_.clear();
  for (const std::uint32_t w : solver_.new_walls()) new_walls_.push_back(walls_[w]);
  took(seconds_.impulses);
  counts.pairs_touching = solver_.loaded_pairs();
  counts.walls_touching = solver_.loaded_walls();
  return counts;
}

}  // namespace dartcast
