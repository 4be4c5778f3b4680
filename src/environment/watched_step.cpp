// Watches steps, and makes replays of them.
#include "environment/watched_step.hpp"

#include <algorithm>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "environment/audit_state.hpp"
#include "tracking/carry.hpp"
#include "tracking/cells_around.hpp"

namespace dartcast {

namespace {

// Where the vertices of a particle's simplex take it.
Vec3 carried(const CellComplex& complex, const ParticleState& state) {
  const Weights weights = detail::barycentric(complex.previous_corners(state.at()), state.position);
  const Vec3 place = detail::combine(complex.corners(state.at()), weights);
  return is_finite(place) ? place : state.position;
}

}  // namespace

WatchedStep::WatchedStep(const Environment& environment, const Particles& particles, std::span<const Vec3> targets,
                         const StepOptions& options, bool simultaneous)
    : environment_(environment),
      before_(particles),
      targets_(targets),
      options_(options),
      simultaneous_(simultaneous) {}

ContactCallback WatchedStep::noted(const ContactCallback& respond) {
  responds_ = static_cast<bool>(respond);
  if (!respond) return {};
  return [this, &respond](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
    const AfterContact answer = respond(c, walls, earlier);
    note(c.particle, answer);
    return answer;
  };
}

RoundCallback WatchedStep::noted(const RoundCallback& respond) {
  responds_ = true;
  return [this, &respond](const ContactList& list, std::span<AfterContact> after) {
    respond(list, after);
    for (std::size_t i = 0; i < after.size(); ++i) note(list.contacts[i].particle, after[i]);
  };
}

void WatchedStep::note(std::uint32_t particle, const AfterContact& answer) {
  const std::lock_guard lock(mutex_);
  answers_[particle].push_back(answer);
}

void WatchedStep::check(std::span<const ParticleState> states, std::span<const Weights> weights) const {
  for (std::uint32_t i = 0; i < states.size(); ++i) {
    const std::string fault = detail::fault_of(environment_.complex(), states[i], weights[i]);
    if (fault.empty()) continue;
    StepReplay replay = replay_of(i);
    replay.reason = fault;
    replay.end = states[i].position;
    return environment_.replay_hook()(replay);
  }
}

// The cells are those that the step passes if it is taken alone, and those along its straight ways.
StepReplay WatchedStep::replay_of(std::uint32_t particle) const {
  const CellComplex& complex = environment_.complex();
  const ParticleState& state = before_[particle];
  const Vec3& target = targets_[particle];
  const bool moved = environment_.awaits_advance(before_);
  const Vec3 from = moved ? carried(complex, state) : state.position;
  std::vector<std::pair<Vec3, Vec3>> ways = {{state.position, target}, {from, from + (target - state.position)}};
  const auto found = answers_.find(particle);
  const std::vector<AfterContact> answers = found == answers_.end() ? std::vector<AfterContact>{} : found->second;
  std::vector<Cell> passed;
  try {
    std::size_t next = 0;
    const ContactCallback again = [&](const Contact& c, std::span<const WallHit>, std::span<const WallHit>) {
      const AfterContact answer = next < answers.size() ? answers[next] : AfterContact{};
      ++next;
      ways.emplace_back(c.point, c.point + answer.displacement);
      return answer;
    };
    const Trace trace =
        environment_.trace(before_, particle, {&target, 1}, responds_ ? again : ContactCallback{}, options_).at(0);
    for (const Crossing& c : trace.crossings) passed.push_back(c.to);
  } catch (const InternalError&) {  // the step cannot be taken alone either
  }
  StepReplay replay = detail::replay_of(
      complex.map(), {moved ? complex.previous_positions() : complex.positions(), complex.positions()}, state, target,
      ways, std::move(passed));
  replay.weights = before_.held_weights(particle);
  replay.simultaneous = simultaneous_;
  replay.options = options_;
  replay.responds = responds_;
  replay.answers = answers;
  return replay;
}

}  // namespace dartcast
