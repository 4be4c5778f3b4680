// Findings with which a surface can be used, although its maker may not have meant them.
#pragma once

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Adds the warnings of check_and_repair_surface() to the report. Precondition: the surface has no defect of its
/// arrays, corners, coordinates and edges. Cost: n log n.
void add_surface_warnings(const MeshData& mesh, MeshReport& report);

}  // namespace dartcast
