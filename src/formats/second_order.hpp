// Cells of second or higher order: refused, or taken as linear ones.
#pragma once

#include <cstddef>

#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// Counts such a cell at its place in the file. Whether its corners are to be taken, which stand before its other points.
inline bool take_higher_order(ParsedMesh& parsed, std::size_t place) {
  (parsed.linearise ? parsed.linearised : parsed.second_order).add(place);
  return parsed.linearise;
}

}  // namespace dartcast
