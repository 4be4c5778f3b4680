// The exchanges between ranks that a step by cells makes, for plans. Not installed. Tests hold these numbers to what a run
// does: tests/simulation/plan_test.cpp, tests/instructions (the cost of a traveller).
#pragma once

#include "base/exact_sum.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::collectives {

/// Exchanges of particles in a step of a tenth of a cell: one, and a second one if a walk goes on there.
inline constexpr double rounds = 2.0;
/// Sums in a step, and one more for each round. With output: counts and energies. Steps in which particles leave or are held,
/// or whose contacts are written, have a gather besides.
inline constexpr double sums = 7.0;
/// Their bytes: counters, and energies in long accumulators.
inline constexpr double summed_bytes = 8.0 * (2 * ExactSum::word_count + 4) + sizeof(Counters) + 24.0;

/// The bytes of a particle that goes to another rank: its walk, and what a simulation keeps beside it.
inline constexpr double sent_bytes = 216.0;
inline constexpr double seconds_of_packing = 60e-9;  ///< on each side
/// The bytes of a particle that stays: state, memory of its walk, and what a simulation keeps beside it.
inline constexpr double particle_bytes = sizeof(ParticleState) + 150.0;

}  // namespace dartcast::collectives
