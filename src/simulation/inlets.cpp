// How many particles each inlet injects in a step, and where.
//
// The number up to a step is a function of the step alone: a run that goes on has the same, and nothing is kept.
#include "simulation/inlets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

constexpr double radians = 3.14159265358979323846 / 180.0;

void check_cone(const InletCone& c, unsigned dimension) {
  const auto fail = [](const std::string& message) { throw InvalidArgument("simulation: a cone's " + message); };
  if (!is_finite(c.at)) fail("point must be finite");
  if (!is_finite(c.axis) || !(norm(c.axis) > 0.0) || !std::isfinite(norm(c.axis)))
    fail(fmt::format("axis is ({}, {}, {}): it must be finite and not 0", c.axis.x, c.axis.y, c.axis.z));
  if (dimension == 2 && (c.at.z != 0.0 || c.axis.z != 0.0)) fail("point and axis must have z = 0 in the plane");
  if (!(c.inner >= 0.0 && c.outer >= c.inner && c.outer <= 180.0))
    fail(fmt::format("angles are {} and {}: they must be from 0 to 180 degrees, the outer one not the smaller", c.inner,
                     c.outer));
  if (!(c.speed >= 0.0) || !std::isfinite(c.speed))
    fail(fmt::format("speed is {}: it must be finite and not negative", c.speed));
}

void check_rate(const InletParticles& inlet, double largest_factor, double dt) {
  constexpr auto max_injected = static_cast<double>(most_at_once);  // in a step
  if (!(inlet.rate >= 0.0 && inlet.rate * largest_factor * dt <= max_injected))
    throw InvalidArgument(fmt::format(
        "simulation: an inlet's rate is {} particles a second{}: it must not be negative, and at most {} with steps of "
        "{} "
        "s (2^31 particles a step)",
        inlet.rate, inlet.mass_rate != 0.0 ? ", by its mass rate" : "", max_injected / (largest_factor * dt), dt));
  check_count(inlet.burst_count);
  for (const double t : inlet.burst_times) {
    if (!(t >= 0.0) || !std::isfinite(t))
      throw InvalidArgument(
          fmt::format("simulation: an inlet's burst is at {} s: it must be finite and not negative", t));
  }
}

// Particles a second, each of which stands for so many.
double number_rate(const InletParticles& inlet, const Material& material, const std::optional<SizeSampler>& sizes,
                   std::uint64_t number) {
  const double d = material.diameter;
  const double mass = 3.14159265358979323846 / 6.0 * material.density * (sizes ? sizes->mean_cube() : d * d * d);
  if (!(inlet.mass_rate >= 0.0) || inlet.rate != 0.0)
    throw InvalidArgument(fmt::format(
        "simulation: an inlet's mass rate is {}: it must not be negative, and there must be no rate beside it",
        inlet.mass_rate));
  if (!(mass > 0.0))
    throw InvalidArgument("simulation: an inlet's mass rate needs particles of a diameter and density");
  return inlet.mass_rate / (mass * static_cast<double>(number));
}

}  // namespace

Vec3 direction_in(const InletCone& cone, unsigned dimension, KeyedRandom& random) {
  const Vec3 axis = cone.axis * (1.0 / norm(cone.axis));
  const double share = random.uniform();
  const double turn = random.uniform();
  if (dimension == 2) {
    const double angle = cone.inner + share * (cone.outer - cone.inner);
    const SineCosine a = sine_cosine((turn < 0.5 ? angle : -angle) * radians);
    return {axis.x * a.cosine - axis.y * a.sine, axis.x * a.sine + axis.y * a.cosine, 0.0};
  }
  const double inner = sine_cosine(cone.inner * radians).cosine;
  const double outer = sine_cosine(cone.outer * radians).cosine;
  const double cosine = inner + share * (outer - inner);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const SineCosine around = sine_cosine_of_turns(turn);
  const bool is_x = std::abs(axis.x) < 0.5;
  Vec3 aside = cross(axis, is_x ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0});
  aside *= 1.0 / norm(aside);
  return axis * cosine + (aside * around.cosine + cross(axis, aside) * around.sine) * sine;
}

