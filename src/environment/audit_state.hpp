// The audit of one particle.
#pragma once

#include <string>

#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"

namespace dartcast::detail {

/// The fault of a particle's state, as audit() looks for it; empty: there is none.
std::string fault_of(const CellComplex& complex, const ParticleState& state, const Weights& held_weights);

}  // namespace dartcast::detail
