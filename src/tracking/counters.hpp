// What a batch of steps cost, and what happened in it.
#pragma once

#include <array>
#include <cstdint>

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

}  // namespace dartcast
