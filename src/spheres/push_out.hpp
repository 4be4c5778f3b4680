// Where a sphere that overlaps walls is moved out to.
#pragma once

#include "dynamics/near_walls.hpp"

namespace dartcast {

/// The displacement of a sphere at `centre`, in this cell, that takes it out of the walls by as little as it can: to
/// the distance of its radius from all of them, or, where there is no room nearby, to where the least distance is as
/// large as it can be. No longer than twice the radius. The walls are taken as they stand, each as the plane across the
/// direction to its nearest point, again from where that leads (four times at most). Walls passed on the way are not
/// asked for: the environment's walk stops the centre there. Cost: some microseconds.
Vec3 push_out(const CellComplex& complex, Cell cell, const Vec3& centre, double radius, NearWalls& near);

}  // namespace dartcast
