// Whether a cell may meet a tool. Private to editing.
#pragma once

#include <algorithm>

#include "dartcast/cutting.hpp"

namespace dartcast::detail {

/// Whether no plane of the tool has all corners of the cell on its outside. `position`: that of a vertex.
template <class Position>
bool near(const CellView& cell, const ConvexTool& tool, Position&& position) {
  return std::all_of(tool.planes.begin(), tool.planes.end(), [&](const Plane& plane) {
    for (std::uint16_t k = 0; k < cell.shape().corner_count(); ++k) {
      if (plane.height(position(cell.vertex(k))) < 0.0) return true;
    }
    return false;
  });
}

}  // namespace dartcast::detail
