// Writes surfaces: .obj, .off, .ply, .stl as text, .vtp. Regions become the groups of .obj, the solids of .stl and the
// cell array `region` of .vtp.
#include "formats/surface_write.hpp"

#include <fmt/format.h>

#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "formats/file_write.hpp"
#include "formats/vtp_write.hpp"
#include "formats/xml_write.hpp"
#include "surface/ears.hpp"

namespace dartcast {
namespace {

/// The faces of each region, by its name; those of none come first.
std::vector<std::pair<std::string, std::vector<std::size_t>>> faces_by_region(const MeshData& surface) {
  std::map<std::int32_t, std::vector<std::size_t>> faces;
  for (std::size_t c = 0; c < surface.cell_count(); ++c)
    faces[surface.regions.empty() ? 0 : surface.regions[c]].push_back(c);
  std::vector<std::pair<std::string, std::vector<std::size_t>>> named;
  for (auto& [tag, of] : faces) {
    const auto name = surface.region_names.find(tag);
    named.emplace_back(name != surface.region_names.end() ? name->second
                       : tag == 0                         ? ""
                                                          : std::to_string(tag),
                       std::move(of));
  }
  return named;
}

template <class... Values>
void put(std::string& text, fmt::format_string<Values...> form, Values&&... values) {
  fmt::format_to(std::back_inserter(text), form, std::forward<Values>(values)...);
}

void put_points(std::string& text, const MeshData& surface, const char* before) {
  for (const Vec3& x : surface.points) put(text, "{}{} {} {}\n", before, x.x, x.y, x.z);
}

/// Faces as lines that begin with their number of corners.
void put_faces(std::string& text, const MeshData& surface) {
  for (std::size_t c = 0; c < surface.cell_count(); ++c) {
    put(text, "{}", surface.cell(c).size());
    for (const std::uint32_t p : surface.cell(c)) put(text, " {}", p);
    text += '\n';
  }
}

}  // namespace

std::string format_obj(const MeshData& surface) {
  std::string text;
  put_points(text, surface, "v ");
  for (const auto& [name, faces] : faces_by_region(surface)) {
    if (!name.empty()) put(text, "g {}\n", name);
    for (const std::size_t c : faces) {
      text += 'f';
      for (const std::uint32_t p : surface.cell(c)) put(text, " {}", p + std::uint64_t{1});
      text += '\n';
    }
  }
  return text;
}

std::string format_off(const MeshData& surface) {
  std::string text = fmt::format("OFF\n{} {} 0\n", surface.points.size(), surface.cell_count());
  put_points(text, surface, "");
  put_faces(text, surface);
  return text;
}

std::string format_ply(const MeshData& surface) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face "
      "{}\nproperty list uchar uint vertex_indices\nend_header\n",
      surface.points.size(), surface.cell_count());
  put_points(text, surface, "");
  put_faces(text, surface);
  return text;
}

std::string format_stl(const MeshData& surface) {
  std::string text;
  for (const auto& [name, faces] : faces_by_region(surface)) {
    put(text, "solid {}\n", name);
    for (const std::size_t c : faces) {
      for (const TriangleCorners& t : ears(surface.points, surface.cell(c))) {
        const Vec3 area = vector_area(surface.points, t);
        const Vec3 normal = area * (norm(area) > 0.0 ? 1.0 / norm(area) : 0.0);
        put(text, "facet normal {} {} {}\nouter loop\n", normal.x, normal.y, normal.z);
        for (const std::uint32_t p : t) {
          const Vec3& x = surface.points[p];
          put(text, "vertex {} {} {}\n", x.x, x.y, x.z);
        }
        text += "endloop\nendfacet\n";
      }
    }
    put(text, "endsolid {}\n", name);
  }
  return text;
}

void write_vtp_surface(const MeshData& surface, const std::filesystem::path& path) {
  VtpFile file(surface.points);
  file.add_polygons(surface.offsets, surface.connectivity);
  if (!surface.regions.empty()) file.add_for_cells("region", surface.regions);
  write_xml(path, file.data(), Compression::none, write_pieces);
}

}  // namespace dartcast
