// A mesh that has been checked, with its points at other places.
#pragma once

#include <span>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Whether each cell is positive and each point in range with these points. Then check_and_repair() takes the mesh and
/// changes nothing, because all else that it checks does not depend on places. Cost: linear, and a copy of the cells.
/// Preconditions: check_and_repair() found `mesh` valid (its own points may be gone); one point for each of its points.
bool stays_valid(const MeshData& mesh, std::span<const Vec3> points);

}  // namespace dartcast
