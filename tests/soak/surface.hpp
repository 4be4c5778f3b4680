// Particles on surfaces.
#pragma once

#include <cstdint>
#include <string>

#include "dartcast/cell_complex.hpp"
#include "soak/case.hpp"

namespace dartcast::soak {

/// Steps of particles on the scene's walls (in the plane: in its cells, as a surface in space): many at once on several
/// threads, and each alone, traced. Returns what is wrong.
std::string step_on_surface(const Case& c, const CellComplex& complex, std::uint64_t step);

}  // namespace dartcast::soak
