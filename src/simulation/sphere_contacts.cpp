// The collisions of spheres: masses, walls near by, impulses.
#include "simulation/sphere_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "base/parallel.hpp"
#include "response/incident_walls.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

constexpr std::size_t wall_grain = 256;

// The solver takes walls within this share of the radius. A sphere meets farther walls by its own step, with the true
// contact. The nearest point of a far wall says little about the point that is touched.
constexpr double wall_share = 0.25;

// The wall as the solver sees it, which lets spheres rest on it; none if a sphere must meet it by its own step.
std::optional<WallSurface> solved_surface(const WallResponse& response) {
  switch (response.kind) {
    case WallResponseKind::reflect: return WallSurface{response.restitution, response.friction};
    case WallResponseKind::slide: return WallSurface{};
    case WallResponseKind::stick:
    case WallResponseKind::absorb:
    case WallResponseKind::escape: break;
  }
  return std::nullopt;
}

}  // namespace

double SphereContacts::mass(double radius) const {
  if (radius == 0.0) return 0.0;
  constexpr double smallest_weighed = 0x1p-100;  // a smaller sphere gets the mass of this one: its own could be 0
  const double r = std::max(radius, smallest_weighed);
  const bool plane = environment_.map().dimension() == 2;
  return options_.collisions->density * (plane ? std::numbers::pi * r * r : 4.0 / 3.0 * std::numbers::pi * r * r * r);
}

// Masses, and which spheres take part. Held spheres and those that left have no contacts; stuck ones cannot be pushed.
void SphereContacts::weigh(ParticleSet& set) {
  const std::span<const double> radii = set.table[set.table.radius];
  met_radii_.resize(radii.size());
  inverse_masses_.resize(radii.size());
  displacements_.resize(radii.size());
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double r = radii[i];
    const bool meets = !set.states[i].held &&
                       (set.statuses()[i] == ParticleStatus::alive || set.statuses()[i] == ParticleStatus::stuck);
    met_radii_[i] = meets ? r : 0.0;
    const double m = mass(r);
    inverse_masses_[i] = set.statuses()[i] == ParticleStatus::alive && m > 0.0 ? 1.0 / m : 0.0;
  }
}

// The distance that is still free of walls around a sphere, from where it was last measured. Distances were rounded, so
// the result is a little smaller.
double SphereContacts::clearance(const ParticleSet& set, std::size_t i) const {
  const double room = clear_[i].distance * (1.0 - 0x1p-20) - norm(set.states[i].position - clear_[i].centre);
  return std::max(0.0, room);
}

void SphereContacts::walls_of(ParticleSet& set, std::size_t i, double dt, bool moving, NearWalls& near,
                              std::vector<WallContact>& found) {
  const double r = met_radii_[i];
  clearances_[i] = clearance(set, i);
  if (clearances_[i] >= r * (1.0 + wall_share)) return;
  // If walls stand still and none is next to the sphere, search farther: the result then serves for many steps. The
  // walls within the share that counts are the same.
  const bool next_to_wall = motion_.deforms() || (clear_[i].distance > 0.0 && clear_[i].distance < 1.5 * r);
  const double reach = next_to_wall ? wall_share * r : r;
  const auto walls = walls_within(environment_.complex(), set.states[i], r + reach, near, moving);
  clear_[i] = {set.states[i].position, walls.empty() ? r + reach : walls.front().distance};
  clearances_[i] = clearance(set, i);
  for (const WallFeature& w : walls) {
    const std::optional<WallSurface> surface = solved_surface(responses_.of(w.patch));
    if (!surface) continue;
    const Vec3 velocity = moving ? w.displacement * (1.0 / dt) : Vec3{};
    const double gap = w.distance - r;
    const bool meets = gap <= wall_share * r && dot(set.velocities()[i] - velocity, w.normal) * dt <= -gap;
    if (gap > near_share * r && !meets) continue;
    found.push_back({static_cast<std::uint32_t>(i), w.normal, gap, velocity, surface->restitution, surface->friction,
                     w.face, w.triangle});
  }
}

void SphereContacts::find_walls(ParticleSet& set, double dt, bool moving) {
  const std::size_t count = set.states.size();
  const std::size_t chunks = chunk_count(count, wall_grain);
  if (near_.size() < chunks) near_.resize(chunks);
  near_contacts_.resize(chunks);
  clearances_.assign(count, 0.0);
  clear_.resize(count);
  if (motion_.deforms()) clear_.assign(count, {});
  parallel_for(count, wall_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    const std::size_t chunk = begin / wall_grain;
    near_contacts_[chunk].clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (met_radii_[i] > 0.0 && inverse_masses_[i] > 0.0)
        walls_of(set, i, dt, moving, near_[chunk], near_contacts_[chunk]);
    }
  });
  walls_.clear();
  for (const auto& part : near_contacts_) walls_.insert(walls_.end(), part.begin(), part.end());
}

