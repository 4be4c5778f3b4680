// How many particles each inlet injects in a step, and where.
#include "simulation/inlets.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

void Inlets::add(Patch patch, double rate, const NewParticle& particle, const std::optional<SampledPart>& part) {
  constexpr auto max_injected = static_cast<double>(most_at_once);  // in a step
  if (!(rate >= 0.0 && rate * options_.dt <= max_injected))
    throw InvalidArgument(fmt::format(
        "simulation: an inlet's rate is {}: it must not be negative, and at most {} a second with steps of {} s "
        "(2^31 particles a step)",
        rate, max_injected / options_.dt, options_.dt));
  check(particle, environment_, options_, "an inlet's");
  const auto& [velocity, radius, numbers] = particle;
  PatchSampler sampler(environment_.complex(), patch, part);
  inlets_.push_back({patch, std::move(sampler), rate, velocity, radius, {numbers.begin(), numbers.end()}});
}

void Inlets::inject(const Add& add) {
  for (Inlet& inlet : inlets_) {
    const auto up_to = [&](std::uint64_t steps) {
      return std::floor(inlet.rate * options_.dt * static_cast<double>(steps));
    };
    const auto count = static_cast<std::uint64_t>(up_to(motion_.steps() + 1) - up_to(motion_.steps()));
    if (count == 0 || inlet.sampler.empty()) continue;
    if (motion_.deforms()) inlet.sampler.update(environment_.complex());
    add(inlet.sampler, count, {inlet.velocity, inlet.radius, inlet.user_data});
  }
}

// They draw from the areas at rest.
void Inlets::change_part(const std::optional<SampledPart>& part) {
  std::vector<Inlet> inlets;
  for (Inlet& i : inlets_)
    inlets.push_back({i.patch, PatchSampler(environment_.complex(), i.patch, part), i.rate, i.velocity, i.radius,
                      std::move(i.user_data)});
  inlets_ = std::move(inlets);
}

}  // namespace dartcast
