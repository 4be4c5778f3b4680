#include "dartcast/response/respond.hpp"

#include <algorithm>
#include <cmath>

#include "dartcast/base/error.hpp"

namespace dartcast {

namespace {

void check(const Response& r) {
  if (!(r.restitution >= 0.0 && r.restitution <= 1.0)) throw InvalidArgument("a restitution must be between 0 and 1");
  if (!(r.friction >= 0.0) || !std::isfinite(r.friction))
    throw InvalidArgument("a friction must be finite and not negative");
}

const WallHit* most_opposed(const Vec3& v, std::span<const WallHit> walls) {
  const WallHit* worst = nullptr;
  double least = 0.0;
  for (const WallHit& wall : walls) {
    const double along = dot(v, wall.normal);
    if (along < least) {
      least = along;
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
  const WallHit* wall = most_opposed(v, walls);
  return wall != nullptr && dot(v, wall->normal) < -opposed_share * norm(v) ? wall : nullptr;
}

Vec3 on_plane(const Vec3& v, const Vec3& n) { return v - n * dot(v, n); }

}  // namespace

Responses::Responses(const Response& general) : general_(general) { check(general); }

void Responses::set(Patch patch, const Response& response) {
  check(response);
  if (by_patch_.size() <= patch.value) by_patch_.resize(patch.value + 1U);
  by_patch_[patch.value] = {response, true};
}

Vec3 reflected(Vec3 v, std::span<const WallHit> walls, double restitution, double friction) {
  for (std::size_t pass = 0; pass < 2 * walls.size(); ++pass) {
    const WallHit* wall = most_opposed(v, walls);
    if (wall == nullptr) break;
    const double into = -dot(v, wall->normal);
    const Vec3 tangential = v + wall->normal * into;
    const double speed = norm(tangential);
    const double lost = friction * (1.0 + restitution) * into;
    const double kept = speed > lost ? 1.0 - lost / speed : 0.0;
    v = tangential * kept + wall->normal * (restitution * into);
  }
  return v;
}

Vec3 slid(const Vec3& v, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
  const WallHit* newest = most_opposed(v, walls);
  if (newest == nullptr) return v;
  const Vec3 plane = on_plane(v, newest->normal);
  const WallHit* second = opposed(plane, walls);
  if (second == nullptr) second = opposed(plane, earlier);
  if (second == nullptr) return plane;
  const Vec3 crease = cross(newest->normal, second->normal);
  const double length = dot(crease, crease);
  if (length < opposed_share) return on_plane(plane, second->normal);
  const Vec3 line = crease * (dot(v, crease) / length);
  const bool corner = opposed(line, walls) != nullptr || opposed(line, earlier) != nullptr;
  return corner ? Vec3{} : line;
}

Respond respond_with(const Responses& responses, std::span<Vec3> velocities, std::span<Fate> fates, double dt) {
  if (!(dt > 0.0)) throw InvalidArgument("the duration of a step must be positive");
  if (velocities.size() != fates.size()) throw InvalidArgument("one velocity and one fate per particle are needed");
  return [&responses, velocities, fates, dt](const Contact& contact, std::span<const WallHit> walls,
                                             std::span<const WallHit> earlier) -> Continuation {
    Fate& fate = fates[contact.particle];
    if (fate != Fate::alive) return {};
    const Response& response = responses.of(walls.front().patch);
    const Vec3 wall_velocity = contact.wall_displacement * (1.0 / dt);
    Vec3& velocity = velocities[contact.particle];
    const Vec3 relative = velocity - wall_velocity;
    switch (response.kind) {
      case ResponseKind::reflect:
        velocity = wall_velocity + reflected(relative, walls, response.restitution, response.friction);
        return {contact.last ? slid(contact.unused, walls, earlier)
                             : reflected(contact.unused, walls, response.restitution, response.friction),
                true};
      case ResponseKind::slide:
        velocity = wall_velocity + slid(relative, walls, earlier);
        return {slid(contact.unused, walls, earlier), true};
      case ResponseKind::stick:
        velocity = wall_velocity;
        fate = Fate::stuck;
        return {};
      case ResponseKind::absorb: fate = Fate::absorbed; return {};
      case ResponseKind::escape: fate = Fate::escaped; return {};
    }
    return {};
  };
}

}  // namespace dartcast
