// The edits of dartcast/map_edits.hpp where cells are polygons; called by these, which say what they do and check the
// darts.
#pragma once

#include <vector>

#include "dartcast/map_edits.hpp"

namespace dartcast::detail {

SplitEdge split_edge_in_plane(Transaction& t, Dart d);
std::vector<Cell> split_polygon(Transaction& t, Dart a, Dart b);
/// Preconditions: there is a cell beyond the edge, marked alike, and nothing but the edge is between the two.
Cell merge_polygons(Transaction& t, Dart d);
std::vector<Cell> merge_edges_in_plane(Transaction& t, Dart d);

}  // namespace dartcast::detail