void Inlets::add(const ParticlesScene& group, const InletParticles& inlet, std::optional<Patch> patch,
                 const std::optional<SampledPart>& part) {
  check({group.velocity, group.radius, group.user_data, group.material}, environment_, options_, "an inlet's");
  const bool by_flux = inlet.profile == InletProfile::flux;
  Inlet added = {inlet,
                 patch.value_or(Patch()),
                 {},
                 RateIntegral(inlet.waveform),
                 group.velocity,
                 group.radius,
                 group.user_data,
                 group.material,
                 {},
                 group.interception,
                 group.with_field || by_flux};
  if (group.sizes) added.sizes.emplace(*group.sizes, options_.seed);
  if (inlet.mass_rate != 0.0) added.scene.rate = number_rate(inlet, group.material, added.sizes, group.number);
  check_rate(added.scene, added.waveform.largest_factor(), options_.dt);
  if (added.with_field) aiming_.check_field("an inlet with the field's velocity");
  if (patch) {
    added.sampler.emplace(environment_.complex(), *patch, part);
  } else {
    if (by_flux) throw InvalidArgument("simulation: an inlet by flux needs a patch, not a cone");
    if (!inlet.patch.empty()) throw InvalidArgument("simulation: give an inlet either a patch or a cone, not both");
    check_cone(*inlet.cone, environment_.map().dimension());
    const Vec3& at = inlet.cone->at;
    if (PointSampler(environment_, at, part).empty())
      throw InvalidArgument(
          fmt::format("simulation: the cone's point ({}, {}, {}) is in no free cell: is it in the unit of the mesh?",
                      at.x, at.y, at.z));
  }
  inlets_.push_back(std::move(added));
}

std::uint64_t Inlets::count_up_to(const Inlet& inlet, std::uint64_t steps) const {
  const double time = options_.dt * static_cast<double>(steps);
  const InletParticles& scene = inlet.scene;
  const double by_rate = scene.waveform.times.empty() ? scene.rate * options_.dt * static_cast<double>(steps)
                                                      : scene.rate * inlet.waveform(time);
  const auto bursts =
      std::count_if(scene.burst_times.begin(), scene.burst_times.end(), [&](double t) { return t < time; });
  return static_cast<std::uint64_t>(std::floor(by_rate)) + static_cast<std::uint64_t>(bursts) * scene.burst_count;
}

void Inlets::inject(const std::optional<SampledPart>& part, const std::function<void(const Injection&)>& add) {
  for (Inlet& inlet : inlets_) {
    const std::uint64_t before = count_up_to(inlet, motion_.steps());
    const std::uint64_t after = count_up_to(inlet, motion_.steps() + 1);
    if (after <= before) continue;
    Injection injection{{},
                        after - before,
                        {inlet.velocity, inlet.radius, inlet.user_data, inlet.material,
                         inlet.sizes ? &*inlet.sizes : nullptr, inlet.interception},
                        nullptr,
                        inlet.with_field};
    if (inlet.sampler) {
      inject_at_patch(inlet, injection, add);
      continue;
    }
    const PointSampler sampler(environment_, inlet.scene.cone->at, part);
    if (sampler.empty()) continue;
    injection.sampler = &sampler;
    if (!inlet.with_field) injection.cone = &*inlet.scene.cone;
    add(injection);
  }
}

void Inlets::inject_at_patch(Inlet& inlet, Injection injection, const std::function<void(const Injection&)>& add) {
  if (inlet.sampler->empty()) return;
  const CellComplex& complex = environment_.complex();
  if (inlet.scene.profile == InletProfile::flux) {
    aiming_.set_field_time(motion_.time());
    if (!inlet.sampler->update(complex, [&](SimplexId s, unsigned k) { return aiming_.flow_at_corner(s, k); })) return;
  } else if (motion_.deforms()) {
    inlet.sampler->update(complex);
  }
  injection.sampler = &*inlet.sampler;
  add(injection);
}

// They draw from the areas at rest.
void Inlets::change_part(const std::optional<SampledPart>& part) {
  for (Inlet& i : inlets_) {
    if (i.sampler) i.sampler.emplace(environment_.complex(), i.patch, part);
  }
}

}  // namespace dartcast
