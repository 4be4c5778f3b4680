// The steps of a chunk. It is compiled twice, in files of their own: with a tally (chunk_steps_tallied.cpp), and without.
// Then what one of them calls once is inlined there.
#pragma once

#include <array>
#include <cstring>
#include <type_traits>

#include "tracking/batch/batch_plane.hpp"
#include "tracking/batch/batch_stepper.hpp"
#include "tracking/batch/chunk_tally.hpp"

namespace dartcast::detail {

namespace {

struct NoTally {};

// The next step, from i on, that the batch has not completed. Most are complete: four are looked at together.
std::size_t next_deferred(std::span<const StepStatus> status, std::size_t i) {
  static_assert(sizeof(StepStatus) == 2 && step_complete == 0xffff);
  for (std::uint64_t four = 0; i + 4 <= status.size(); i += 4) {
    std::memcpy(&four, &status[i], sizeof four);
    if (four != ~std::uint64_t{0}) break;
  }
  while (i < status.size() && status[i] == step_complete) ++i;
  return i;
}

}  // namespace

template <bool tallied>
void BatchStepper::step_chunk(const BatchScene& scene, const BatchParticles& particles, std::span<const Vec3> targets,
                              std::size_t begin, std::size_t end, ChunkSteps& steps) const {
  StepReport& report = steps.report;
  const std::size_t size = end - begin;
  ParticleCache& cache = particles.cache;
  std::array<StepStatus, max_batch> status;
  std::vector<StepState> partial;
  partial.reserve(size);
  targets = targets.subspan(begin, size);
  const std::span<ParticleState> states = particles.states.subspan(begin, size);
  std::vector<StepTaker> takers;  // with a decider
  std::vector<Vec3> batch_targets;
  if (decider_ != nullptr) {
    takers.resize(size);
    batch_targets.resize(size);
    choose(states, targets, takers, batch_targets);
  }
  const BatchSteps batch{states,
                         std::span(cache.vertices_).subspan(begin, size),
                         cache.simplices_.from(begin),
                         decider_ != nullptr ? std::span<const Vec3>(batch_targets) : targets,
                         std::span(status).first(size),
                         partial};
  std::conditional_t<tallied, ChunkTally, NoTally> tally;
  if constexpr (tallied) tally.begin(tallied_, states, particles.weights.subspan(begin, size), begin);
  if (complex_.map().dimension() == 2)
    step_plane(scene, batch, report.counters);
  else
    step_batch(scene, batch, report.counters);
  report.contacts.contacts.reserve(partial.size());
  report.contacts.walls.reserve(3 * partial.size());  // at a corner there are several
  report.stopped.reserve(partial.size());
  for (std::size_t i = next_deferred(batch.status, 0); i < size; i = next_deferred(batch.status, i + 1)) {
    StepState& step = status[i] == step_untouched ? partial.emplace_back() : partial[status[i]];
    step.begin(static_cast<std::uint32_t>(begin + i), states[i], targets[i], report.contacts);
    const SteppedParticle particle{states[i], particles.weights[begin + i], report.contacts, report.counters};
    if constexpr (tallied) {
      if (decider_ == nullptr && tally.counts(i)) {
        stepper_.run_tallied(step, particle, tally.writer(i));
        add(particles, step, steps);
        continue;
      }
    }
    if (decider_ != nullptr)
      take(takers[i], step, particle);
    else if (rounds_ != nullptr)
      stepper_.run_to_contact(step, particle);
    else
      stepper_.run(step, particle);
    add(particles, step, steps);
  }
  if constexpr (tallied) tally.add(stepper_, batch, moved_, decider_ != nullptr, report.contacts.contacts);
}

}  // namespace dartcast::detail
