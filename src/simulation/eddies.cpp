// A discrete random walk: the velocity of an eddy is held for its life, or until the particle has crossed it.
//
// The life is constant where k and epsilon are, and a particle's first eddy has a random share of it. So the velocities are
// stationary from the start, with the correlation 1 - s / life.
#include "simulation/eddies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/elementary.hpp"
#include "base/normal_deviates.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

constexpr double c_mu = 0.09;
constexpr double damping = 0.02;  // per y+

std::size_t column(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InvalidArgument(fmt::format(
        "simulation: turbulence needs the number \"{}\" of each particle, but user_data does not have it: add it",
        name));
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

Eddies::Eddies(const SimulationOptions& options, bool planar)
    : options_(options), acts_(!options.turbulence.k.empty()), planar_(planar) {
  const TurbulenceOptions& t = options.turbulence;
  if (!(t.lagrangian > 0.0) || !std::isfinite(t.lagrangian))
    throw InvalidArgument("simulation: the turbulence's Lagrangian constant must be finite and above 0");
  if (!acts_ && t.epsilon.empty() && t.omega.empty()) return;
  if (!acts_ || t.epsilon.empty() == t.omega.empty())
    throw InvalidArgument("simulation: turbulence needs k, and one of epsilon and omega");
  const Fluid& fluid = options.forces.fluid;
  if (!t.wall_distance.empty() && !(fluid.density > 0.0 && fluid.viscosity > 0.0))
    throw InvalidArgument("simulation: turbulence with a wall distance needs the fluid's density and viscosity");
  if (options.collisions)
    throw InvalidArgument("simulation: spheres that collide know of no eddies: leave collisions or turbulence out");
  energy_ = column(options.user_data, t.k);
  rate_ = column(options.user_data, t.epsilon.empty() ? t.omega : t.epsilon);
  state_ = column(options.user_data, eddy_numbers[0]);
  for (std::size_t i = 1; i < eddy_numbers.size(); ++i) {
    if (column(options.user_data, eddy_numbers[i]) != state_ + i)
      throw InvalidArgument("simulation: turbulence needs eddy_x, eddy_y, eddy_z and eddy_left in a row in user_data");
  }
}

// Where there is no turbulence, there are no eddies either.
Eddies::Eddy Eddies::eddy_at(std::span<const double> numbers, const Crossing& crossing) const {
  const double k = numbers[energy_];
  const double rate = numbers[rate_];
  if (!(k > 0.0 && rate > 0.0)) return {};
  const double epsilon = options_.turbulence.epsilon.empty() ? c_mu * k * rate : rate;
  Eddy eddy = {std::sqrt(k * (2.0 / 3.0)), 2.0 * options_.turbulence.lagrangian * k / epsilon};
  if (!(eddy.life > 0.0) || !std::isfinite(eddy.life) || !std::isfinite(eddy.speed)) return {};
  // The way that drag leaves a particle relative to the eddy ends at relaxation * slip.
  const double reach = crossing.relaxation * crossing.slip;
  const double root = std::sqrt(k);
  const double size = std::sqrt(std::sqrt(c_mu * c_mu * c_mu)) * k * root / epsilon;
  if (size < reach) eddy.life = std::min(eddy.life, -crossing.relaxation * logarithm(1.0 - size / reach));
  return eddy;
}

namespace {

// Eddies are held for whole steps, n or n + 1 of them if the life is between. The dispersion of a long time is that of
// the life if the variance of the velocity has this factor. It is the life times the mean of the number of steps,
// divided by the mean of its square. Below one step the velocity is the mean of those of several eddies. For many steps
// the factor is 1.
double share_of_variance(double life, double duration) {
  const double steps = std::max(1.0, life / duration);
  if (steps > 0x1p+20) return 1.0;
  const double n = std::floor(steps);
  return life / duration * steps / (n * n + (steps - n) * (2.0 * n + 1.0));
}

}  // namespace

Vec3 Eddies::velocity(std::span<double> numbers, const RandomMoment& moment, std::uint64_t id, double duration,
                      const Crossing& crossing) const {
  const std::span<double> state = numbers.subspan(state_, eddy_numbers.size());
  double& left = state[3];
  if (!(left > 0.0)) {
    const Eddy eddy = eddy_at(numbers, crossing);
    if (!(eddy.life > 0.0)) {
      std::fill(state.begin(), state.end(), 0.0);
      return {};
    }
    const bool first = state[0] == 0.0 && state[1] == 0.0 && state[2] == 0.0;
    const double speed = eddy.speed * std::sqrt(share_of_variance(eddy.life, duration));
    const std::array<double, 4> deviates = normal_deviates(moment.bits(id));
    for (std::size_t i = 0; i < 3; ++i) state[i] = i == 2 && planar_ ? 0.0 : speed * deviates[i];
    const double life = std::max(eddy.life, duration);
    // An eddy that ended within a step has taken some of the time of the next one.
    left = first ? life * (static_cast<double>(moment.bits(id, 1)[0]) + 0.5) * 0x1p-32 : left + life;
  }
  left -= duration;
  return {state[0], state[1], state[2]};
}

Vec3 Eddies::damped(const Vec3& velocity, std::span<const double> numbers, const SampledFields::Value& distance) const {
  const Vec3& normal = distance.gradient;
  const double square = dot(normal, normal);
  if (!(square > 0.0)) return velocity;
  const Fluid& fluid = options_.forces.fluid;
  const double friction_speed = std::sqrt(std::sqrt(c_mu) * std::max(0.0, numbers[energy_]));
  const double y = distance.value * friction_speed * fluid.density / fluid.viscosity;
  return velocity - normal * (dot(velocity, normal) / square * exponential(-damping * y));
}

}  // namespace dartcast
