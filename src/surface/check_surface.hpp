// Judging a surface in space before anything is built from it.
#pragma once

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// As check_and_repair(), of a mesh whose cells are triangles, quadrilaterals and polygons anywhere in space. A polygon
/// is fanned from its lowest-numbered corner and need not be plane: the triangles of the fan are the surface. Repairs
/// in place:
///   orientation (faces that ran against their neighbours were turned; of each part the first face decides).
/// Warns of what can be used with care:
///   repeated_points (that faces use), open_border (edges of one face), pinched_points (several fans of faces at one).
/// Refuses:
///   empty, structure (array sizes, cells of space), id_out_of_range, repeated_corner, not_finite, out_of_range
///   (coordinates), face_shared (edges of more than two faces), not_orientable, flat (a triangle of a fan without
///   area, exactly), too_large.
/// Surfaces that cross themselves are taken: particles know nothing of it. Never throws for any content of the arrays.
/// Cost: n log n.
MeshReport check_and_repair_surface(MeshData& mesh);

}  // namespace dartcast
