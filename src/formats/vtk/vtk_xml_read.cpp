// Makes a data set of the arrays in one of VTK's XML files, piece by piece.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk/vtk_grid.hpp"
#include "formats/vtk/vtk_xml.hpp"
#include "formats/vtk/vtu_array.hpp"
#include "formats/vtu_write.hpp"

namespace dartcast {
namespace {

/// The sections of cells in VTK's order, with the type of their cells; none: they have an array of types.
constexpr std::array<std::pair<const char*, std::uint8_t>, 5> typed_sections = {{{"Cells", 0},
                                                                                 {"Verts", vtk_poly_vertex},
                                                                                 {"Lines", vtk_poly_line},
                                                                                 {"Polys", vtk_polygon},
                                                                                 {"Strips", vtk_triangle_strip}}};

/// Face streams, one after the other, and where that of each cell ends. A negative end: no polyhedron.
struct FaceStreams {
  std::vector<std::int64_t> numbers;
  std::vector<std::int64_t> ends;
};

void check_size(const VtuArray& array, std::uint64_t found, std::uint64_t items) {
  if (items > INT64_MAX / array.components || found != items * array.components) {
    fail_array(array, fmt::format("it has {} numbers, where {} x {} should stand; the file is truncated or damaged",
                                  found, items, array.components));
  }
}

void check_ascends(const VtuArray& array, const std::vector<std::int64_t>& ends) {
  if (!std::is_sorted(ends.begin(), ends.end()) || (!ends.empty() && ends.front() < 0))
    fail_array(array, "it must ascend");
}

/// Texts, each ended by a 0.
std::vector<std::string> texts_of(const VtuArray& array, const VtuEncoding& encoding) {
  const std::vector<std::int64_t> characters = decode_integers(array, encoding);
  if (!characters.empty() && characters.back() != 0) fail_array(array, "its last text does not end");
  std::vector<std::string> texts;
  std::string text;
  for (const std::int64_t c : characters) {
    if (c == 0) {
      texts.push_back(std::exchange(text, {}));
    } else {
      text += static_cast<char>(c);
    }
  }
  return texts;
}

VtkArray array_of(const VtuArray& array, const VtuEncoding& encoding, std::uint64_t items) {
  VtkArray out{array.name, static_cast<std::size_t>(array.components), array.type == "String", {}, {}};
  if (out.is_text) {
    out.texts = texts_of(array, encoding);
    if (array.components != 1 || out.texts.size() != items)
      fail_array(array, fmt::format("it has {} texts, where {} should stand", out.texts.size(), items));
  } else {
    out.values = decode_numbers(array, encoding);
    check_size(array, out.values.size(), items);
  }
  return out;
}

/// The arrays of one section of cells.
class CellArrays {
 public:
  CellArrays(const std::vector<VtuArray>& arrays, std::string_view section, std::uint64_t cells,
             const VtuEncoding& encoding)
      : arrays_(arrays), section_(section), cells_(cells), encoding_(encoding) {}

  [[nodiscard]] const VtuArray* find(std::string_view name) const {
    const auto found = std::find_if(arrays_.begin(), arrays_.end(), [&](const VtuArray& a) { return a.name == name; });
    return found == arrays_.end() ? nullptr : &*found;
  }
  [[nodiscard]] const VtuArray& array(std::string_view name) const {
    const VtuArray* found = find(name);
    if (found == nullptr) throw InvalidMesh(fmt::format("<{}> must have the array {}", section_, name));
    if (found->components != 1) fail_array(*found, "it must have one component");
    return *found;
  }
  [[nodiscard]] std::vector<std::int64_t> numbers(std::string_view name) const {
    return decode_integers(array(name), encoding_);
  }
  /// A number for each cell.
  [[nodiscard]] std::vector<std::int64_t> of_cells(std::string_view name) const {
    std::vector<std::int64_t> values = numbers(name);
    check_size(array(name), values.size(), cells_);
    return values;
  }
  /// Ends of ranges of a second array, which is as long as the last one says.
  [[nodiscard]] std::pair<std::vector<std::int64_t>, std::vector<std::int64_t>> ranges(std::string_view ends,
                                                                                       std::string_view of,
                                                                                       bool by_cell) const {
    std::vector<std::int64_t> last = by_cell ? of_cells(ends) : numbers(ends);
    check_ascends(array(ends), last);
    std::vector<std::int64_t> values = numbers(of);
    check_size(array(of), values.size(), last.empty() ? 0 : static_cast<std::uint64_t>(last.back()));
    return {std::move(last), std::move(values)};
  }

