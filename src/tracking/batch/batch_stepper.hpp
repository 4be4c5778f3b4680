// Advances many particles: in chunks over threads, the usual steps in vectors, the others one by one. With a response
// in rounds the steps of particles at walls wait until one call has answered all of them (batch_rounds.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/threads.hpp"
#include "tracking/batch/batch.hpp"
#include "tracking/batch/particle_cache.hpp"
#include "tracking/batch/step_decider.hpp"
#include "tracking/batch/travelling_step.hpp"
#include "tracking/step.hpp"
#include "tracking/tallied.hpp"

namespace dartcast::detail {

/// A set of particles: one entry per particle in each.
struct BatchParticles {
  std::span<ParticleState> states;
  std::span<Weights> weights;
  ParticleCache& cache;
};

/// Steps of consecutive particles.
struct ChunkSteps {
  StepReport report;
  /// One at each of the report's contacts; or none, if these are not to be answered.
  std::vector<StepState> waiting;
};

/// A set of particles that grows while it steps: particles come from other ranks.
struct GrowingParticles {
  std::vector<ParticleState>& states;
  std::vector<Weights>& weights;
  ParticleCache& cache;
};

/// The ranks that have an environment's parts, as the steps of one of them see them.
class PartTraffic {
 public:
  PartTraffic() = default;
  PartTraffic(const PartTraffic&) = delete;
  PartTraffic& operator=(const PartTraffic&) = delete;
  virtual ~PartTraffic() = default;

  [[nodiscard]] virtual const PartCells& cells() const = 0;
  /// Sends steps away, each to the rank Traveller::to, and returns those that come here, in an order that depends on the
  /// ranks alone. If no rank has sent any, `over` becomes true. The data that users keep of a particle go along:
  /// StepState::particle is its index here. Those that come get the next indices, in their order. Collective.
  virtual std::vector<Traveller> exchange(std::vector<Traveller> leaving, bool& over) = 0;
};

/// A contact's walls, behind those that the particle met earlier.
inline std::span<const WallHit> all_walls_of(const ContactList& list, const Contact& c) {
  return std::span(list.walls).subspan(c.first_wall - c.earlier, c.earlier + c.wall_count);
}

/// The steps of consecutive chunks.
ChunkSteps joined(std::vector<ChunkSteps> chunks);

/// Carries any number of particles through one step of a complex, with the results that Stepper (tracking/step.hpp)
/// gives one by one, to the same bits.
class BatchStepper {
 public:
  /// `moved`: as for Stepper. `may_throw`: whether `respond` may. `decider`: takes the steps that may meet a wall; none:
  /// Stepper does. `crossed`: as for Stepper. The references must outlive the stepper.
  BatchStepper(const CellComplex& complex, bool moved, Threads threads, const StepOptions& options,
               const ContactCallback& respond, bool may_throw, const StepDecider* decider = nullptr,
               const Tallied& tallied = {}, const CrossingCallback* crossed = nullptr)
      : complex_(complex),
        moved_(moved),
        threads_(threads),
        options_(options),
        may_throw_(may_throw),
        decider_(decider),
        tallied_(tallied),
        stepper_(complex, moved, options, respond, crossed) {}
  /// With a response in rounds, which is not empty.
  BatchStepper(const CellComplex& complex, bool moved, Threads threads, const StepOptions& options,
               const RoundCallback& respond, const CrossingCallback* crossed = nullptr);

  /// Advances each particle to its target. Throws InvalidArgument if the numbers differ, or a target is not finite, out
  /// of the exact range or not in the plane. Throws what a response throws. Nothing is changed then. Cost: some 20 ns a
  /// particle, and 1 us for each that meets a wall; and a few us for each round.
  StepReport advance(const BatchParticles& particles, std::span<const Vec3> targets) const;

  /// The same in a part of an environment, in space: steps go on where their cells are. Particles in `gone` are now on
  /// another rank; those behind the first ones have come. The report has what happened here, of both. Collective.
  StepReport advance_in_part(const GrowingParticles& particles, std::span<const Vec3> targets,
                             const ContactCallback& respond, PartTraffic& traffic,
                             std::vector<std::uint8_t>& gone) const;

 private:
  [[nodiscard]] std::vector<Vec3> decided_targets(std::span<const Vec3> targets) const;
  friend class PartSteps;

  [[nodiscard]] StepReport step_all(const BatchParticles& particles, std::span<const Vec3> targets) const;
  [[nodiscard]] BatchScene scene_of(ParticleCache& cache, std::size_t count) const;
  // tallied: there is a tally.
  template <bool tallied>
  void step_chunk(const BatchScene& scene, const BatchParticles& particles, std::span<const Vec3> targets,
                  std::size_t begin, std::size_t end, ChunkSteps& steps) const;
  void choose(std::span<const ParticleState> states, std::span<const Vec3> targets, std::span<StepTaker> takers,
              std::span<Vec3> batch_targets) const;
  void take(StepTaker taker, StepState& step, const SteppedParticle& particle) const;
  bool walks_freely(StepState& step, const SteppedParticle& particle) const;
  // A step that has come to its end, or to a contact.
  void add(const BatchParticles& particles, const StepState& step, ChunkSteps& steps) const {
    if (step.waits()) return steps.waiting.push_back(step);
    const std::uint32_t i = step.particle;
    if (step.result.held) steps.report.held.push_back({i, step.result.invalid_cell});
    if (step.result.stopped) steps.report.stopped.push_back({i, step.result.unused});
    if (!step.stays(particles.states[i])) particles.cache.place(i, complex_, particles.states[i]);
  }
  // In rounds.
  [[nodiscard]] ChunkSteps answer(const BatchParticles& particles, std::span<const StepState> waiting,
                                  const ContactList& met, std::span<const AfterContact> after) const;
  [[nodiscard]] StepReport answer_in_rounds(const BatchParticles& particles, ChunkSteps steps) const;

  const CellComplex& complex_;
  bool moved_;
  Threads threads_;
  const StepOptions& options_;
  bool may_throw_;
  const StepDecider* decider_ = nullptr;
  Tallied tallied_;
  const RoundCallback* rounds_ = nullptr;  // none: the stepper responds at each contact
  Stepper stepper_;
};

}  // namespace dartcast::detail
