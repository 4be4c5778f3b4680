// One stretch of a sphere's way: the target of the centre, and the wall that the sphere touches there.
#pragma once

#include <cstdint>

#include "dynamics/near_walls.hpp"

namespace dartcast::detail {

/// The end of a stretch.
enum class WayEnd : std::uint8_t {
  target,   ///< nothing is touched
  contact,  ///< a wall is touched
  overlap   ///< a wall overlaps the sphere at the start: it moves out, or with the wall, and no further
};

struct SphereWay {
  WayEnd end = WayEnd::target;
  Vec3 target;                 ///< of the centre, in the current geometry
  double time = 0.0;           ///< of the contact, never late: share of the stretch
  double used = 0.0;           ///< share of the motion that was made
  Vec3 wall_displacement;      ///< contact, or overlap, after a move
  CellFace face;               ///< contact: of the wall touched
  std::uint16_t triangle = 0;  ///< in the face's fan
};

/// A sphere at the start of a stretch. Positions before the last move if `moving`, else as they are now.
struct SphereInterval {
  Cell cell;
  MovingSphere sphere;
  bool moving = false;  ///< the walls move meanwhile
  bool push_out =
      true;  ///< out of walls that overlap it; else it moves as a sphere of the radius that there is room for
};

/// The way of a sphere. Cost: that of the search, and some 0.1 us for each wall found.
SphereWay way_of(const CellComplex& complex, const SphereInterval& interval, NearWalls& near);

}  // namespace dartcast::detail
