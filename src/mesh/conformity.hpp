// Boundary faces that lie against each other without being the same face: hanging nodes, diagonals that disagree,
// quadrangles against triangles, seams of doubled points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "mesh/faces.hpp"

namespace dartcast {

struct Conformity {
  std::vector<std::uint32_t> faces;  ///< boundary faces that lie against another one, ascending
  bool complete = true;              ///< false: more pairs of faces came into question than could be looked at
};

/// Two faces lie against each other in three cases. Two triangles of their fans are exactly coplanar and overlap with
/// positive area (exact signs). Or they do so after rounding: they are turned towards each other, and off each other's
/// plane by at most 1e-9 of their size. Or a face of four corners or more has three corners in a row that are a triangle
/// of another cell. Cost: n log n for a tree of boxes, then the pairs of boxes that overlap; it stops after 200 pairs a
/// face on average. Preconditions: coordinates in the exact range.
Conformity find_unmatched_faces(const MeshData& mesh, const BoundaryFaces& boundary);

}  // namespace dartcast
