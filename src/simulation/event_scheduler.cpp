#include "simulation/event_scheduler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dartcast/error.hpp"

namespace dartcast {

EventScheduler::EventScheduler(const std::vector<Event>& events, const RemeshScene& remesh,
                               const AdaptiveSubdivisionScene& adaptive_subdivision, double dt, Simulation& flow)
    : events_(events),
      remesh_(remesh),
      adapt_every_(adaptive_subdivision.every),
      adaptive_subdivision_(adaptive_subdivision.options),
      dt_(dt),
      flow_(flow) {
  const double latest = static_cast<double>(max_steps) * dt;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const double at = events_[i].at;
    if (!(at >= 0.0 && at <= latest))
      throw InvalidArgument(fmt::format("event {} ({}): its time is {} s: it must be between 0 and {} s", i + 1,
                                        event_kind_names[events_[i].what.index()], at, latest));
  }
  const CombinatorialMap& map = flow.environment().map();
  if (map.dimension() == 2 && adapt_every_ > 0)
    throw InvalidArgument("crowding: in the plane cells are not subdivided; leave [crowding] out");
  for (std::size_t i = 0; map.dimension() == 2 && i < events_.size(); ++i) {
    if (!std::holds_alternative<Ligature>(events_[i].what))
      throw InvalidArgument(fmt::format("event {} ({}): in the plane a ligature can be tied, and nothing else be done",
                                        i + 1, event_kind_names[events_[i].what.index()]));
  }
  for (const Cell c : map.cells()) {
    if (map.is_free(c)) continue;
    blocked_.resize(std::max<std::size_t>(blocked_.size(), map.source(c) + 1U));
    blocked_[map.source(c)] = true;
  }
}

// Times that are whole numbers of steps but for rounding count as such.
std::uint64_t EventScheduler::step_of(const Event& event) const {
  constexpr double rounding = 1e-9;
  constexpr double never = 0x1p+63;  // more steps than any run has, and still a number of steps
  const double steps = event.at / dt_;
  return static_cast<std::uint64_t>(std::min(never, std::ceil(steps * (1.0 - rounding))));
}

void EventScheduler::before_step() {
  for (; next_ < events_.size() && step_of(events_[next_]) <= flow_.steps(); ++next_) {
    const std::uint64_t in_opened = count_in_opened();
    log_.events.push_back(operate(next_));
    log_.events.back().particles_in_opened = in_opened;
    log_.changes.push_back({flow_.steps(), next_, 0});
  }
}

EventReport EventScheduler::operate(std::uint32_t event) {
  try {
    return apply(flow_, events_[event]);
  } catch (const Error& e) {
    throw Error(fmt::format("event {} ({} at {} s): {}", event + 1, event_kind_names[events_[event].what.index()],
                            events_[event].at, e.what()));
  }
}

void EventScheduler::after_step() {
  if (remesh_.every > 0 && flow_.steps() % remesh_.every == 0) {
    const RepairReport report = remesh();
    log_.mended += report.mended.size();
    log_.left = report.left.size();
    if (!report.mended.empty()) log_.changes.push_back({flow_.steps(), EventLog::Change::remeshing, 0});
  }
  if (adapt_every_ > 0 && flow_.steps() % adapt_every_ == 0) adapt();
  if (!log_.changes.empty()) log_.in_opened = count_in_opened();
}

RepairReport EventScheduler::remesh() { return flow_.repair(remesh_.options); }

void EventScheduler::adapt() {
  const AdaptiveSubdivisionReport report = flow_.adapt(adaptive_subdivision_);
  log_.subdivided += report.subdivided;
  log_.merged += report.merged;
  log_.refused = report.refused.size();
  for (const SubdivisionChange& c : report.changes) {
    const std::uint32_t event = c.merged ? EventLog::Change::merging : EventLog::Change::subdividing;
    log_.changes.push_back({flow_.steps(), event, c.what});
  }
}

void EventScheduler::repeat(const EventLog::Change& change) {
  const auto edit = [&](const std::function<void(ComplexEdit&)>& make) { return flow_.edit(make).edit; };
  adaptive_subdivision_.repeat(flow_.environment().complex(), {change.event == EventLog::Change::merging, change.what},
                               edit);
}

void EventScheduler::replay(const EventLog& log) {
  for (const EventLog::Change& change : log.changes) {
    flow_.go_to(change.step);
    if (change.event == EventLog::Change::remeshing) {
      remesh();
    } else if (change.event == EventLog::Change::subdividing || change.event == EventLog::Change::merging) {
      repeat(change);
    } else if (change.event < events_.size()) {
      operate(change.event);
      next_ = change.event + 1;
    } else {
      throw InvalidArgument("surgery: the log names an event that the scene does not have");
    }
  }
  log_ = log;
}

std::uint64_t EventScheduler::count_in_opened() const {
  const CombinatorialMap& map = flow_.environment().map();
  const auto states = flow_.particles().states();
  return static_cast<std::uint64_t>(std::count_if(states.begin(), states.end(), [&](const ParticleState& s) {
    const std::uint32_t source = map.source(s.cell);
    return !s.held && source < blocked_.size() && blocked_[source];
  }));
}

}  // namespace dartcast
