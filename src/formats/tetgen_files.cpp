// Reads TetGen's files: points, then cells, then faces.
#include "formats/tetgen_files.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/read_memory.hpp"
#include "formats/second_order.hpp"

namespace dartcast {
namespace {

/// The first line of each file: the number of items, and up to three numbers that say what each has.
struct Head {
  std::size_t count = 0;
  std::array<std::size_t, 3> more{};
};

Head read_head(FileText& text, std::string_view items, std::size_t numbers) {
  text.set_comment('#');
  Head head;
  head.count = static_cast<std::size_t>(text.integer(fmt::format("the number of {}", items), 0, no_point - 1));
  for (std::size_t k = 0; k < numbers; ++k) {
    if (k > 0 && text.line_ends()) break;  // attributes and markers may be left out
    head.more[k] = static_cast<std::size_t>(text.integer("a number of the first line", 0, 1000));
  }
  text.check_count(items, head.count, 2 * (1 + head.more[0]));
  return head;
}

class TetgenReader {
 public:
  explicit TetgenReader(bool linearise) { parsed_.linearise = linearise; }

  void read_points(std::string_view content) {
    FileText text(content);
    const Head head = read_head(text, "points", 3);
    dimension_ = head.more[0];
    if (dimension_ != 2 && dimension_ != 3)
      text.fail(fmt::format("points of dimension {}: 2 or 3 is meant", dimension_));
    for (std::size_t i = 0; i < head.count; ++i) {
      const std::int64_t number = text.integer("the number of a point", 0, no_point);
      if (i == 0) first_ = number;
      if (first_ > 1 || number != first_ + static_cast<std::int64_t>(i))
        text.fail(fmt::format("point {}: they must be counted from 0 or 1 on", number));
      Vec3 p;
      p.x = text.number("a coordinate");
      p.y = text.number("a coordinate");
      if (dimension_ == 3) p.z = text.number("a coordinate");
      for (std::size_t k = 0; k < head.more[1] + head.more[2]; ++k) text.number("an attribute or a marker");
      parsed_.mesh.points.push_back(p);
    }
  }

  void read_cells(std::string_view content) {
    FileText text(content);
    const Head head = read_head(text, "cells", 2);
    const std::size_t corners = dimension_ + 1;
    const std::size_t nodes = head.more[0];
    if (nodes < corners) text.fail(fmt::format("cells of {} points: {} are needed", nodes, corners));
    for (std::size_t i = 0; i < head.count; ++i) {
      text.integer("the number of a cell", 0, no_point);
      std::array<std::uint32_t, 4> cell{};
      for (std::size_t k = 0; k < nodes; ++k) {
        const std::uint32_t p = corner(text);
        if (k < corners) cell[k] = p;
      }
      double attribute = 0.0;
      for (std::size_t k = 0; k < head.more[1]; ++k) attribute = text.number("an attribute");
      if (nodes > corners && !take_higher_order(parsed_, i)) continue;
      add(std::span(cell).first(corners), region(attribute));
    }
  }

  void read_faces(std::string_view content) {
    FileText text(content);
    const Head head = read_head(text, "faces", 1);
    for (std::size_t i = 0; i < head.count; ++i) {
      text.integer("the number of a face", 0, no_point);
      std::array<std::uint32_t, 3> face{};
      for (std::uint32_t& p : face) p = corner(text);
      const std::int64_t marker = head.more[0] > 0 ? text.integer("a marker", INT32_MIN, INT32_MAX) : 0;
      text.line();  // the cells on both sides may follow
      parsed_.mesh.add_patch_face(face, static_cast<std::int32_t>(marker));
    }
  }

  [[nodiscard]] bool has_cells() const { return !parsed_.mesh.types.empty(); }
  ParsedMesh take() { return std::move(parsed_); }

 private:
  std::uint32_t corner(FileText& text) const {
    const std::int64_t number = text.integer("a point's number", INT64_MIN, INT64_MAX);
    const bool known = number >= first_ && number - first_ < static_cast<std::int64_t>(no_point);
    return known ? static_cast<std::uint32_t>(number - first_) : no_point;
  }

  static std::int32_t region(double attribute) {
    const bool whole = std::abs(attribute) <= INT32_MAX && attribute == std::floor(attribute);
    return whole ? static_cast<std::int32_t>(attribute) : 0;
  }

  void add(std::span<const std::uint32_t> cell, std::int32_t region) {
    if (dimension_ == 2) return parsed_.mesh.add_patch_face(cell, region);  // the cells of a file without others
    parsed_.mesh.add_cell(CellType::tetrahedron, cell);
    parsed_.mesh.regions.push_back(region);
  }

  ParsedMesh parsed_;
  std::size_t dimension_ = 3;
  std::int64_t first_ = 0;
};

/// The other file, or none if it may be missing.
std::string beside(std::filesystem::path path, const char* ending, bool needed, const ReadOptions& options) {
  path.replace_extension(ending);
  if (!needed && file_bytes(path) == 0) return {};
  try {
    check_memory(memory_of_text(file_bytes(path)), options.max_memory);
    return read_bytes(path);
  } catch (const InvalidMesh& e) {
    throw InvalidMesh(fmt::format("{}: {}", path.filename().string(), e.what()));
  }
}

template <class Read>
void with_ending(const char* ending, Read&& read) {
  try {
    read();
  } catch (const InvalidMesh& e) {
    throw InvalidMesh(fmt::format("{}, {}", ending, e.what()));
  }
}

}  // namespace

ParsedMesh parse_tetgen(const std::filesystem::path& path, std::string_view content, const ReadOptions& options) {
  const bool named_points = path.extension().string().size() == 5;  // .node, or .ele
  const std::string other = beside(path, named_points ? ".ele" : ".node", true, options);
  TetgenReader reader(options.linearise);
  with_ending(".node", [&] { reader.read_points(named_points ? content : std::string_view(other)); });
  with_ending(".ele", [&] { reader.read_cells(named_points ? std::string_view(other) : content); });
  if (reader.has_cells()) {
    const std::string faces = beside(path, ".face", false, options);
    if (!faces.empty()) with_ending(".face", [&] { reader.read_faces(faces); });
  }
  ParsedMesh parsed = reader.take();
  parsed.format = "TetGen";
  if (parsed.mesh.types.empty() && parsed.mesh.patch_tags.empty() && parsed.second_order.count == 0)
    throw InvalidMesh(".ele: the file has no cells");
  finish(parsed);
  return parsed;
}

}  // namespace dartcast
