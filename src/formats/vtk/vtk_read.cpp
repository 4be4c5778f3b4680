// Reads VTK's unstructured grids, after the checks of their content.
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdTypeArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <set>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/second_order.hpp"
#include "formats/vtk/face_stream.hpp"
#include "formats/vtk/vtk_errors.hpp"
#include "formats/vtk/vtk_legacy_check.hpp"
#include "formats/vtk/vtk_mesh.hpp"
#include "formats/vtk/vtk_tags.hpp"
#include "formats/vtk/vtu_check.hpp"

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
      {VTK_TETRA, CellType::tetrahedron, false, {0, 1, 2, 3}},
      {VTK_HEXAHEDRON, CellType::hexahedron, false, {0, 1, 2, 3, 4, 5, 6, 7}},
      {VTK_VOXEL, CellType::hexahedron, false, {0, 1, 3, 2, 4, 5, 7, 6}},
      {VTK_WEDGE, CellType::prism, false, {0, 2, 1, 3, 5, 4}},
      {VTK_PYRAMID, CellType::pyramid, false, {0, 1, 2, 3, 4}},
      {VTK_TRIANGLE, CellType::polyhedron, true, {0, 1, 2}},
      {VTK_QUAD, CellType::polyhedron, true, {0, 1, 2, 3}},
      {VTK_PIXEL, CellType::polyhedron, true, {0, 1, 3, 2}},
  }};
  const auto* found = std::find_if(table.begin(), table.end(), [&](const Standard& s) { return s.vtk == vtk; });
  return found == table.end() ? nullptr : found;
}

/// The linear type with the corners of one of second or higher order, which stand first; the type itself for others.
int linear_type(int vtk) {
  switch (vtk) {
    case VTK_QUADRATIC_EDGE:
    case VTK_LAGRANGE_CURVE: return VTK_LINE;
    case VTK_QUADRATIC_TRIANGLE:
    case VTK_BIQUADRATIC_TRIANGLE:
    case VTK_LAGRANGE_TRIANGLE: return VTK_TRIANGLE;
    case VTK_QUADRATIC_QUAD:
    case VTK_BIQUADRATIC_QUAD:
    case VTK_QUADRATIC_LINEAR_QUAD:
    case VTK_LAGRANGE_QUADRILATERAL: return VTK_QUAD;
    case VTK_QUADRATIC_TETRA:
    case VTK_LAGRANGE_TETRAHEDRON: return VTK_TETRA;
    case VTK_QUADRATIC_HEXAHEDRON:
    case VTK_TRIQUADRATIC_HEXAHEDRON:
    case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
    case VTK_LAGRANGE_HEXAHEDRON: return VTK_HEXAHEDRON;
    case VTK_QUADRATIC_WEDGE:
    case VTK_QUADRATIC_LINEAR_WEDGE:
    case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
    case VTK_LAGRANGE_WEDGE: return VTK_WEDGE;
    case VTK_QUADRATIC_PYRAMID:
    case VTK_LAGRANGE_PYRAMID: return VTK_PYRAMID;
    default: return vtk;
  }
}

bool is_point_or_line(int vtk) {
  static const std::set<int> types = {VTK_EMPTY_CELL,        VTK_VERTEX,         VTK_POLY_VERTEX, VTK_LINE,
                                      VTK_POLY_LINE,         VTK_QUADRATIC_EDGE, VTK_CUBIC_LINE,  VTK_PARAMETRIC_CURVE,
                                      VTK_HIGHER_ORDER_EDGE, VTK_LAGRANGE_CURVE, VTK_BEZIER_CURVE};
  return types.count(vtk) > 0;
}

bool is_higher_order(int vtk) {
  return (vtk >= VTK_QUADRATIC_EDGE && vtk <= VTK_TRIQUADRATIC_PYRAMID) ||
         (vtk >= VTK_PARAMETRIC_CURVE && vtk <= VTK_PARAMETRIC_HEX_REGION) ||
         (vtk >= VTK_HIGHER_ORDER_EDGE && vtk <= VTK_BEZIER_PYRAMID);
}

std::uint32_t checked_id(std::int64_t id) {
  return id >= 0 && id < no_point ? static_cast<std::uint32_t>(id) : no_point;
}

void copy_points(vtkUnstructuredGrid& grid, MeshData& mesh) {
  const vtkIdType n = grid.GetNumberOfPoints();
  if (n >= static_cast<vtkIdType>(no_point)) throw InvalidMesh("more than 2^32 - 2 points");
  mesh.points.resize(static_cast<std::size_t>(n));
  for (vtkIdType i = 0; i < n; ++i) {
    double x[3];
    grid.GetPoint(i, x);
    mesh.points[static_cast<std::size_t>(i)] = {x[0], x[1], x[2]};
  }
}

