// What a step of particles takes and gives: options, contacts, those held or stopped, counts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/contact.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// Signs asked in walks: `tests` counts each once, side tests included, however it was answered; `exact` those that the
/// filter left open. Locating, certifying a position and audits are not counted.
struct TestCounts {
  std::uint64_t tests = 0;
  std::uint64_t exact = 0;
};

/// Sums over particle-steps. Addition is in integers, so that the order of adding does not matter.
struct Counters {
  static constexpr std::size_t histogram_size = 64;

  std::uint64_t particle_steps = 0;
  TestCounts orientation;
  /// Particle-steps by number of orientation tests; the last entry also holds all above.
  std::array<std::uint64_t, histogram_size> histogram{};
  std::uint64_t forecast_kept = 0;           ///< ended in the simplex where they began, without a contact
  std::uint64_t updated_by_deformation = 0;  ///< changed simplex where the vertices' motion alone would have done it
  std::uint64_t steps_split = 0;             ///< taken in several parts, for the vertices turned or stretched too much
  std::array<std::uint64_t, 3> contacts{};   ///< by kind: vertex, edge, face
  std::uint64_t unfinished = 0;              ///< stopped at the last contact allowed in a step

  Counters& operator+=(const Counters& other) {
    particle_steps += other.particle_steps;
    orientation.tests += other.orientation.tests;
    orientation.exact += other.orientation.exact;
    for (std::size_t i = 0; i < histogram_size; ++i) histogram[i] += other.histogram[i];
    forecast_kept += other.forecast_kept;
    updated_by_deformation += other.updated_by_deformation;
    steps_split += other.steps_split;
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i] += other.contacts[i];
    unfinished += other.unfinished;
    return *this;
  }
};

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

/// A particle stopped at a contact before its target.
struct StoppedParticle {
  std::uint32_t particle = 0;
  Vec3 unused;  ///< displacement left, relative to the wall
};

struct StepReport {
  ContactList contacts;                  ///< by particle, then by time
  std::vector<HeldParticle> held;        ///< by particle
  std::vector<StoppedParticle> stopped;  ///< by particle
  Counters counters;
};

}  // namespace dartcast
