// How far an edit moved the walls and the boundary.
#pragma once

#include <span>

#include "dartcast/map_edits.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// A bound of the distance from any point of a wall or of the boundary, where an open transaction split, merged or
/// fanned its faces anew, to where it lay: 0 where it is fanned as it was; else the extent along its normal of the
/// corners of the face before and after, which hold both. Vertices that were identified count with their distance.
/// `positions`: of all vertices, those gone included. Cost: linear in the cells touched, on average.
double boundary_shift(const Transaction& t, std::span<const Vec3> positions);

}  // namespace dartcast
