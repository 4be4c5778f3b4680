// Makes surfaces and patches of the faces in .vtp files.
#include "formats/vtp_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/format_table.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const fs::path& folder, std::string_view ending) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().ends_with(ending)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The .vtu file of the mesh; none if there is no such file, or several.
fs::path mesh_file(const fs::path& folder) {
  for (const char* ending : {".mesh.vtu", ".vtu"}) {
    const std::vector<fs::path> found = files_in(folder, ending);
    if (found.size() == 1) return found.front();
  }
  return {};
}

/// The points of a mesh, by number or by place.
class MeshPoints {
 public:
  explicit MeshPoints(const MeshData& mesh) {
    Vec3 low, high;
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
      const Vec3& x = mesh.points[p];
      by_place_[key(x)] = p;
      low = p == 0 ? x : Vec3{std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
      high = p == 0 ? x : Vec3{std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
    rounding_ = 1e-4 * norm(high - low);
    points_ = mesh.points;
    const auto ids = std::find_if(mesh.point_data.begin(), mesh.point_data.end(),
                                  [](const DataArray& a) { return a.name == "GlobalNodeID" && a.components == 1; });
    if (ids == mesh.point_data.end()) return;
    for (std::uint32_t p = 0; p < ids->values.size(); ++p) by_id_[ids->values[p]] = p;
  }

  /// Places may be rounded if there are numbers. Throws InvalidMesh if the two name different points.
  [[nodiscard]] std::uint32_t find(const VtpFaces& faces, std::uint32_t point) const {
    if (point >= faces.points.size()) return no_point;
    const Vec3& x = faces.points[point];
    const auto place = by_place_.find(key(x));
    const std::uint32_t here = place == by_place_.end() ? no_point : place->second;
    if (by_id_.empty() || faces.ids.empty()) return here;
    const auto found = by_id_.find(faces.ids[point]);
    if (found == by_id_.end()) return no_point;
    if (!(norm(points_[found->second] - x) <= rounding_) || (here != no_point && points_[found->second] != x))
      throw InvalidMesh(
          fmt::format("point {} has the GlobalNodeID {}, but lies at ({}, {}, {}), where the mesh has another point: "
                      "write the surfaces again, or leave GlobalNodeID out",
                      point, faces.ids[point], x.x, x.y, x.z));
    return found->second;
  }

 private:
  using Key = std::tuple<double, double, double>;
  static Key key(const Vec3& p) { return {p.x, p.y, p.z}; }

  std::span<const Vec3> points_;
  double rounding_ = 0.0;
  std::map<Key, std::uint32_t> by_place_;
  std::map<double, std::uint32_t> by_id_;
};

using FilesOfFaces = std::map<std::vector<std::uint32_t>, std::string>;  // by sorted corners

void add_patch(const fs::path& file, const MeshPoints& points, std::uint64_t max_memory, FilesOfFaces& known,
               MeshData& mesh) {
  check_memory(memory_of_vtk({.file = file_bytes(file)}), max_memory);
  const VtpFaces faces = read_vtp_faces(read_bytes(file), max_memory);
  const auto tag = static_cast<std::int32_t>(mesh.patch_names.size() + 1);
  mesh.patch_names[tag] = file.stem().string();
  for (std::size_t f = 0; f < faces.faces.size(); ++f) {
    std::vector<std::uint32_t> corners = faces.faces[f];
    for (std::uint32_t& p : corners) {
      p = points.find(faces, p);
      if (p == no_point) throw InvalidMesh(fmt::format("face {} has a point that the mesh does not have", f));
    }
    std::vector<std::uint32_t> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    const auto [before, added] = known.try_emplace(std::move(sorted), file.filename().string());
    if (!added) throw InvalidMesh(fmt::format("face {} is in {}, too: a face has one patch", f, before->second));
    mesh.add_patch_face(corners, tag);
    mesh.patch_source.push_back(static_cast<std::uint32_t>(mesh.patch_tags.size() - 1));
  }
}

}  // namespace

ParsedSurface parse_vtp_surface(std::string_view content, std::uint64_t max_memory) {
  const VtpFaces faces = read_vtp_faces(content, max_memory);
  const FileText text(content);
  ParsedSurface surface;
  surface.format = "VTK XML (.vtp)";
  for (const Vec3& p : faces.points) surface.add_point(p, text, true);
  for (std::size_t f = 0; f < faces.faces.size(); ++f) {
    if (!faces.groups.empty()) surface.enter_region(faces.groups[f] == "0" ? "" : faces.groups[f]);
    surface.add_face(faces.faces[f], text, true);
  }
  surface.finish();
  return surface;
}

bool is_simvascular(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "mesh-surfaces", error) && !mesh_file(folder).empty();
}

ParsedMesh parse_simvascular(const fs::path& folder, const ReadOptions& options) {
  const fs::path file = mesh_file(folder);
  const auto named = [](const fs::path& path, auto&& read) {
    try {
      return read();
    } catch (const InvalidMesh& e) {
      throw InvalidMesh(fmt::format("{}: {}", path.filename().string(), e.what()));
    }
  };
  ParsedMesh parsed = named(file, [&] {
    check_memory(memory_of_vtk({.file = file_bytes(file)}), options.max_memory);
    return parse_vtu(file, read_bytes(file), options);
  });
  parsed.format = "SimVascular";
  MeshData& mesh = parsed.mesh;
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  mesh.patch_tags.clear();
  mesh.patch_source.clear();
  mesh.patch_names.clear();
  const MeshPoints points(mesh);
  FilesOfFaces known;
  for (const fs::path& surface : files_in(folder / "mesh-surfaces", ".vtp"))
    named(surface, [&] { add_patch(surface, points, options.max_memory, known, mesh); });
  return parsed;
}

}  // namespace dartcast
