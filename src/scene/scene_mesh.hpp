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
  Finding skipped;                ///< bad cells that were left out, where the scene wants that
  std::vector<Finding> warnings;  ///< as of LoadedScene
};

/// Calls make(). Where make() throws InvalidMesh, puts the mesh file's name before the message.
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

/// Only the options `max_memory` and `kept_mesh` have an effect. Throws InvalidMesh with the mesh file's name where the
/// mesh is refused, or a region, array or patch that the scene names is not in it.
SceneMesh load_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options = {}, Threads threads = {});

/// Reads all other files that the scene names. `mesh`: the scene's, loaded; null: this process has a part of it at most,
/// and the scene has no fields from files.
void load_all_but_mesh(Scene& scene, const MeshData* mesh, const ReadOptions& options);

}  // namespace dartcast