void add_polyhedron(vtkUnstructuredGrid& grid, vtkIdType c, MeshData& mesh) {
  vtkIdTypeArray* faces = grid.GetFaces();
  vtkIdTypeArray* locations = grid.GetFaceLocations();
  const vtkIdType begin =
      faces == nullptr || locations == nullptr || c >= locations->GetNumberOfTuples() ? -1 : locations->GetValue(c);
  if (begin < 0 || begin >= faces->GetNumberOfTuples()) throw InvalidMesh(fmt::format("polyhedron {} has no faces", c));
  const vtkIdType size = faces->GetNumberOfTuples();
  std::vector<std::uint32_t> stream = {checked_id(faces->GetValue(begin))};
  vtkIdType at = begin + 1;
  for (vtkIdType f = 0; f < faces->GetValue(begin); ++f) {
    const vtkIdType n = at < size ? faces->GetValue(at) : -1;
    if (n < 0 || n >= size - at) throw InvalidMesh(fmt::format("the faces of polyhedron {} do not fit its numbers", c));
    stream.push_back(checked_id(n));
    for (vtkIdType k = 1; k <= n; ++k) stream.push_back(checked_id(faces->GetValue(at + k)));
    at += n + 1;
  }
  mesh.add_cell(CellType::polyhedron, stream);
}

/// Adds cell c of the grid, with its corners.
void add_cell(vtkUnstructuredGrid& grid, vtkIdType c, std::span<const vtkIdType> ids, ParsedMesh& parsed,
              Places& places) {
  int vtk = grid.GetCellTypesArray()->GetValue(c);
  MeshData& mesh = parsed.mesh;
  if (const int linear = linear_type(vtk); linear != vtk && parsed.linearise) {
    const Standard* corners = find_standard(linear);
    const std::size_t n = corners == nullptr ? 2 : corners->order.size();
    if (ids.size() < n) throw InvalidMesh(fmt::format("cell {} of VTK's type {} has {} points", c, vtk, ids.size()));
    take_higher_order(parsed, static_cast<std::size_t>(c));
    ids = ids.first(n);
    vtk = linear;
  }
  const Standard* standard = find_standard(vtk);
  const bool face = vtk == VTK_POLYGON || (standard != nullptr && standard->face);
  std::vector<std::uint32_t> corners;
  if (standard != nullptr) {
    if (ids.size() != standard->order.size()) {
      throw InvalidMesh(fmt::format("cell {} of VTK's type {} has {} corners instead of {}", c, vtk, ids.size(),
                                    standard->order.size()));
    }
    for (const int k : standard->order) corners.push_back(checked_id(ids[static_cast<std::size_t>(k)]));
  } else {
    for (const vtkIdType id : ids) corners.push_back(checked_id(id));
  }
  if (face) {
    mesh.add_patch_face(corners, 0);
    places.faces.push_back(static_cast<std::uint32_t>(c));
    return;
  }
  if (vtk == VTK_LINE || vtk == VTK_POLY_LINE) {
    for (std::size_t k = 1; k < corners.size(); ++k) {
      parsed.add_edge(corners[k - 1], corners[k], 0);
      places.edges.push_back(static_cast<std::uint32_t>(c));
    }
    return;
  }
  if (standard != nullptr) {
    mesh.add_cell(standard->type, corners);
  } else if (vtk == VTK_POLYHEDRON) {
    add_polyhedron(grid, c, mesh);
  } else {
    if (!is_point_or_line(vtk))
      (is_higher_order(vtk) ? parsed.second_order : parsed.unsupported).add(static_cast<std::size_t>(c));
    return;
  }
  places.cells.push_back(static_cast<std::uint32_t>(c));
}

Places copy_cells(vtkUnstructuredGrid& grid, ParsedMesh& parsed) {
  Places places;
  vtkCellArray* cells = grid.GetCells();
  const vtkIdType n = grid.GetNumberOfCells();
  if (n >= static_cast<vtkIdType>(no_point)) throw InvalidMesh("more than 2^32 - 2 cells");
  if (n > 0 && (cells == nullptr || grid.GetCellTypesArray() == nullptr ||
                grid.GetCellTypesArray()->GetNumberOfTuples() != n || !cells->IsValid())) {
    throw InvalidMesh("the cells' types or offsets do not fit the cells");
  }
  for (vtkIdType c = 0; c < n; ++c) {
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(c, size, ids);
    add_cell(grid, c, {ids, static_cast<std::size_t>(size)}, parsed, places);
  }
  return places;
}

