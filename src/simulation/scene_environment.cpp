// Generates the mesh of a scene, and selects its free cells and patches.
#include "simulation/scene_environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_selection.hpp"
#include "mesh/patch_walls.hpp"
#include "parts/part_of_rank.hpp"

namespace dartcast {

namespace {

struct Generator {
  MeshData operator()(const std::filesystem::path& file) const {
    throw InvalidArgument(fmt::format("{}: the mesh has not been read; call load_scene_files() first", file.string()));
  }
  MeshData operator()(const BoxOptions& o) const { return generate_box(o); }
  MeshData operator()(const OctahedraOptions& o) const { return generate_octahedra(o); }
  MeshData operator()(const VesselOptions& o) const { return generate_vessel(o); }
  MeshData operator()(const RectangleOptions& o) const { return generate_rectangle(o); }
  MeshData operator()(const MazeOptions& o) const { return generate_maze(o); }
  MeshData operator()(const SurfaceScene& /*surfaces*/) const {
    throw InvalidArgument("no mesh has been made around the surfaces; call load_scene_files() first");
  }
  MeshData operator()(const MeshData& mesh) const { return mesh; }
  MeshData operator()(const MeshPart& part) const {
    if (part.parts == 1) return whole_mesh(part);
    throw InvalidArgument(
        fmt::format("the scene's mesh is part {} of {}: so many ranks share it by cells", part.part, part.parts));
  }
};

void select_free_by_value(MeshData& mesh, const FreeValues& by_value) {
  const bool has_array = std::any_of(mesh.cell_data.begin(), mesh.cell_data.end(),
                                     [&](const DataArray& a) { return a.name == by_value.array; });
  if (by_value.array != "region" || has_array) {
    select_free_values(mesh, by_value.array, by_value.values);
    return;
  }
  std::vector<std::string> tags;  // formats without arrays have their groups as regions
  for (const double value : by_value.values) tags.push_back(fmt::format("{}", value));
  select_free_regions(mesh, tags);
}

}  // namespace

MeshData generated_mesh(const MeshSource& source) { return std::visit(Generator{}, source); }

void select_cells_and_patches(MeshData& mesh, const EnvironmentScene& scene) {
  if (const auto* by_region = std::get_if<FreeRegions>(&scene.free)) select_free_regions(mesh, by_region->regions);
  if (const auto* by_value = std::get_if<FreeValues>(&scene.free)) select_free_by_value(mesh, *by_value);
  if (const auto* names = std::get_if<std::vector<std::string>>(&scene.patches)) select_patches(mesh, *names);
  if (const auto* angle = std::get_if<PatchAngle>(&scene.patches)) divide_walls(mesh, angle->degrees);
}

void check_patches(const Scene& scene, const MeshData& mesh) {
  if (!scene.events.empty()) return;
  std::vector<std::string> named;
  if (const auto* names = std::get_if<std::vector<std::string>>(&scene.environment.patches)) named = *names;
  for (const auto& entry : scene.contact.by_patch) named.push_back(entry.first);
  for (const ParticlesScene& p : scene.particles) {
    if (const auto* inlet = std::get_if<InletParticles>(&p.source)) named.push_back(inlet->patch);
  }
  expect_walls(mesh, named);
}

MeshData scene_mesh(const EnvironmentScene& scene) {
  if (scene.skip_bad_cells || std::holds_alternative<PatchArray>(scene.patches))
    throw InvalidArgument("the scene's mesh is not ready for use; call load_scene_files() first");
  MeshData mesh = generated_mesh(scene.mesh);
  if (scene.scale != 1.0) {
    for (Vec3& x : mesh.points) x *= scene.scale;
  }
  const MeshReport report = check_and_repair(mesh);
  if (!report.valid()) throw InvalidMesh("the scene's mesh: " + report.defects.front().message);
  select_cells_and_patches(mesh, scene);
  return mesh;
}

}  // namespace dartcast
