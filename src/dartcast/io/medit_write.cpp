#include <fmt/format.h>

#include <array>
#include <iterator>

#include "dartcast/base/error.hpp"
#include "dartcast/io/medit.hpp"

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
    if (size > 4) throw InvalidArgument("Medit's format cannot hold faces of more than four corners; write .vtu");
    if (size != corners) continue;
    append_element(lines, {mesh.patch_faces.data() + begin, size}, mesh.patch_tags[f]);
    ++count;
  }
  append_section(out, name, count, lines);
}

void append_cells(std::string& out, const MeshData& mesh, CellType type, const char* name) {
  std::string lines;
  std::size_t count = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.types[c] == CellType::polyhedron)
      throw InvalidArgument("Medit's format cannot hold polyhedra; write .vtu");
    if (mesh.types[c] != type) continue;
    append_element(lines, mesh.cell(c), mesh.regions.empty() ? 0 : mesh.regions[c]);
    ++count;
  }
  append_section(out, name, count, lines);
}

}  // namespace

std::string format_medit(const MeshData& mesh) {
  std::string out = fmt::format("MeshVersionFormatted 2\nDimension 3\nVertices\n{}\n", mesh.points.size());
  for (const Vec3& p : mesh.points) fmt::format_to(std::back_inserter(out), "{} {} {} 0\n", p.x, p.y, p.z);
  append_faces(out, mesh, 3, "Triangles");
  append_faces(out, mesh, 4, "Quadrilaterals");
  append_cells(out, mesh, CellType::tetrahedron, "Tetrahedra");
  append_cells(out, mesh, CellType::hexahedron, "Hexahedra");
  append_cells(out, mesh, CellType::prism, "Prisms");
  append_cells(out, mesh, CellType::pyramid, "Pyramids");
  return out + "End\n";
}

}  // namespace dartcast
