// Holes of a surface, and the caps that close them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/vec3.hpp"
#include "surface/triangle_pairs.hpp"

namespace dartcast {

/// The border of a hole: the corners of a face that would close it, in the sense that this face would have.
struct Hole {
  std::vector<std::uint32_t> corners;
  Vec3 centre;
  double area = 0.0;       ///< of the border as seen along its normal
  double off_plane = 0.0;  ///< the largest distance of a corner from the plane through the centre
};

/// The corners of all triangles. Precondition: a surface of triangles.
std::vector<TriangleCorners> triangles_of(const MeshData& surface);

/// All holes of an oriented surface of triangles, in the order of their lowest corners.
std::vector<Hole> holes_of(const MeshData& surface);

/// Makes points on borders one if they have the same place: there the surface is cracked. If the result would not be
/// valid, nothing changes. A repair in the report has their number. Precondition: an oriented surface of triangles.
void join_borders(MeshData& surface, MeshReport& report);

/// Closes all holes with triangles, in regions of their own: inlet for the largest one, outlet or outlet_1 ... for the
/// others. Faces that had no region are in region 0. A hole whose border is off a plane by more than `tolerance` of its
/// diameter is a defect, and nothing changes. The tolerance is a matter of taste, not of exactness: a cap's triangles
/// end exactly at the border, however that lies. If a hole is off a plane by more than a twentieth of its diameter, its
/// triangles have the least area. They cross nothing if such triangles are found (fill_hole()).
void close_holes(MeshData& surface, MeshReport& report, double tolerance);

/// Holes as a defect, with the first ones' places.
Finding open_holes(const MeshData& surface);

}  // namespace dartcast
