// The point of the free cells that is nearest to a point in a blocked cell, or outside.
#pragma once

#include <optional>
#include <span>

#include "dartcast/cell_complex.hpp"
#include "tracking/place_in_simplex.hpp"

namespace dartcast {

struct NearestFree {
  SimplexPlacement place;
  double distance = 0.0;  ///< from the point to there
};

/// Searches outwards from the cells given, always from the nearest cell reached, to the first free cell. It is the
/// nearest one if it can be reached over cells that are no farther. Nothing if there is none. Cells with a simplex
/// that is not positive are passed through. The place is exactly in its closed simplex; distances are rounded. `start`:
/// cells next to x; the one that holds x, if one does, comes first. Precondition: x is in the exact range. Cost: the
/// cells nearer than the place found.
std::optional<NearestFree> nearest_free(const CellComplex& complex, std::span<const Cell> start, const Vec3& x);

/// The point of a triangle that is nearest to x, rounded (C. Ericson, "Real-Time Collision Detection", 2005, section
/// 5.1.5).
Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

}  // namespace dartcast
