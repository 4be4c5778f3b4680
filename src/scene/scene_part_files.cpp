// Loads a scene for ranks that share it by cells.
//
// Each rank gets its part of the mesh in one of three ways: made, read, or sent by the first. Then all read the other files.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_selection.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/format_table.hpp"
#include "mesh/mesh_scale.hpp"
#include "parts/merged_parts.hpp"
#include "parts/part_cutter.hpp"
#include "scene/scene_mesh.hpp"
#include "simulation/scene_environment.hpp"

namespace dartcast {

namespace {

// Cells are free that one of the selections takes. One that takes none on any rank is an error.
class FreeInParts {
 public:
  FreeInParts(MeshData& mesh, Ranks& ranks) : mesh_(mesh), ranks_(ranks), free_(mesh.cell_count()) {}

  template <class Select>
  void add(Select&& select) {
    std::uint64_t without = 0;
    std::string why;
    try {
      select(mesh_);
      for (std::size_t c = 0; c < free_.size(); ++c) free_[c] = free_[c] | mesh_.free[c];
    } catch (const InvalidMesh& e) {
      without = 1;
      why = e.what();
    }
    ranks_.sum({&without, 1});
    if (without == ranks_.size()) throw InvalidMesh(why);
  }
  void finish() { mesh_.free = std::move(free_); }

 private:
  MeshData& mesh_;
  Ranks& ranks_;
  std::vector<std::uint8_t> free_;
};

void select_free(MeshData& mesh, const EnvironmentScene& scene, Ranks& ranks) {
  if (std::holds_alternative<std::monostate>(scene.free)) return;
  FreeInParts free(mesh, ranks);
  if (const auto* regions = std::get_if<FreeRegions>(&scene.free)) {
    for (const std::string& name : regions->regions) free.add([&](MeshData& m) { select_free_regions(m, {&name, 1}); });
  }
  if (const auto* by_value = std::get_if<FreeValues>(&scene.free))
    free.add([&](MeshData& m) { select_free_values(m, by_value->array, by_value->values); });
  free.finish();
}

// All pieces know the names of all patches.
void keep_patches(MeshData& mesh, std::vector<std::string> names) {
  names.emplace_back(unknown_patch);
  select_patches(mesh, names);
}

void refuse(bool has, const char* what) {
  if (has)
    throw InvalidArgument(fmt::format(
        "partition: {} cannot be chosen in a mesh that comes in pieces: choose them in the mesh before it is cut",
        what));
}

// As read_scene_mesh() and resolve_mesh() do with a whole mesh.
void finish_piece(MeshData& mesh, const EnvironmentScene& scene, Ranks& ranks) {
  refuse(scene.skip_bad_cells, "cells to leave out");
  refuse(std::holds_alternative<PatchAngle>(scene.patches), "patches by their angle");
  refuse(std::holds_alternative<PatchArray>(scene.patches), "patches by an array");
  if (scene.scale != 1.0) scale_mesh(mesh, scene.scale);
  select_free(mesh, scene, ranks);
  select_walls(mesh, scene.walls);
  if (const auto* names = std::get_if<std::vector<std::string>>(&scene.patches)) keep_patches(mesh, *names);
}

// The first rank cuts the whole, and keeps its own part.
MeshPart sent_part(const Scene& scene, Ranks& ranks, const ReadOptions& options, Threads threads, LoadedScene& loaded) {
  std::vector<std::string> parts(ranks.size());
  if (ranks.rank() == 0) {
    SceneMesh whole = read_scene_mesh(scene.environment, options_for_fields(scene, options), threads);
    resolve_mesh(whole, scene);
    loaded.skipped = std::move(whole.skipped);
    loaded.warnings = std::move(whole.warnings);
    const std::vector<std::uint32_t> owners = partition(whole.mesh, ranks.size());
    PartCutter cutter(whole.mesh, owners, ranks.size());
    for (std::uint32_t p = 0; p < ranks.size(); ++p) parts[p] = packed(cutter.cut(cutter.cells_of(p), p));
  }
  return unpacked_part(ranks.exchange(std::move(parts)).front());
}

bool is_made_in_parts(const EnvironmentScene& scene) {
  const auto* box = std::get_if<BoxOptions>(&scene.mesh);
  return box != nullptr && has_parts(*box) && !scene.skip_bad_cells &&
         !std::holds_alternative<PatchAngle>(scene.patches);
}

}  // namespace

LoadedScene load_scene_part(Scene scene, Ranks& ranks, const ReadOptions& options, Threads threads) {
  check_can_be_spread(scene);
  const EnvironmentScene& e = scene.environment;
  refuse(e.skip_bad_cells && std::any_of(scene.deformation.begin(), scene.deformation.end(),
                                         [](const DeformationScene& s) { return !s.frames.empty(); }),
         "cells to leave out, with frames,");
  refuse(e.skip_bad_cells && !(scene.motion.field.files.empty() && scene.motion.force.files.empty()),
         "cells to leave out, with a field from files,");
  const auto* path = std::get_if<std::filesystem::path>(&e.mesh);
  LoadedScene loaded;
  MeshPart part;
  if (is_made_in_parts(e)) {
    part = box_part(std::get<BoxOptions>(e.mesh), ranks.size(), ranks.rank());
    finish_piece(part.mesh, e, ranks);
  } else if (path != nullptr && ending_of(*path) == ".pvtu") {
    part = read_mesh_part(*path, ranks.size(), ranks.rank(), options);
    finish_piece(part.mesh, e, ranks);
  } else {
    part = sent_part(scene, ranks, options, threads, loaded);
  }
  for (Finding& warning : read_all_but_mesh(scene, nullptr, options)) loaded.warnings.push_back(std::move(warning));
  scene.environment = EnvironmentScene{};
  scene.environment.mesh = std::move(part);
  loaded.scene = std::move(scene);
  return loaded;
}

}  // namespace dartcast
