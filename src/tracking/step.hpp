// One step of one particle: riding along with the vertices, walking, contacts, and what follows them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/trace.hpp"
#include "tracking/walk.hpp"

namespace dartcast {

/// What is known of a wall's face that a walk has come to, inside of it.
struct WallImpact {
  Vec3 normal;
  double fraction = 0.0;  ///< of the segment
  Vec3 point;
  Vec3 position;  ///< of the particle, in the simplex at the wall
  Vec3 wall_displacement;
};

/// A step that has been walked up to its first wall: see Stepper::step().
struct PartialStep {
  Vec3 from;         ///< where the walk began: the particle's place, after riding along with the vertices
  Walk walk;         ///< ends at a wall: one that q is beyond, or one that q is on
  TestCounts tests;  ///< made so far
  const WallImpact* impact = nullptr;

  PartialStep(const Vec3& start, const Walk& first, const TestCounts& counts)
      : from(start), walk(first), tests(counts) {}

  /// Whether the step has put the particle where it landed, and it has stayed there.
  [[nodiscard]] bool stays(const ParticleState& after) const {
    return impact != nullptr && after.at() == walk.wall_simplex && after.position == impact->position;
  }
};

/// Carries particles through one step of a complex. A plain reader of the complex: any number may run at once.
class Stepper {
 public:
  /// `moved`: the complex's positions have been committed for this step; targets then are relative to positions before
  /// the move (they are absolute points, computed by the caller from where the particle was).
  Stepper(const CellComplex& complex, bool moved, const StepOptions& options, const ContactCallback& respond)
      : complex_(complex), moved_(moved), options_(options), respond_(respond) {}

  /// Steps one particle to `target`, a finite point in the exact range. Adds its contacts in order of time. `partial`:
  /// goes on from there, if it is not null; the step is one that is not split.
  StepResult step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                  ContactList& contacts, Counters& counters, const PartialStep* partial = nullptr) const;

  /// The same step to the same bits, for one particle to be looked at: adds its crossings, too. Cost: some exact values
  /// for each of these.
  StepResult trace(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                   ContactList& contacts, std::vector<Crossing>& crossings) const;

 private:
  template <std::size_t N, class Recorder>
  StepResult step_in(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                     ContactList& contacts, Counters& counters, const PartialStep* partial,
                     const Recorder& recorder) const;

  const CellComplex& complex_;
  bool moved_;
  const StepOptions& options_;
  const ContactCallback& respond_;
};

}  // namespace dartcast
