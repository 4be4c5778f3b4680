// One sphere's step after its first stretch: contacts, overlaps, and the stretches that follow.
#include "spheres/sphere_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast::detail {

namespace {

// A sphere is moved out twice at most: walls are not planes, so once may not suffice.
constexpr unsigned max_pushes = 2;
// A slide into a wall by up to this share of its length is rounding: responses leave 2^-39 (src/response/response.cpp).
constexpr double lift_share = 0x1p-36;

}  // namespace

void list_overlaps(const CellComplex& complex, const ParticleState& state, std::uint32_t particle, double radius,
                   NearWalls& near, std::vector<SphereOverlap>& overlaps) {
  for (const WallFeature& f : near.within(complex, state.cell, state.position, radius, false)) {
    if (f.distance < radius - touching_slack(state.position, radius))
      overlaps.push_back({particle, radius - f.distance, 0.0, f.face, f.point, f.normal});
  }
}

void SphereRun::start(std::uint32_t particle, const MovingSphere& sphere, const SphereWay& way, bool moving) {
  particle_ = particle;
  radius_ = sphere.radius;
  begin_ = sphere.from;
  aim_ = sphere.to;
  moving_ = moving;
  time_ = 0.0;
  corrections_ = 0;
  way_ = way;
  contacts_.clear();
  walls_.clear();
  overlaps_.clear();
  stopped_.reset();
  held_.reset();
  unfinished_ = false;
}

const Vec3& SphereRun::plan(const SphereScene& scene, const ParticleState& state, NearWalls& near) {
  moving_ = false;
  begin_ = state.position;
  way_ = way_of(*scene.complex, {state.cell, {begin_, aim_, radius_}, false, corrections_ < max_pushes}, near);
  way_.target = flushed(way_.target);
  if (way_.end == WayEnd::overlap && overlaps_.empty())
    list_overlaps(*scene.complex, state, particle_, radius_, near, overlaps_);
  return way_.target;
}

bool SphereRun::land(const SphereScene& scene, const ParticleState& state, CentreContact centre, NearWalls& near) {
  if (held_) return false;
  if (way_.end == WayEnd::overlap) return moved_out(scene, state, near);
  if (centre.contact != nullptr) return touched_by_centre(scene, state, centre);
  return way_.end == WayEnd::contact && touched(scene, state, near);
}

// The sphere still has its own motion to make, less the displacement of the wall, which is already made.
bool SphereRun::moved_out(const SphereScene& scene, const ParticleState& state, NearWalls& near) {
  bool again = moving_;
  if (!moving_) {
    ++corrections_;
    const auto walls = near.within(*scene.complex, state.cell, state.position, radius_, false);
    const double depth = walls.empty() ? 0.0 : radius_ - walls.front().distance;
    again = depth > slack(state.position) && corrections_ < max_pushes;
    for (SphereOverlap& o : overlaps_) o.left = depth > slack(state.position) ? depth : 0.0;
  }
  aim_ = flushed(state.position + ((aim_ - begin_) - way_.wall_displacement));
  return again || aim_ != state.position;
}

// The contact's walls are all places touched at that time. The one that the sphere came to first is the first.
bool SphereRun::touched(const SphereScene& scene, const ParticleState& state, NearWalls& near) {
  const CellComplex& complex = *scene.complex;
  const Vec3 own = aim_ - begin_;
  const double reach = radius_ + slack(state.position) + 2.0 * sphere_time_bound * norm(own);
  const auto features = near.within(complex, state.cell, state.position, reach, scene.moved);
  const WallFeature first = NearWalls::place_on(complex, way_.face, way_.triangle, state.position, scene.moved);
  Contact& contact = contacts_.emplace_back();
  contact.particle = particle_;
  contact.kind = first.kind;
  contact.dart = first.dart;
  contact.point = first.point;
  contact.first_wall = static_cast<std::uint32_t>(walls_.size());
  contact.earlier = contact.first_wall;
  walls_.push_back(first.hit());
  for (const WallFeature& f : features) {
    if (norm(f.point - first.point) > 2.0 * slack(state.position)) walls_.push_back(f.hit());
  }
  contact.wall_count = static_cast<std::uint32_t>(walls_.size()) - contact.first_wall;
  contact.time_of_impact = time_ + way_.time * (1.0 - time_);
  if (scene.moved) contact.wall_displacement = moving_ ? way_.wall_displacement : first.displacement;
  contact.displacement = moving_ ? own - way_.wall_displacement : own;
  contact.unused = contact.displacement * (1.0 - way_.used);
  return follow(scene, state, contact);
}

