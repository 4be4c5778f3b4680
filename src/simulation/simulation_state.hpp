// All that a simulation goes on from after a step: a member for each component, and the log of events.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/bodies.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/events.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/solids.hpp"
#include "dartcast/statistics.hpp"
#include "dynamics/contact_solver.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/rigid_pose.hpp"
#include "simulation/start_times.hpp"

namespace dartcast {

struct ParticleSystemState {
  std::uint64_t steps = 0;
  std::uint64_t next_id = 0;
  SavedParticles table;
  SimulationTotals totals;
  StateHash gone;
  std::vector<CachedImpulse> impulses;  ///< that the next step's collisions start from
};

struct CathetersState {
  std::vector<CatheterCheckpoint> catheters;
  std::vector<CatheterTotals> totals;
};

/// Where all vertices were before the last move and after it, and after how many steps.
struct VertexPlaces {
  std::uint64_t steps = 0;
  std::vector<Vec3> before;
  std::vector<Vec3> now;
};

/// The solids; empty if there are none.
struct SolidsState {
  struct Tool {
    RigidPose pose;
    RigidPose wanted;
    std::uint64_t contacts = 0;
    std::uint64_t stopped = 0;
  };
  SolidCheckpoint set;
  std::vector<Tool> tools;
  double walls_before = 1.0;  ///< shares that the walls made of the last two moves
  double walls_now = 1.0;
  /// After steps at which a solid had stopped the walls: those before an edit, and the last.
  std::vector<VertexPlaces> places;
};

/// The statistics so far.
struct StatisticsState {
  bool has_hits = false;
  bool has_impacts = false;
  std::vector<FaceHits> hits;
  std::vector<std::uint64_t> ended_hits;
  bool observes_motion = false;  ///< what follows is kept
  std::vector<PlaneTotals> planes;
  std::vector<LeaveTotals> left;
  std::vector<LeaveTotals> left_by_class;
  ResidenceTimes absorbed_by_edits;
  std::vector<StartTimes::Start> starts;
  std::uint64_t next_id = 0;
  std::vector<std::uint64_t> cells;  ///< words of the tally; empty: none
};

struct SimulationState {
  ParticleSystemState particles;
  EventLog events;
  Bodies::Checkpoint bodies;
  CathetersState catheters;
  SolidsState solids;
  StatisticsState statistics;
};

}  // namespace dartcast
