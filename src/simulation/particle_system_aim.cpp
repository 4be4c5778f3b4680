// The velocities that gravity, drag and the flow give to particles, and the targets that these lead to.
#include <algorithm>
#include <array>

#include "base/elementary.hpp"
#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "dartcast/predicates.hpp"
#include "simulation/flow_aim.hpp"
#include "simulation/particle_system.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

constexpr std::size_t aim_grain = 512;  // a multiple of the lanes of a vector

}  // namespace

// Inline: a loop over all particles calls it.
inline Vec3 ParticleSystem::accelerated(const Vec3& v, const Vec3& flow, const Vec3& force,
                                        const Forces& forces) const {
  const Vec3 acceleration = force_ ? options_.gravity + force : options_.gravity;
  if (options_.drag == 0.0) return field_ ? flow : v + acceleration * forces.dt;
  return v + (flow + acceleration * (1.0 / options_.drag) - v) * forces.lost;
}

// Most particles of a flow are aimed four at a time, and most of those without one in a short loop; the others one by
// one.
void ParticleSystem::aim(double dt, bool moving) {
  targets_.resize(set_.states.size());
  const Forces forces = forces_of(dt);
  const bool in_fours = field_ && !force_ && field_->place() == FieldPlace::points;
  const bool flies = !field_ && !force_;
  const detail::FlowScene scene = in_fours ? flow_scene(forces, moving) : detail::FlowScene{};
  parallel_for(set_.states.size(), aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    std::array<std::uint8_t, aim_grain / 4> aimed{};
    if (in_fours) aim_in_flow(scene, begin, end, aimed);
    if (flies) return aim_in_flight(forces, begin, end, moving);
    for (std::size_t i = begin; i < end; ++i) {
      if ((aimed[(i - begin) / 4] >> (i - begin) % 4 & 1U) == 0) aim_one(i, forces, moving);
    }
  });
}

void ParticleSystem::aim_one(std::size_t i, const Forces& forces, bool moving) {
  const Aim a =
      leaves(set_.fates()[i]) ? Aim{set_.velocities()[i], set_.states[i].position} : aim_at(i, forces, moving);
  set_.velocities()[i] = a.velocity;
  targets_[i] = flushed(a.target);
}

// As aim_one() without a field, in a loop that needs no look at cells.
void ParticleSystem::aim_in_flight(const Forces& forces, std::size_t begin, std::size_t end, bool moving) {
  const std::span<const ParticleState> states = set_.states.states();
  for (std::size_t i = begin; i < end; ++i) {
    if (states[i].held || set_.fates()[i] != ParticleStatus::alive) {
      aim_one(i, forces, moving);
      continue;
    }
    set_.velocities()[i] = accelerated(set_.velocities()[i], {}, {}, forces);
    targets_[i] = flushed(states[i].position + set_.velocities()[i] * forces.dt);
  }
}

detail::FlowScene ParticleSystem::flow_scene(const Forces& forces, bool moving) const {
  const CellComplex& complex = environment_.complex();
  detail::FlowScene scene;
  scene.now = complex.positions().data();
  scene.before = motion_.deforms() ? complex.previous_positions().data() : scene.now;
  scene.values = field_->values().data();
  scene.rest = field_->rest().empty() ? nullptr : field_->rest().data();
  scene.planar = complex.map().dimension() == 2;
  scene.moving = moving;
  scene.per_move = 1.0 / options_.dt;
  scene.dt = forces.dt;
  scene.drags = options_.drag > 0.0;
  scene.lost = forces.lost;
  if (scene.drags) scene.terminal = options_.gravity * (1.0 / options_.drag);
  return scene;
}

void ParticleSystem::aim_in_flow(const detail::FlowScene& scene, std::size_t begin, std::size_t end,
                                 std::span<std::uint8_t> aimed) {
  const std::size_t size = end - begin;
  detail::aim_in_flow(scene,
                      {set_.states.states().subspan(begin, size), set_.states.vertex_numbers().subspan(begin, size),
                       std::span(set_.fates()).subspan(begin, size), std::span(set_.velocities()).subspan(begin, size),
                       std::span(targets_).subspan(begin, size), aimed.first(size / 4)});
}

// The share of a velocity that drag takes within dt.
double ParticleSystem::lost_to_drag(double dt) const { return -exponential_less_one(-options_.drag * dt); }

ParticleSystem::Forces ParticleSystem::forces_of(double dt) const {
  return {dt, options_.drag > 0.0 ? lost_to_drag(dt) : 0.0};
}

// The acceleration that contacts know of: none where a field or a force changes velocities, too. Drag reduces it.
Acceleration ParticleSystem::acceleration(double dt) const {
  if (field_ || force_) return {};
  if (options_.drag == 0.0) return {options_.gravity, dt};
  return {options_.gravity * (lost_to_drag(dt) / (options_.drag * dt)), dt};
}

// A particle's velocity after the acceleration, and its target relative to positions before a move. A held particle
// takes no step. A stuck particle goes exactly where its wall carries it, to the last bit, so that no contact follows.
ParticleSystem::Aim ParticleSystem::aim_at(std::size_t i, const Forces& forces, bool moving) const {
  const ParticleState& s = set_.states[i];
  if (s.held) return {velocities()[i], s.position};
  const bool stuck = fates()[i] == ParticleStatus::stuck;
  if (!stuck && !field_ && !force_) {
    const Vec3 v = accelerated(velocities()[i], {}, {}, forces);
    return {v, s.position + v * forces.dt};
  }
  if (stuck && !moving) return {velocities()[i], s.position};
  const CellComplex& complex = environment_.complex();
  const Corners now = complex.corners(s.at());
  const Corners before = motion_.deforms() ? complex.previous_corners(s.at()) : now;
  const Weights w = detail::barycentric(moving ? before : now, s.position);
  const Vec3 carried = detail::combine(now, w);
  const Vec3 mesh = (carried - detail::combine(before, w)) * (1.0 / options_.dt);
  if (stuck) {
    const bool positive = volume_sign(now) == Sign::positive;
    return {mesh, positive ? detail::carried(complex, s.at(), w).position : s.position};
  }
  const Vec3 force = force_ ? force_->at(complex, s.at(), w, now) : Vec3{};
  const Vec3 flow = field_ ? field_->at(complex, s.at(), w, now) : Vec3{};
  if (!field_ || field_->frame() == FieldFrame::space) {
    const Vec3 v = accelerated(velocities()[i], flow, force, forces);
    return {v, s.position + v * forces.dt};
  }
  const Vec3 v = accelerated(velocities()[i], flow + mesh, force, forces);
  return {v, (moving ? carried : s.position) + (v - mesh) * forces.dt};
}

}  // namespace dartcast
