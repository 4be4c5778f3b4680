// A complex as a mesh again: for output, and to go on with elsewhere.
#pragma once

#include "dartcast/geometry/complex.hpp"
#include "dartcast/mesh/mesh_data.hpp"

namespace dartcast {

/// The cells as they are now, pool by pool, with their free marks and `source` as in the map; points: the vertices that
/// they use, at their positions, without interior points. No regions, patches or data. Cost: linear.
MeshData to_mesh(const Complex& complex);

}  // namespace dartcast
