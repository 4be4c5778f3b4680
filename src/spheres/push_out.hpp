// The displacement of a sphere out of walls that it overlaps.
#pragma once

#include "dynamics/near_walls.hpp"

namespace dartcast {

/// The shortest displacement of a sphere at `centre`, in this cell, to a place at the distance of its radius from all
/// walls. If there is no such place near by, it maximizes the least distance. It is no longer than twice the radius.
/// Each wall counts as the plane across the direction to its nearest point. The planes are found again at the new
/// place, four times at most. Walls on the way are ignored, because the environment's walk stops the centre there.
/// Cost: some microseconds.
Vec3 push_out(const CellComplex& complex, Cell cell, const Vec3& centre, double radius, NearWalls& near);

}  // namespace dartcast
