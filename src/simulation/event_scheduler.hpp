// What a run does to the topology: events at their times; in between remeshing, and relief of crowded cells.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/scene.hpp"

namespace dartcast {

/// What has been done to the topology, in order: enough to do it again.
struct EventLog {
  struct Change {
    static constexpr std::uint32_t remeshing = 0xffffffffU;
    static constexpr std::uint32_t subdividing = 0xfffffffeU;
    static constexpr std::uint32_t merging = 0xfffffffdU;

    std::uint64_t step = 0;           ///< steps done before it
    std::uint32_t event = remeshing;  ///< its place in the scene's list
    std::uint32_t what = 0;           ///< SubdivisionChange::what
  };

  std::vector<Change> changes;
  std::vector<EventReport> events;
  std::uint64_t mended = 0;      ///< regions remeshed
  std::uint64_t left = 0;        ///< cells not valid after the last check
  std::uint64_t subdivided = 0;  ///< crowded cells
  std::uint64_t merged = 0;      ///< of these, made again
  std::uint64_t refused = 0;     ///< crowded cells that could not be subdivided, or made again, when last looked at
  std::uint64_t in_opened = 0;   ///< particles in cells that were blocked when the run began
};

class EventScheduler {
 public:
  /// All outlive it. `events`: by time. Throws InvalidArgument where an event's time is negative or beyond 2^53 steps,
  /// the scene is of the plane and an event is no ligature, or crowded cells are to be subdivided; and as
  /// AdaptiveSubdivision.
  EventScheduler(const std::vector<Event>& events, const RemeshScene& remesh,
                 const AdaptiveSubdivisionScene& adaptive_subdivision, double dt, Simulation& flow);

  /// To be called before each step: events that are due. Throws as apply(), naming the event.
  void before_step();
  /// To be called after each step: checks and remeshes, and relieves crowded cells, where that is due; and counts.
  void after_step();
  /// Does again what an earlier run has done, to a flow without particles.
  void replay(const EventLog& log);
  /// To be called after each edit of the environment, by whomever.
  void after_edit() {
    adaptive_subdivision_.update_after_edit(flow_.environment().map(), flow_.environment().last_edit().map.added);
  }

  [[nodiscard]] const EventLog& log() const { return log_; }

 private:
  [[nodiscard]] std::uint64_t step_of(const Event& event) const;
  EventReport operate(std::uint32_t event);
  RepairReport remesh();
  void adapt();
  void repeat(const EventLog::Change& change);
  [[nodiscard]] std::uint64_t count_in_opened() const;

  const std::vector<Event>& events_;
  const RemeshScene& remesh_;
  std::uint64_t adapt_every_;
  AdaptiveSubdivision adaptive_subdivision_;
  double dt_;
  Simulation& flow_;
  std::vector<bool> blocked_;  // by source, when the run began
  std::uint32_t next_ = 0;     // event
  EventLog log_;
};

}  // namespace dartcast
