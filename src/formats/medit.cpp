// Reads Medit's .mesh section by section.
#include "formats/medit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"

namespace dartcast {
namespace {

struct Keyword {
  std::string_view name;
  std::size_t corners;
  unsigned dimension;
  CellType type;  // of a cell of space
};

constexpr std::array<Keyword, 7> keywords = {{{"Tetrahedra", 4, 3, CellType::tetrahedron},
                                              {"Hexahedra", 8, 3, CellType::hexahedron},
                                              {"Prisms", 6, 3, CellType::prism},
                                              {"Pyramids", 5, 3, CellType::pyramid},
                                              {"Triangles", 3, 2, {}},
                                              {"Quadrilaterals", 4, 2, {}},
                                              {"Edges", 2, 1, {}}}};

constexpr std::array<std::string_view, 16> higher_order = {
    "TrianglesP2",  "TrianglesP3",  "TrianglesP4",  "QuadrilateralsQ2", "QuadrilateralsQ3", "QuadrilateralsQ4",
    "TetrahedraP2", "TetrahedraP3", "TetrahedraP4", "HexahedraQ2",      "HexahedraQ3",      "HexahedraQ4",
    "PrismsP2",     "PrismsP3",     "PyramidsP2",   "PyramidsP3"};

void read_vertices(FileText& text, MeshData& mesh, int dimension) {
  if (dimension == 0) text.fail("Vertices stand before Dimension");
  if (!mesh.points.empty()) text.fail("a second section of Vertices");
  const std::size_t n = text.count("vertices", 6);
  if (n >= no_point) text.fail("more than 2^32 - 2 vertices");
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 p;
    p.x = text.number("a coordinate");
    p.y = text.number("a coordinate");
    if (dimension == 3) p.z = text.number("a coordinate");
    text.number("a reference");
    mesh.points.push_back(p);
  }
}

void read_elements(FileText& text, ParsedMesh& parsed, const Keyword& keyword) {
  MeshData& mesh = parsed.mesh;
  const std::size_t n = text.count(keyword.name, 2 * (keyword.corners + 1));
  std::array<std::uint32_t, 8> corners{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < keyword.corners; ++k) {
      const std::int64_t number = text.integer("a vertex number", INT64_MIN, INT64_MAX);
      corners[k] = number >= 1 && number <= no_point ? static_cast<std::uint32_t>(number - 1) : no_point;
    }
    const auto tag = static_cast<std::int32_t>(text.integer("a reference", INT32_MIN, INT32_MAX));
    const std::span<const std::uint32_t> used(corners.data(), keyword.corners);
    if (keyword.dimension == 1) {
      parsed.add_edge(corners[0], corners[1], tag);
    } else if (keyword.dimension == 2) {
      mesh.add_patch_face(used, tag);
    } else {
      mesh.add_cell(keyword.type, used);
      mesh.regions.push_back(tag);
    }
  }
}

/// Skips the numbers of a section that this library does not use.
void skip_numbers(FileText& text) {
  while (!text.at_end() && std::isalpha(static_cast<unsigned char>(text.peek()[0])) == 0) text.word("a number");
}

/// Names the other formats that end in .mesh.
void refuse_other_mesh(std::string_view content) {
  const std::string_view text = from_first_word(content);
  if (text.starts_with("MFEM NC mesh")) {
    throw InvalidMesh(
        "this .mesh is of MFEM, non-conforming (MFEM NC mesh), which is not supported; make it conforming and write "
        "Gmsh's or VTK's format");
  }
  if (text.starts_with("MFEM ")) {
    throw InvalidMesh(fmt::format("this .mesh is of MFEM ({}), which is not supported; write Gmsh's or VTK's format",
                                  text.substr(0, std::min<std::size_t>(text.find_first_of("\r\n"), 40))));
  }
}

}  // namespace

ParsedMesh parse_medit(std::string_view content) {
  refuse_other_mesh(content);
  FileText text(content);
  text.set_comment('#');
  ParsedMesh parsed;
  parsed.format = "Medit ASCII";
  int dimension = 0;
  bool ended = false;
  if (text.word("'MeshVersionFormatted'") != "MeshVersionFormatted")
    text.fail("'MeshVersionFormatted' should stand here");
  text.integer("the version", 0, 4);
  while (!text.at_end() && !ended) {
    const std::string_view name = text.word("a keyword");
    if (std::isalpha(static_cast<unsigned char>(name[0])) == 0) {
      text.fail(
          fmt::format("'{}' stands where a keyword should; a section is longer than it announces", name.substr(0, 40)));
    }
    if (name == "Dimension") {
      dimension = static_cast<int>(text.integer("the dimension", 2, 3));
    } else if (name == "Vertices") {
      read_vertices(text, parsed.mesh, dimension);
    } else if (const auto* k =
                   std::find_if(keywords.begin(), keywords.end(), [&](const Keyword& x) { return x.name == name; });
               k != keywords.end()) {
      read_elements(text, parsed, *k);
    } else if (std::find(higher_order.begin(), higher_order.end(), name) != higher_order.end()) {
      const std::size_t n = text.count(name, 8);
      for (std::size_t i = 0; i < n; ++i) parsed.second_order.add(i);
      skip_numbers(text);
    } else {
      ended = name == "End";
      skip_numbers(text);
    }
  }
  if (parsed.mesh.types.empty() && parsed.mesh.patch_tags.empty() && parsed.second_order.count == 0) {
    throw InvalidMesh("the file has no cells; it is truncated, or has points and edges only");
  }
  finish(parsed);
  return parsed;
}

}  // namespace dartcast
