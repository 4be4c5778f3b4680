// The mesh of a scene, read or generated.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

struct SceneMesh {
  MeshData mesh;                  ///< checked and repaired, with `free` and patches as the scene says
  MeshReport report;              ///< of a file: repairs and warnings; of a generator: counts alone
  Finding skipped;                ///< bad cells that were left out, if the scene wants that
  std::vector<Finding> warnings;  ///< as of LoadedScene
};

/// Calls make(). If make() throws InvalidMesh, puts the mesh file's name before the message.
template <class Make>
auto with_mesh_name(const MeshSource& mesh, Make&& make) {
  try {
    return make();
  } catch (const InvalidMesh& e) {
    const auto* path = std::get_if<std::filesystem::path>(&mesh);
    const auto* surfaces = std::get_if<SurfaceScene>(&mesh);
    const std::string name = path != nullptr       ? path->string()
                             : surfaces != nullptr ? surfaces->surfaces.front().file.string()
                                                   : "the generated mesh";
    if (std::string_view(e.what()).starts_with(name)) throw;
    throw InvalidMesh(name + ": " + e.what());
  }
}

/// Reads or makes the mesh. Only the options `max_memory` and `kept_mesh` have an effect. Throws InvalidMesh with the mesh
/// file's name if the mesh is refused.
SceneMesh read_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options = {}, Threads threads = {});

/// Sets free cells and patches of the mesh as the scene says. Throws as select_cells_and_patches() and check_patches(), with
/// the mesh file's name.
void resolve_mesh(SceneMesh& read, const Scene& scene);

/// Reads an environment, and sets its free cells and patches. Errors have the mesh file's name.
SceneMesh load_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options = {});

/// Reads all other files that the scene names. `mesh`: the scene's, read. Null: this process has a part of it at most.
/// Then the scene has no fields from files, and no frames if it leaves cells out.
void read_all_but_mesh(Scene& scene, const MeshData* mesh, const ReadOptions& options);

}  // namespace dartcast
