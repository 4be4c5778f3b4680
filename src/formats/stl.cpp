// Reads .stl, ASCII and binary, and joins equal corners.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/raw_number.hpp"
#include "formats/surface_formats.hpp"

namespace dartcast {
namespace {

constexpr std::size_t stl_head = 84;      // bytes: 80 of a comment, 4 of the number of triangles
constexpr std::size_t stl_triangle = 50;  // bytes: a normal and three corners of three floats, 2 bytes more

std::uint64_t announced_triangles(std::string_view content) {
  return raw_number<std::uint32_t>(content.substr(stl_head - 4, 4), std::endian::little);
}

/// Decided by the size, because the comment of a binary file may start with "solid", too; for another file by its zeros.
bool is_text_stl(std::string_view content) {
  if (content.size() >= stl_head && content.size() == stl_head + stl_triangle * announced_triangles(content))
    return false;
  const std::string_view body = from_first_word(without_byte_order_mark(content));
  return in_lower_case(body.substr(0, 5)) == "solid" &&
         content.substr(0, stl_head).find('\0') == std::string_view::npos;
}

/// All corners as points, three a triangle; equal ones are joined at the end.
void add_stl_triangle(ParsedSurface& surface, const std::array<Vec3, 3>& corners, const FileText& text, bool binary) {
  const auto first = static_cast<std::uint32_t>(surface.mesh.points.size());
  for (const Vec3& p : corners) surface.add_point({p.x + 0.0, p.y + 0.0, p.z + 0.0}, text, binary);  // -0 is 0
  surface.add_face(std::array{first, first + 1, first + 2}, text, binary);
}

void read_binary_stl(std::string_view content, ParsedSurface& surface) {
  surface.format = "STL binary";
  if (content.size() < stl_head) throw InvalidMesh("the file is too short for .stl, ASCII or binary; it is truncated");
  const std::uint64_t n = announced_triangles(content);
  const std::uint64_t bytes = stl_head + stl_triangle * n;
  if (n > 0 && content.size() > bytes && content.size() - bytes < stl_triangle) {
    surface.warn(fmt::format("{} bytes behind the last triangle are left out", content.size() - bytes));
  } else if (content.size() != bytes) {
    throw InvalidMesh(
        fmt::format("byte {}: {} triangles are announced, of {} bytes in all, but the file has {}; it is "
                    "truncated or damaged, or no .stl",
                    stl_head - 4, n, bytes, content.size()));
  }
  FileText text(content);
  text.move_to(stl_head);
  for (std::uint64_t i = 0; i < n; ++i) {
    const std::string_view triangle = text.raw(stl_triangle, "a triangle");
    const auto number = [&](std::size_t k) {
      return static_cast<double>(raw_number<float>(triangle.substr(4 * k, 4), std::endian::little));
    };
    const auto corner = [&](std::size_t k) { return Vec3{number(k), number(k + 1), number(k + 2)}; };
    add_stl_triangle(surface, {corner(3), corner(6), corner(9)}, text, true);
  }
}

void expect_stl(FileText& text, std::string_view wanted) {
  if (in_lower_case(text.word(fmt::format("'{}'", wanted))) != wanted)
    text.fail(fmt::format("'{}' should stand here", wanted));
}

/// As "endloop"; some programs write "end loop".
void expect_stl_end(FileText& text, std::string_view what, ParsedSurface& surface) {
  if (in_lower_case(text.peek()) != "end") return expect_stl(text, fmt::format("end{}", what));
  text.word("'end'");
  expect_stl(text, what);
  surface.warn(fmt::format("'end {0}' stands in place of 'end{0}'", what));
}

/// The end of a solid, to the end of its line. None if a facet follows.
bool take_stl_end(FileText& text, ParsedSurface& surface) {
  const std::string word = in_lower_case(text.peek());
  if (word == "end") {
    expect_stl_end(text, "solid", surface);
  } else if (!word.starts_with("endsolid")) {
    return false;
  } else if (word != "endsolid") {
    surface.warn("a name stands right behind 'endsolid'");
  }
  text.line();
  return true;
}

void read_stl_facet(FileText& text, ParsedSurface& surface) {
  expect_stl(text, "facet");
  expect_stl(text, "normal");
  for (int i = 0; i < 3; ++i) text.word("a normal's coordinate");
  expect_stl(text, "outer");
  expect_stl(text, "loop");
  std::array<Vec3, 3> corners;
  for (Vec3& p : corners) {
    expect_stl(text, "vertex");
    p.x = text.number("a coordinate");
    p.y = text.number("a coordinate");
    p.z = text.number("a coordinate");
  }
  add_stl_triangle(surface, corners, text, false);
  expect_stl_end(text, "loop", surface);
  expect_stl_end(text, "facet", surface);
}

void read_text_stl(std::string_view content, ParsedSurface& surface) {
  surface.format = "STL ASCII";
  FileText text(content);
  while (!text.at_end()) {
    expect_stl(text, "solid");
    surface.enter_region(text.line());
    while (!take_stl_end(text, surface)) read_stl_facet(text, surface);
  }
}

/// For each point the first one that is equal to it.
std::vector<std::uint32_t> first_equal_points(const std::vector<Vec3>& points) {
  const auto key = [&](std::uint32_t i) { return std::tie(points[i].x, points[i].y, points[i].z); };
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b) || (key(a) == key(b) && a < b); });
  std::vector<std::uint32_t> first(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  }
  return first;
}

void join_equal_corners(MeshData& mesh) {
  std::vector<std::uint32_t> number = first_equal_points(mesh.points);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < number.size(); ++i) {
    if (number[i] == i) {
      mesh.points[next] = mesh.points[i];
      number[i] = next++;
    } else {
      number[i] = number[number[i]];
    }
  }
  mesh.points.resize(next);
  for (std::uint32_t& corner : mesh.connectivity) corner = number[corner];
}

void leave_out_collapsed(ParsedSurface& surface) {
  Finding collapsed{"collapsed", 0, {}, "triangles with two equal corners; they have been left out"};
  MeshData& mesh = surface.mesh;
  MeshData kept;
  for (std::uint32_t t = 0; t < mesh.cell_count(); ++t) {
    const auto c = mesh.cell(t);
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) {
      collapsed.add(t);
      continue;
    }
    kept.add_cell(CellType::triangle, c);
    kept.regions.push_back(mesh.regions[t]);
    kept.source.push_back(t);
  }
  if (collapsed.count == 0) return;
  kept.points = std::move(mesh.points);
  mesh = std::move(kept);
  add_finding(surface.repairs, collapsed);
}

}  // namespace

ParsedSurface parse_stl(std::string_view content) {
  ParsedSurface surface;
  if (is_text_stl(content)) {
    read_text_stl(without_byte_order_mark(content), surface);
  } else {
    read_binary_stl(content, surface);
  }
  join_equal_corners(surface.mesh);
  leave_out_collapsed(surface);
  surface.finish();
  return surface;
}

}  // namespace dartcast
