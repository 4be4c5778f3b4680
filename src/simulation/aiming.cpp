// The velocities that gravity, drag and the flow give to particles, and the targets that these lead to.
#include "simulation/aiming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.hpp"
#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "simulation/brownian_bridge.hpp"
#include "simulation/runge_kutta.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

constexpr std::size_t aim_grain = 512;  // a multiple of the lanes of a vector

}  // namespace

Aiming::Aiming(const Environment& environment, Followers& followers, const MovingVertices& motion,
               const SimulationOptions& options, const WallResponses& responses, const SampledFields& sampled)
    : environment_(environment),
      motion_(motion),
      options_(options),
      responses_(responses),
      sampled_(sampled),
      eddies_(options, environment.map().dimension() == 2),
      forces_(environment, motion, options, eddies_, sampled) {
  followers.add([this](const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
    if (field_) field_->update_after_edit(edit, environment_.complex());
    if (force_) force_->update_after_edit(edit, environment_.complex());
  });
}

void Aiming::load_step() {
  if (options_.integrator == Integrator::rk4 && !field_)
    throw InvalidArgument(
        "simulation: the integrator rk4 follows a velocity field, but there is none: call set_field()");
  if (eddies_.act()) check_field("turbulence");
  check_sampled("diffusivity", options_.diffusivity);
  check_sampled("wall distance", options_.turbulence.wall_distance);
  if (forces_.acts()) forces_.check(fields());
  if (field_) field_->hold(motion_.time(), motion_.time() + options_.dt);
  if (force_) force_->hold(motion_.time(), motion_.time() + options_.dt);
}

void Aiming::check_field(std::string_view what) const {
  if (!field_)
    throw InvalidArgument(
        fmt::format("simulation: {} needs a velocity field, but there is none: call set_field()", what));
}

void Aiming::check_sampled(std::string_view what, const std::string& name) const {
  const VectorField* const field = sampled_.component(name).field;
  if (!name.empty() && (field == nullptr || field->place() != FieldPlace::points))
    throw InvalidArgument(fmt::format(
        "simulation: the {} \"{}\" must be a component of an array at points that the scene samples", what, name));
}

void Aiming::set_field_time(double time) {
  field_->set_times(std::span(&time, 1), environment_.complex(), environment_.threads());
}

Vec3 Aiming::flow_at_corner(SimplexId at, unsigned corner) const {
  const CellComplex& complex = environment_.complex();
  const Corners now = complex.corners(at);
  Weights w{};
  w[corner] = 1.0;
  const Vec3 flow = field_->at(complex, at, w, now);
  if (field_->frame() == FieldFrame::mesh || !motion_.deforms()) return flow;
  return flow - (now[corner] - complex.previous_corners(at)[corner]) * (1.0 / options_.dt);
}

void Aiming::start_with_field(ParticleSet& set, std::size_t first, double time) {
  check_field("a start with the field's velocity");
  set_field_time(time);
  const CellComplex& complex = environment_.complex();
  const bool carries = field_->frame() == FieldFrame::mesh && motion_.deforms();
  const std::span<Vec3> velocities = set.velocities();
  parallel_for(velocities.size() - first, aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = first + begin; i < first + end; ++i) {
      const ParticleState& s = set.states[i];
      if (s.held) continue;
      const Corners now = complex.corners(s.at());
      const Weights w = detail::barycentric(now, s.position);
      velocities[i] = field_->at(complex, s.at(), w, now);
      if (!carries) continue;
      const Vec3 moved = detail::combine(now, w) - detail::combine(complex.previous_corners(s.at()), w);
      velocities[i] += moved * (1.0 / options_.dt);
    }
  });
}

void Aiming::set_times(double begin, double duration) {
  const std::array<double, 3> times = {begin, begin + 0.5 * duration, begin + duration};
  const std::size_t in_forces = forces_.acts() ? forces_.moments() : 1;
  const std::size_t count = options_.integrator == Integrator::rk4 ? 3 : in_forces;
  begin_ = begin;
  const CellComplex& complex = environment_.complex();
  if (field_) field_->set_times(std::span(times).first(count), complex, environment_.threads());
  if (force_) force_->set_times(std::span(times).first(in_forces), complex, environment_.threads());
}

