// The mesh of a scene, and what its arrays give: without any file.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// By the generator, or a copy of the mesh. Throws InvalidArgument where the source is a file.
MeshData generated_mesh(const MeshSource& source);

/// Sets free cells and patches as the scene says; patches from an array have been read with the file. Precondition: a
/// mesh that check_and_repair() found valid. Throws InvalidMesh, naming those there are, where a region, array or patch
/// is not in the mesh.
void select_cells_and_patches(MeshData& mesh, const EnvironmentScene& scene);

/// Throws InvalidMesh where a patch that the scene names has no face that is a wall. An event may make one: where the
/// scene has any, nothing is checked. `mesh`: as select_cells_and_patches() leaves it.
void check_patches(const Scene& scene, const MeshData& mesh);

/// The mesh with scale, free cells and patches as the scene says. Throws InvalidArgument where something must be read
/// first, and InvalidMesh.
MeshData scene_mesh(const EnvironmentScene& scene);

/// A point array of three components as vectors. Throws InvalidMesh that names the arrays there are.
std::vector<Vec3> point_vectors(const MeshData& mesh, const std::string& array);

/// The deformation's steps, with arrays taken from the mesh. Throws InvalidMesh as point_vectors(), and InvalidArgument
/// where frames have not been read.
std::vector<DeformationStep> deformation_steps(std::span<const DeformationScene> scene, const MeshData& mesh);

}  // namespace dartcast
