// The step of one particle that is added to a tally.
#include "tracking/step.hpp"
#include "tracking/step_run.hpp"
#include "tracking/tally_writer.hpp"

namespace dartcast {

void Stepper::run_tallied(StepState& step, const SteppedParticle& particle, detail::TallyWriter& writer) const {
  writer.begin(particle.state);
  detail::run_step(setting_, step, particle, writer);
  writer.finish();
}

// A batch has taken it, without a contact.
void Stepper::tally_arrived(const ParticleState& before, const ParticleState& after,
                            detail::TallyWriter& writer) const {
  const CellComplex& complex = setting_.complex;
  if (!setting_.moved) {
    if (complex.map().dimension() == 2) return writer.walk(current_space<3>(complex), before, after);
    return writer.walk(current_space<4>(complex), before, after);
  }
  ParticleState state = before;
  Weights weights{};
  ContactList contacts;
  Counters counters;
  StepState step;
  step.begin(0, state, after.position, contacts);
  run_tallied(step, {state, weights, contacts, counters}, writer);
}

void Stepper::tally_straight(const ParticleState& before, const Weights& held, const ParticleState& after, double end,
                             detail::TallyWriter& writer) const {
  writer.begin(before);
  const auto go = [&]<std::size_t N>(const Space<Stored, N>& space) {
    SimplexPlacement from{before.at(), before.position};
    if (setting_.moved) {
      const Weights weights =
          before.held ? held
                      : detail::barycentric(previous_space<N>(setting_.complex).corners(before.at()), before.position);
      if (volume_sign(space.corners(before.at())) == Sign::positive)
        from = detail::carried(space, before.at(), weights);
      else
        from = {after.at(), after.position};
    }
    writer.go_straight(space, from, after, end);
  };
  if (setting_.complex.map().dimension() == 2)
    go(current_space<3>(setting_.complex));
  else
    go(current_space<4>(setting_.complex));
}

}  // namespace dartcast
