// A complex as a mesh again: for output, and to go on with elsewhere.
#pragma once

#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// The cells as they are now, pool by pool, with their free marks and `source` as in the map; points: the vertices that
/// they use, at their positions, without interior points. No regions, patches or data. `vertices`: unless null, takes
/// the vertex of each point. Cost: linear.
MeshData to_mesh(const CellComplex& complex, std::vector<Vertex>* vertices = nullptr);

}  // namespace dartcast
