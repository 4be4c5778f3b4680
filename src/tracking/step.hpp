// One step of one particle: it is carried along with the mesh, walks to its target, and responds at walls.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "tracking/step_state.hpp"

namespace dartcast {

namespace detail {
class TallyWriter;  // tracking/tally_writer.hpp
}

/// The particle that a step moves, and the lists and sums that the step adds to.
struct SteppedParticle {
  ParticleState& state;
  Weights& weights;
  ContactList& contacts;  ///< in order of time
  Counters& counters;
};

/// The complex and the rules, which all steps of a set of particles share.
struct StepSetting {
  const CellComplex& complex;
  bool moved;
  const StepOptions& options;
  const ContactCallback& respond;
  const CrossingCallback* crossed = nullptr;  ///< none: nothing is called at crossings
};

/// Carries particles through one step of a complex. A plain reader of the complex: any number may run at once.
class Stepper {
 public:
  /// `moved`: the complex's positions have been committed for this step. Targets then are relative to positions before
  /// the move (they are absolute points, computed by the caller from where the particle was).
  Stepper(const CellComplex& complex, bool moved, const StepOptions& options, const ContactCallback& respond,
          const CrossingCallback* crossed = nullptr)
      : setting_{complex, moved, options, respond, crossed} {}

  /// Whether anything responds at walls: else particles stop at the first one.
  [[nodiscard]] bool responds() const { return static_cast<bool>(setting_.respond); }

  /// Steps one particle to `target`, a finite point in the exact range. `step`: one that a batch has begun.
  StepResult step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                  ContactList& contacts, Counters& counters, StepState step = {}) const {
    step.begin(particle, state, target, contacts);
    run(step, {state, weights, contacts, counters});
    return step.result;
  }
  /// Runs a step to its end, from any stage but `contact`.
  void run(StepState& step, const SteppedParticle& particle) const;

  /// The same up to its first contact, where it waits for the answer. It calls no response.
  void run_to_contact(StepState& step, const SteppedParticle& particle) const;
  /// Goes on with a step that waits, after the answer to `contact`, which is in the list `met`, up to its next contact.
  /// Adds that to the particle's contacts, with all walls met earlier in the step in front of its own.
  void answer(const ContactList& met, const Contact& contact, const AfterContact& next, StepState& step,
              const SteppedParticle& particle) const;

  /// step() to the same bits, which also records its crossings. Cost: some exact values for each crossing.
  StepResult trace(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                   ContactList& contacts, std::vector<Crossing>& crossings) const;

  // These add a step to a tally. The writer takes it from its start to its end.
  /// run(), from any stage but `contact`.
  void run_tallied(StepState& step, const SteppedParticle& particle, detail::TallyWriter& writer) const;
  /// A step that something else has taken to its target, without a contact.
  void tally_arrived(const ParticleState& before, const ParticleState& after, detail::TallyWriter& writer) const;
  /// A step that has no walk: a straight way from where the mesh carries the particle, up to the fraction `end` of the step
  /// (dartcast/cell_tally.hpp). `held`: its weights before the step, if it was held.
  void tally_straight(const ParticleState& before, const Weights& held, const ParticleState& after, double end,
                      detail::TallyWriter& writer) const;

 private:
  // run() if nothing responds, and the step's end is known.
  void stop_at_impact(StepState& step, const SteppedParticle& particle) const;

  StepSetting setting_;
};

}  // namespace dartcast
