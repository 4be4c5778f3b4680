// Responses at walls: the velocity after a contact.
#include "dartcast/response.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/elementary.hpp"
#include "base/vec3_parts.hpp"
#include "dartcast/error.hpp"
#include "response/incident_walls.hpp"
#include "response/library_response.hpp"

namespace dartcast {

namespace {

void check(const WallResponse& r) {
  if (!(r.restitution >= 0.0 && r.restitution <= 1.0))
    throw InvalidArgument("response: a restitution must be between 0 and 1");
  if (!(r.friction >= 0.0) || !std::isfinite(r.friction))
    throw InvalidArgument("response: a friction must be finite and not negative");
  if (!(r.stick_below >= 0.0) || !std::isfinite(r.stick_below))
    throw InvalidArgument("response: the speed to stick below must be finite and not negative");
  if (!(r.stick_below_weber >= 0.0) || !std::isfinite(r.stick_below_weber))
    throw InvalidArgument("response: the Weber number to stick below must be finite and not negative");
  const auto increases = [](const std::vector<double>& list, double from, double to) {
    return !list.empty() && list.front() >= from && list.back() <= to &&
           std::adjacent_find(list.begin(), list.end(), [](double a, double b) { return !(a < b); }) == list.end();
  };
  const RestitutionTable& t = r.table;
  if (t.speeds.empty() && t.angles.empty() && t.values.empty()) return;
  if (!increases(t.speeds, 0.0, std::numeric_limits<double>::max()))
    throw InvalidArgument("response: the speeds of a restitution table must increase from 0 or above");
  if (!increases(t.angles, 0.0, 90.0))
    throw InvalidArgument("response: the angles of a restitution table must increase, from 0 to 90 degrees");
  if (t.values.size() != t.speeds.size() * t.angles.size() ||
      !std::all_of(t.values.begin(), t.values.end(), [](double e) { return e >= 0.0 && e <= 1.0; }))
    throw InvalidArgument(
        "response: a restitution table needs a value between 0 and 1 for each speed and angle, the angles of a speed "
        "in a "
        "row");
}

// Where a number stands in a list: between an entry and the next one, and how far.
struct PlaceInList {
  std::size_t entry, next;
  double share;
};
PlaceInList place_in(const std::vector<double>& list, double x) {
  const auto above = std::upper_bound(list.begin(), list.end(), x);
  const std::size_t last = list.size() - 1;
  if (above == list.begin()) return {0, 0, 0.0};
  const auto entry = static_cast<std::size_t>(above - list.begin()) - 1;
  if (entry == last) return {last, last, 0.0};
  return {entry, entry + 1, (x - list[entry]) / (list[entry + 1] - list[entry])};
}

// `into`: the part of the speed that points into the wall.
double restitution_at(const RestitutionTable& t, double speed, double into) {
  const double along = std::sqrt(std::max(0.0, (speed - into) * (speed + into)));
  const double degrees = polar_angle(std::max(0.0, into), along) * (180.0 / 3.14159265358979323846);
  const PlaceInList s = place_in(t.speeds, speed);
  const PlaceInList a = place_in(t.angles, degrees);
  const auto between = [&](std::size_t row) {
    const double* const e = &t.values[row * t.angles.size()];
    return e[a.entry] + (e[a.next] - e[a.entry]) * a.share;
  };
  const double low = between(s.entry);
  return std::clamp(low + (between(s.next) - low) * s.share, 0.0, 1.0);
}

const WallHit* max_opposed(const Vec3& v, std::span<const WallHit> walls) {
  const WallHit* worst = nullptr;
  double lowest = 0.0;
  for (const WallHit& wall : walls) {
    const double along = dot(v, wall.normal);
    if (along < lowest) {
      lowest = along;
      worst = &wall;
    }
  }
  return worst;
}

// Below this share of its length a projected vector counts as lying in a wall: it is what rounding leaves of zero. No
// decision of a walk depends on it.
constexpr double opposed_share = 1e-12;

// A wall that v points into by more than that.
const WallHit* opposed(const Vec3& v, std::span<const WallHit> walls) {
  const WallHit* wall = max_opposed(v, walls);
  return wall != nullptr && dot(v, wall->normal) < -opposed_share * norm(v) ? wall : nullptr;
}

}  // namespace

WallResponses::WallResponses(const WallResponse& general) : general_(general) { check(general); }

void WallResponses::set(Patch patch, const WallResponse& response) {
  check(response);
  if (by_patch_.size() <= patch.value) by_patch_.resize(patch.value + 1U);
  by_patch_[patch.value] = {response, true};
}

Vec3 reflected(const Vec3& v, std::span<const WallHit> walls, double restitution, double friction) {
  return rebounded(v, walls, [&](const WallHit&, double) { return WallSurface{restitution, friction}; });
}

Vec3 slid(const Vec3& v, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
  const WallHit* newest = max_opposed(v, walls);
  if (newest == nullptr) return v;
  const Vec3 plane = across_normal(v, newest->normal);
  const WallHit* second = opposed(plane, walls);
  if (second == nullptr) second = opposed(plane, earlier);
  if (second == nullptr) return plane;
  const Vec3 crease = cross(newest->normal, second->normal);
  const double length = dot(crease, crease);
  if (length < opposed_share) return across_normal(plane, second->normal);
  const Vec3 line = crease * (dot(v, crease) / length);
  const bool corner = opposed(line, walls) != nullptr || opposed(line, earlier) != nullptr;
  return corner ? Vec3{} : line;
}

namespace {

// How a wall of this response takes part in a reflection that another wall has led to.
WallSurface surface(const WallResponse& response) {
  switch (response.kind) {
    case WallResponseKind::slide: return {};
    case WallResponseKind::reflect:
    case WallResponseKind::stick:
    case WallResponseKind::absorb:
    case WallResponseKind::escape: break;
  }
  return {response.restitution, response.friction};
}

WallSurface tabulated_surface(const WallResponse& response, const Vec3& impact, const Vec3& normal) {
  WallSurface s = surface(response);
  if (response.kind != WallResponseKind::slide)
    s.restitution = restitution_at(response.table, norm(impact), -dot(impact, normal));
  return s;
}

// Whether a particle that a step has stopped at such a wall keeps a velocity of its own.
bool keeps_velocity(WallResponseKind kind) {
  switch (kind) {
    case WallResponseKind::reflect: return true;
    case WallResponseKind::slide:
    case WallResponseKind::stick:
    case WallResponseKind::absorb:
    case WallResponseKind::escape: break;
  }
  return false;
}

// The callable that respond_with() makes.
struct LibraryResponse {
  const WallResponses& responses;
  std::span<Vec3> velocities;
  std::span<ParticleStatus> statuses;
  double dt;
  Acceleration acceleration;
  Drops drops;

