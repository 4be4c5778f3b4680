// The mesh of a scene, or a rank's part of it, without any file.
#pragma once

#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/ranks.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// By the generator, or a copy of the mesh. Throws InvalidArgument if the source is a file.
MeshData generated_mesh(const MeshSource& source);

/// Sets free cells and patches as the scene says; patches from an array have been read with the file. Precondition: a
/// mesh that check_and_repair() found valid. Throws InvalidMesh, naming those there are, if a region, array or patch
/// is not in the mesh.
void select_cells_and_patches(MeshData& mesh, const EnvironmentScene& scene);

/// Throws InvalidMesh if a patch that the scene names has no face that is a wall. An event may make one: if the
/// scene has any, nothing is checked. `mesh`: as select_cells_and_patches() leaves it.
void check_patches(const Scene& scene, const MeshData& mesh);

/// The mesh with scale, free cells and patches as the scene says. Throws InvalidArgument if something must be read
/// first, and InvalidMesh.
MeshData scene_mesh(const EnvironmentScene& scene);

/// Throws InvalidArgument, which names it, if a scene has something that needs the whole environment on one rank.
void check_can_be_spread(const Scene& scene);

/// The rank's part of the scene's mesh, which may be given as such. Throws as partition(), and InvalidArgument if the part
/// is of another rank.
MeshPart scene_part(const EnvironmentScene& scene, const Ranks& ranks);

}  // namespace dartcast
