// Ranks that share the cells of a mesh, as threads of one process.
#pragma once

#include <string>

#include "dartcast/cell_complex.hpp"
#include "soak/scene.hpp"

namespace dartcast::soak {

/// Takes some steps on the mesh as it is now, once on one rank and once on several. Returns what differs.
std::string step_on_ranks(const Case& c, const SceneMesh& scene, const CellComplex& complex, std::uint64_t step);

}  // namespace dartcast::soak
