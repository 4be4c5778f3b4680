// Whether a cell may meet a tool. Private to editing.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "dartcast/cutting.hpp"

namespace dartcast::detail {

/// Whether none of the planes of a tool has all corners of a cell on its outside. `position`: that of a vertex.
template <class Position>
bool near(std::span<const std::uint32_t> corners, std::span<const Plane> planes, Position&& position) {
  return std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
    return std::any_of(corners.begin(), corners.end(),
                       [&](std::uint32_t v) { return plane.height(position(Vertex(v))) < 0.0; });
  });
}

}  // namespace dartcast::detail
