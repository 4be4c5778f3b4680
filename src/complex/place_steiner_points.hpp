// Interior points for the cells that an edit made.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/map_edits.hpp"

namespace dartcast {

struct PlacedSteinerPoints {
  SteinerWeights weights;                       ///< of the new vertices
  std::vector<std::pair<Cell, Cell>> replaced;  ///< cells that were given points, and what they are now; sorted
};

/// Gives the cells that the transaction added, and their neighbours where a face asks for it, the points that they
/// need: faces that may be straight at a corner, or whose plain fan has no positive side, one that both their cells
/// share; cells with such a face, with faces that may lie in one plane, or with a simplex that is not positive, one of
/// their own. Replaces these cells. Whether all simplices are positive now is for the caller to check. `positions`: of
/// all vertices so far. Cost: linear in these cells, on average.
PlacedSteinerPoints place_steiner_points(Transaction& t, std::span<const Vec3> positions);

}  // namespace dartcast
