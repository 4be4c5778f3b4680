// A step of one particle that is not complete: all that it needs to go on, as plain data.
#pragma once

#include <cstdint>
#include <optional>

#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "tracking/walk.hpp"

namespace dartcast {

/// Where a segment meets the inside of a wall's face.
struct WallImpact {
  Vec3 normal;
  double fraction = 0.0;  ///< of the segment
  Vec3 point;
  Vec3 position;  ///< of the particle, in the simplex at the wall
  Vec3 wall_displacement;
};

/// The slice of the step that is walked in one geometry: the particle's motion from time `begin` to time `end`.
struct TimeInterval {
  double begin = 0.0;
  double end = 1.0;
  Vec3 later;  ///< displacement planned after `end`, absolute
};

/// Where a step goes on (docs/concepts/steps.md).
enum class StepStage : std::uint8_t {
  start,     ///< nothing has been done
  in_batch,  ///< a batch has taken the first walk as far as it could; the particle is where the step started
  carry,     ///< a slice begins at `interval.begin`: the vertices carry the particle along
  walk,      ///< the particle walks from its place to the target of the slice
  on_way,    ///< `walk` has come to a cell of another rank: it passes a facet, or has ended there
  contact,   ///< it waits for the answer to its last contact
  done
};

/// A step between its stages. The rest of its state is in the particle and, if it waits, in the contact.
struct StepState {
  StepStage stage = StepStage::start;
  SimplexId start;  ///< where the step started
  Vec3 start_position;
  Vec3 target;  ///< of the whole step

  // The time slice that the step is in, and the walk in it.
  Vec3 slice_target;
  TimeInterval interval;     ///< from the last contact on
  std::uint32_t slice = 1;   ///< from 1 on
  std::uint32_t slices = 1;  ///< that the step is taken in
  Walk walk;                 ///< in_batch, on_way

  // Found by a batch.
  Vec3 walk_start;                   ///< where it begins: the particle's place, carried along with the mesh
  std::optional<WallImpact> impact;  ///< at the walk's end, if it has been computed
  bool left_behind = false;          ///< there: the vertices leave behind the place where the step started
  bool carried_on = false;  ///< there, in several slices: a particle that stops has that position at the step's end

  std::uint32_t particle = 0;
  // Contacts so far, in the list that they are added to.
  std::uint32_t contact_count = 0;
  std::uint32_t crossing_count = 0;  ///< of faces of periodic pairs
  std::uint32_t first_wall = 0;      ///< of this particle in this step
  std::uint32_t first_here = 0;      ///< of those at the place of the last contact
  double last_time = -1.0;           ///< of the last contact

  TestCounts tests;
  StepResult result;

  StepState() = default;
  /// A step whose first walk, up to its first wall or to the end of the first slice, a batch has taken.
  StepState(const Vec3& walk_starts, const Walk& first, const TestCounts& counts)
      : stage(StepStage::in_batch), walk(first), walk_start(walk_starts), tests(counts) {}

  /// Makes it that of a particle, before anything else has been done outside of the batch.
  void begin(std::uint32_t number, const ParticleState& state, const Vec3& to, const ContactList& contacts) {
    particle = number;
    start = state.at();
    start_position = state.position;
    target = to;
    first_wall = first_here = static_cast<std::uint32_t>(contacts.walls.size());
  }

  [[nodiscard]] bool waits() const { return stage == StepStage::contact; }
  [[nodiscard]] bool moves_itself() const { return !result.stopped && !result.held; }
  /// Whether the impact says where a particle that stops there is at the end of the step.
  [[nodiscard]] bool knows_end() const { return impact && (slices == 1 || carried_on); }
  /// Whether the step has put the particle there, and it has stayed there.
  [[nodiscard]] bool stays(const ParticleState& after) const {
    if (!knows_end()) return false;
    const bool stopped_there = result.stopped && contact_count == 1 && crossing_count == 0;
    return stopped_there || (after.at() == walk.wall_simplex && after.position == impact->position);
  }
};

}  // namespace dartcast
