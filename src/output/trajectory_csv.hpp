// One trajectory as a table: a row for the start, for each crossing, contact and target, and for the end.
#pragma once

#include <span>
#include <string>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/trace.hpp"

namespace dartcast {

/// Columns: step (from 1, one for each target), time (fraction of the step), event (start, crossing, contact, target,
/// end), kind (vertex, edge, face, volume: of the cell of the map that the particle is in, or passes), x, y, z, cell
/// and next (indices in the mesh; next: the one entered at a crossing, else empty). Numbers are the shortest that give
/// the same bits back, whatever the locale. `map`: the one that the traces were made in. Cost: linear.
std::string trajectory_csv(const CombinatorialMap& map, std::span<const Trace> traces);

}  // namespace dartcast
