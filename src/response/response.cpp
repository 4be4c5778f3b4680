// Responses at walls: the velocity after a contact.
#include "dartcast/response.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

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

  [[nodiscard]] Vec3 rebound(const Vec3& v, const JointWalls& walls, const Vec3& lead) const {
    const auto surface_of = [&](const WallHit& wall, double) { return surface(responses.of(wall.patch)); };
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
    const Vec3 relative = rebound(velocity - wall_velocity, met, lead);
    velocity = wall_velocity + relative;
    if (acceleration.value != Vec3{}) {
      const Vec3 way = relative * ((1.0 - time) * acceleration.duration);
      return {is_finite(way) ? way : Vec3{}, true};  // a step never throws for a velocity
    }
    return {rebound(contact.unused, met, {}), true};
  }

  AfterContact operator()(const Contact& contact, std::span<const WallHit> walls,
                          std::span<const WallHit> earlier) const {
    ParticleStatus& fate = statuses[contact.particle];
    if (fate != ParticleStatus::alive) return {};
    const Vec3 wall_velocity = contact.wall_displacement * (1.0 / dt);
    Vec3& velocity = velocities[contact.particle];
    switch (responses.of(walls.front().patch).kind) {
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
                             std::span<ParticleStatus> statuses, double dt, const Acceleration& acceleration) {
  if (!(dt > 0.0)) throw InvalidArgument("respond_with: dt must be positive");
  if (velocities.size() != statuses.size())
    throw InvalidArgument("respond_with: one velocity and one status per particle are needed");
  if (acceleration.value != Vec3{} && !(acceleration.duration > 0.0))
    throw InvalidArgument("respond_with: the duration of an acceleration must be positive");
  return LibraryResponse{responses, velocities, statuses, dt, acceleration};
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
