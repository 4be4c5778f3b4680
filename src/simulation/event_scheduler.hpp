// Edits of the topology in a simulation: events at their times, remeshing, and subdivision of crowded cells.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/events.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/adaptive_subdivision.hpp"
#include "simulation/followers.hpp"

namespace dartcast {

/// A function with the name of one of Simulation's does the work of that function.
class EventScheduler {
 public:
  /// The environment outlives it. `dt`: of a step, s.
  EventScheduler(const Environment& environment, Followers& followers, double dt);

  void set_events(std::vector<Event> events);
  void set_remeshing(const RemeshScene& remeshing) { remeshing_ = remeshing; }
  void set_adaptive_subdivision(const AdaptiveSubdivisionScene& subdivision);
  AdaptiveSubdivisionReport adapt(Simulation& simulation);

  /// Before each step: carries out events that are due. Throws as apply(), naming the event.
  void before_step(Simulation& simulation);
  /// After each step: remeshes and subdivides if that is due, and counts.
  void after_step(Simulation& simulation);
  /// Does again those changes of the log that have not been made yet. Throws InvalidArgument if other changes have
  /// been made, the log names an unknown event, or there are particles and something is to be done.
  void replay(Simulation& simulation, const EventLog& log);
  /// Goes on from a log that has been replayed.
  void set_log(const EventLog& log) { log_ = log; }

  [[nodiscard]] const EventLog& log() const { return log_; }

 private:
  [[nodiscard]] std::uint64_t step_of(const Event& event) const;
  EventReport carry_out(Simulation& simulation, std::uint32_t number);
  RepairReport remesh(Simulation& simulation);
  void repeat(Simulation& simulation, const EventLog::Change& change);
  void repeat_subdivision(Simulation& simulation, const EventLog::Change& change);
  [[nodiscard]] std::uint64_t count_in_opened(const Simulation& simulation) const;

  const Environment& environment_;
  double dt_;
  std::vector<Event> events_;  // by time
  RemeshScene remeshing_;
  std::uint64_t adapt_every_ = 0;
  AdaptiveSubdivision subdivision_ = AdaptiveSubdivision(AdaptiveSubdivisionOptions{});
  std::vector<bool> blocked_;  // by source, when the simulation was made
  std::uint32_t next_ = 0;     // event
  EventLog log_;
};

}  // namespace dartcast
