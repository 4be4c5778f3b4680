// Writes Medit's .mesh as text.
#include <fmt/format.h>

#include <array>
#include <iterator>

#include "formats/medit.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

void append_element(std::string& out, std::span<const std::uint32_t> corners, std::int32_t tag) {
  for (const std::uint32_t v : corners) fmt::format_to(std::back_inserter(out), "{} ", std::uint64_t{v} + 1);
  fmt::format_to(std::back_inserter(out), "{}\n", tag);
}

void append_section(std::string& out, const char* name, std::size_t count, const std::string& lines) {
  if (count > 0) fmt::format_to(std::back_inserter(out), "{}\n{}\n{}", name, count, lines);
}

void append_faces(std::string& out, const MeshData& mesh, std::size_t corners, const char* name) {
  std::string lines;
  std::size_t count = 0;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t begin = mesh.patch_offsets[f];
    const std::size_t size = mesh.patch_offsets[f + 1] - begin;
    if (size != corners) continue;
    append_element(lines, {mesh.patch_faces.data() + begin, size}, mesh.patch_tags[f]);
    ++count;
  }
  append_section(out, name, count, lines);
}

/// Whether a cell belongs to the section of `type`: in the plane the number of its corners decides.
bool is_of(const MeshData& mesh, std::size_t c, CellType type) {
  if (mesh.types[c] != CellType::polygon) return mesh.types[c] == type;
  return dimension(type) == 2 && mesh.cell(c).size() == corner_count(type);
}

void append_cells(std::string& out, const MeshData& mesh, CellType type, const char* name) {
  std::string lines;
  std::size_t count = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (!is_of(mesh, c, type)) continue;
    append_element(lines, mesh.cell(c), mesh.regions.empty() ? 0 : mesh.regions[c]);
    ++count;
  }
  append_section(out, name, count, lines);
}

}  // namespace

std::string format_medit(const MeshData& mesh) {
  const bool plane = mesh.dimension() == 2;
  std::string out =
      fmt::format("MeshVersionFormatted 2\nDimension {}\nVertices\n{}\n", mesh.dimension(), mesh.points.size());
  for (const Vec3& p : mesh.points) {
    fmt::format_to(std::back_inserter(out), "{} {} ", p.x, p.y);
    if (!plane) fmt::format_to(std::back_inserter(out), "{} ", p.z);
    out += "0\n";
  }
  append_faces(out, mesh, 2, "Edges");
  append_faces(out, mesh, 3, "Triangles");
  append_faces(out, mesh, 4, "Quadrilaterals");
  append_cells(out, mesh, CellType::triangle, "Triangles");
  append_cells(out, mesh, CellType::quadrilateral, "Quadrilaterals");
  append_cells(out, mesh, CellType::tetrahedron, "Tetrahedra");
  append_cells(out, mesh, CellType::hexahedron, "Hexahedra");
  append_cells(out, mesh, CellType::prism, "Prisms");
  append_cells(out, mesh, CellType::pyramid, "Pyramids");
  return out + "End\n";
}

}  // namespace dartcast
