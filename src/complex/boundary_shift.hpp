// The distance by which an edit moved the walls and the boundary.
#pragma once

#include <span>

#include "dartcast/map_edits.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// An open transaction may split, merge or fan faces anew. This bounds how far a point of a wall or of the boundary is
/// then from its old position. It is 0 if a face is fanned as before, or split along its fan. Otherwise it is the
/// extent, along the face's normal, of the corners of the face before and after, which contain both. Merged vertices
/// count with their distance. `positions`: of all vertices, including removed ones. Cost: linear in the cells touched,
/// on average.
double boundary_shift(const Transaction& t, std::span<const Vec3> positions);

}  // namespace dartcast