 private:
  const std::vector<VtuArray>& arrays_;
  std::string_view section_;
  std::uint64_t cells_;
  const VtuEncoding& encoding_;
};

/// The faces of polyhedra as VTK 9.4 and later write them: faces as ranges of points, polyhedra as ranges of faces.
FaceStreams faces_by_number(const CellArrays& arrays) {
  const auto [face_ends, corners] = arrays.ranges("face_offsets", "face_connectivity", false);
  const auto [cell_ends, faces] = arrays.ranges("polyhedron_offsets", "polyhedron_to_faces", true);
  std::vector<std::uint8_t> used(face_ends.size(), 0);
  FaceStreams streams;
  std::size_t at = 0;
  for (const std::int64_t end : cell_ends) {
    const std::int64_t count = end - static_cast<std::int64_t>(at);
    if (count > 0) streams.numbers.push_back(count);
    for (; at < static_cast<std::size_t>(end); ++at) {
      const auto f = static_cast<std::size_t>(faces[at]);
      if (faces[at] < 0 || f >= face_ends.size() || ++used[f] > 2)
        fail_array(arrays.array("polyhedron_to_faces"),
                   fmt::format("{} is no face, or one of more than two polyhedra", faces[at]));
      const std::int64_t first = f == 0 ? 0 : face_ends[f - 1];
      streams.numbers.push_back(face_ends[f] - first);
      streams.numbers.insert(streams.numbers.end(), corners.begin() + first, corners.begin() + face_ends[f]);
    }
    streams.ends.push_back(count > 0 ? static_cast<std::int64_t>(streams.numbers.size()) : -1);
  }
  return streams;
}

/// The faces as older versions write them, as streams.
FaceStreams faces_as_streams(const CellArrays& arrays) {
  FaceStreams streams{arrays.numbers("faces"), arrays.of_cells("faceoffsets")};
  std::int64_t begin = 0;
  for (std::size_t c = 0; c < streams.ends.size(); ++c) {
    const std::int64_t end = streams.ends[c];
    if (end < 0) continue;
    if (end < begin || end > static_cast<std::int64_t>(streams.numbers.size()))
      fail_array(arrays.array("faceoffsets"), fmt::format("the faces of cell {} end at {}, out of range", c, end));
    begin = end;
  }
  return streams;
}

/// One file, whose pieces follow each other.
class GridReader {
 public:
  GridReader(const VtkXmlFile& file, bool with_data) : file_(file), encoding_(file.encoding), with_data_(with_data) {}

  VtkGrid read() {
    for (const VtkXmlPiece& piece : file_.pieces) add_piece(piece);
    for (const VtuArray& array : file_.field) add_field(array);
    return std::move(grid_);
  }

 private:
  void add_piece(const VtkXmlPiece& piece) {
    const PointRange range{grid_.points.size(), static_cast<std::size_t>(piece.points())};
    grid_.pieces.push_back(grid_.points.size());
    add_points(piece);
    add_data(piece, "PointData", piece.points(), grid_.point_data);
    add_data(piece, "CellData", piece.cells(), grid_.cell_data);
    for (const auto& [section, type] : typed_sections) {
      const auto count = piece.items.find(section);
      if (count != piece.items.end() && count->second > 0)
        add_cells({piece.arrays(section), section, count->second, encoding_}, type, range);
    }
  }

  void add_points(const VtkXmlPiece& piece) {
    const std::vector<VtuArray>& arrays = piece.arrays("Points");
    if (arrays.size() != 1) throw InvalidMesh("<Points> must have one array");
    if (arrays[0].type == "String") fail_array(arrays[0], "points are numbers, not text");
    if (arrays[0].components != 3) fail_array(arrays[0], "points must have three components");
    const std::vector<double> xyz = decode_numbers(arrays[0], encoding_);
    check_size(arrays[0], xyz.size(), piece.points());
    if (grid_.points.empty()) grid_.points.reserve(xyz.size() / 3);
    for (std::size_t i = 0; i < xyz.size(); i += 3) grid_.points.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
    if (grid_.points.size() >= no_point) throw InvalidMesh("more than 2^32 - 2 points");
  }

