// Surfaces of which a few triangles cross or touch: these are replaced.
#pragma once

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// How often triangles are taken out and holes closed, at most.
inline constexpr unsigned most_mendings = 10;

/// Takes out the triangles that cross or touch, and those that have a corner in common with them. Closes the holes with
/// triangles between the same points. Does this again until none cross. A repair in the report then has the number of
/// triangles taken out, and the greatest distance between the old surface and the new one. It is measured at corners
/// and in the middle of edges and triangles. If this does not end well, nothing changes, and the crossings stay a
/// defect for the caller to find. Precondition: a closed, oriented surface of triangles.
void mend_crossings(MeshData& surface, MeshReport& report);

}  // namespace dartcast
