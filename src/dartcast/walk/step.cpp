#include "dartcast/walk/step.hpp"

#include "dartcast/walk/step_run.hpp"

namespace dartcast {

namespace {

// The usual step records nothing, at no cost.
struct NoRecorder {
  static NoVisitor visitor() { return {}; }
  template <class... Arguments>
  static void walked(const Arguments&...) {}
  static void put(const State&, double) {}
};

}  // namespace

StepResult Stepper::step(std::uint32_t particle, State& state, Weights& weights, const Vec3& target,
                         ContactList& contacts, Counters& counters, const Begun* begun) const {
  constexpr NoRecorder none;
  if (complex_.map().dimension() == 2)
    return step_in<3>(particle, state, weights, target, contacts, counters, begun, none);
  return step_in<4>(particle, state, weights, target, contacts, counters, begun, none);
}

}  // namespace dartcast
