// Generates the mesh of a scene, selects its free cells and patches, and cuts a rank's part out.
#include "simulation/scene_environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <variant>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_selection.hpp"
#include "mesh/mesh_scale.hpp"
#include "mesh/patch_walls.hpp"
#include "mesh/periodic_pairs.hpp"
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

void refuse_if(bool has, std::string_view what) {
  if (has)
    throw InvalidArgument(fmt::format(
        "partition: a scene with {} cannot be spread by cells: leave --partition cells out, and the ranks share "
        "its particles",
        what));
}

}  // namespace

MeshData generated_mesh(const MeshSource& source) { return std::visit(Generator{}, source); }

void select_cells_and_patches(MeshData& mesh, const EnvironmentScene& scene) {
  if (const auto* by_region = std::get_if<FreeRegions>(&scene.free)) select_free_regions(mesh, by_region->regions);
  if (const auto* by_value = std::get_if<FreeValues>(&scene.free)) select_free_by_value(mesh, *by_value);
  select_walls(mesh, scene.walls);
  if (const auto* names = std::get_if<std::vector<std::string>>(&scene.patches)) select_patches(mesh, *names);
  if (const auto* angle = std::get_if<PatchAngle>(&scene.patches)) divide_walls(mesh, angle->degrees);
  for (const PeriodicPair& pair : scene.periodic) end_pairs(mesh, std::array{pair.a, pair.b});
  mesh.periodic.insert(mesh.periodic.end(), scene.periodic.begin(), scene.periodic.end());
}

void check_patches(const Scene& scene, const MeshData& mesh) {
  if (!scene.events.empty()) return;
  std::vector<std::string> named;
  if (const auto* names = std::get_if<std::vector<std::string>>(&scene.environment.patches)) named = *names;
  for (const PeriodicPair& pair : scene.environment.periodic) named.insert(named.end(), {pair.a, pair.b});
  for (const auto& entry : scene.contact.by_patch) named.push_back(entry.first);
  for (const ParticlesScene& p : scene.particles) {
    const auto* inlet = std::get_if<InletParticles>(&p.source);
    if (inlet != nullptr && !inlet->patch.empty()) named.push_back(inlet->patch);
  }
  expect_walls(mesh, named);
}

MeshData scene_mesh(const EnvironmentScene& scene) {
  if (scene.skip_bad_cells || std::holds_alternative<PatchArray>(scene.patches))
    throw InvalidArgument("the scene's mesh is not ready for use; call load_scene_files() first");
  MeshData mesh = generated_mesh(scene.mesh);
  if (scene.scale != 1.0) scale_mesh(mesh, scene.scale);
  const MeshReport report = check_and_repair(mesh);
  if (!report.valid()) throw InvalidMesh("the scene's mesh: " + report.defects.front().message);
  select_cells_and_patches(mesh, scene);
  return mesh;
}

void check_can_be_spread(const Scene& scene) {
  refuse_if(!scene.environment.periodic.empty(), "periodic pairs");
  refuse_if(scene.collisions.has_value(), "spheres that collide");
  refuse_if(!scene.bodies.empty(), "bodies");
  refuse_if(!scene.catheters.empty(), "catheters");
  refuse_if(!scene.solids.empty(), "solids");
  refuse_if(!scene.events.empty() || scene.remesh.every > 0 || scene.adaptive_subdivision.every > 0, "edits");
  refuse_if(scene.statistics.options.any(), "statistics");
  refuse_if(scene.motion.substeps > 1, "substeps");
  refuse_if(scene.motion.integrator != Integrator::euler, "the integrator rk4");
  refuse_if(scene.motion.brownian_bridge, "a Brownian bridge");
  refuse_if(scene.motion.wall_motion != WallMotion::carried, "points that move at the same time as the walls");
  for (const ParticlesScene& p : scene.particles) {
    refuse_if(p.radius > 0.0 || p.interception, "spheres");
    const auto* placed = std::get_if<PlacedParticles>(&p.source);
    const auto* seeds = placed != nullptr ? std::get_if<ParticleSeeds>(&placed->positions) : nullptr;
    for (std::size_t i = 0; seeds != nullptr && i < seeds->radii.size(); ++i)
      refuse_if(seeds->radii[i] > 0.0, "spheres");
  }
}

MeshPart scene_part(const EnvironmentScene& scene, const Ranks& ranks) {
  if (const auto* part = std::get_if<MeshPart>(&scene.mesh)) {
    if (part->parts != ranks.size() || part->part != ranks.rank())
      throw InvalidArgument(fmt::format("the scene's mesh is part {} of {}, and this is rank {} of {}", part->part,
                                        part->parts, ranks.rank(), ranks.size()));
    return *part;
  }
  MeshData whole = std::holds_alternative<MeshData>(scene.mesh) ? std::get<MeshData>(scene.mesh) : scene_mesh(scene);
  check_and_repair(whole);  // a part of it must not be repaired in another way
  return mesh_part(whole, partition(whole, ranks.size()), ranks.size(), ranks.rank());
}

}  // namespace dartcast
