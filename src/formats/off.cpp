// Reads Geomview's .off.
#include <cstdint>
#include <vector>

#include "formats/file_text.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/surface_formats.hpp"
#include "mesh/polyhedron.hpp"

namespace dartcast {
namespace {

void read_off_header(FileText& text, ParsedSurface& surface) {
  std::string_view word = text.peek();
  if (const std::size_t end = word.find("OFF") + 3;
      end > 2 && end < word.size() && word[end] >= '0' && word[end] <= '9') {
    word = word.substr(0, end);
    surface.warn("a number stands right behind 'OFF'");
  }
  if (!word.ends_with("OFF")) return;
  text.move_to(text.position() + word.size());
  const auto drop = [&](std::string_view prefix) {
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  };
  drop("ST");
  drop("C");
  drop("N");
  if (word != "OFF") text.fail("only OFF with vertices of three coordinates is supported: no 4OFF, no nOFF");
  if (text.peek() == "BINARY") text.fail("binary OFF is not supported; write it in ASCII, or as .ply");
}

/// Throws if the line has ended: the number is missing, and the next line's must not take its place.
void expect_off_number(const FileText& text) {
  if (text.line_ends()) text.fail("the line ends too early: a vertex or face has all of its numbers on one line");
}

void read_off_point(FileText& text, ParsedSurface& surface) {
  Vec3 p;
  p.x = text.number("a coordinate");
  expect_off_number(text);
  p.y = text.number("a coordinate");
  expect_off_number(text);
  p.z = text.number("a coordinate");
  surface.add_point(p, text);
  text.line();
}

void read_off_face(FileText& text, ParsedSurface& surface, std::vector<std::uint32_t>& corners) {
  const std::int64_t n = text.integer("a number of corners", 0, polyhedron_limit);
  corners.clear();
  for (std::int64_t k = 0; k < n; ++k) {
    expect_off_number(text);
    const std::int64_t id = text.integer("a corner", INT64_MIN, INT64_MAX);
    corners.push_back(id >= 0 && id < no_point ? static_cast<std::uint32_t>(id) : no_point);
  }
  surface.add_face(corners, text);
  text.line();
}

}  // namespace

ParsedSurface parse_off(std::string_view content) {
  FileText text(content);
  text.set_comment('#');
  ParsedSurface surface;
  surface.format = "OFF ASCII";
  read_off_header(text, surface);
  const std::size_t points = text.count("vertices", 6);
  const std::size_t faces = text.count("faces", 6);
  text.line();
  for (std::size_t i = 0; i < points; ++i) read_off_point(text, surface);
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < faces; ++i) read_off_face(text, surface, corners);
  if (!text.at_end()) text.fail("the file goes on behind its last face: it has more than it announces");
  surface.finish();
  return surface;
}

}  // namespace dartcast
