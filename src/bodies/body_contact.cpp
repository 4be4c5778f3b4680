// The answer of a body's particle to a wall, in both passes of a step.
#include "bodies/body_contact.hpp"

#include <algorithm>
#include <cmath>

#include "response/incident_walls.hpp"

namespace dartcast {

namespace {

// A particle rests on the wall, and does not bounce, if the acceleration of so many steps explains its speed.
constexpr double resting_steps = 2.0;

bool enters(const Vec3& v, std::span<const WallHit> walls) {
  return std::any_of(walls.begin(), walls.end(), [&](const WallHit& w) { return dot(v, w.normal) < 0.0; });
}

// The velocity along the walls, with friction, which also points into none of those met earlier in the step.
Vec3 along_walls(const Pass& pass, const Vec3& v, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
  const Vec3 result = rebounded(v, walls, [&](const WallHit& wall, double) {
    const WallResponse& r = pass.responses->of(wall.patch);
    return WallSurface{0.0, r.kind == WallResponseKind::slide ? 0.0 : r.friction};
  });
  return enters(result, earlier) ? slid(v, walls, earlier) : result;
}

// Whether the wall's response ends the particle's step here.
bool ends_here(const Pass& pass, const Contact& contact, std::span<const WallHit> walls) {
  ParticleStatus& fate = pass.statuses[contact.particle];
  if (fate != ParticleStatus::alive) return true;
  switch (pass.responses->of(walls.front().patch).kind) {
    case WallResponseKind::stick: fate = ParticleStatus::stuck; break;
    case WallResponseKind::absorb: fate = ParticleStatus::absorbed; break;
    case WallResponseKind::escape: fate = ParticleStatus::escaped; break;
    case WallResponseKind::reflect:
    case WallResponseKind::slide: return false;
  }
  return true;
}

// One contact of the first pass.
struct BodyImpact {
  const Pass& pass;
  const Contact& contact;
  std::span<const WallHit> walls;
  std::span<const WallHit> earlier;
  PassBody body;
  Leg& leg;
  Vec3 wall_velocity;
  double left;  // rest of the step, s

  [[nodiscard]] PotentialEnergy potential() const {
    return {body.stiffness, pass.goals[contact.particle], pass.gravity + pass.forces[contact.particle]};
  }
  // The predicted acceleration ignores the contact, whose effect on the forces starts with the next step.
  [[nodiscard]] Vec3 acceleration(const Vec3& at, double time) const {
    return body.limited ? potential().acceleration(at) : leg.early + (leg.late - leg.early) * time;
  }

  // The particle bounces off walls that it was not on, and slides on the others.
  [[nodiscard]] Vec3 bounced(const Vec3& relative) const {
    const double resting = resting_steps * pass.dt * norm(acceleration(contact.point, contact.time_of_impact));
    return rebounded(relative, walls, [&](const WallHit& wall, double into) {
      const WallResponse& r = pass.responses->of(wall.patch);
      if (r.kind == WallResponseKind::slide) return WallSurface{0.0, 0.0};
      const bool slides = into <= resting || pass.on[contact.particle].has(wall.face);
      return WallSurface{slides ? 0.0 : r.restitution, r.friction};
    });
  }

  // The energy that the particle still has, and a velocity with that energy. A moving wall may add any amount.
  [[nodiscard]] double spent(Vec3& velocity) const {
    const double wanted = 0.5 * dot(velocity, velocity);
    if (leg.pushed) return wanted;
    const double has = std::max(0.0, leg.kinetic - potential().rise(leg.from, contact.point - leg.from));
    if (has >= wanted) return wanted;
    velocity *= std::sqrt(has / wanted);
    return has;
  }
};

AfterContact integrate_on(BodyImpact& m, const Vec3& velocity) {
  const Vec3 x = m.contact.point;
  const double begin = m.contact.time_of_impact;
  const auto acceleration = [&](const Vec3& at, double share) {
    return m.acceleration(at, begin + (1.0 - begin) * share);
  };
  const PointMotion free = runge_kutta_4({x, velocity}, m.left, acceleration);
  const Vec3 way = (free.position - x) - m.wall_velocity * m.left;
  Vec3 next = along_walls(m.pass, way, m.walls, m.earlier);
  const bool held_back = next != way;
  const Vec3 relative = free.velocity - m.wall_velocity;
  const Vec3 after = held_back ? along_walls(m.pass, relative, m.walls, m.earlier) : relative;
  if (m.body.limited && !m.leg.pushed) next *= m.potential().affordable_share(x, next, m.leg.kinetic);
  m.leg.from = x;
  m.leg.before = velocity;
  m.leg.after = after + m.wall_velocity;
  m.leg.begin = begin;
  return {next, true};
}

}  // namespace

bool TouchedFaces::has(CellFace f) const {
  return std::find(face.begin(), face.begin() + count, f) != face.begin() + count;
}

void TouchedFaces::set(std::span<const WallHit> walls) {
  count = 0;
  for (const WallHit& wall : walls) {
    if (count == face.size()) return;
    if (!has(wall.face)) face[count++] = wall.face;
  }
}

double PotentialEnergy::affordable_share(const Vec3& x, const Vec3& d, double kinetic) const {
  const double a = 0.5 * stiffness * dot(d, d);
  const double b = -dot(acceleration(x), d);
  if (a + b <= kinetic) return 1.0;
  // The positive root of a s^2 + b s = kinetic; a + b > kinetic >= 0 says that it is below 1.
  const double root = std::sqrt(b * b + 4.0 * a * kinetic);
  return b > 0.0 ? 2.0 * kinetic / (b + root) : (root - b) / (2.0 * a);
}

AfterContact answer_motion(const Pass& pass, const Contact& contact, std::span<const WallHit> walls,
                           std::span<const WallHit> earlier) {
  const std::uint32_t i = contact.particle;
  Leg& leg = pass.legs[i];
  pass.next_on[i].set(walls);
  const Vec3 wall_velocity = contact.wall_displacement * (1.0 / pass.dt);
  if (contact.wall_displacement != Vec3{}) leg.pushed = true;
  if (ends_here(pass, contact, walls)) {
    leg.after = wall_velocity;
    return {};
  }
  const double time = contact.time_of_impact;
  const double share = leg.begin < 1.0 ? std::clamp((time - leg.begin) / (1.0 - leg.begin), 0.0, 1.0) : 1.0;
  BodyImpact meeting{
      pass, contact, walls, earlier, pass.bodies[pass.body_of[i]], leg, wall_velocity, (1.0 - time) * pass.dt};
  const Vec3 arriving = leg.before + (leg.after - leg.before) * share;
  Vec3 leaving = meeting.bounced(arriving - wall_velocity) + wall_velocity;
  if (meeting.body.limited) leg.kinetic = meeting.spent(leaving);
  return integrate_on(meeting, leaving);
}

AfterContact answer_pull(const Pass& pass, const Contact& contact, std::span<const WallHit> walls,
                         std::span<const WallHit> earlier) {
  const std::uint32_t i = contact.particle;
  pass.next_on[i].set(walls);
  const PassBody& body = pass.bodies[pass.body_of[i]];
  if (ends_here(pass, contact, walls)) {
    pass.legs[i].after = {};
    return {};
  }
  if (!body.slides) return {};
  const Vec3 way = along_walls(pass, contact.unused, walls, earlier);
  return {way * PotentialEnergy{body.stiffness, pass.goals[i], pass.gravity}.affordable_share(contact.point, way, 0.0),
          true};
}

}  // namespace dartcast
