// The step of one particle that waits at each contact for its answer.
#include "tracking/step.hpp"
#include "tracking/step_run.hpp"

namespace dartcast {

void Stepper::run_to_contact(StepState& step, const SteppedParticle& particle) const {
  detail::NoRecords<true> driver;
  detail::run_step(setting_, step, particle, driver);
}

void Stepper::answer(const ContactList& met, const Contact& contact, const AfterContact& next, StepState& step,
                     const SteppedParticle& particle) const {
  const detail::EarlierWalls earlier(particle.contacts);
  detail::NoRecords<true> driver;
  if (setting_.complex.map().dimension() == 2)
    detail::StepRun<3, detail::NoRecords<true>>(setting_, step, particle, driver).answer(met, contact, next);
  else
    detail::StepRun<4, detail::NoRecords<true>>(setting_, step, particle, driver).answer(met, contact, next);
}

}  // namespace dartcast
