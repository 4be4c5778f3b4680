// Surfaces that bound regions: read, triangulated, closed and checked before a mesh is made around them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/vec3.hpp"
#include "surface/triangle_pairs.hpp"

namespace dartcast {

/// The triangles of all surfaces. All points are used.
struct ClosedSurfaces {
  std::vector<Vec3> points;
  std::vector<TriangleCorners> triangles;
  std::vector<std::uint32_t> surface;  ///< per triangle: its number in SurfaceScene::surfaces
  std::vector<std::int32_t> patch;     ///< per triangle
  std::map<std::int32_t, std::string> patch_names;
  std::vector<std::uint32_t> source;  ///< per triangle: the face in its file
  MeshReport report;                  ///< closed and free of crossings if it is valid
};

/// Reads the files, cuts polygons into triangles, orients these, closes flat holes if the scene wants it, and checks
/// all. Nothing in the files makes this throw.
ClosedSurfaces read_closed_surfaces(const SurfaceScene& scene, const ReadOptions& options);

}  // namespace dartcast
