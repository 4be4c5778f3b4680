#include "simulation/event_scheduler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dartcast/error.hpp"

namespace dartcast {

Surgery::Surgery(const std::vector<Event>& events, const RemeshScene& remesh, const CrowdingScene& crowding, double dt,
                 Flow& flow)
    : events_(events),
      remesh_(remesh),
      relieve_every_(crowding.every),
      crowding_(crowding.options),
      dt_(dt),
      flow_(flow) {
  const double latest = static_cast<double>(most_steps) * dt;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const double at = events_[i].at;
    if (!(at >= 0.0 && at <= latest))
      throw InvalidArgument(fmt::format("event {} ({}): its time is {} s: it must be between 0 and {} s", i + 1,
                                        event_kind_names[events_[i].what.index()], at, latest));
  }
  const Map& map = flow.environment().map();
  if (map.dimension() == 2 && relieve_every_ > 0)
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
std::uint64_t Surgery::step_of(const Event& event) const {
  constexpr double rounding = 1e-9;
  constexpr double never = 0x1p+63;  // more steps than any run has, and still a number of steps
  const double steps = event.at / dt_;
  return static_cast<std::uint64_t>(std::min(never, std::ceil(steps * (1.0 - rounding))));
}

void Surgery::before_step() {
  for (; next_ < events_.size() && step_of(events_[next_]) <= flow_.steps(); ++next_) {
    const std::uint64_t in_opened = count_in_opened();
    log_.events.push_back(operate(next_));
    log_.events.back().particles_in_opened = in_opened;
    log_.changes.push_back({flow_.steps(), next_, 0});
  }
}

EventReport Surgery::operate(std::uint32_t event) {
  try {
    return apply(flow_, events_[event]);
  } catch (const Error& e) {
    throw Error(fmt::format("event {} ({} at {} s): {}", event + 1, event_kind_names[events_[event].what.index()],
                            events_[event].at, e.what()));
  }
}

void Surgery::after_step() {
  if (remesh_.every > 0 && flow_.steps() % remesh_.every == 0) {
    const RepairReport report = remesh();
    log_.mended += report.mended.size();
    log_.left = report.left.size();
    if (!report.mended.empty()) log_.changes.push_back({flow_.steps(), SurgeryLog::Change::remeshing, 0});
  }
  if (relieve_every_ > 0 && flow_.steps() % relieve_every_ == 0) relieve();
  if (!log_.changes.empty()) log_.in_opened = count_in_opened();
}

RepairReport Surgery::remesh() { return flow_.repair(remesh_.options); }

void Surgery::relieve() {
  const CrowdingReport report = flow_.relieve(crowding_);
  log_.subdivided += report.subdivided;
  log_.merged += report.merged;
  log_.refused = report.refused.size();
  for (const CrowdingChange& c : report.changes) {
    const std::uint32_t event = c.merged ? SurgeryLog::Change::merging : SurgeryLog::Change::subdividing;
    log_.changes.push_back({flow_.steps(), event, c.what});
  }
}

void Surgery::repeat(const SurgeryLog::Change& change) {
  const auto edit = [&](const std::function<void(ComplexEdit&)>& make) { return flow_.edit(make).edit; };
  crowding_.repeat(flow_.environment().complex(), {change.event == SurgeryLog::Change::merging, change.what}, edit);
}

void Surgery::replay(const SurgeryLog& log) {
  for (const SurgeryLog::Change& change : log.changes) {
    flow_.go_to(change.step);
    if (change.event == SurgeryLog::Change::remeshing) {
      remesh();
    } else if (change.event == SurgeryLog::Change::subdividing || change.event == SurgeryLog::Change::merging) {
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

std::uint64_t Surgery::count_in_opened() const {
  const Map& map = flow_.environment().map();
  const auto states = flow_.particles().states();
  return static_cast<std::uint64_t>(std::count_if(states.begin(), states.end(), [&](const State& s) {
    const std::uint32_t source = map.source(s.cell);
    return !s.held && source < blocked_.size() && blocked_[source];
  }));
}

}  // namespace dartcast