  // `speed`: into the wall.
  [[nodiscard]] bool sticks(const WallResponse& response, std::uint32_t particle, double speed) const {
    if (response.kind != WallResponseKind::reflect) return false;
    if (response.stick_below > 0.0 && speed < response.stick_below) return true;
    if (response.stick_below_weber == 0.0 || drops.diameters.empty()) return false;
    const double inertia = drops.densities[particle] * drops.diameters[particle] * speed * speed;
    return speed <= 0.0 || inertia < response.stick_below_weber * drops.surface_tension;
  }

  // `impact`: the velocity relative to the wall, before.
  [[nodiscard]] Vec3 rebound(const Vec3& v, const JointWalls& walls, const Vec3& impact, const Vec3& lead) const {
    const auto surface_of = [&](const WallHit& wall, double) {
      const WallResponse& response = responses.of(wall.patch);
      if (response.table.speeds.empty()) return surface(response);
      return tabulated_surface(response, impact, wall.normal);
    };
    return rebounded(v, walls, surface_of, lead);
  }

  // If accelerated, the way left is that of the velocity; else it may be of another making, and is reflected itself.
  [[nodiscard]] AfterContact reflect(const Contact& contact, std::span<const WallHit> walls,
                                     std::span<const WallHit> earlier) const {
    const JointWalls met(walls, contact.last ? earlier : earlier.last(contact.together));
    const Vec3 wall_velocity = contact.wall_displacement * (1.0 / dt);
    Vec3& velocity = velocities[contact.particle];
    const double time = contact.time_of_impact;
    const Vec3 lead = acceleration.value * (acceleration.duration * (time - 0.5));
    const Vec3 impact = velocity - wall_velocity;
    const Vec3 relative = rebound(impact, met, impact, lead);
    velocity = wall_velocity + relative;
    if (acceleration.value != Vec3{}) {
      const Vec3 way = relative * ((1.0 - time) * acceleration.duration);
      return {is_finite(way) ? way : Vec3{}, true};  // a step never throws for a velocity
    }
    return {rebound(contact.unused, met, impact, {}), true};
  }

