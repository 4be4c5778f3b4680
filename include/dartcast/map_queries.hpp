// Orbits of a combinatorial map: the darts of a vertex, an edge, a face, a cell.
#pragma once

#include <vector>

#include "dartcast/combinatorial_map.hpp"

namespace dartcast {

// Each returns every dart of the orbit once, d first. Where the map has a boundary an orbit holds what is connected to
// d across faces: a vertex at which two parts touch without a common face has an orbit for each. Cost: its size, times
// its log.

/// All darts that start at the vertex of d.
std::vector<Dart> vertex_orbit(const CombinatorialMap& map, Dart d);
/// All darts along the edge of d, in either direction.
std::vector<Dart> edge_orbit(const CombinatorialMap& map, Dart d);
/// All darts of the face of d, from both its sides.
std::vector<Dart> face_orbit(const CombinatorialMap& map, Dart d);
/// All darts of the cell of d.
std::vector<Dart> cell_orbit(const CombinatorialMap& map, Dart d);

}  // namespace dartcast
