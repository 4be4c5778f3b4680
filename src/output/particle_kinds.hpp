// Where particles are in their cells, for output. Not installed.
#pragma once

#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"

namespace dartcast {

inline Kind kind_of(const CellComplex& complex, const ParticleState& s) {
  return s.held ? Kind::volume : forecast(complex.map(), s, complex.corners(s.at())).kind;
}

}  // namespace dartcast
