// Checks every array of a .vtu or .vtp file before VTK reads it.
#include "formats/vtk/vtu_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk/face_stream.hpp"
#include "formats/vtk/vtk_xml.hpp"
#include "formats/vtk/vtu_array.hpp"

namespace dartcast {
namespace {

/// The data must announce `items` times the array's components.
void check_size(const VtuArray& array, const VtuEncoding& encoding, std::uint64_t items) {
  const std::uint64_t found = count_numbers(array, encoding);
  if (items > INT64_MAX / array.components || found != items * array.components) {
    fail_array(array, fmt::format("it has {} numbers, where {} x {} should stand; the file is truncated or damaged",
                                  found, items, array.components));
  }
}

const VtuArray* find_array(const std::vector<VtuArray>& arrays, std::string_view name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const VtuArray& a) { return a.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

void check_faces(const VtuArray& faces, const VtuArray& offsets, std::uint64_t cells, const VtuEncoding& encoding) {
  check_size(offsets, encoding, cells);
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

/// Connectivity and offsets of `cells` cells.
void check_corners(const std::vector<VtuArray>& arrays, std::string_view section, std::uint64_t cells,
                   const VtuEncoding& encoding) {
  const VtuArray* connectivity = find_array(arrays, "connectivity");
  const VtuArray* offsets = find_array(arrays, "offsets");
  if (connectivity == nullptr || offsets == nullptr)
    throw InvalidMesh(fmt::format("<{}> must have the arrays connectivity and offsets", section));
  for (const VtuArray* a : {connectivity, offsets}) {
    if (a->components != 1) fail_array(*a, "it must have one component");
  }
  check_size(*offsets, encoding, cells);
  const std::vector<std::int64_t> ends = decode_integers(*offsets, encoding);
  if (!std::is_sorted(ends.begin(), ends.end()) || ends.front() < 0) fail_array(*offsets, "it must ascend");
  check_size(*connectivity, encoding, static_cast<std::uint64_t>(ends.back()));
}

/// The arrays of an UnstructuredGrid's cells beside those of corners.
void check_cells(const std::vector<VtuArray>& arrays, std::uint64_t cells, const VtuEncoding& encoding) {
  const VtuArray* types = find_array(arrays, "types");
  if (types == nullptr) throw InvalidMesh("<Cells> must have the array types");
  if (types->components != 1) fail_array(*types, "it must have one component");
  check_size(*types, encoding, cells);
  const VtuArray* faces = find_array(arrays, "faces");
  const VtuArray* face_offsets = find_array(arrays, "faceoffsets");
  const std::vector<std::int64_t> cell_types = decode_integers(*types, encoding);
  const bool polyhedra = std::find(cell_types.begin(), cell_types.end(), 42) != cell_types.end();
  if ((faces == nullptr) != (face_offsets == nullptr) || (polyhedra && faces == nullptr)) {
    throw InvalidMesh("polyhedra must have the arrays faces and faceoffsets");
  }
  if (faces == nullptr || face_offsets == nullptr) return;
  if (faces->components != 1 || face_offsets->components != 1) fail_array(*faces, "it must have one component");
  if (polyhedra || count_numbers(*face_offsets, encoding) != 0) check_faces(*faces, *face_offsets, cells, encoding);
}

/// An array of texts, each ended by a 0.
void check_texts(const VtuArray& array, const VtuEncoding& encoding, std::uint64_t items) {
  const std::vector<std::int64_t> characters = decode_integers(array, encoding);
  if (!characters.empty() && characters.back() != 0) fail_array(array, "its last text does not end");
  const auto texts = static_cast<std::uint64_t>(std::count(characters.begin(), characters.end(), 0));
  if (array.components != 1 || texts != items) {
    fail_array(array, fmt::format("it has {} texts, where {} should stand", texts, items));
  }
}

/// The arrays at points or cells. Where VTK fails to read one at cells, it tries the section of points.
void check_data(const VtkXmlPiece& piece, std::string_view section, const VtuEncoding& encoding) {
  const bool at_cells = section == "CellData";
  const std::uint64_t items = at_cells ? piece.cells() : piece.points();
  for (const VtuArray& array : piece.arrays(section)) {
    if (array.type == "String") {
      if (!at_cells) fail_array(array, "text at points is not supported");
      check_texts(array, encoding, items);
      continue;
    }
    check_size(array, encoding, items);
    if (at_cells && !piece.sections.contains("PointData")) check_bytes(array, encoding);
  }
}

void check_piece(const VtkXmlPiece& piece, const VtuEncoding& encoding) {
  const std::vector<VtuArray>& points = piece.arrays("Points");
  if (points.size() != 1) throw InvalidMesh("<Points> must have one array");
  if (points[0].type == "String") fail_array(points[0], "points are numbers, not text");
  if (points[0].components != 3) fail_array(points[0], "points must have three components");
  check_size(points[0], encoding, piece.points());
  check_data(piece, "PointData", encoding);
  check_data(piece, "CellData", encoding);
  for (const auto& [section, count] : piece.items) {
    if (section == "Points" || count == 0) continue;
    check_corners(piece.arrays(section), section, count, encoding);
    if (section == "Cells") check_cells(piece.arrays(section), count, encoding);
  }
}

/// VTK allocates the values that the tag announces, without a check.
void check_field(const VtuArray& array, const VtuEncoding& encoding) {
  if (array.type == "String") {
    check_texts(array, encoding, array.tuples);
  } else if (array.tuples > 0) {
    check_size(array, encoding, array.tuples);
  }
}

/// Sums the sizes that arrays announce. A later check compares them with those of the pieces.
ReadSizes sizes_of(const VtkXmlFile& file, std::uint64_t file_size) {
  ReadSizes sizes;
  sizes.file = 2 * file_size;
  const auto numbers_of = [&](const VtuArray& array) { return max_numbers(array, file.encoding); };
  for (const VtkXmlPiece& piece : file.pieces) {
    for (const auto& [section, arrays] : piece.sections) {
      for (const VtuArray& array : arrays) {
        const std::uint64_t n = numbers_of(array);
        const std::uint64_t bytes = n * vtu_type_bytes(array.type);
        if (section == "Points") sizes.points += n / 3;
        if (section == "Points" || section == "PointData" || section == "CellData") {
          sizes.vtk += array.type == "String" ? 32 * n : bytes;
          sizes.values += section == "Points" || array.type == "String" ? 0 : n;
        } else {
          (array.name == "offsets" ? sizes.cells : sizes.corners) += array.name == "types" ? 0 : n;
        }
      }
    }
  }
  for (const VtuArray& array : file.field) {
    sizes.vtk += numbers_of(array) * (array.type == "String" ? 32 : vtu_type_bytes(array.type));
  }
  return sizes;
}

}  // namespace

void check_vtu(std::string_view content, std::string_view kind, std::uint64_t max_memory) {
  const VtkXmlFile file = read_vtk_xml(content, kind);
  check_memory(memory_of_vtk(sizes_of(file, content.size())), max_memory);
  for (const VtkXmlPiece& piece : file.pieces) check_piece(piece, file.encoding);
  for (const VtuArray& array : file.field) check_field(array, file.encoding);
}

}  // namespace dartcast
