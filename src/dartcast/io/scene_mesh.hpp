// What a scene names, read or generated: its mesh, its fields and frames.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "dartcast/base/parallel.hpp"
#include "dartcast/mesh/mesh_data.hpp"
#include "dartcast/mesh/report.hpp"
#include "dartcast/simulation/scene.hpp"

namespace dartcast {

struct SceneMesh {
  MeshData mesh;      ///< inspected, with `free` and patches as the scene says
  MeshReport report;  ///< of a file: repairs and warnings; of a generator: counts alone
  Finding skipped;    ///< bad cells that were left out, where the scene wants that
};

/// Throws InvalidMesh where the mesh is refused, or a region, array or patch that the scene names is not in it.
SceneMesh load_scene_mesh(const EnvironmentScene& scene, Threads threads = {});

/// A point array of three components as vectors. Throws InvalidMesh that names the arrays there are.
std::vector<Vec3> point_vectors(const MeshData& mesh, const std::string& array);

/// The deformation's steps, with arrays taken from the mesh and frames read from their files, these scaled and without
/// bad cells as the mesh is. Throws InvalidMesh.
std::vector<DeformationStep> load_deformation(std::span<const DeformationScene> scene, const MeshData& mesh,
                                              const EnvironmentScene& environment = {});

}  // namespace dartcast
