// One step of one particle: riding along with the vertices, walking, contacts, and what follows them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "tracking/counters.hpp"
#include "tracking/crossing.hpp"
#include "tracking/walk.hpp"

namespace dartcast {

struct StepOptions {
  /// Contacts allowed to a particle in one step, at least 1; at the last one it is asked to slide.
  unsigned max_contacts = 16;
  /// How far the chord may be off the true motion relative to the vertices, as a share (> 0) of the local edge: a step
  /// is split into ceil(sqrt(|A| |r| / (2 tolerance edge))) parts, A the displacement gradient of the vertices, r the
  /// particle's own motion.
  double tolerance = 0.05;
  /// Parts at most, at least 1; a step that would need more is taken in this many.
  unsigned max_parts = 256;
};

/// Throws InvalidArgument, which names the caller and the option, where one is out of range.
void check(const StepOptions& options, const char* caller);

/// A particle that a cell kept from its step, and why.
struct HeldParticle {
  std::uint32_t particle = 0;
  Cell cell;  ///< the invalid cell: its own, or one on its way; or its own, which is blocked
};

struct StepResult {
  bool held = false;
  Cell invalid_cell;
  bool stopped = false;  ///< at a contact that nothing followed
  Vec3 unused;           ///< displacement left when it stopped, relative to the wall
};

/// Barycentric coordinates that a held particle keeps; in the plane the fourth is 0.
using Weights = std::array<double, 4>;

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
