// Carries out events when they are due, and repeats the edits of a log.
#include "simulation/event_scheduler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/validity.hpp"
#include "simulation/particle_share.hpp"

namespace dartcast {

namespace {

bool is_possible_in_plane(EventKind kind) {
  switch (kind) {
    case EventKind::ligature:
    case EventKind::open:
    case EventKind::close: return true;
    case EventKind::cut:
    case EventKind::carve:
    case EventKind::reconnect: return false;
  }
  return false;
}

// Each rank has counted its own.
void sum_particles(EventReport& report, Ranks* ranks) {
  std::array<std::uint64_t*, 5> counts = {&report.particles_touched, &report.particles_located, &report.particles_moved,
                                          &report.particles_held, &report.particles_absorbed};
  std::array<std::uint64_t, 5> sums{};
  for (std::size_t i = 0; i < counts.size(); ++i) sums[i] = *counts[i];
  sum_over(ranks, sums);
  for (std::size_t i = 0; i < counts.size(); ++i) *counts[i] = sums[i];
}

}  // namespace

EventScheduler::EventScheduler(const Environment& environment, Followers& followers, double dt)
    : environment_(environment), dt_(dt) {
  followers.add([this](const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
    subdivision_.update_after_edit(environment_.map(), edit.map.added);
  });
  const CombinatorialMap& map = environment.map();
  for (const Cell c : map.cells()) {
    if (map.is_free(c)) continue;
    blocked_.resize(std::max<std::size_t>(blocked_.size(), map.source(c) + std::size_t{1}));
    blocked_[map.source(c)] = true;
  }
}

void EventScheduler::set_events(std::vector<Event> events) {
  const double latest = static_cast<double>(max_steps) * dt_;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const std::string_view name = name_of(kind_of(events[i]));
    const double at = events[i].at;
    if (!(at >= 0.0 && at <= latest))
      throw InvalidArgument(
          fmt::format("event {} ({}): its time is {} s: it must be between 0 and {} s", i + 1, name, at, latest));
    if (environment_.map().dimension() == 2 && !is_possible_in_plane(kind_of(events[i])))
      throw InvalidArgument(fmt::format(
          "event {} ({}): in the plane cells open and close, and a ligature can be tied; nothing else can be done",
          i + 1, name));
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.at < b.at; });
  events_ = std::move(events);
  next_ = 0;
}

void EventScheduler::set_adaptive_subdivision(const AdaptiveSubdivisionScene& subdivision) {
  if (environment_.map().dimension() == 2 && subdivision.every > 0)
    throw InvalidArgument(
        "adaptive subdivision: cells of the plane are not subdivided; leave [adaptive_subdivision] out");
  if (!subdivision_.subdivisions().empty())
    throw InvalidArgument("adaptive subdivision: cells are subdivided already; set the options before the first step");
  subdivision_ = AdaptiveSubdivision(subdivision.options);
  adapt_every_ = subdivision.every;
}

// Times that are whole numbers of steps but for rounding count as such.
std::uint64_t EventScheduler::step_of(const Event& event) const {
  constexpr double rounding = 1e-9;
  constexpr double never = 0x1p+63;  // more steps than any run has, and still a number of steps
  const double steps = event.at / dt_;
  return static_cast<std::uint64_t>(std::min(never, std::ceil(steps * (1.0 - rounding))));
}

void EventScheduler::before_step(Simulation& simulation) {
  for (; next_ < events_.size() && step_of(events_[next_]) <= simulation.steps(); ++next_) {
    const std::uint64_t in_opened = count_in_opened(simulation);
    log_.events.push_back(carry_out(simulation, next_));
    log_.events.back().particles_in_opened = in_opened;
    log_.changes.push_back({simulation.steps(), next_, 0});
  }
}

