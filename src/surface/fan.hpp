// The triangles around a vertex of a surface, as far as no wall separates them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dartcast/surface.hpp"

namespace dartcast::detail {

/// A corner of a triangle, at the vertex, and the angle there.
struct FanCorner {
  SimplexId triangle;
  unsigned corner = 0;
  double angle = 0.0;
};

/// The corners counterclockwise. If walls meet the vertex (`closed` is false), they go from the wall on the right to
/// the wall on the left.
struct Fan {
  std::vector<FanCorner> corners;
  bool closed = true;
  double total = 0.0;   ///< sum of the angles
  std::size_t own = 0;  ///< the index of the given triangle's corner; 0 if closed
  double before = 0.0;  ///< sum of those before it

  /// The corner that contains an angle from the fan's first edge, and the rest of the angle there, in [0, its angle].
  [[nodiscard]] std::pair<FanCorner, double> at(double angle) const;
};

/// Which edges end a fan: all walls, or only open borders.
enum class FanWalls : std::uint8_t { end, passed };

/// The fan of a corner. It starts with the corner's own triangle if the fan is closed. Cost: linear in the triangles
/// around the vertex.
Fan fan_of(const Surface& surface, SimplexId triangle, unsigned corner, FanWalls walls = FanWalls::end);

}  // namespace dartcast::detail
