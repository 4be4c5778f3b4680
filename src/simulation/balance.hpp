// Equal work for ranks that share a simulation by cells. Not installed.
#pragma once

#include "dartcast/simulation.hpp"

namespace dartcast {

/// Moves cells, and the particles in them, between the ranks if one has far more work than the mean: 1.2 times, if a
/// particle counts as many cells. Nothing happens if that would help little. Every result of the simulation stays the
/// same to the bit. Precondition: parts.part and parts.motion_of_part. Collective.
void balance(Simulation::Parts& parts);

}  // namespace dartcast
