#include "dartcast/io/vtu_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dartcast/base/error.hpp"
#include "dartcast/io/face_stream.hpp"
#include "dartcast/io/vtu_array.hpp"
#include "dartcast/io/xml_tags.hpp"

namespace dartcast {
namespace {

std::string attribute(const XmlTag& tag, const std::string& name, const std::string& otherwise) {
  const auto found = tag.attributes.find(name);
  return found == tag.attributes.end() ? otherwise : found->second;
}

std::uint64_t number_of(const XmlTags& tags, const XmlTag& tag, const std::string& name, const std::string& otherwise) {
  const std::string text = attribute(tag, name, otherwise);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value > INT64_MAX) {
    tags.fail(fmt::format("tag <{}>: {}=\"{}\" is not a size", tag.name, name, text.substr(0, 40)));
  }
  return value;
}

/// One <Piece>: its arrays by the section they stand in.
struct Piece {
  std::uint64_t points = 0;
  std::uint64_t cells = 0;
  std::multimap<std::string, VtuArray> arrays;
};

struct File {
  VtuEncoding encoding;
  std::vector<Piece> pieces;
  std::vector<VtuArray> field;
};

void read_head(const XmlTags& tags, const XmlTag& tag, File& file) {
  if (tag.name != "VTKFile") tags.fail("<VTKFile> should stand here");
  const std::string type = attribute(tag, "type", "");
  if (type != "UnstructuredGrid") {
    tags.fail(
        fmt::format("the data set is {}, not UnstructuredGrid: it has no volume cells to use", type.substr(0, 40)));
  }
  const std::string order = attribute(tag, "byte_order", "LittleEndian");
  if (order != "LittleEndian" && order != "BigEndian") tags.fail("byte_order is neither LittleEndian nor BigEndian");
  const std::string header = attribute(tag, "header_type", "UInt32");
  if (header != "UInt32" && header != "UInt64") tags.fail("header_type is neither UInt32 nor UInt64");
  file.encoding.big_endian = order == "BigEndian";
  file.encoding.header_bytes = header == "UInt64" ? 8 : 4;
  file.encoding.compressor = attribute(tag, "compressor", "");
}

VtuArray read_array(const XmlTags& tags, const XmlTag& tag, std::string_view content) {
  VtuArray array;
  array.name = attribute(tag, "Name", "");
  array.type = attribute(tag, "type", "");
  array.format = attribute(tag, "format", "ascii");
  if (vtu_type_bytes(array.type) == 0)
    tags.fail(fmt::format("'{}' is not a type of numbers", array.type.substr(0, 40)));
  if (array.format != "ascii" && array.format != "binary" && array.format != "appended") {
    tags.fail(fmt::format("'{}' is not a format of data", array.format.substr(0, 40)));
  }
  array.components = number_of(tags, tag, "NumberOfComponents", "1");
  array.tuples = number_of(tags, tag, "NumberOfTuples", "0");
  array.offset = number_of(tags, tag, "offset", "0");
  if (array.components == 0 || array.components > 1000000) tags.fail("a number of components is out of range");
  if (tag.closes) return array;
  array.text = content.substr(tag.end, content.find('<', tag.end) - tag.end);
  return array;
}

/// The appended data, which need not be XML: they end before the last closing tag of their own.
void read_appended(XmlTags& tags, const XmlTag& tag, std::string_view content, File& file) {
  // VTK looks for the tag's text and takes the first byte behind white space for the mark, whatever it is.
  const std::size_t first = content.find('>', content.find("<AppendedData"));
  const std::size_t begin = content.find_first_not_of(" \t\r\n", tag.end);
  const std::size_t end = content.rfind("</AppendedData");
  if (first + 1 != tag.end || begin == std::string_view::npos || content[begin] != '_') {
    tags.fail("the appended data do not start with '_' behind their tag");
  }
  if (end == std::string_view::npos || end <= begin)
    tags.fail("the appended data are not closed; the file is truncated");
  file.encoding.appended = content.substr(begin + 1, end - begin - 1);
  file.encoding.appended_raw = attribute(tag, "encoding", "base64") == "raw";
  tags.move_to(end);
}

File read_tags(std::string_view content) {
  XmlTags tags(content);
  XmlTag tag;
  File file;
  std::string section;
  if (!tags.next(tag)) tags.fail("no XML tag in the file");
  read_head(tags, tag, file);
  bool grid = false;
  while (tags.next(tag)) {
    if (!tag.opens) {
      if (tag.name == section) section.clear();
    } else if (tag.name == "UnstructuredGrid") {
      grid = true;
    } else if (tag.name == "Piece") {
      file.pieces.push_back(
          {number_of(tags, tag, "NumberOfPoints", "0"), number_of(tags, tag, "NumberOfCells", "0"), {}});
    } else if (tag.name == "AppendedData") {
      read_appended(tags, tag, content, file);
    } else if (tag.name == "Points" || tag.name == "Cells" || tag.name == "PointData" || tag.name == "CellData" ||
               tag.name == "FieldData") {
      section = tag.closes ? "" : tag.name;
    } else if (tag.name == "DataArray" || tag.name == "Array") {
      VtuArray array = read_array(tags, tag, content);
      if (array.name.empty()) array.name = section;
      if (section == "FieldData") {
        file.field.push_back(array);
      } else if (!section.empty() && !file.pieces.empty()) {
        file.pieces.back().arrays.emplace(section, array);
      } else {
        tags.fail("an array stands outside the sections of a piece");
      }
    }
  }
  if (!grid || file.pieces.empty()) tags.fail("the file has no <UnstructuredGrid> with a <Piece>");
  return file;
}

/// The data must announce `items` times the array's components.
void check_size(const VtuArray& array, const VtuEncoding& encoding, std::uint64_t items) {
  const std::uint64_t found = count_numbers(array, encoding);
  if (items > INT64_MAX / array.components || found != items * array.components) {
    fail_array(array, fmt::format("it has {} numbers, where {} x {} should stand; the file is truncated or damaged",
                                  found, items, array.components));
  }
}

const VtuArray* find_cell_array(const Piece& piece, std::string_view name) {
  const auto [begin, end] = piece.arrays.equal_range("Cells");
  const VtuArray* found = nullptr;
  for (auto at = begin; at != end; ++at) {
    if (at->second.name != name) continue;
    if (found != nullptr) fail_array(at->second, "it occurs twice");
    found = &at->second;
  }
  return found;
}

void check_faces(const VtuArray& faces, const VtuArray& offsets, const Piece& piece, const VtuEncoding& encoding) {
  check_size(offsets, encoding, piece.cells);
  const std::vector<std::int64_t> ends = decode_integers(offsets, encoding);
  const std::vector<std::int64_t> stream = decode_integers(faces, encoding);
  std::int64_t begin = 0;
  for (std::size_t c = 0; c < ends.size(); ++c) {
    if (ends[c] < 0) continue;
    if (ends[c] < begin || ends[c] > static_cast<std::int64_t>(stream.size())) {
      fail_array(offsets, fmt::format("the faces of cell {} end at {}, out of range", c, ends[c]));
    }
    if (!is_face_stream({stream.data() + begin, static_cast<std::size_t>(ends[c] - begin)})) {
      fail_array(faces, fmt::format("the faces of cell {} do not fit its numbers", c));
    }
    begin = ends[c];
  }
}

void check_cells(const Piece& piece, const VtuEncoding& encoding) {
  const VtuArray* connectivity = find_cell_array(piece, "connectivity");
  const VtuArray* offsets = find_cell_array(piece, "offsets");
  const VtuArray* types = find_cell_array(piece, "types");
  if (connectivity == nullptr || offsets == nullptr || types == nullptr) {
    throw InvalidMesh("<Cells> must have the arrays connectivity, offsets and types");
  }
  for (const VtuArray* a : {connectivity, offsets, types}) {
    if (a->components != 1) fail_array(*a, "it must have one component");
  }
  check_size(*offsets, encoding, piece.cells);
  check_size(*types, encoding, piece.cells);
  const std::vector<std::int64_t> ends = decode_integers(*offsets, encoding);
  if (!std::is_sorted(ends.begin(), ends.end()) || ends.front() < 0) fail_array(*offsets, "it must ascend");
  check_size(*connectivity, encoding, static_cast<std::uint64_t>(ends.back()));
  const VtuArray* faces = find_cell_array(piece, "faces");
  const VtuArray* face_offsets = find_cell_array(piece, "faceoffsets");
  const std::vector<std::int64_t> cell_types = decode_integers(*types, encoding);
  const bool polyhedra = std::find(cell_types.begin(), cell_types.end(), 42) != cell_types.end();
  if ((faces == nullptr) != (face_offsets == nullptr) || (polyhedra && faces == nullptr)) {
    throw InvalidMesh("polyhedra must have the arrays faces and faceoffsets");
  }
  if (faces == nullptr || face_offsets == nullptr) return;
  if (faces->components != 1 || face_offsets->components != 1) fail_array(*faces, "it must have one component");
  if (polyhedra || count_numbers(*face_offsets, encoding) != 0) check_faces(*faces, *face_offsets, piece, encoding);
}

void check_piece(const Piece& piece, const VtuEncoding& encoding) {
  std::size_t coordinates = 0;
  for (const auto& [section, array] : piece.arrays) {
    if (section == "Cells") continue;
    if (array.type == "String") fail_array(array, "text at points or cells is not supported");
    if (section == "Points") {
      ++coordinates;
      if (array.components != 3) fail_array(array, "points must have three components");
    }
    check_size(array, encoding, section == "CellData" ? piece.cells : piece.points);
  }
  if (coordinates != 1) throw InvalidMesh("<Points> must have one array");
  if (piece.cells > 0) check_cells(piece, encoding);
}

/// VTK makes room for the values that the tag announces, and trusts it.
void check_field(const VtuArray& array, const VtuEncoding& encoding) {
  if (array.type != "String") {
    if (array.tuples > 0) check_size(array, encoding, array.tuples);
    return;
  }
  const std::vector<std::int64_t> characters = decode_integers(array, encoding);
  if (!characters.empty() && characters.back() != 0) fail_array(array, "its last text does not end");
  const auto texts = static_cast<std::uint64_t>(std::count(characters.begin(), characters.end(), 0));
  if (array.components != 1 || texts != array.tuples) {
    fail_array(array, fmt::format("it has {} texts, where {} should stand", texts, array.tuples));
  }
}

}  // namespace

void check_vtu(std::string_view content) {
  const File file = read_tags(content);
  for (const Piece& piece : file.pieces) check_piece(piece, file.encoding);
  for (const VtuArray& array : file.field) check_field(array, file.encoding);
}

}  // namespace dartcast