// The share of a velocity that drag takes within dt.
double Aiming::lost_to_drag(double dt) const { return -exponential_less_one(-options_.drag * dt); }

Acceleration Aiming::acceleration(double dt) const {
  if (field_ || force_ || forces_.acts() || diffuses()) return {};
  if (options_.drag == 0.0) return {options_.gravity, dt};
  return {options_.gravity * (lost_to_drag(dt) / (options_.drag * dt)), dt};
}

// Inline: a loop over all particles calls it.
inline Vec3 Aiming::accelerated(const Segment& segment, const Vec3& v, const Vec3& flow, const Vec3& force) const {
  const Vec3 acceleration = force_ ? options_.gravity + force : options_.gravity;
  if (options_.drag == 0.0) return field_ ? flow : v + acceleration * segment.dt;
  return v + (flow + acceleration * (1.0 / options_.drag) - v) * segment.lost;
}

Aiming::Segment Aiming::segment_of(ParticleSet& set, double dt, bool moving) {
  targets_.resize(set.states.size());
  return {set.states, set.statuses(), set.velocities(), dt, options_.drag > 0.0 ? lost_to_drag(dt) : 0.0, moving};
}

void Aiming::aim(ParticleSet& set, double dt, bool moving) {
  const Segment segment = segment_of(set, dt, moving);
  losses_.assign(counts_losses_ ? targets_.size() : 0, DragLoss());
  if (forces_.acts()) {
    aim_by_forces(segment, set);
  } else {
    std::vector<Vec3> before;
    if (counts_losses_ && options_.drag > 0.0) before.assign(segment.velocities.begin(), segment.velocities.end());
    options_.integrator == Integrator::rk4 ? aim_by_runge_kutta(segment) : aim_at_field(segment);
    if (eddies_.act()) add_eddies(segment, set);
    if (!before.empty()) note_losses(segment, before);
  }
  if (diffuses()) diffuse(segment, set);
}

// Particles that follow the field follow the eddy; drag takes them a share of the way to its velocity.
void Aiming::add_eddies(const Segment& segment, ParticleSet& set) {
  const RandomMoment moment = eddies_.moment(moment_);
  const double share = options_.drag > 0.0 ? segment.lost : 1.0;
  const SampledFields::Component distance = sampled_.component(options_.turbulence.wall_distance);
  parallel_for(targets_.size(), aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (segment.statuses[i] != ParticleStatus::alive || segment.particles[i].held) continue;
      Vec3 change = eddies_.velocity(set.user_data(i), moment, set.ids()[i], segment.dt, {}) * share;
      if (distance.field != nullptr)
        change = eddies_.damped(change, set.user_data(i), sampled_.at(distance, segment.particles[i], segment.moving));
      segment.velocities[i] += change;
      targets_[i] = flushed(targets_[i] + change * segment.dt);
    }
  });
}

// The loss to the constant drag is the change that the acceleration does not explain. The way is that of the step, by
// the velocity at its end.
void Aiming::note_losses(const Segment& segment, std::span<const Vec3> before) {
  const CellComplex& complex = environment_.complex();
  parallel_for(losses_.size(), aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ParticleState& s = segment.particles[i];
      if (segment.statuses[i] != ParticleStatus::alive || s.held) continue;
      Vec3 a = options_.gravity;
      if (force_) {
        const Corners now = complex.corners(s.at());
        a += force_->at(complex, s.at(),
                        detail::barycentric(segment.moving ? complex.previous_corners(s.at()) : now, s.position), now);
      }
      const Vec3& v = segment.velocities[i];
      const double gain = 0.5 * (dot(v, v) - dot(before[i], before[i]));
      losses_[i] = {a * segment.dt - (v - before[i]), dot(a, v) * segment.dt - gain};
    }
  });
}

