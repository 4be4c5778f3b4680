// Why a solid or a surface has no room, in words.
#pragma once

#include "dartcast/solids.hpp"

namespace dartcast {

/// Follows "its part".
constexpr const char* reason(SolidRefusal why) {
  switch (why) {
    case SolidRefusal::vertex_not_free: return "is in a blocked cell or outside";
    case SolidRefusal::meets_wall: return "meets a wall";
    case SolidRefusal::encloses_wall: return "encloses a wall";
    case SolidRefusal::cell_not_positive: return "is in a cell that is flat or inverted";
    case SolidRefusal::meets_solid: return "overlaps another solid";
    case SolidRefusal::none: break;
  }
  return "has room";
}

}  // namespace dartcast
