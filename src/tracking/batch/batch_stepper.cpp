// Chunks over threads; in each the batch, then one by one the steps that it has deferred.
#include "tracking/batch/batch_stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "tracking/batch/chunk_steps.inl"
#include "tracking/checked_point.hpp"

namespace dartcast::detail {

namespace {

constexpr std::size_t chunk = max_batch;

}  // namespace

extern template void BatchStepper::step_chunk<true>(const BatchScene&, const BatchParticles&, std::span<const Vec3>,
                                                    std::size_t, std::size_t, ChunkSteps&) const;

ChunkSteps joined(std::vector<ChunkSteps> chunks) {
  if (chunks.size() == 1) return std::move(chunks.front());
  std::size_t contacts = 0;
  std::size_t walls = 0;
  for (const ChunkSteps& steps : chunks) {
    contacts += steps.report.contacts.contacts.size();
    walls += steps.report.contacts.walls.size();
  }
  ChunkSteps all;
  StepReport& report = all.report;
  report.contacts.contacts.reserve(contacts);
  report.contacts.walls.reserve(walls);
  for (const ChunkSteps& steps : chunks) {
    const StepReport& part = steps.report;
    report.contacts.append(part.contacts);
    report.held.insert(report.held.end(), part.held.begin(), part.held.end());
    report.stopped.insert(report.stopped.end(), part.stopped.begin(), part.stopped.end());
    report.counters += part.counters;
    all.waiting.insert(all.waiting.end(), steps.waiting.begin(), steps.waiting.end());
  }
  return all;
}

// The targets as decisions see them; empty where that is what they are.
std::vector<Vec3> BatchStepper::decided_targets(std::span<const Vec3> targets) const {
  const unsigned dimension = complex_.map().dimension();
  std::vector<std::uint8_t> good(chunk_count(targets.size(), chunk));
  parallel_for(targets.size(), chunk, threads_, [&](std::size_t begin, std::size_t end) {
    const std::span<const Vec3> some = targets.subspan(begin, end - begin);
    good[begin / chunk] =
        all_as_decided(some) &&
        (dimension == 3 || std::all_of(some.begin(), some.end(), [](const Vec3& q) { return q.z == 0.0; }));
  });
  if (std::all_of(good.begin(), good.end(), [](std::uint8_t g) { return g != 0; })) return {};
  std::vector<Vec3> decided(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i)
    decided[i] = checked_point(targets[i], "the target of particle", i, dimension);
  return decided;
}

// Also the targets for the batch: those of steps that it must leave as they are are no numbers.
void BatchStepper::choose(std::span<const ParticleState> states, std::span<const Vec3> targets,
                          std::span<StepTaker> takers, std::span<Vec3> batch_targets) const {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  decider_->choose(states, targets, takers);
  for (std::size_t i = 0; i < states.size(); ++i)
    batch_targets[i] = takers[i] == StepTaker::decider ? Vec3{none, none, none} : targets[i];
}

// Whether a walk takes the step to its target. If not, all is as before.
bool BatchStepper::walks_freely(StepState& step, const SteppedParticle& particle) const {
  const ParticleState state = particle.state;
  const Weights weights = particle.weights;
  const Counters counters = particle.counters;
  const std::size_t contacts = particle.contacts.contacts.size();
  const std::size_t walls = particle.contacts.walls.size();
  stepper_.run_to_contact(step, particle);
  if (!step.waits() && !particle.state.held && particle.state.position == step.target) return true;
  particle.state = state;
  particle.weights = weights;
  particle.counters = counters;
  particle.contacts.contacts.resize(contacts);
  particle.contacts.walls.resize(walls);
  step.stage = StepStage::start;
  return false;
}

// A step that the batch has deferred, with a decider.
void BatchStepper::take(StepTaker taker, StepState& step, const SteppedParticle& particle) const {
  if (taker == StepTaker::carried) return stepper_.run(step, particle);
  if (taker == StepTaker::walk && walks_freely(step, particle)) return;
  step.impact.reset();
  step.result = decider_->step(step.particle, particle.state, particle.weights, step.target, particle.contacts,
                               particle.counters);
}

// Also makes the cache that of the step.
BatchScene BatchStepper::scene_of(ParticleCache& cache, std::size_t count) const {
  const CacheKind in_space = moved_ ? CacheKind::previous_geometry : CacheKind::barycentric;
  const CacheKind kind = complex_.map().dimension() == 2 ? CacheKind::none : in_space;
  const BatchScene scene{&complex_, moved_, kind == cache.kind_, options_, !cache.walls_changed_};
  cache.kind_ = kind;
  cache.simplices_.resize(kind == CacheKind::none ? 0 : count);
  cache.walls_changed_ = false;
  return scene;
}

StepReport BatchStepper::step_all(const BatchParticles& particles, std::span<const Vec3> targets) const {
  BatchScene scene = scene_of(particles.cache, targets.size());
  scene.stops = !stepper_.responds() && rounds_ == nullptr && decider_ == nullptr && tallied_.tally == nullptr &&
                complex_.periodic() == nullptr;
  std::vector<ChunkSteps> chunks(chunk_count(targets.size(), chunk));
  parallel_for(targets.size(), chunk, threads_, [&](std::size_t begin, std::size_t end) {
    ChunkSteps& steps = chunks[begin / chunk];
    if (tallied_.tally != nullptr)
      step_chunk<true>(scene, particles, targets, begin, end, steps);
    else
      step_chunk<false>(scene, particles, targets, begin, end, steps);
  });
  ChunkSteps steps = joined(std::move(chunks));
  return rounds_ != nullptr ? answer_in_rounds(particles, std::move(steps)) : std::move(steps.report);
}

StepReport BatchStepper::advance(const BatchParticles& particles, std::span<const Vec3> targets) const {
  if (targets.size() != particles.states.size())
    throw InvalidArgument(fmt::format("{}: {} targets for {} particles",
                                      rounds_ != nullptr ? "advance_in_rounds" : "advance", targets.size(),
                                      particles.states.size()));
  const std::vector<Vec3> decided = decided_targets(targets);
  if (!decided.empty()) targets = decided;
  if (!may_throw_) return step_all(particles, targets);
  const std::vector<ParticleState> states(particles.states.begin(), particles.states.end());
  const std::vector<Weights> weights(particles.weights.begin(), particles.weights.end());
  const ParticleCache cache = particles.cache;
  const std::optional<CellTally> tally = tallied_.tally != nullptr ? std::optional(*tallied_.tally) : std::nullopt;
  try {
    return step_all(particles, targets);
  } catch (...) {
    std::copy(states.begin(), states.end(), particles.states.begin());
    std::copy(weights.begin(), weights.end(), particles.weights.begin());
    particles.cache = cache;
    if (tally) *tallied_.tally = *tally;
    throw;
  }
}

}  // namespace dartcast::detail