DataArray copy_array(vtkDataArray& from, const std::vector<std::uint32_t>* rows) {
  DataArray to;
  to.name = from.GetName() == nullptr ? "" : from.GetName();
  to.components = static_cast<std::size_t>(from.GetNumberOfComponents());
  const std::size_t n = rows == nullptr ? static_cast<std::size_t>(from.GetNumberOfTuples()) : rows->size();
  to.values.reserve(n * to.components);
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<vtkIdType>(rows == nullptr ? i : (*rows)[i]);
    for (int k = 0; k < from.GetNumberOfComponents(); ++k) to.values.push_back(from.GetComponent(row, k));
  }
  return to;
}

/// Calls take(array) for the arrays that have a value for each of n items.
template <class Take>
void for_each_array(vtkFieldData& data, vtkIdType n, Take&& take) {
  for (int a = 0; a < data.GetNumberOfArrays(); ++a) {
    vtkDataArray* array = data.GetArray(a);
    if (array == nullptr || array->GetNumberOfComponents() < 1) continue;
    if (array->GetNumberOfTuples() != n) {
      throw InvalidMesh(fmt::format("array '{}' has {} items instead of {}",
                                    array->GetName() == nullptr ? "" : array->GetName(), array->GetNumberOfTuples(),
                                    n));
    }
    take(*array);
  }
}

ParsedMesh convert(vtkUnstructuredGrid& grid, std::string format, const ReadOptions& options) {
  ParsedMesh parsed;
  parsed.linearise = options.linearise;
  parsed.format = std::move(format);
  MeshData& mesh = parsed.mesh;
  copy_points(grid, mesh);
  Places places = copy_cells(grid, parsed);
  if (take_plane(parsed)) {
    places.cells = std::move(places.faces);
    places.faces = std::move(places.edges);
  }
  for_each_array(*grid.GetPointData(), grid.GetNumberOfPoints(),
                 [&](vtkDataArray& a) { mesh.point_data.push_back(copy_array(a, nullptr)); });
  for_each_array(*grid.GetCellData(), grid.GetNumberOfCells(),
                 [&](vtkDataArray& a) { mesh.cell_data.push_back(copy_array(a, &places.cells)); });
  if (copy_tags(grid, places, options.patch_array, mesh))
    std::erase_if(mesh.cell_data, [](const DataArray& a) { return a.name == "patch"; });
  const bool anything = !mesh.types.empty() || parsed.second_order.count + parsed.unsupported.count > 0;
  if (!anything) throw InvalidMesh("the file has no cells");
  mesh.source = places.cells;
  mesh.patch_source = places.faces;
  finish(parsed);
  return parsed;
}

/// Runs a VTK reader. Any complaint of it refuses the file.
template <class Reader>
ParsedMesh read_with(Reader& reader, const std::string& format, const ReadOptions& options) {
  const VtkErrors errors;
  const auto refuse = [&](const std::string& text) {
    throw InvalidMesh(fmt::format("VTK cannot read the file: {}", text));
  };
  try {
    reader.Update();
  } catch (const std::bad_alloc&) {
    refuse("an array is too large for this machine's memory");
  }
  if (!errors.first().empty()) refuse(errors.first());
  if (reader.GetErrorCode() != 0) refuse(fmt::format("error {}", reader.GetErrorCode()));
  if (reader.GetOutput() == nullptr) refuse("no output");
  return convert(*reader.GetOutput(), format, options);
}

}  // namespace

ParsedMesh parse_vtu(const std::filesystem::path& path, std::string_view content, const ReadOptions& options) {
  check_vtu(content, "UnstructuredGrid", options.max_memory);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  return read_with(*reader, "VTK XML (.vtu)", options);
}

ParsedMesh parse_legacy_vtk(const std::filesystem::path& path, std::string_view content, const ReadOptions& options) {
  if (from_first_word(content).starts_with("<"))
    throw InvalidMesh("this .vtk is one of VTK's XML files; rename it to .vtu");
  check_legacy_vtk(content, options.max_memory);
  vtkNew<vtkUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->ReadAllScalarsOn();
  reader->ReadAllVectorsOn();
  reader->ReadAllNormalsOn();
  reader->ReadAllTensorsOn();
  reader->ReadAllColorScalarsOn();
  reader->ReadAllTCoordsOn();
  reader->ReadAllFieldsOn();
  return read_with(*reader, "VTK legacy (.vtk)", options);
}

}  // namespace dartcast
