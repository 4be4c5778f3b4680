// Whether a polyhedron's faces are a closed surface, all turned the same way.
#pragma once

#include <cstddef>
#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// A polyhedron has at most this many faces, and at most this many distinct corners.
inline constexpr std::uint32_t polyhedron_limit = 1000;

enum class Closure {
  closed,    ///< every edge is used twice, in opposite directions
  repaired,  ///< closed after some faces have been turned over
  open,      ///< an edge is not used exactly twice, the faces fall into parts, or they cannot be turned the same way
};

/// Turns over, in place, the faces of polyhedron c that disagree with its first face. Whether all of it is then inside
/// out is for orient_cell(). Precondition: the cell's connectivity is well formed. Cost: n log n in its edges.
Closure close_polyhedron(MeshData& mesh, std::size_t c);

}  // namespace dartcast
