// One step of one particle: it is carried along with the mesh, walks to its target, and responds at walls.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "dartcast/cell_complex.hpp"
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

/// A step that has been walked up to its first wall, or to the end of the first of several parts: see Stepper::resume().
struct PartialStep {
  Vec3 from;         ///< where the walk started: the particle's place, carried along with the mesh
  Walk walk;         ///< ends at a wall that the target is beyond, or that it lies on; or at the end of the part
  TestCounts tests;  ///< made so far
  std::optional<WallImpact> impact;  ///< where it has been computed
  unsigned parts = 1;                ///< that the step is taken in; the walk is that of the first one
  /// Where an impact has been computed: whether the vertices leave behind the place where the step started.
  bool left_behind = false;
  /// In a step of several parts: the particle stops at the impact, whose position is where it is at the step's end.
  bool carried_on = false;

  PartialStep(const Vec3& start, const Walk& first, const TestCounts& counts)
      : from(start), walk(first), tests(counts) {}

  /// Whether the impact says where a particle that stops there is at the end of the step.
  [[nodiscard]] bool knows_end() const { return impact && (parts == 1 || carried_on); }
  /// Whether the step has put the particle there, and it has stayed there.
  [[nodiscard]] bool stays(const ParticleState& after) const {
    return knows_end() && after.at() == walk.wall_simplex && after.position == impact->position;
  }
};

/// The part of the step that is walked in one geometry: the particle's motion from time `begin` to time `end`.
struct TimeInterval {
  double begin;
  double end;
  Vec3 later;  ///< displacement planned after `end`, absolute
};

/// A step that waits at a contact for its answer: see Stepper::step_to_contact(). The rest of its state is in the
/// contact.
struct PausedStep {
  bool waits = false;  ///< else the step is complete
  std::uint32_t particle = 0;
  SimplexId start;  ///< where the step started
  Vec3 start_position;
  TestCounts tests;  ///< made so far
  unsigned contact_count = 0;
  TimeInterval interval{};  ///< from the contact on
  unsigned part = 1;        ///< in which it waits, from 1 on
  unsigned parts = 1;       ///< in which the step is taken
};

/// The first part of a step, taken while the walls moved: see Stepper::ride_on().
struct TakenPart {
  double time = 0.0;             ///< up to which
  std::optional<Vec3> target;    ///< at the end of the step; none: the particle stays at the wall that it met last
  unsigned contact_count = 0;    ///< so far
  std::uint32_t first_wall = 0;  ///< of this particle in this step
  double last_contact = -1.0;    ///< time of the last one: no later one is reported before it
};

/// Carries particles through one step of a complex. A plain reader of the complex: any number may run at once.
class Stepper {
 public:
  /// `moved`: the complex's positions have been committed for this step; targets then are relative to positions before
  /// the move (they are absolute points, computed by the caller from where the particle was).
  Stepper(const CellComplex& complex, bool moved, const StepOptions& options, const ContactCallback& respond)
      : complex_(complex), moved_(moved), options_(options), respond_(respond) {}

  /// Whether anything responds at walls: else particles stop at the first one.
  [[nodiscard]] bool responds() const { return static_cast<bool>(respond_); }

  /// Steps one particle to `target`, a finite point in the exact range. Adds its contacts in order of time.
  StepResult step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                  ContactList& contacts, Counters& counters) const;

  /// The same step, continued from where its walk has ended.
  StepResult resume(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                    ContactList& contacts, Counters& counters, const PartialStep& partial) const;

  /// The rest of a step whose first part has been taken in another way: the vertices carry the particle along from where
  /// they are at `taken.time`, and it walks to the target. Preconditions: `moved`; the particle is in its simplex as it is
  /// then.
  StepResult ride_on(std::uint32_t particle, ParticleState& state, Weights& weights, const TakenPart& taken,
                     ContactList& contacts, Counters& counters) const;

  /// The same step to the same bits, which also records its crossings. Cost: some exact values for each crossing.
  StepResult trace(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                   ContactList& contacts, std::vector<Crossing>& crossings) const;

  /// The same step up to its first contact, where it waits for the answer. It calls no response. `partial`: as for
  /// resume(), or null where the step starts. Where it does not wait, the result is that of step().
  StepResult step_to_contact(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                             ContactList& contacts, Counters& counters, const PartialStep* partial,
                             PausedStep& paused) const;

  /// Continues a paused step after the answer to `contact`, which is in the list `met`, up to its next contact. Adds the
  /// next one to `contacts`, with all walls met earlier in the step in front of its own. Returns as step_to_contact().
  StepResult step_on(const ContactList& met, const Contact& contact, const AfterContact& next, ParticleState& state,
                     Weights& weights, ContactList& contacts, Counters& counters, PausedStep& paused) const;

 private:
  // resume() where the end is known and nothing responds; `split`: of a step in several parts.
  template <bool split>
  StepResult stop_at_impact(std::uint32_t particle, ParticleState& state, const Vec3& target, ContactList& contacts,
                            Counters& counters, const PartialStep& partial) const;

  template <std::size_t N, class Recorder>
  StepResult step_in(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                     ContactList& contacts, Counters& counters, const PartialStep* partial,
                     const Recorder& recorder) const;
  template <std::size_t N, class Recorder>
  StepResult ride_on_in(std::uint32_t particle, ParticleState& state, Weights& weights, const TakenPart& taken,
                        ContactList& contacts, Counters& counters, const Recorder& recorder) const;
  template <std::size_t N>
  StepResult step_on_in(const ContactList& met, const Contact& contact, const AfterContact& next, ParticleState& state,
                        Weights& weights, ContactList& contacts, Counters& counters, PausedStep& paused) const;

  const CellComplex& complex_;
  bool moved_;
  const StepOptions& options_;
  const ContactCallback& respond_;
};

}  // namespace dartcast
