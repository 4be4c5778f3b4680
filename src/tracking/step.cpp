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
  if (partial.knows_end() && !respond_) {
    return partial.parts == 1 ? stop_at_impact<false>(particle, state, target, contacts, counters, partial)
                              : stop_at_impact<true>(particle, state, target, contacts, counters, partial);
  }
  constexpr NoRecorder none;
  if (complex_.map().dimension() == 2)
    return step_in<3>(particle, state, weights, target, contacts, counters, &partial, none);
  return step_in<4>(particle, state, weights, target, contacts, counters, &partial, none);
}

// As StepPart::move(), handle_contact() and finish() in step_run.hpp, sum by sum, for the first contact of a step.
template <bool split>
StepResult Stepper::stop_at_impact(std::uint32_t particle, ParticleState& state, const Vec3& target,
                                   ContactList& contacts, Counters& counters, const PartialStep& partial) const {
  const WallImpact& impact = *partial.impact;
  const SimplexId at_wall = partial.walk.wall_simplex;
  if (partial.left_behind && state.at() != at_wall) ++counters.updated_by_deformation;
  Vec3 q = target;
  Vec3 later;
  double end_of_part = 1.0;
  if constexpr (split) {
    ++counters.steps_split;
    end_of_part = 1.0 / partial.parts;
    const Vec3 planned = target - state.position;
    const auto [share, end] = detail::next_part(state.position, planned, partial.parts);
    q = end;
    later = (planned - share) - impact.wall_displacement * (1.0 - end_of_part);
  }
  Contact& contact = contacts.contacts.emplace_back();
  detail::describe_impact(complex_.map(), partial.walk, impact, contact, contacts);
  const Vec3 way = q - partial.from;
  contact.particle = particle;
  contact.last = options_.max_contacts == 1;
  contact.time_of_impact = 0.0 + impact.fraction * end_of_part;
  contact.displacement = way + later;
  contact.unused = way * (1.0 - impact.fraction) + later;
  state.put(at_wall, impact.position);
  state.touching_count = 1;
  state.touching[0] = contacts.walls.back().face;
  ++counters.contacts[static_cast<std::size_t>(contact.kind)];
  ++counters.particle_steps;
  counters.orientation.tests += partial.tests.tests;
  counters.orientation.exact += partial.tests.exact;
  ++counters.histogram[std::min<std::size_t>(partial.tests.tests, Counters::histogram_size - 1)];
  StepResult result;
  result.stopped = true;
  result.unused = contact.unused;
  return result;
}

StepResult Stepper::ride_on(std::uint32_t particle, ParticleState& state, Weights& weights, const TakenPart& taken,
                            ContactList& contacts, Counters& counters) const {
  constexpr NoRecorder none;
  if (complex_.map().dimension() == 2) return ride_on_in<3>(particle, state, weights, taken, contacts, counters, none);
  return ride_on_in<4>(particle, state, weights, taken, contacts, counters, none);
}

}  // namespace dartcast
