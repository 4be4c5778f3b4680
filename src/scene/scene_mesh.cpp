#include "scene/scene_mesh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/mesh_selection.hpp"
#include "formats/checked_file.hpp"
#include "formats/skip_in_file.hpp"

namespace dartcast {

namespace {

MeshData generated(const MeshSource& source) {
  if (const auto* octahedra = std::get_if<OctahedraOptions>(&source)) return generate_octahedra(*octahedra);
  if (const auto* vessel = std::get_if<VesselOptions>(&source)) return generate_vessel(*vessel);
  if (const auto* rectangle = std::get_if<RectangleOptions>(&source)) return generate_rectangle(*rectangle);
  if (const auto* maze = std::get_if<MazeOptions>(&source)) return generate_maze(*maze);
  return generate_box(std::get<BoxOptions>(source));
}

MeshFile load_source(const MeshSource& source, const ReadOptions& options) {
  if (const auto* path = std::get_if<std::filesystem::path>(&source)) return read_mesh(*path, options);
  MeshFile file{generated(source), {}};
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

void select_free(MeshData& mesh, const EnvironmentScene& scene) {
  if (const auto* by_region = std::get_if<FreeRegions>(&scene.free)) select_free_regions(mesh, by_region->regions);
  const auto* by_value = std::get_if<FreeValues>(&scene.free);
  if (by_value == nullptr) return;
  const bool has_array = std::any_of(mesh.cell_data.begin(), mesh.cell_data.end(),
                                     [&](const DataArray& a) { return a.name == by_value->array; });
  if (by_value->array != "region" || has_array) {
    select_free_values(mesh, by_value->array, by_value->values);
    return;
  }
  std::vector<std::string> tags;  // formats without arrays have their groups as regions
  for (const double value : by_value->values) tags.push_back(fmt::format("{}", value));
  select_free_regions(mesh, tags);
}

const DataArray& point_array(const MeshData& mesh, const std::string& name, std::size_t components) {
  std::vector<std::string> known;
  for (const DataArray& a : mesh.point_data) {
    if (a.name == name && a.components == components) return a;
    known.push_back(fmt::format("{} ({})", a.name, a.components));
  }
  throw InvalidMesh(
      fmt::format("the mesh has no point array '{}' of {} components; its point arrays (components) are: {}", name,
                  components, known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
}

// Of the cells that `mesh` has, by their places in the input file.
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
  with_mesh_name(scene.mesh, [&] {
    select_free(result.mesh, scene);
    if (const auto* names = std::get_if<std::vector<std::string>>(&scene.patches)) select_patches(result.mesh, *names);
    if (const auto* angle = std::get_if<PatchAngle>(&scene.patches)) divide_walls(result.mesh, angle->degrees);
  });
  return result;
}

std::vector<Vec3> point_vectors(const MeshData& mesh, const std::string& array) {
  const DataArray& data = point_array(mesh, array, 3);
  std::vector<Vec3> result(mesh.points.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = {data.values[3 * i], data.values[3 * i + 1], data.values[3 * i + 2]};
  }
  return result;
}

std::vector<DeformationStep> load_deformation(std::span<const DeformationScene> scene, const MeshData& mesh,
                                              const EnvironmentScene& environment, const ReadOptions& options) {
  std::vector<DeformationStep> steps;
  for (const DeformationScene& s : scene) {
    DeformationStep& step = steps.emplace_back(s.step);
    if (!s.field.empty()) step.field = point_vectors(mesh, s.field);
    if (!s.path.empty()) step.path = point_array(mesh, s.path, 1).values;
    for (const auto& file : s.frames) step.frames.push_back(frame_positions(file, mesh, environment, options));
  }
  return steps;
}

}  // namespace dartcast
