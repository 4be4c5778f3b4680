// The usual step of one particle: nothing records it.
#include "tracking/step.hpp"

#include <fmt/format.h>

#include "tracking/step_run.hpp"

namespace dartcast {

namespace {

// The usual step records nothing, at no cost.
struct NoRecorder : detail::NeverWaits {
  static NoVisitor visitor() { return {}; }
  template <class... Arguments>
  static void walked(const Arguments&...) {}
  static void put(const ParticleState&, double) {}
};

}  // namespace

void check(const StepOptions& options, const char* caller) {
  if (!(options.tolerance > 0.0))
    throw InvalidArgument(fmt::format("{}: the tolerance is {}: it must be positive", caller, options.tolerance));
  if (options.max_parts == 0) throw InvalidArgument(fmt::format("{}: max_parts is 0: it must be at least 1", caller));
  if (options.max_contacts == 0)
    throw InvalidArgument(fmt::format("{}: max_contacts is 0: it must be at least 1", caller));
}

StepResult Stepper::step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                         ContactList& contacts, Counters& counters) const {
  constexpr NoRecorder none;
  if (complex_.map().dimension() == 2)
    return step_in<3>(particle, state, weights, target, contacts, counters, nullptr, none);
  return step_in<4>(particle, state, weights, target, contacts, counters, nullptr, none);
}

StepResult Stepper::resume(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                           ContactList& contacts, Counters& counters, const PartialStep& partial) const {
  if (!respond_ && partial.knows_end()) {
    return partial.parts == 1 ? stop_at_impact<false>(particle, state, target, contacts, counters, partial)
                              : stop_at_impact<true>(particle, state, target, contacts, counters, partial);
  }
  constexpr NoRecorder none;
  if (complex_.map().dimension() == 2)
    return step_in<3>(particle, state, weights, target, contacts, counters, &partial, none);
  return step_in<4>(particle, state, weights, target, contacts, counters, &partial, none);
}

StepResult Stepper::ride_on(std::uint32_t particle, ParticleState& state, Weights& weights, const TakenPart& taken,
                            ContactList& contacts, Counters& counters) const {
  constexpr NoRecorder none;
  if (complex_.map().dimension() == 2) return ride_on_in<3>(particle, state, weights, taken, contacts, counters, none);
  return ride_on_in<4>(particle, state, weights, taken, contacts, counters, none);
}

}  // namespace dartcast
