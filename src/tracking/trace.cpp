// The step of one particle with its crossings recorded.
#include "tracking/crossing_recorder.hpp"
#include "tracking/step.hpp"
#include "tracking/step_run.hpp"

namespace dartcast {

StepResult Stepper::trace(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                          ContactList& contacts, std::vector<Crossing>& crossings) const {
  const detail::CrossingRecorder recorder(complex_, moved_, state.cell, contacts, crossings);
  Counters counters;
  if (complex_.map().dimension() == 2)
    return step_in<3>(particle, state, weights, target, contacts, counters, nullptr, recorder);
  return step_in<4>(particle, state, weights, target, contacts, counters, nullptr, recorder);
}

}  // namespace dartcast
