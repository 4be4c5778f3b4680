// Many points, in chunks over threads. Each chunk has memory of its own, and no point knows of another.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "dartcast/spheres.hpp"
#include "environment/watched_step.hpp"
#include "spheres/simultaneous_step.hpp"
#include "tracking/checked_point.hpp"

namespace dartcast {

struct SimultaneousStepper::Buffers {
  std::vector<SimultaneousStep::Memory> memory;
  std::vector<ParticleState> states;
  std::vector<Weights> weights;
  std::vector<Vec3> targets;
};

SimultaneousStepper::SimultaneousStepper() = default;
SimultaneousStepper::~SimultaneousStepper() = default;
SimultaneousStepper::SimultaneousStepper(SimultaneousStepper&&) noexcept = default;
SimultaneousStepper& SimultaneousStepper::operator=(SimultaneousStepper&&) noexcept = default;

StepReport SimultaneousStepper::advance(Environment& environment, Particles& particles, std::span<const Vec3> targets,
                                        const ContactCallback& respond, const StepOptions& options) {
  environment.check_advance(particles, options);
  const std::size_t count = particles.size();
  if (count == 0 || targets.size() != count || !environment.awaits_advance(particles))
    return environment.advance(particles, targets, respond, options);
  if (!buffers_) buffers_ = std::make_unique<Buffers>();
  Buffers& b = *buffers_;
  b.targets.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    b.targets[i] = detail::checked_point(targets[i], "the target of particle", i, environment.map().dimension());
  b.states.assign(particles.states().begin(), particles.states().end());
  b.weights.resize(count);
  for (std::size_t i = 0; i < count; ++i) b.weights[i] = particles.held_weights(i);
  std::optional<WatchedStep> watched;
  if (environment.replay_hook()) watched.emplace(environment, particles, targets, options, true);
  const ContactCallback noted = watched ? watched->noted(respond) : ContactCallback{};
  const std::size_t grain = std::max<std::size_t>(256, chunk_count(count, 256));
  std::vector<StepReport> reports(chunk_count(count, grain));
  if (b.memory.size() < reports.size()) b.memory.resize(reports.size());
  const SimultaneousStep stepper(environment.complex(), options, watched ? noted : respond);
  const auto take_some = [&](std::size_t begin, std::size_t end) {
    StepReport& report = reports[begin / grain];
    for (std::size_t i = begin; i < end; ++i) {
      const auto particle = static_cast<std::uint32_t>(i);
      const StepResult result = stepper.step(particle, b.states[i], b.weights[i], b.targets[i], report.contacts,
                                             report.counters, b.memory[begin / grain]);
      if (result.held) report.held.push_back({particle, result.invalid_cell});
      if (result.stopped) report.stopped.push_back({particle, result.unused});
    }
  };
  const auto take = [&] { parallel_for(count, grain, environment.threads(), take_some); };
  if (watched) {
    watched->run(take);
    watched->check(b.states, b.weights);
  } else {
    take();
  }
  StepReport all;
  for (StepReport& part : reports) {
    all.contacts.append(part.contacts);
    all.held.insert(all.held.end(), part.held.begin(), part.held.end());
    all.stopped.insert(all.stopped.end(), part.stopped.begin(), part.stopped.end());
    all.counters += part.counters;
  }
  particles = environment.restored(b.states, b.weights);
  return all;
}

}  // namespace dartcast