void Aiming::diffuse(const Segment& segment, const ParticleSet& set) {
  const SampledFields::Component of = sampled_.component(options_.diffusivity);
  const double length = of.field == nullptr ? std::sqrt(2.0 * options_.diffusion * segment.dt) : 1.0;
  const RandomMoment moment = {options_.seed, RandomPurpose::diffusion, moment_};
  const RandomMoment touching = {options_.seed, RandomPurpose::bridge, moment_};
  const bool planar = environment_.map().dimension() == 2;
  parallel_for(targets_.size(), aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    std::array<Vec3, aim_grain> ways;
    NearWalls walls;
    const std::size_t size = end - begin;
    detail::draw_ways({moment, length, planar, set.ids().subspan(begin, size), std::span(ways).first(size)});
    for (std::size_t i = begin; i < end; ++i) {
      const ParticleState& state = segment.particles[i];
      if (segment.statuses[i] != ParticleStatus::alive || state.held) continue;
      double variance = 2.0 * options_.diffusion * segment.dt;
      if (of.field != nullptr) {
        const SampledFields::Value d = sampled_.at(of, state, segment.moving);
        variance = 2.0 * d.value * segment.dt;
        ways[i - begin] = ways[i - begin] * std::sqrt(variance) + d.gradient * segment.dt;
      }
      targets_[i] = flushed(targets_[i] + ways[i - begin]);
      if (!options_.brownian_bridge || variance == 0.0) continue;
      const std::uint32_t chance = touching.bits(set.ids()[i])[0];
      targets_[i] = flushed(bridged(environment_.complex(), responses_, walls,
                                    {state, set.radii()[i], targets_[i], variance, chance, segment.moving}));
    }
  });
}

// Most particles of a flow are aimed four at a time, and most of those without one in a short loop. The others are
// aimed one by one.
void Aiming::aim_at_field(const Segment& segment) {
  const bool in_fours = field_ && !force_ && field_->place() == FieldPlace::points;
  const bool flies = !field_ && !force_;
  const detail::FlowScene scene = in_fours ? flow_scene(segment) : detail::FlowScene{};
  parallel_for(targets_.size(), aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    std::array<std::uint8_t, aim_grain / 4> aimed{};
    if (in_fours)
      detail::aim_in_flow(scene, of_segment(segment, begin, end, std::span(aimed).first((end - begin) / 4)));
    if (flies) return aim_in_flight(segment, begin, end);
    for (std::size_t i = begin; i < end; ++i) {
      if ((aimed[(i - begin) / 4] >> (i - begin) % 4 & 1U) == 0) aim_one(segment, i);
    }
  });
}

void Aiming::aim_one(const Segment& segment, std::size_t i) {
  const bool leaving = leaves(segment.statuses[i]);
  const Aim a = leaving ? Aim{segment.velocities[i], segment.particles[i].position} : aim_at(segment, i);
  segment.velocities[i] = a.velocity;
  targets_[i] = flushed(a.target);
}

// As aim_one() without a field, in a loop that needs no look at cells.
void Aiming::aim_in_flight(const Segment& segment, std::size_t begin, std::size_t end) {
  const std::span<const ParticleState> states = segment.particles.states();
  const std::span<Vec3> velocities = segment.velocities;
  for (std::size_t i = begin; i < end; ++i) {
    if (states[i].held || segment.statuses[i] != ParticleStatus::alive) {
      aim_one(segment, i);
      continue;
    }
    velocities[i] = accelerated(segment, velocities[i], {}, {});
    targets_[i] = flushed(states[i].position + velocities[i] * segment.dt);
  }
}

detail::FlowScene Aiming::flow_scene(const Segment& segment) const {
  const CellComplex& complex = environment_.complex();
  detail::FlowScene scene;
  scene.now = complex.positions().data();
  scene.before = motion_.deforms() ? complex.previous_positions().data() : scene.now;
  scene.values = field_->values().data();
  scene.rest = field_->rest().empty() ? nullptr : field_->rest().data();
  scene.planar = complex.map().dimension() == 2;
  scene.moving = segment.moving;
  scene.per_move = 1.0 / options_.dt;
  scene.dt = segment.dt;
  scene.drags = options_.drag > 0.0;
  scene.lost = segment.lost;
  if (scene.drags) scene.terminal = options_.gravity * (1.0 / options_.drag);
  return scene;
}

detail::FlowParticles Aiming::of_segment(const Segment& segment, std::size_t begin, std::size_t end,
                                         std::span<std::uint8_t> aimed) {
  const std::size_t size = end - begin;
  const Particles& particles = segment.particles;
  return {particles.states().subspan(begin, size),  particles.vertex_numbers().subspan(begin, size),
          segment.statuses.subspan(begin, size),    segment.velocities.subspan(begin, size),
          std::span(targets_).subspan(begin, size), aimed};
}

