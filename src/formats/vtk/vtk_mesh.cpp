// Makes meshes of VTK's unstructured grids.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/read_memory.hpp"
#include "formats/second_order.hpp"
#include "formats/vtk.hpp"
#include "formats/vtk/vtk_grid.hpp"
#include "formats/vtk/vtk_tags.hpp"
#include "formats/vtu_write.hpp"

namespace dartcast {
namespace {

/// The conversion of a linear VTK cell. A face has `type` polyhedron.
struct Standard {
  int vtk;
  CellType type;
  bool face;
  std::vector<int> order;
};

const Standard* find_standard(int vtk) {
  static const std::array<Standard, 8> table = {{
      {vtk_tetra, CellType::tetrahedron, false, {0, 1, 2, 3}},
      {vtk_hexahedron, CellType::hexahedron, false, {0, 1, 2, 3, 4, 5, 6, 7}},
      {vtk_voxel, CellType::hexahedron, false, {0, 1, 3, 2, 4, 5, 7, 6}},
      {vtk_wedge, CellType::prism, false, {0, 2, 1, 3, 5, 4}},
      {vtk_pyramid, CellType::pyramid, false, {0, 1, 2, 3, 4}},
      {vtk_triangle, CellType::polyhedron, true, {0, 1, 2}},
      {vtk_quad, CellType::polyhedron, true, {0, 1, 2, 3}},
      {vtk_pixel, CellType::polyhedron, true, {0, 1, 3, 2}},
  }};
  const auto* found = std::find_if(table.begin(), table.end(), [&](const Standard& s) { return s.vtk == vtk; });
  return found == table.end() ? nullptr : found;
}

/// The linear type with the corners of one of second or higher order, which stand first; the type itself for others.
int linear_type(int vtk) {
  switch (vtk) {
    case 21:
    case 68: return vtk_line;  // quadratic edge, Lagrange curve
    case 22:
    case 34:
    case 69: return vtk_triangle;
    case 23:
    case 28:
    case 30:
    case 70: return vtk_quad;
    case 24:
    case 71: return vtk_tetra;
    case 25:
    case 29:
    case 33:
    case 72: return vtk_hexahedron;
    case 26:
    case 31:
    case 32:
    case 73: return vtk_wedge;
    case 27:
    case 74: return vtk_pyramid;
    default: return vtk;
  }
}

/// No cell, points, lines, and curves of any order.
bool is_point_or_line(int vtk) {
  return vtk <= vtk_poly_line || vtk == 21 || vtk == 35 || vtk == 51 || vtk == 60 || vtk == 68 || vtk == 75;
}

/// Quadratic, parametric, and those of any order (Lagrange, Bezier).
bool is_higher_order(int vtk) {
  return (vtk >= 21 && vtk <= 37) || (vtk >= 51 && vtk <= 56) || (vtk >= 60 && vtk <= 81);
}

/// Adds cell c of the grid. `corners`: scratch memory.
void add_cell(const VtkGrid& grid, std::size_t c, std::vector<std::uint32_t>& corners, ParsedMesh& parsed,
              Places& places) {
  int vtk = grid.types[c];
  MeshData& mesh = parsed.mesh;
  std::span<const std::uint32_t> ids =
      std::span(grid.connectivity).subspan(grid.offsets[c], grid.offsets[c + 1] - grid.offsets[c]);
  if (const int linear = linear_type(vtk); linear != vtk && parsed.linearise) {
    const Standard* standard = find_standard(linear);
    const std::size_t n = standard == nullptr ? 2 : standard->order.size();
    if (ids.size() < n) throw InvalidMesh(fmt::format("cell {} of VTK's type {} has {} points", c, vtk, ids.size()));
    take_higher_order(parsed, c);
    ids = ids.first(n);
    vtk = linear;
  }
  const Standard* standard = find_standard(vtk);
  if (standard != nullptr) {
    if (ids.size() != standard->order.size()) {
      throw InvalidMesh(fmt::format("cell {} of VTK's type {} has {} corners instead of {}", c, vtk, ids.size(),
                                    standard->order.size()));
    }
    corners.clear();
    for (const int k : standard->order) corners.push_back(ids[static_cast<std::size_t>(k)]);
    ids = corners;
  }
  const auto number = static_cast<std::uint32_t>(c);
  if (vtk == vtk_polygon || (standard != nullptr && standard->face)) {
    mesh.add_patch_face(ids, 0);
    places.faces.push_back(number);
  } else if (vtk == vtk_line || vtk == vtk_poly_line) {
    for (std::size_t k = 1; k < ids.size(); ++k) {
      parsed.add_edge(ids[k - 1], ids[k], 0);
      places.edges.push_back(number);
    }
  } else if (standard != nullptr || vtk == vtk_polyhedron) {
    mesh.add_cell(standard != nullptr ? standard->type : CellType::polyhedron, ids);
    places.cells.push_back(number);
  } else if (!is_point_or_line(vtk)) {
    (is_higher_order(vtk) ? parsed.second_order : parsed.unsupported).add(c);
  }
}

/// Not 0 at cells that another piece has, too, and at hidden ones: they are left out.
constexpr const char* ghost_array = "vtkGhostType";

Places copy_cells(const VtkGrid& grid, ParsedMesh& parsed) {
  Places places;
  std::vector<std::uint32_t> corners;
  const VtkArray* ghosts = find_array(grid.cell_data, ghost_array);
  for (std::size_t c = 0; c < grid.types.size(); ++c) {
    if (ghosts == nullptr || ghosts->is_text || ghosts->values[c * ghosts->components] == 0.0)
      add_cell(grid, c, corners, parsed, places);
  }
  return places;
}

/// The cells that are free, by the array `free` of a file that dartcast has written. Other programs' arrays of this name
/// may mean something else.
void take_free(const VtkGrid& grid, MeshData& mesh) {
  const VtkArray* writer = find_array(grid.field, free_writer);
  if (writer == nullptr || writer->texts != std::vector<std::string>{"dartcast"}) return;
  for (const DataArray& a : mesh.cell_data) {
    if (a.name != "free" || a.components != 1) continue;
    for (const double value : a.values) mesh.free.push_back(value != 0.0 ? 1 : 0);
  }
}

/// All must have a value for each of n items.
void check_items(const std::vector<VtkArray>& arrays, std::size_t n) {
  for (const VtkArray& a : arrays) {
    if (a.items() != n) throw InvalidMesh(fmt::format("array '{}' has {} items instead of {}", a.name, a.items(), n));
  }
}

ParsedMesh mesh_of(VtkGrid grid, std::string format, const ReadOptions& options) {
  ParsedMesh parsed;
  parsed.linearise = options.linearise;
  parsed.format = std::move(format);
  MeshData& mesh = parsed.mesh;
  check_items(grid.point_data, grid.points.size());
  join_pieces(grid);
  mesh.points = std::move(grid.points);
  check_items(grid.cell_data, grid.types.size());
  Places places = copy_cells(grid, parsed);
  if (take_plane(parsed)) {
    places.cells = std::move(places.faces);
    places.faces = std::move(places.edges);
  }
  const bool patch_is_ours = copy_tags(grid, places, options.patch_array, mesh);
  for (VtkArray& a : grid.point_data) {
    if (!a.is_text) mesh.point_data.push_back({std::move(a.name), a.components, std::move(a.values)});
  }
  for (VtkArray& a : grid.cell_data) {
    if (a.is_text || (patch_is_ours && a.name == "patch") || a.name == ghost_array) continue;
    a.take_rows(places.cells);
    mesh.cell_data.push_back({std::move(a.name), a.components, std::move(a.values)});
  }
  take_free(grid, mesh);
  const bool anything = !mesh.types.empty() || parsed.second_order.count + parsed.unsupported.count > 0;
  if (!anything) throw InvalidMesh("the file has no cells");
  mesh.source = places.cells;
  mesh.patch_source = places.faces;
  finish(parsed);
  return parsed;
}

}  // namespace

ParsedMesh parse_vtu(const std::filesystem::path& /*path*/, std::string_view content, const ReadOptions& options) {
  return mesh_of(read_vtk_xml_grid(content, "UnstructuredGrid", options.max_memory), "VTK XML (.vtu)", options);
}

ParsedMesh parse_vtu_pieces(std::span<const std::filesystem::path> pieces, const ReadOptions& options) {
  VtkGrid grid;
  for (const std::filesystem::path& piece : pieces) {
    try {
      check_memory(memory_of_vtk({.file = file_bytes(piece)}), options.max_memory);
      const std::string content = read_bytes(piece);
      add_pieces(read_vtk_xml_grid(content, "UnstructuredGrid", options.max_memory), grid);
    } catch (const InvalidMesh& e) {
      throw InvalidMesh(fmt::format("{}: {}", piece.filename().string(), e.what()));
    }
  }
  return mesh_of(std::move(grid), "VTK XML, in pieces (.pvtu)", options);
}

ParsedMesh parse_legacy_vtk(const std::filesystem::path& /*path*/, std::string_view content,
                            const ReadOptions& options) {
  if (from_first_word(content).starts_with("<"))
    throw InvalidMesh("this .vtk is one of VTK's XML files; rename it to .vtu");
  return mesh_of(read_legacy_grid(content, options.max_memory), "VTK legacy (.vtk)", options);
}

}  // namespace dartcast