  AfterContact operator()(const Contact& contact, std::span<const WallHit> walls,
                          std::span<const WallHit> earlier) const {
    ParticleStatus& fate = statuses[contact.particle];
    if (fate != ParticleStatus::alive) return {};
    const Vec3 wall_velocity = contact.wall_displacement * (1.0 / dt);
    Vec3& velocity = velocities[contact.particle];
    const WallResponse& response = responses.of(walls.front().patch);
    const double speed = dot(wall_velocity - velocity, walls.front().normal);
    switch (sticks(response, contact.particle, speed) ? WallResponseKind::stick : response.kind) {
      case WallResponseKind::reflect: return reflect(contact, walls, earlier);
      case WallResponseKind::slide:
        velocity = wall_velocity + slid(velocity - wall_velocity, walls, earlier);
        return {slid(contact.unused, walls, earlier), true};
      case WallResponseKind::stick:
        velocity = wall_velocity;
        fate = ParticleStatus::stuck;
        return {};
      case WallResponseKind::absorb: fate = ParticleStatus::absorbed; return {};
      case WallResponseKind::escape: fate = ParticleStatus::escaped; return {};
    }
    return {};
  }
};

}  // namespace

namespace detail {

bool is_library_response(const ContactCallback& respond) { return respond.target<LibraryResponse>() != nullptr; }

}  // namespace detail

ContactCallback respond_with(const WallResponses& responses, std::span<Vec3> velocities,
                             std::span<ParticleStatus> statuses, double dt, const Acceleration& acceleration,
                             const Drops& drops) {
  if (!(dt > 0.0)) throw InvalidArgument("respond_with: dt must be positive");
  if (velocities.size() != statuses.size())
    throw InvalidArgument("respond_with: one velocity and one status per particle are needed");
  if (acceleration.value != Vec3{} && !(acceleration.duration > 0.0))
    throw InvalidArgument("respond_with: the duration of an acceleration must be positive");
  if (drops.diameters.size() != drops.densities.size() ||
      (!drops.diameters.empty() && (drops.diameters.size() != velocities.size() || !(drops.surface_tension > 0.0))))
    throw InvalidArgument(
        "respond_with: one diameter and one density per drop are needed, and a surface tension above 0");
  return LibraryResponse{responses, velocities, statuses, dt, acceleration, drops};
}

void hold_stopped(const StepReport& report, const WallResponses& responses, std::span<Vec3> velocities,
                  std::span<const ParticleStatus> statuses, double dt, const Acceleration& acceleration) {
  const std::vector<Contact>& contacts = report.contacts.contacts;
  auto next = contacts.begin();
  for (const StoppedParticle& stopped : report.stopped) {
    next = std::find_if(next, contacts.end(), [&](const Contact& c) { return c.particle > stopped.particle; });
    if (next == contacts.begin() || std::prev(next)->particle != stopped.particle) continue;
    const Contact& contact = *std::prev(next);
    const std::span<const WallHit> walls = report.contacts.walls_of(contact);
    if (statuses[contact.particle] != ParticleStatus::alive || !keeps_velocity(responses.of(walls.front().patch).kind))
      continue;
    const Vec3 wall_velocity = contact.wall_displacement * (1.0 / dt);
    Vec3& velocity = velocities[contact.particle];
    const Vec3 relative = velocity - wall_velocity;
    const Vec3 gained = acceleration.value * acceleration.duration;
    const double energy = dot(relative, relative) + 2.0 * (contact.time_of_impact - 0.5) * dot(gained, relative);
    const HeldBack held = held_back(relative, {walls, report.contacts.earlier_walls_of(contact)});
    velocity = wall_velocity + shortened(held.velocity, energy, gained * 0.5);
  }
}

}  // namespace dartcast
