// The end of a step that stops at its first wall, where the batch has computed the impact. A file of its own, so that the
// compiler inlines as much in step.cpp.
#include <algorithm>

#include "tracking/contact_geometry.hpp"
#include "tracking/step.hpp"

namespace dartcast {

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

template StepResult Stepper::stop_at_impact<false>(std::uint32_t, ParticleState&, const Vec3&, ContactList&, Counters&,
                                                   const PartialStep&) const;
template StepResult Stepper::stop_at_impact<true>(std::uint32_t, ParticleState&, const Vec3&, ContactList&, Counters&,
                                                  const PartialStep&) const;

}  // namespace dartcast
