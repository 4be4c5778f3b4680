// The step of one particle with its crossings recorded.
#include "tracking/crossing_recorder.hpp"
#include "tracking/step.hpp"
#include "tracking/step_run.hpp"

namespace dartcast {

StepResult Stepper::trace(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                          ContactList& contacts, std::vector<Crossing>& crossings) const {
  detail::CrossingRecorder recorder(setting_.complex, setting_.moved, state.cell, contacts, crossings);
  Counters counters;
  StepState step;
  step.begin(particle, state, target, contacts);
  detail::run_step(setting_, step, {state, weights, contacts, counters}, recorder);
  return step.result;
}

}  // namespace dartcast