// The environment stopped the centre before the sphere's own contact, or where it had none.
bool SphereRun::touched_by_centre(const SphereScene& scene, const ParticleState& state, CentreContact centre) {
  const Contact& met = *centre.contact;
  Contact& contact = contacts_.emplace_back(met);
  contact.particle = particle_;
  contact.first_wall = static_cast<std::uint32_t>(walls_.size());
  contact.earlier = contact.first_wall;
  const auto walls = centre.list->walls_of(met);
  walls_.insert(walls_.end(), walls.begin(), walls.end());
  if (scene.moved && !moving_) {  // the environment does not count later stretches as a move
    const WallHit& wall = walls.front();
    contact.wall_displacement =
        NearWalls::place_on(*scene.complex, wall.face, wall.triangle, met.point, true).displacement;
  }
  if (way_.end == WayEnd::contact) {  // before the sphere's own contact: only a part of its motion is made
    const double share = way_.used * met.time_of_impact;
    contact.time_of_impact = share;
    contact.displacement = moving_ ? (aim_ - begin_) - contact.wall_displacement : aim_ - begin_;
    contact.unused = contact.displacement * (1.0 - share);
  }
  contact.time_of_impact = time_ + contact.time_of_impact * (1.0 - time_);
  return follow(scene, state, contact);
}

// After a contact among moving walls another stretch always follows, because other walls may overlap the sphere now.
bool SphereRun::follow(const SphereScene& scene, const ParticleState& state, Contact& contact) {
  const auto count = static_cast<unsigned>(contacts_.size());
  contact.last = count >= scene.options->max_contacts;
  if (count == 1 || contact.time_of_impact - time_ >= share_together) first_here_ = contact.first_wall;
  contact.together = contact.first_wall - first_here_;
  time_ = contact.time_of_impact;
  const bool asked = static_cast<bool>(*scene.respond);
  if (!asked || count > scene.options->max_contacts) return stop(state, contact.unused, asked);
  const std::span<const WallHit> all = walls_;
  const AfterContact next = (*scene.respond)(contact, all.subspan(contact.first_wall), all.first(contact.first_wall));
  if (!is_finite(next.displacement))
    throw InvalidArgument(
        fmt::format("the response for particle {} returned a displacement that is not finite", particle_));
  Vec3 q = flushed(state.position + next.displacement);
  if (!in_exact_range(q)) return stop(state, contact.unused, true);  // no test can be made there
  if (next.along && q != state.position) lift(state.position, q);
  aim_ = q;
  return moving_ || q != state.position;
}

// The walls that move carry it on. Returns whether they do.
bool SphereRun::stop(const ParticleState& state, const Vec3& unused, bool unfinished) {
  unfinished_ = unfinished;
  stopped_ = StoppedParticle{particle_, unused};
  aim_ = state.position;
  return moving_;
}

// Corrects slides that rounding turned into a wall.
void SphereRun::lift(const Vec3& position, Vec3& q) const {
  const double above = 0.25 * slack(q);
  const double limit = lift_share * norm(q - position) + above;
  for (int pass = 0; pass < 2; ++pass) {
    for (const WallHit& wall : walls_) {
      const double height = dot(q - position, wall.normal);
      if (height < above && height >= -limit) q += wall.normal * (above - height);
    }
  }
  q = flushed(q);
}

void SphereRun::report(SphereReport& report) const {
  StepReport& step = report.step;
  const auto offset = static_cast<std::uint32_t>(step.contacts.walls.size());
  for (Contact c : contacts_) {
    c.first_wall += offset;
    step.contacts.contacts.push_back(c);
  }
  step.contacts.walls.insert(step.contacts.walls.end(), walls_.begin(), walls_.end());
  if (stopped_) step.stopped.push_back(*stopped_);
  if (held_) step.held.push_back(*held_);
  step.counters.unfinished += unfinished_ ? 1 : 0;
  report.overlaps.insert(report.overlaps.end(), overlaps_.begin(), overlaps_.end());
}

}  // namespace dartcast::detail
