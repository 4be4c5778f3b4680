// Brings the fields to the times of a step, and lets tracers follow the velocity field by Runge-Kutta.
#include <array>
#include <span>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "simulation/particle_system.hpp"
#include "simulation/runge_kutta.hpp"

namespace dartcast {

namespace {

constexpr std::size_t tracer_grain = 256;

}  // namespace

void ParticleSystem::load_step() {
  if (options_.integrator == Integrator::rk4 && !field_)
    throw InvalidArgument(
        "simulation: the integrator rk4 follows a velocity field, but there is none: call set_field()");
  if (field_) field_->hold(time(), time() + options_.dt);
  if (force_) force_->hold(time(), time() + options_.dt);
}

void ParticleSystem::set_fields_to(double begin, double duration) {
  const std::array<double, 3> times = {begin, begin + 0.5 * duration, begin + duration};
  const std::size_t count = options_.integrator == Integrator::rk4 ? 3 : 1;
  const CellComplex& complex = environment_.complex();
  if (field_) field_->set_times(std::span(times).first(count), complex, environment_.threads());
  if (force_) force_->set_times(std::span(times).first(1), complex, environment_.threads());
}

void ParticleSystem::aim_by_runge_kutta(double dt, bool moving) {
  targets_.resize(set_.states.size());
  const Forces forces = forces_of(dt);
  const RungeKuttaStep step = {environment_.complex(), *field_, dt, moving};
  parallel_for(set_.states.size(), tracer_grain, environment_.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ParticleState& s = set_.states[i];
      const bool follows = set_.fates()[i] == ParticleStatus::alive && !s.held;
      const Aim a = follows ? Aim{runge_kutta_velocity(step, s), {}} : aim_at(i, forces, moving);
      set_.velocities()[i] = a.velocity;
      targets_[i] = flushed(follows ? s.position + a.velocity * dt : a.target);
    }
  });
}

}  // namespace dartcast
