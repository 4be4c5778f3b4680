// The triangles of a surface, checked before use.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "mesh/box_tree.hpp"

namespace dartcast {

using SurfaceTriangle = std::array<std::uint32_t, 3>;

/// The triangles of a surface's faces, oriented alike across edges. Each face gives a fan from its lowest-numbered
/// corner, and one that is not convex the triangles of ears(). Throws InvalidMesh, with the kind of the first defect and its first face, if check_and_repair_surface()
/// refuses the surface. Cost: n log n.
std::vector<SurfaceTriangle> surface_triangles(const MeshData& surface);

/// Throws InvalidMesh, which names an edge, if a triangle has no neighbour across one of its edges. Such a surface
/// is open and has no inside. Precondition: no edge has more than two triangles. Cost: n log n.
void check_closed(const std::vector<SurfaceTriangle>& triangles);

/// The smallest box that holds some corners of points.
Box box_of(const std::vector<Vec3>& points, const SurfaceTriangle& triangle);

}  // namespace dartcast
