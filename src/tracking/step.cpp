// The usual step of one particle: nothing records it, and a response answers each contact at once.
#include "tracking/step.hpp"

#include <fmt/format.h>

#include "tracking/step_run.hpp"

namespace dartcast {

void check(const StepOptions& options, const char* caller) {
  if (!(options.tolerance > 0.0))
    throw InvalidArgument(fmt::format("{}: the tolerance is {}: it must be positive", caller, options.tolerance));
  if (options.max_slices == 0) throw InvalidArgument(fmt::format("{}: max_slices is 0: it must be at least 1", caller));
  if (options.max_crossings == 0)
    throw InvalidArgument(fmt::format("{}: max_crossings is 0: it must be at least 1", caller));
  if (options.max_contacts == 0)
    throw InvalidArgument(fmt::format("{}: max_contacts is 0: it must be at least 1", caller));
}

void Stepper::run(StepState& step, const SteppedParticle& particle) const {
  if (!setting_.respond && step.knows_end() && setting_.complex.periodic() == nullptr)
    return stop_at_impact(step, particle);
  detail::NoRecords<false> driver;
  detail::run_step(setting_, step, particle, driver);
}

}  // namespace dartcast
