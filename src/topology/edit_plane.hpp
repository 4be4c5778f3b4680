// The edits of dartcast/map_edits.hpp if cells are polygons. The functions there call them, and check the darts
// before.
#pragma once

#include <vector>

#include "dartcast/map_edits.hpp"

namespace dartcast::detail {

SplitEdge split_edge_in_plane(Transaction& t, Dart d);
std::vector<Cell> split_polygon(Transaction& t, Dart a, Dart b);
/// Preconditions: there is a cell beyond the edge, free or blocked like this one, and they share nothing but the edge.
Cell merge_polygons(Transaction& t, Dart d);
std::vector<Cell> merge_edges_in_plane(Transaction& t, Dart d);

}  // namespace dartcast::detail
