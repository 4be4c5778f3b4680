// Reads Medit's .mesh section by section.
#include "formats/medit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/medit_elements.hpp"

namespace dartcast {
namespace {

// Sections of third order or more are always refused.
constexpr std::array<std::string_view, 8> higher_order = {"TrianglesP3",      "TrianglesP4",  "QuadrilateralsQ3",
                                                          "QuadrilateralsQ4", "TetrahedraP3", "TetrahedraP4",
                                                          "HexahedraQ3",      "HexahedraQ4"};

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

void read_elements(FileText& text, ParsedMesh& parsed, const MeditSection& section) {
  const std::size_t n = text.count(section.name, 2 * (section.points + 1));
  std::array<std::uint32_t, 8> corners{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < section.points; ++k) {
      const std::int64_t number = text.integer("a vertex number", INT64_MIN, INT64_MAX);
      if (k < section.corners)
        corners[k] = number >= 1 && number <= no_point ? static_cast<std::uint32_t>(number - 1) : no_point;
    }
    const auto tag = static_cast<std::int32_t>(text.integer("a reference", INT32_MIN, INT32_MAX));
    add_medit_element(section, std::span(corners).first(section.corners), tag, i, parsed);
  }
}

/// Skips the numbers and quoted texts of a section that this library does not use.
void skip_numbers(FileText& text) {
  while (!text.at_end() && std::isalpha(static_cast<unsigned char>(text.peek()[0])) == 0) {
    if (text.peek()[0] != '"') {
      text.word("a number");
      continue;
    }
    text.skip_past("\"");
    text.skip_past("\"");
  }
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

ParsedMesh parse_medit(std::string_view content, bool linearise) {
  refuse_other_mesh(content);
  FileText text(content);
  text.set_comment('#');
  ParsedMesh parsed;
  parsed.format = "Medit ASCII";
  parsed.linearise = linearise;
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
    } else if (const auto* k = std::find_if(medit_sections.begin(), medit_sections.end(),
                                            [&](const MeditSection& x) { return x.name == name; });
               k != medit_sections.end()) {
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
