// A still picture of a frame, for pages that cannot draw the scene. Not installed.
#pragma once

#include <string>

#include "report/recorded.hpp"

namespace dartcast {

/// SVG: edges of the walls and up to 1,000 particles, seen from the side in space, from above in the plane.
std::string picture_of(const RecordedFrame& frame, const RecordedWalls& walls, std::uint32_t dimension);

}  // namespace dartcast
