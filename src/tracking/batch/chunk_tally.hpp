// Adds the steps of a chunk to a tally: those that the batch has completed, and those that a decider has taken.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tracking/batch/batch_stepper.hpp"
#include "tracking/step.hpp"
#include "tracking/tally_writer.hpp"

namespace dartcast::detail {

class ChunkTally {
 public:
  /// Before the steps, of particles that are numbered from `first` on.
  void begin(const Tallied& tallied, std::span<const ParticleState> states, std::span<const Weights> weights,
             std::size_t first) {
    writer_.emplace(*tallied.tally);
    tallied_ = tallied;
    first_ = first;
    before_.assign(states.begin(), states.end());
    held_.assign(weights.begin(), weights.end());
  }
  /// Whether the chunk's step i is added.
  [[nodiscard]] bool counts(std::size_t i) const { return tallied_.radii.empty() || tallied_.radii[first_ + i] == 0.0; }
  /// For the chunk's step i, which Stepper takes.
  [[nodiscard]] TallyWriter& writer(std::size_t i) {
    writer_->set_particle(tallied_.particles, first_ + i);
    return *writer_;
  }

  /// After the steps. `contacts`: theirs.
  void add(const Stepper& stepper, const BatchSteps& steps, bool moved, bool decided,
           std::span<const Contact> contacts) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < before_.size(); ++i) {
      if (!counts(i)) continue;
      const ParticleState& before = before_[i];
      const ParticleState& after = steps.states[i];
      if (steps.status[i] == step_complete) {
        if (!moved && before.at() == after.at())
          writer(i).stay(after.cell, norm(after.position - before.position));
        else
          stepper.tally_arrived(before, after, writer(i));
      } else if (decided) {
        while (next < contacts.size() && contacts[next].particle < first_ + i) ++next;
        const bool met = next < contacts.size() && contacts[next].particle == first_ + i;
        stepper.tally_straight(before, held_[i], after, met ? contacts[next].time_of_impact : 1.0, writer(i));
      }
    }
  }

 private:
  std::optional<TallyWriter> writer_;
  std::vector<ParticleState> before_;
  std::vector<Weights> held_;
  Tallied tallied_;
  std::size_t first_ = 0;  // particle of the chunk
};

}  // namespace dartcast::detail
