// The end of a step that stops at its first wall, if the batch has computed the impact: at most steps to far targets. In
// a file of its own, because there g++ 12 inlines all of it.
#include "tracking/step.hpp"
#include "tracking/step_run.hpp"

namespace dartcast {

void Stepper::stop_at_impact(StepState& step, const SteppedParticle& particle) const {
  detail::NoRecords<false> driver;
  detail::StepRun<4, detail::NoRecords<false>>(setting_, step, particle, driver).stop_at_impact();
}

}  // namespace dartcast
