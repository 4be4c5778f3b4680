// Steiner points for the cells that an edit made.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/map_edits.hpp"

namespace dartcast {

struct PlacedSteinerPoints {
  SteinerWeights weights;                       ///< of the new vertices
  std::vector<std::pair<Cell, Cell>> replaced;  ///< cells that got points, and the cells in their place; sorted
};

/// Gives Steiner points to the cells that the transaction added, and to their neighbours at a face that needs one. A
/// face gets a point if it may be straight at a corner, or if its plain fan has no positive side. Both its cells share
/// the point. A cell gets a point if it has such a face, faces that may lie in one plane, or a simplex that is not
/// positive. These cells are replaced. The caller must check whether all simplices are positive afterwards.
/// `positions`: of all vertices so far. Cost: linear in these cells, on average.
PlacedSteinerPoints place_steiner_points(Transaction& t, std::span<const Vec3> positions);

/// The cells that would keep a simplex that is not positive, sorted. They are among the given ones and their neighbours
/// at a face that needs a point. `keep_faces`: also cells with a face that would get a point because it is bent. The
/// search may make vertices in the transaction, which the caller undoes. Cost: as above, but less if the mean of each
/// cell's corners sees all its faces.
std::vector<Cell> cells_without_cone(Transaction& t, std::span<const Vec3> positions, std::span<const Cell> cells,
                                     bool keep_faces);

}  // namespace dartcast
