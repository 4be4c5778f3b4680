// The mesh around the surfaces of a scene, made once and kept.
#pragma once

#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// As mesh_surfaces(), but by way of the text of a .msh file. So a mesh that is read again has the same bits as one
/// just made. ReadOptions::kept_mesh is that file. Throws Error if it cannot be written.
MeshFile kept_surface_mesh(const SurfaceScene& scene, const ReadOptions& options);

}  // namespace dartcast