// The contacts of spheres that came to walls among others. The time is that of the way without impulses; the end of the
// step if only another sphere brings it there.
void SphereContacts::note_contacts(const ParticleSet& set, std::span<const Vec3> targets,
                                   std::span<const WallContact> walls, double dt) {
  solved_.clear();
  for (const WallContact& w : walls) {
    const Vec3& x = set.states[w.sphere].position;
    Contact c;
    c.particle = w.sphere;
    c.wall_displacement = w.wall_velocity * dt;
    c.displacement = targets[w.sphere] - x - c.wall_displacement;
    const double nearing = -dot(c.displacement, w.normal);
    c.time_of_impact = w.gap <= 0.0 ? 0.0 : nearing > w.gap ? w.gap / nearing : 1.0;
    c.unused = c.displacement * (1.0 - c.time_of_impact);
    WallFeature place =
        NearWalls::place_on(environment_.complex(), w.face, w.triangle, x + c.displacement * c.time_of_impact, false);
    place.normal = w.normal;
    c.kind = place.kind;
    c.dart = place.dart;
    c.point = place.point + c.wall_displacement;
    c.first_wall = static_cast<std::uint32_t>(solved_.walls.size());
    c.wall_count = 1;
    solved_.walls.push_back(place.hit());
    solved_.contacts.push_back(c);
  }
  std::sort(solved_.contacts.begin(), solved_.contacts.end(), [](const Contact& a, const Contact& b) {
    return std::tuple(a.particle, a.time_of_impact, a.first_wall) <
           std::tuple(b.particle, b.time_of_impact, b.first_wall);
  });
}

// Puts them before those of the spheres' own steps, with times that do not fall.
void SphereContacts::add_to(StepReport& report) {
  if (solved_.contacts.empty()) return;
  for (const Contact& c : solved_.contacts) ++report.counters.contacts[static_cast<std::size_t>(c.kind)];
  solved_.append(report.contacts);
  std::vector<Contact>& all = solved_.contacts;
  std::stable_sort(all.begin(), all.end(), [](const Contact& a, const Contact& b) { return a.particle < b.particle; });
  for (std::size_t k = all.size() - 1; k > 0; --k) {
    if (all[k - 1].particle == all[k].particle)
      all[k - 1].time_of_impact = std::min(all[k - 1].time_of_impact, all[k].time_of_impact);
  }
  std::swap(report.contacts, solved_);
  solved_.clear();
}

// The ways that the solver leaves to the spheres.
void SphereContacts::take_targets(ParticleSet& set, std::span<Vec3> targets) {
  pushed_.assign(targets.size(), 0);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (set.statuses()[i] != ParticleStatus::alive || set.states[i].held) continue;
    const Vec3 target = flushed(set.states[i].position + displacements_[i]);
    pushed_[i] = target != targets[i] ? 1 : 0;
    targets[i] = target;
  }
}

CollisionCounts SphereContacts::collide(ParticleSet& set, std::span<Vec3> targets, double dt, bool moving,
                                        const Vec3& acceleration) {
  weigh(set);
  find_walls(set, dt, moving);
  const CollisionOptions& c = *options_.collisions;
  SolverOptions solver;
  solver.dt = dt;
  solver.restitution = c.restitution;
  solver.friction = c.friction;
  solver.iterations = c.iterations;
  solver.position_iterations = c.position_iterations;
  solver.resting_speed = 2.0 * norm(options_.gravity) * dt;
  solver.acceleration = acceleration;
  const CellComplex& complex = environment_.complex();
  const CollidingSpheres spheres = {set.states.states(), set.table[set.table.id], met_radii_,     inverse_masses_,
                                    clearances_,         set.velocities(),        displacements_, options_.gravity};
  CollisionCounts counts;
  if (meets_bodies()) {
    counts = body_collider_.collide(complex, spheres, walls_, *bodies_, solver, environment_.threads());
    collider_.solver().set_cached_impulses({});
    note_contacts(set, targets, body_collider_.new_walls(), dt);
  } else {
    counts = collider_.collide(complex, spheres, walls_, solver, environment_.threads());
    body_collider_.solver().set_cached_impulses({});
    note_contacts(set, targets, collider_.new_walls(), dt);
  }
  take_targets(set, targets);
  return counts;
}

void SphereContacts::save(ParticleSystemState& state) const {
  const auto impulses =
      meets_bodies() ? body_collider_.solver().cached_impulses() : collider_.solver().cached_impulses();
  state.impulses.assign(impulses.begin(), impulses.end());
}

void SphereContacts::restore(const ParticleSystemState& state) {
  clear_.clear();
  body_collider_.solver().set_cached_impulses(state.impulses);  // the one that continues drops the other's
  collider_.solver().set_cached_impulses(state.impulses);
}

}  // namespace dartcast
