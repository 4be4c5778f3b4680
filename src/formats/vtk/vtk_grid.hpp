// A data set of VTK, as its readers find it: points, cells of any type, and arrays.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/vec3.hpp"
#include "formats/parsed_mesh.hpp"

namespace dartcast {

/// VTK's numbers of the cell types that have a meaning here.
enum VtkCellType : std::uint8_t {
  vtk_poly_vertex = 2,
  vtk_line = 3,
  vtk_poly_line = 4,
  vtk_triangle = 5,
  vtk_triangle_strip = 6,
  vtk_polygon = 7,
  vtk_pixel = 8,
  vtk_quad = 9,
  vtk_tetra = 10,
  vtk_voxel = 11,
  vtk_hexahedron = 12,
  vtk_wedge = 13,
  vtk_pyramid = 14,
  vtk_polyhedron = 42,
};

/// An array of numbers or of texts.
struct VtkArray {
  std::string name;
  std::size_t components = 1;
  bool is_text = false;
  std::vector<double> values;      ///< row-major
  std::vector<std::string> texts;  ///< one each

  [[nodiscard]] std::size_t items() const { return is_text ? texts.size() : values.size() / components; }
  /// Keeps these rows, which ascend. Precondition: it holds numbers.
  void take_rows(std::span<const std::uint32_t> rows);
};

/// The first array of this name; null if there is none.
const VtkArray* find_array(const std::vector<VtkArray>& arrays, std::string_view name);

struct VtkGrid {
  std::vector<Vec3> points;
  std::vector<std::uint8_t> types;         ///< per cell
  std::vector<std::size_t> offsets = {0};  ///< cells + 1, into connectivity
  /// Points; 0xffffffff if a number names none. A polyhedron has its faces, as in MeshData.
  std::vector<std::uint32_t> connectivity;
  std::vector<VtkArray> point_data;
  std::vector<VtkArray> cell_data;
  std::vector<VtkArray> field;      ///< of texts alone
  std::vector<std::size_t> pieces;  ///< the first point of each piece; one or none: the grid is in one
};

/// Adds the pieces of another file, as they are. Throws InvalidMesh if it has other arrays.
void add_pieces(VtkGrid&& from, VtkGrid& to);

/// Points of different pieces at one place become the first of them. Cost: n log n.
void join_pieces(VtkGrid& grid);

/// The points of a file that the numbers of one of its pieces name.
struct PointRange {
  std::size_t first = 0;
  std::size_t count = 0;

  [[nodiscard]] std::uint32_t point(std::int64_t id) const {
    const bool known = id >= 0 && static_cast<std::uint64_t>(id) < count;
    return known ? static_cast<std::uint32_t>(first + static_cast<std::size_t>(id)) : no_point;
  }
};

/// Adds a cell. `ids`: its points, counted from the range's first, or the face stream of a polyhedron. Throws InvalidMesh
/// if that does not fit its numbers.
void add_cell(std::uint8_t type, std::span<const std::int64_t> ids, const PointRange& range, VtkGrid& grid);

/// Reads one of VTK's XML files of a kind, "UnstructuredGrid" or "PolyData". Tags, sections and names are checked as
/// read_vtk_xml() does, and the length of each array. It follows from the counts of points and cells, and from the last
/// offset. The data must hold it, in ASCII, base64 or raw, inline or appended, compressed or not. A compressed block may
/// not grow more than 1100 times. The memory for the announced sizes is checked before any data are decoded
/// (`max_memory`: as of ReadOptions). Without `with_data` the arrays at points and cells are left out, and only their
/// announced lengths checked. In PolyData vertices, lines, polygons and strips follow each other in each piece. Throws
/// InvalidMesh with the line or array if something is wrong, or if the file is of another kind.
VtkGrid read_vtk_xml_grid(std::string_view content, std::string_view kind, std::uint64_t max_memory,
                          bool with_data = true);

/// Reads a legacy .vtk file, ASCII or binary, of the versions 1.0 to 5.9. It checks every count against the bytes that
/// are there, and every number of an ASCII file. Arrays have different names at the points, at the cells, in the file.
/// Throws InvalidMesh with the line (or byte) if something is wrong, or if the data set is not an unstructured
/// grid. `max_memory`: as of ReadOptions.
VtkGrid read_legacy_grid(std::string_view content, std::uint64_t max_memory);

}  // namespace dartcast
