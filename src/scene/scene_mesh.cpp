// Reads the files that a scene names; then looks up in the mesh what the scene names there.
#include "scene/scene_mesh.hpp"

#include <fmt/format.h>

#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/checked_file.hpp"
#include "formats/file_series.hpp"
#include "formats/scene_files.hpp"
#include "formats/skip_in_file.hpp"
#include "mesh/mesh_scale.hpp"
#include "mesh/patch_walls.hpp"
#include "scene/kept_mesh.hpp"
#include "simulation/scene_environment.hpp"
#include "simulation/with_name.hpp"

namespace dartcast {

namespace {

MeshFile load_source(const MeshSource& source, const ReadOptions& options) {
  if (const auto* path = std::get_if<std::filesystem::path>(&source)) return read_mesh(*path, options);
  if (const auto* surfaces = std::get_if<SurfaceScene>(&source)) return kept_surface_mesh(*surfaces, options);
  MeshFile file{generated_mesh(source), {}};
  file.report = check_and_repair(file.mesh);
  file.report.file = mesh_name(source);
  file.report.format = "generated";
  return file;
}

// Points are rounded: what was positive may be flat then.
void scale_points(MeshFile& file, double scale) {
  if (scale == 1.0 || file.mesh.types.empty()) return;
  scale_mesh(file.mesh, scale);
  if (file.report.valid()) file.report.defects = check_and_repair(file.mesh).defects;
}

}  // namespace

std::string mesh_name(const MeshSource& mesh) {
  if (const auto* path = std::get_if<std::filesystem::path>(&mesh)) return path->string();
  if (const auto* surfaces = std::get_if<SurfaceScene>(&mesh)) return surfaces->surfaces.front().file.string();
  const auto* box = std::get_if<BoxOptions>(&mesh);
  if (box == nullptr || box->jitter <= surely_valid_jitter) return "the generated mesh";
  return fmt::format("the generated mesh, whose jitter of {:.4g} may turn cells over (up to {:.2f} none does)",
                     box->jitter, surely_valid_jitter);
}

ReadOptions options_for_fields(const Scene& scene, ReadOptions options) {
  for (const FieldScene* field : {&scene.motion.field, &scene.motion.force}) {
    if (!field->array.empty() && field->files.empty() && field->at != FieldPlace::cells)
      options.point_fields.push_back(field->array);
  }
  if (scene.motion.field.files.empty() && scene.motion.field.at != FieldPlace::cells)
    options.point_fields.insert(options.point_fields.end(), scene.motion.sample.begin(), scene.motion.sample.end());
  return options;
}

SceneMesh read_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options, Threads threads) {
  ReadOptions read = options;
  read.linearise = scene.linearise;
  if (const auto* patches = std::get_if<PatchArray>(&scene.patches)) read.patch_array = patches->name;
  MeshFile file = load_source(scene.mesh, read);
  scale_points(file, scene.scale);
  if (scene.skip_bad_cells) skip_bad_cells(file, threads);
  file = valid_file(std::move(file));
  SceneMesh result{std::move(file.mesh), std::move(file.report), {}, {}};
  for (const Finding& warning : result.report.warnings) {
    if (warning.kind == "bad_cells") result.skipped = warning;
    if (warning.kind == "cyclic") result.warnings.push_back(warning);
  }
  for (const Finding& repair : result.report.repairs) {
    if (repair.kind == "crossings") result.warnings.push_back(repair);
  }
  return result;
}

void resolve_mesh(SceneMesh& read, const Scene& scene) {
  with_mesh_name(scene.environment.mesh, [&] {
    select_cells_and_patches(read.mesh, scene.environment);
    check_patches(scene, read.mesh);
  });
  add_finding(read.warnings, inner_patch_faces(read.mesh));
}

SceneMesh load_scene_mesh(const EnvironmentScene& scene, const ReadOptions& options) {
  SceneMesh read = read_scene_mesh(scene, options);
  with_mesh_name(scene.mesh, [&] { select_cells_and_patches(read.mesh, scene); });
  add_finding(read.warnings, inner_patch_faces(read.mesh));
  return read;
}

std::vector<Finding> read_all_but_mesh(Scene& scene, const MeshData* mesh, const ReadOptions& options) {
  std::vector<Finding> warnings;
  ReadOptions read = options;
  read.linearise = scene.environment.linearise;
  read.on_stage = {};  // most files are read later, by other threads
  const CellsOfScene cells = mesh != nullptr && scene.environment.skip_bad_cells ? CellsOfScene(*mesh) : CellsOfScene();
  for (DeformationScene& s : scene.deformation) {
    if (s.frames.empty()) continue;
    if (!s.displacement.empty()) {
      if (mesh == nullptr)
        throw InvalidArgument(
            "deformation: a displacement needs the whole mesh: ranks that have parts of it cannot read it");
      s.step.reader = displaced_frames(s, *mesh, cells, scene.environment.scale, read);
      continue;
    }
    FieldSeries series = file_series({"deformation", {}, std::exchange(s.frames, {}), s.step.times, s.spacing});
    s.step.times = std::move(series.times);
    s.step.reader = frame_reader(std::move(series.files), mesh, cells, scene.environment.scale, read, warnings);
  }
  MotionScene& motion = scene.motion;
  const bool in_files = !motion.field.files.empty();
  read_field_files(motion.field, mesh, cells, read, motion.sample, motion.sampled);
  read_field_files(motion.force, mesh, cells, read, {}, motion.sampled);
  if (in_files) motion.sample.clear();
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
  for (SolidScene& solid : scene.solids) {
    if (const auto* file = std::get_if<std::filesystem::path>(&solid.shape))
      solid.shape = with_name("solid", solid.name, [&] { return read_surface(*file, options).mesh; });
  }
  return warnings;
}

LoadedScene load_scene_files(Scene scene, const ReadOptions& options, Threads threads) {
  SceneMesh read = read_scene_mesh(scene.environment, options_for_fields(scene, options), threads);
  for (Finding& warning : read_all_but_mesh(scene, &read.mesh, options)) read.warnings.push_back(std::move(warning));
  resolve_mesh(read, scene);
  scene.environment = EnvironmentScene{};
  scene.environment.mesh = std::move(read.mesh);
  return {std::move(scene), std::move(read.skipped), std::move(read.warnings)};
}

}  // namespace dartcast
