// The step of one particle that waits at each contact for its answer. While it waits, its state is in a PausedStep, in
// the contact and in the particle.
#include "tracking/step.hpp"
#include "tracking/step_run.hpp"

namespace dartcast {

namespace {

// Notes where a step waits.
class PauseRecorder {
 public:
  static constexpr bool pausing = true;
  static constexpr bool travels = false;

  explicit PauseRecorder(PausedStep& step) : step_(&step) {}

  static NoVisitor visitor() { return {}; }
  template <class... Arguments>
  static void walked(const Arguments&...) {}
  static void put(const ParticleState&, double) {}

  void pause(const TimeInterval& interval) {
    step_->waits = true;
    step_->interval = interval;
    step_->part = 1;
    step_->parts = 1;
  }
  [[nodiscard]] bool waits() const { return step_->waits; }
  void in_part(unsigned part, unsigned parts) {
    step_->part = part;
    step_->parts = parts;
  }
  void save(const detail::RunOf<PauseRecorder>& run, SimplexId start, const Vec3& start_position) {
    step_->particle = run.particle;
    step_->start = start;
    step_->start_position = start_position;
    step_->tests = run.tests;
    step_->contact_count = run.contact_count;
  }

 private:
  PausedStep* step_;
};

}  // namespace

StepResult Stepper::step_to_contact(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                                    ContactList& contacts, Counters& counters, const PartialStep* partial,
                                    PausedStep& paused) const {
  paused.waits = false;
  const PauseRecorder recorder(paused);
  if (complex_.map().dimension() == 2)
    return step_in<3>(particle, state, weights, target, contacts, counters, partial, recorder);
  return step_in<4>(particle, state, weights, target, contacts, counters, partial, recorder);
}

template <std::size_t N>
StepResult Stepper::step_on_in(const ContactList& met, const Contact& contact, const AfterContact& next,
                               ParticleState& state, Weights& weights, ContactList& contacts, Counters& counters,
                               PausedStep& paused) const {
  const std::size_t contact_count = contacts.contacts.size();
  const std::size_t wall_count = contacts.walls.size();
  const Contact here = detail::with_walls(met, contact, contacts);
  const TimeInterval interval = paused.interval;
  paused.waits = false;
  detail::RunOf<PauseRecorder> run{paused.particle,
                                   state,
                                   contacts,
                                   counters,
                                   {},
                                   paused.contact_count,
                                   here.first_wall - here.earlier,
                                   here.first_wall - here.together,
                                   here.time_of_impact,
                                   paused.tests,
                                   PauseRecorder(paused)};
  if (paused.parts > 1)
    detail::MovingStep<N, PauseRecorder>(complex_, options_, respond_)
        .move_on(run, weights, here, next, interval, paused.part, paused.parts);
  else
    detail::StepPart<Stored, N, PauseRecorder>(complex_, moved_, current_space<N>(complex_), options_, respond_)
        .move_on(run, here, next, interval);
  if (contacts.contacts.size() == contact_count) contacts.walls.resize(wall_count);
  return detail::finish<N>(complex_, moved_, run, paused.start, paused.start_position);
}

StepResult Stepper::step_on(const ContactList& met, const Contact& contact, const AfterContact& next,
                            ParticleState& state, Weights& weights, ContactList& contacts, Counters& counters,
                            PausedStep& paused) const {
  if (complex_.map().dimension() == 2)
    return step_on_in<3>(met, contact, next, state, weights, contacts, counters, paused);
  return step_on_in<4>(met, contact, next, state, weights, contacts, counters, paused);
}

}  // namespace dartcast
