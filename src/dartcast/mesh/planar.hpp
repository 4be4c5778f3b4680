// Planar meshes: triangles and quadrangles in a coordinate plane, kept as the patch faces of a mesh without cells.
#pragma once

#include "dartcast/mesh/mesh_data.hpp"
#include "dartcast/mesh/report.hpp"

namespace dartcast {

/// Inspects a mesh that has patch faces and no cells, and repairs their orientation (counterclockwise) in place.
/// Finds faces that are flat or not convex, sides that three faces use, points that hang on a side, and surfaces that
/// do not lie in a plane x, y or z = constant. Preconditions: ids in range, no repeated corners, coordinates in the
/// exact range.
void inspect_planar(MeshData& mesh, MeshReport& report);

}  // namespace dartcast