EventReport EventScheduler::carry_out(Simulation& simulation, std::uint32_t number) {
  const Event& event = events_[number];
  const auto named = [&](const Error& e) {
    return Error(fmt::format("event {} ({} at {} s): {}", number + 1, name_of(kind_of(event)), event.at, e.what()));
  };
  try {
    EventReport report = apply(simulation, event);
    sum_particles(report, simulation.options().ranks);
    return report;
  } catch (const EditRefused& e) {
    if (event.required) throw named(e);
    EventReport report;
    report.kind = kind_of(event);
    report.step = simulation.steps();
    report.time = simulation.time();
    report.refused = e.what();
    return report;
  } catch (const Error& e) {
    throw named(e);
  }
}

void EventScheduler::after_step(Simulation& simulation) {
  if (remeshing_.every > 0 && simulation.steps() % remeshing_.every == 0) {
    const RepairReport report = remesh(simulation);
    log_.mended += report.mended.size();
    log_.left = report.left.size();
    if (!report.mended.empty()) log_.changes.push_back({simulation.steps(), EventLog::Change::remeshing, 0});
  }
  if (adapt_every_ > 0 && simulation.steps() % adapt_every_ == 0) adapt(simulation);
  if (!log_.changes.empty()) log_.in_opened = count_in_opened(simulation);
}

// Cells beside a repaired region that stay inverted may refuse the whole repair. All cells are left then.
RepairReport EventScheduler::remesh(Simulation& simulation) {
  try {
    return simulation.repair(remeshing_.options);
  } catch (const EditRefused& e) {
    RepairReport report;
    for (const InvalidCell& bad : environment_.validity(environment_.map().cell_count()).first)
      report.left.push_back({bad.cell, environment_.map().source(bad.cell), e.what()});
    return report;
  }
}

AdaptiveSubdivisionReport EventScheduler::adapt(Simulation& simulation) {
  AdaptiveSubdivisionReport report = subdivision_.adapt(
      environment_.complex(), simulation.particles(),
      [&](const std::function<void(ComplexEdit&)>& make) { return simulation.edit(make).edit; },
      simulation.options().ranks);
  log_.subdivided += report.subdivided;
  log_.merged += report.merged;
  log_.refused = report.refused.size();
  for (const SubdivisionChange& c : report.changes) {
    const std::uint32_t event = c.merged ? EventLog::Change::merging : EventLog::Change::subdividing;
    log_.changes.push_back({simulation.steps(), event, c.what});
  }
  return report;
}

void EventScheduler::replay(Simulation& simulation, const EventLog& log) {
  const std::size_t made = log_.changes.size();
  if (made > log.changes.size() || !std::equal(log_.changes.begin(), log_.changes.end(), log.changes.begin()))
    throw InvalidArgument("events: the edits so far differ from those of the checkpoint; make a new simulation");
  for (std::size_t i = made; i < log.changes.size(); ++i) {
    simulation.go_to(log.changes[i].step);
    repeat(simulation, log.changes[i]);
    log_.changes.push_back(log.changes[i]);
  }
}

void EventScheduler::repeat(Simulation& simulation, const EventLog::Change& change) {
  if (change.event == EventLog::Change::remeshing) {
    remesh(simulation);
  } else if (change.event == EventLog::Change::subdividing || change.event == EventLog::Change::merging) {
    repeat_subdivision(simulation, change);
  } else if (change.event < events_.size()) {
    carry_out(simulation, change.event);
    next_ = change.event + 1;
  } else {
    throw InvalidArgument("events: the log names an event that the scene does not have");
  }
}

void EventScheduler::repeat_subdivision(Simulation& simulation, const EventLog::Change& change) {
  const auto edit = [&](const std::function<void(ComplexEdit&)>& make) { return simulation.edit(make).edit; };
  subdivision_.repeat(environment_.complex(), {change.event == EventLog::Change::merging, change.what}, edit);
}

std::uint64_t EventScheduler::count_in_opened(const Simulation& simulation) const {
  const CombinatorialMap& map = environment_.map();
  const auto states = simulation.particles().states();
  std::uint64_t count = 0;
  for (const ParticleState& s : states) {
    const std::uint32_t source = map.source(s.cell);
    count += !s.held && source < blocked_.size() && blocked_[source] ? 1 : 0;
  }
  sum_over(simulation.options().ranks, {&count, 1});
  return count;
}

}  // namespace dartcast
