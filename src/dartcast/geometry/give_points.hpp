// Interior points for the cells that an edit made.
#pragma once

#include <span>

#include "dartcast/geometry/interior_weights.hpp"
#include "dartcast/map/transaction.hpp"

namespace dartcast {

/// Gives the cells that the transaction added, and their neighbours where a face asks for it, the points that they
/// need: faces that may be straight at a corner, or whose plain fan has no positive side, one that both their cells
/// share; cells with such a face, with faces that may lie in one plane, or with a simplex that is not positive, one of
/// their own. Replaces these cells; returns the weights of the new vertices. Whether all simplices are positive now is
/// for the caller to check. `positions`: of all vertices so far. Cost: linear in these cells, on average.
InteriorWeights give_interior_points(Transaction& t, std::span<const Vec3> positions);

}  // namespace dartcast
