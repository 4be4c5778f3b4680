// Keeps the mesh around a scene's surfaces. Its first line has a digest of all that it was made from.
#include "scene/kept_mesh.hpp"

#include <fmt/format.h>

#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/digest.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_selection.hpp"
#include "formats/file_text.hpp"
#include "formats/gmsh.hpp"

namespace dartcast {

namespace {

constexpr std::string_view end_of_comments = "$EndComments\n";

/// The first lines of the file. Gmsh skips them as comments. Repairs of the surfaces follow, a line each.
std::string mark_of(const SurfaceScene& scene) {
  std::string values = fmt::format("{} {:a} {:a} {} {:a} {:a} {} {}", scene.outside, scene.box, scene.size, scene.cap,
                                   scene.cap_tolerance, scene.angle, scene.repair, static_cast<int>(scene.mesher));
  for (const NamedSurface& s : scene.surfaces) values += fmt::format(" {} {}", s.region, file_digest(s.file));
  return fmt::format("$Comments\ndartcast surface mesh {:016x}\n", digest(values));
}

std::string lines_of(const std::vector<Finding>& repairs) {
  std::string lines;
  for (const Finding& r : repairs) lines += fmt::format("{} {} {}\n", r.kind, r.count, r.message);
  return lines;
}

std::vector<Finding> repairs_in(std::string_view text, std::size_t from) {
  std::vector<Finding> repairs;
  std::istringstream lines(std::string(text.substr(from, text.find(end_of_comments) - from)));
  Finding r;
  while (lines >> r.kind >> r.count && std::getline(lines >> std::ws, r.message)) repairs.push_back(r);
  return repairs;
}

// In the scene's regions particles are free, outside they are not.
MeshFile read_text(const SurfaceScene& scene, std::string_view text) {
  MeshFile file{parse_gmsh(text).mesh, {}};
  file.report = check_and_repair(file.mesh);
  file.report.file = scene.surfaces.front().file.string();
  file.report.format = "tetrahedra that were kept";
  const std::vector<std::string> outside = {scene.outside};
  select_free_regions(file.mesh, outside);
  for (std::uint8_t& free : file.mesh.free) free = free == 0 ? 1 : 0;
  return file;
}

// None if there is none, or it is of other surfaces, or damaged: then it is made again.
std::optional<MeshFile> read_kept(const SurfaceScene& scene, const std::filesystem::path& kept, std::string_view mark) {
  if (kept.empty() || file_bytes(kept) == 0) return std::nullopt;
  try {
    const std::string text = read_bytes(kept);
    if (!text.starts_with(mark)) return std::nullopt;
    MeshFile file = read_text(scene, text);
    file.report.repairs = repairs_in(text, mark.size());
    if (file.report.valid()) return file;
  } catch (const InvalidMesh&) {
  }
  return std::nullopt;
}

}  // namespace

MeshFile kept_surface_mesh(const SurfaceScene& scene, const ReadOptions& options) {
  const std::string mark = mark_of(scene);
  const std::filesystem::path& kept = options.kept_mesh;
  if (auto file = read_kept(scene, kept, mark)) return std::move(*file);
  MeshFile made = mesh_surfaces(scene, options);
  if (!made.report.valid()) return made;
  const std::string text =
      mark + lines_of(made.report.repairs) + std::string(end_of_comments) + format_gmsh_2(made.mesh);
  if (!kept.empty()) {
    if (kept.has_parent_path()) std::filesystem::create_directories(kept.parent_path());
    write_bytes(kept, text);
  }
  made.mesh = read_text(scene, text).mesh;
  return made;
}

}  // namespace dartcast
