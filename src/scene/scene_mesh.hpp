// The mesh of a scene, read or generated.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "formats/checked_file.hpp"

namespace dartcast {

struct SceneMesh {
  MeshData mesh;                  ///< checked and repaired, with `free` and patches as the scene says
  MeshReport report;              ///< of a file: repairs and warnings; of a generator: counts alone
  Finding skipped;                ///< bad cells that were left out, if the scene wants that
  std::vector<Finding> warnings;  ///< as of LoadedScene
};

/// The mesh's name in messages: that of its file. The name of a generated mesh says which option may make it invalid.
std::string mesh_name(const MeshSource& mesh);

/// with_file_name() of a scene's mesh.
template <class Make>
auto with_mesh_name(const MeshSource& mesh, Make&& make) {
  return with_file_name(mesh_name(mesh), make);
}

/// The options, with the arrays that the scene's fields take from its mesh as `point_fields`.
ReadOptions options_for_fields(const Scene& scene, ReadOptions options);

/// Reads or makes the mesh. The options `patch_array` and `linearise` have no effect. Throws InvalidMesh with the mesh
/// file's name if the mesh is refused.
SceneMesh read_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options = {}, Threads threads = {});

/// Sets free cells and patches of the mesh as the scene says. Throws as select_cells_and_patches() and check_patches(), with
/// the mesh file's name.
void resolve_mesh(SceneMesh& read, const Scene& scene);

/// Reads an environment, and sets its free cells and patches. Errors have the mesh file's name.
SceneMesh load_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options = {});

/// Reads all other files that the scene names. Returns warnings. `mesh`: the scene's, read. Null: this process has a part of it at most.
/// Then the scene has no fields from files, and no frames if it leaves cells out.
std::vector<Finding> read_all_but_mesh(Scene& scene, const MeshData* mesh, const ReadOptions& options);

}  // namespace dartcast
