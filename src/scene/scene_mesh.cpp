// Reads the files that a scene names.
#include "scene/scene_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/checked_file.hpp"
#include "formats/skip_in_file.hpp"
#include "scene/scene_fields.hpp"
#include "scene/seed_file.hpp"
#include "simulation/scene_environment.hpp"
#include "simulation/with_name.hpp"

namespace dartcast {

namespace {

MeshFile load_source(const MeshSource& source, const ReadOptions& options) {
  if (const auto* path = std::get_if<std::filesystem::path>(&source)) return read_mesh(*path, options);
  MeshFile file{generated_mesh(source), {}};
  file.report = check_and_repair(file.mesh);
  file.report.file = "the generated mesh";
  file.report.format = "generated";
  return file;
}

// Points are rounded: what was positive may be flat then.
void scale_points(MeshFile& file, double scale) {
  if (scale == 1.0 || file.mesh.types.empty()) return;
  for (Vec3& x : file.mesh.points) x *= scale;
  if (file.report.valid()) file.report.defects = check_and_repair(file.mesh).defects;
}

// Keeps the cells of a frame that `mesh` has, by their places in the input file.
void keep_cells_of(const MeshData& mesh, MeshData& frame) {
  const std::set<std::uint32_t> wanted(mesh.source.begin(), mesh.source.end());
  MeshData kept;
  for (std::size_t c = 0; c < frame.cell_count(); ++c) {
    const auto source = frame.source.empty() ? static_cast<std::uint32_t>(c) : frame.source[c];
    if (wanted.count(source) > 0) kept.add_cell(frame.types[c], frame.cell(c));
  }
  kept.points = std::move(frame.points);
  frame = std::move(kept);
  check_and_repair(frame);  // drops the points of the other cells
}

std::vector<Vec3> frame_positions(const std::filesystem::path& file, const MeshData& mesh,
                                  const EnvironmentScene& environment, const ReadOptions& options) {
  MeshFile read = read_mesh(file, options);
  if (environment.skip_bad_cells && !read.mesh.types.empty()) {
    keep_cells_of(mesh, read.mesh);
  } else {
    read = valid_file(std::move(read));
  }
  std::vector<Vec3> points = std::move(read.mesh.points);
  if (points.size() != mesh.points.size()) {
    throw InvalidMesh(fmt::format("{}: {} points; the scene's mesh has {}: frames must have the same points",
                                  file.string(), points.size(), mesh.points.size()));
  }
  for (Vec3& x : points) x *= environment.scale;
  return points;
}

}  // namespace

SceneMesh load_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options, Threads threads) {
  ReadOptions read = options;
  if (const auto* patches = std::get_if<PatchArray>(&scene.patches)) read.patch_array = patches->name;
  MeshFile file = load_source(scene.mesh, read);
  scale_points(file, scene.scale);
  if (scene.skip_bad_cells) skip_bad_cells(file, threads);
  file = valid_file(std::move(file));
  SceneMesh result{std::move(file.mesh), std::move(file.report), {}};
  const std::vector<Finding>& warnings = result.report.warnings;
  if (!warnings.empty() && warnings.front().kind == "bad_cells") result.skipped = warnings.front();
  with_mesh_name(scene.mesh, [&] { select_cells_and_patches(result.mesh, scene); });
  return result;
}

LoadedScene load_scene_files(Scene scene, const ReadOptions& options, Threads threads) {
  SceneMesh loaded = load_scene_mesh(scene.environment, options, threads);
  for (DeformationScene& s : scene.deformation) {
    for (const auto& file : s.frames)
      s.step.frames.push_back(frame_positions(file, loaded.mesh, scene.environment, options));
    s.frames.clear();
  }
  for (FieldScene* field : {&scene.motion.field, &scene.motion.force})
    load_field(*field, scene.environment, loaded.mesh, options);
  for (ParticlesScene& p : scene.particles) {
    auto* placed = std::get_if<PlacedParticles>(&p.source);
    if (placed == nullptr) continue;
    if (const auto* file = std::get_if<std::filesystem::path>(&placed->positions))
      placed->positions = read_seeds(*file, options);
  }
  for (BodyScene& body : scene.bodies) {
    if (const auto* file = std::get_if<std::filesystem::path>(&body.surface))
      body.surface = with_name("body", body.name, [&] { return read_surface(*file, options).mesh; });
  }
  scene.environment = EnvironmentScene{};
  scene.environment.mesh = std::move(loaded.mesh);
  return {std::move(scene), std::move(loaded.skipped)};
}

}  // namespace dartcast