void Aiming::aim_by_runge_kutta(const Segment& segment) {
  if (segment.moving) find_halfway();
  const RungeKuttaStep step = {environment_.complex(), *field_, segment.dt, segment.moving, halfway_};
  parallel_for(targets_.size(), aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    runge_kutta_velocities(step, of_segment(segment, begin, end, {}));
    for (std::size_t i = begin; i < end; ++i) {
      const ParticleState& s = segment.particles[i];
      if (s.held || segment.statuses[i] != ParticleStatus::alive)
        aim_one(segment, i);
      else
        targets_[i] = flushed(s.position + segment.velocities[i] * segment.dt);
    }
  });
}

// The same doubles as those of Between in tracking/space.hpp.
void Aiming::find_halfway() {
  const std::span<const Vec3> from = environment_.complex().previous_positions();
  const std::span<const Vec3> to = environment_.complex().positions();
  halfway_.resize(to.size());
  parallel_for(to.size(), aim_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) halfway_[v] = from[v] + (to[v] - from[v]) * 0.5;
  });
}

ForceStep::Fields Aiming::fields() const { return {field_ ? &*field_ : nullptr, force_ ? &*force_ : nullptr}; }

void Aiming::set_law(ParticleLaw law) {
  SimulationOptions options = options_;
  options.forces.terms = {Force::lorentz};  // a term that asks for nothing
  if (law) check_forces(options, environment_.map().dimension() == 2);
  forces_.set_law(std::move(law));
}

// First those that do not move by themselves.
void Aiming::aim_by_forces(const Segment& segment, ParticleSet& set) {
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (segment.particles[i].held || segment.statuses[i] != ParticleStatus::alive) aim_one(segment, i);
  }
  forces_.aim({fields(), begin_, segment.dt, segment.moving, moment_, losses_}, set, targets_);
}

void Aiming::aim_stuck(ParticleSet& set, double dt) {
  const Segment segment = segment_of(set, dt, true);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (segment.statuses[i] == ParticleStatus::stuck) targets_[i] = flushed(aim_at(segment, i).target);
  }
}

// A particle's velocity after the acceleration, and its target relative to positions before a move. A held particle
// takes no step. A stuck particle goes exactly where its wall carries it, to the last bit, so that no contact follows.
Aiming::Aim Aiming::aim_at(const Segment& segment, std::size_t i) const {
  const ParticleState& s = segment.particles[i];
  if (s.held) return {segment.velocities[i], s.position};
  const bool stuck = segment.statuses[i] == ParticleStatus::stuck;
  if (!stuck && !field_ && !force_) {
    const Vec3 v = accelerated(segment, segment.velocities[i], {}, {});
    return {v, s.position + v * segment.dt};
  }
  if (stuck && !segment.moving) return {segment.velocities[i], s.position};
  const CellComplex& complex = environment_.complex();
  const Corners now = complex.corners(s.at());
  const Corners before = motion_.deforms() ? complex.previous_corners(s.at()) : now;
  const Weights w = detail::barycentric(segment.moving ? before : now, s.position);
  const Vec3 carried = detail::combine(now, w);
  const Vec3 mesh = (carried - detail::combine(before, w)) * (1.0 / options_.dt);
  if (stuck) {
    const bool positive = volume_sign(now) == Sign::positive;
    return {mesh, positive ? detail::carried(complex, s.at(), w).position : s.position};
  }
  const Vec3 force = force_ ? force_->at(complex, s.at(), w, now) : Vec3{};
  const Vec3 flow = field_ ? field_->at(complex, s.at(), w, now) : Vec3{};
  if (!field_ || field_->frame() == FieldFrame::space) {
    const Vec3 v = accelerated(segment, segment.velocities[i], flow, force);
    return {v, s.position + v * segment.dt};
  }
  const Vec3 v = accelerated(segment, segment.velocities[i], flow + mesh, force);
  return {v, (segment.moving ? carried : s.position) + (v - mesh) * segment.dt};
}

}  // namespace dartcast