  void add_cells(const CellArrays& arrays, std::uint8_t type, const PointRange& range) {
    const auto [ends, ids] = arrays.ranges("offsets", "connectivity", true);
    std::vector<std::int64_t> types;
    FaceStreams streams;
    if (type == 0) {
      types = arrays.of_cells("types");
      if (std::find(types.begin(), types.end(), vtk_polyhedron) != types.end())
        streams = arrays.find("face_connectivity") != nullptr ? faces_by_number(arrays) : faces_as_streams(arrays);
    }
    if (grid_.types.empty()) {
      grid_.types.reserve(ends.size());
      grid_.offsets.reserve(ends.size() + 1);
      grid_.connectivity.reserve(ids.size());
    }
    std::size_t begin = 0;
    std::size_t stream = 0;
    for (std::size_t c = 0; c < ends.size(); ++c) {
      const auto end = static_cast<std::size_t>(ends[c]);
      std::span<const std::int64_t> numbers = std::span(ids).subspan(begin, end - begin);
      begin = end;
      if (type == 0 && (types[c] < 0 || types[c] > UINT8_MAX))
        throw InvalidMesh(fmt::format("cell {} has the unknown type {}", c, types[c]));
      if (!streams.ends.empty()) {
        const std::size_t last = streams.ends[c] < 0 ? stream : static_cast<std::size_t>(streams.ends[c]);
        if (types[c] == vtk_polyhedron) {
          numbers = std::span(streams.numbers).subspan(stream, last - stream);
        } else if (streams.ends[c] >= 0) {
          throw InvalidMesh(fmt::format("cell {} has faces, but is no polyhedron", c));
        }
        stream = last;
      }
      add_cell(type == 0 ? static_cast<std::uint8_t>(types[c]) : type, numbers, range, grid_);
    }
    if (grid_.types.size() >= no_point) throw InvalidMesh("more than 2^32 - 2 cells");
  }

  /// Pieces have the same arrays (read_vtk_xml()); one without items may have none.
  void add_data(const VtkXmlPiece& piece, std::string_view section, std::uint64_t items, std::vector<VtkArray>& to) {
    const std::vector<VtuArray>& arrays = piece.arrays(section);
    for (std::size_t a = 0; a < arrays.size(); ++a) {
      if (section == "PointData" && arrays[a].type == "String")
        fail_array(arrays[a], "text at points is not supported");
      if (!with_data_) {
        if (arrays[a].type != "String" && arrays[a].format != "ascii")
          check_size(arrays[a], count_numbers(arrays[a], encoding_), items);
        continue;
      }
      VtkArray array = array_of(arrays[a], encoding_, items);
      if (a == to.size()) {
        to.push_back(std::move(array));
      } else {
        to[a].values.insert(to[a].values.end(), array.values.begin(), array.values.end());
        to[a].texts.insert(to[a].texts.end(), array.texts.begin(), array.texts.end());
      }
    }
  }

  /// Only texts are used.
  void add_field(const VtuArray& array) {
    const bool is_own = std::find(arrays_of_texts.begin(), arrays_of_texts.end(), array.name) != arrays_of_texts.end();
    if (is_own && array.type == "UInt8" && array.components == 1) {
      check_size(array, count_numbers(array, encoding_), array.tuples);
      grid_.field.push_back({array.name, 1, true, {}, texts_of(array, encoding_)});
      return;
    }
    if (array.type != "String" && array.tuples == 0) return;
    VtkArray read = array_of(array, encoding_, array.tuples);
    if (read.is_text) grid_.field.push_back(std::move(read));
  }

  const VtkXmlFile& file_;
  const VtuEncoding& encoding_;
  const bool with_data_;
  VtkGrid grid_;
};

/// Sums the sizes that arrays announce. A later check compares them with those of the pieces.
ReadSizes sizes_of(const VtkXmlFile& file, std::uint64_t file_size) {
  ReadSizes sizes;
  sizes.file = file_size;
  const auto numbers_of = [&](const VtuArray& array) { return max_numbers(array, file.encoding); };
  for (const VtkXmlPiece& piece : file.pieces) {
    for (const auto& [section, arrays] : piece.sections) {
      for (const VtuArray& array : arrays) {
        const std::uint64_t n = numbers_of(array);
        const std::uint64_t bytes = n * vtu_type_bytes(array.type);
        if (section == "Points") sizes.points += n / 3;
        if (section == "Points" || section == "PointData" || section == "CellData") {
          sizes.decoded += array.type == "String" ? 32 * n : bytes;
          sizes.values += section == "Points" || array.type == "String" ? 0 : n;
        } else {
          (array.name == "offsets" ? sizes.cells : sizes.corners) += array.name == "types" ? 0 : n;
        }
      }
    }
  }
  for (const VtuArray& array : file.field)
    sizes.decoded += numbers_of(array) * (array.type == "String" ? 32 : vtu_type_bytes(array.type));
  return sizes;
}

}  // namespace

VtkGrid read_vtk_xml_grid(std::string_view content, std::string_view kind, std::uint64_t max_memory, bool with_data) {
  const VtkXmlFile file = read_vtk_xml(content, kind);
  check_memory(memory_of_vtk(sizes_of(file, content.size())), max_memory);
  return GridReader(file, with_data).read();
}

}  // namespace dartcast
