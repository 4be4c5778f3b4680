// Meshes of the plane: where they lie, and boundary edges that lie against each other without being the same edge.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "mesh/conformity.hpp"
#include "mesh/faces.hpp"

namespace dartcast {

/// Moves points that share one z to z = 0 (repair: plane). Refuses a mesh whose z differ (no_volume): a surface in
/// space. `point_source`: per point, its index in the input. Precondition: a mesh of the plane, finite coordinates.
void put_in_plane(MeshData& mesh, const std::vector<std::uint32_t>& point_source, MeshReport& report);

/// find_unmatched_faces() in the plane. Two boundary edges lie against each other if they are on one line and have
/// more than a point in common. An edge is also found if an end of another lies inside it: a hanging point. All
/// signs are exact. Cost: n log n for a tree of boxes, then the pairs of boxes that overlap; it stops after 200 pairs
/// an edge on average. Preconditions: coordinates in the exact range, edges of two ends at different places.
Conformity find_unmatched_edges(const MeshData& mesh, const BoundaryFaces& boundary);

}  // namespace dartcast
