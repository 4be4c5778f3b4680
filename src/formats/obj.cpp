// Reads Wavefront's .obj line by line.
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <system_error>
#include <vector>

#include "formats/file_text.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/surface_formats.hpp"

namespace dartcast {
namespace {

/// Whether a word comes before the line's end; a line that ends in a backslash continues in the next one.
bool statement_goes_on(FileText& text) {
  while (!text.line_ends()) {
    if (text.peek() != "\\") return text.peek().front() != '#';
    text.word("a backslash");
    if (text.line_ends()) text.line();
  }
  return false;
}

double obj_coordinate(FileText& text) {
  if (!statement_goes_on(text)) text.fail("the line ends where a coordinate should stand");
  return text.number("a coordinate");
}

void read_obj_vertex(FileText& text, ParsedSurface& surface) {
  Vec3 p;
  p.x = obj_coordinate(text);
  p.y = obj_coordinate(text);
  p.z = obj_coordinate(text);
  surface.add_point(p, text);
}

std::uint32_t read_obj_corner(FileText& text, std::size_t points) {
  std::string_view word = text.word("a corner");
  word = word.substr(0, word.find('/'));
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size())
    text.fail("a corner should be written as v, v/vt, v/vt/vn or v//vn, in whole numbers");
  if (number == 0) text.fail("a corner is 0, but vertices count from 1, or from -1 backwards");
  if (number > 0) return number <= no_point ? static_cast<std::uint32_t>(number - 1) : no_point;
  if (number < -static_cast<std::int64_t>(points))
    text.fail(fmt::format("corner {} of a face, but only {} vertices stand before it", number, points));
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(points) + number);
}

void read_obj_face(FileText& text, ParsedSurface& surface, std::vector<std::uint32_t>& corners) {
  corners.clear();
  while (statement_goes_on(text)) corners.push_back(read_obj_corner(text, surface.mesh.points.size()));
  surface.add_face(corners, text);
}

}  // namespace

ParsedSurface parse_obj(std::string_view content) {
  FileText text(content);
  ParsedSurface surface;
  surface.format = "Wavefront OBJ";
  std::vector<std::uint32_t> corners;
  while (!text.at_end()) {
    const std::string_view keyword = text.peek();
    if (keyword == "v" || keyword == "f" || keyword == "g" || keyword == "o") text.word("a keyword");
    if (keyword == "v") {
      read_obj_vertex(text, surface);
    } else if (keyword == "f") {
      read_obj_face(text, surface, corners);
    } else if (keyword == "g" || keyword == "o") {
      surface.enter_region(text.line());
      continue;
    }
    text.line();
  }
  surface.finish();
  return surface;
}

}  // namespace dartcast
