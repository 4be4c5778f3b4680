// Writes legacy .vtk: a VTK grid from the mesh, then VTK's writer.
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>

#include <algorithm>
#include <array>
#include <string>

#include "dartcast/error.hpp"
#include "formats/vtk/vtk_errors.hpp"
#include "formats/vtk/vtk_mesh.hpp"
#include "formats/vtu_write.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

int vtk_type(CellType type) {
  static constexpr std::array<int, 8> types = {VTK_TETRA,      VTK_HEXAHEDRON, VTK_WEDGE, VTK_PYRAMID,
                                               VTK_POLYHEDRON, VTK_TRIANGLE,   VTK_QUAD,  VTK_POLYGON};
  return types[static_cast<std::size_t>(type)];
}

void add_polyhedron(vtkUnstructuredGrid& grid, std::span<const std::uint32_t> stream) {
  std::vector<vtkIdType> faces;
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < stream[0]; ++f) {
    for (std::size_t k = 0; k <= stream[at]; ++k) faces.push_back(stream[at + k]);
    at += stream[at] + 1;
  }
  grid.InsertNextCell(VTK_POLYHEDRON, static_cast<vtkIdType>(stream[0]), faces.data());
}

void add_cells(const MeshData& mesh, vtkUnstructuredGrid& grid) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto corners = mesh.cell(c);
    if (mesh.types[c] == CellType::polyhedron) {
      add_polyhedron(grid, corners);
      continue;
    }
    std::vector<vtkIdType> ids(corners.begin(), corners.end());
    if (mesh.types[c] == CellType::prism) {
      std::swap(ids[1], ids[2]);
      std::swap(ids[4], ids[5]);
    }
    grid.InsertNextCell(vtk_type(mesh.types[c]), static_cast<vtkIdType>(corners.size()), ids.data());
  }
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::vector<vtkIdType> ids(mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f]),
                                     mesh.patch_faces.begin() + static_cast<std::ptrdiff_t>(mesh.patch_offsets[f + 1]));
    static constexpr std::array<int, 5> types = {0, 0, VTK_LINE, VTK_TRIANGLE, VTK_QUAD};
    grid.InsertNextCell(ids.size() < types.size() ? types[ids.size()] : VTK_POLYGON, static_cast<vtkIdType>(ids.size()),
                        ids.data());
  }
}

/// An array with a row of zeros for each item that it has no values for.
void add_array(vtkFieldData& to, const DataArray& from, vtkIdType items) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(from.name.c_str());
  array->SetNumberOfComponents(static_cast<int>(from.components));
  array->SetNumberOfTuples(items);
  array->Fill(0.0);
  for (std::size_t i = 0; i < from.values.size(); ++i) array->SetValue(static_cast<vtkIdType>(i), from.values[i]);
  to.AddArray(array);
}

/// Adds regions at the cells, and tags of patches at the patch faces, which come after them.
void add_tags(const MeshData& mesh, vtkUnstructuredGrid& grid) {
  const auto add = [&](const char* name, auto&& cell_tag, auto&& face_tag) {
    vtkNew<vtkIntArray> array;
    array->SetName(name);
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) array->InsertNextValue(cell_tag(c));
    for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) array->InsertNextValue(face_tag(f));
    grid.GetCellData()->AddArray(array);
  };
  const auto none = [](std::size_t) { return 0; };
  if (!mesh.regions.empty())
    add(
        "region", [&](std::size_t c) { return mesh.regions[c]; }, none);
  if (!mesh.patch_tags.empty()) add("patch", none, [&](std::size_t f) { return mesh.patch_tags[f]; });
}

vtkSmartPointer<vtkUnstructuredGrid> make_grid(const MeshData& mesh) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.points.size()));
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    points->SetPoint(static_cast<vtkIdType>(p), mesh.points[p].x, mesh.points[p].y, mesh.points[p].z);
  }
  grid->SetPoints(points);
  grid->AllocateEstimate(static_cast<vtkIdType>(mesh.cell_count()) + static_cast<vtkIdType>(mesh.patch_tags.size()), 8);
  add_cells(mesh, *grid);
  for (const DataArray& a : mesh.point_data) add_array(*grid->GetPointData(), a, grid->GetNumberOfPoints());
  for (const DataArray& a : mesh.cell_data) {
    if (!is_replaced(mesh, a.name)) add_array(*grid->GetCellData(), a, grid->GetNumberOfCells());
  }
  if (!mesh.free.empty()) {
    add_array(*grid->GetCellData(), DataArray{"free", 1, {mesh.free.begin(), mesh.free.end()}},
              grid->GetNumberOfCells());
  }
  add_tags(mesh, *grid);
  return grid;
}

}  // namespace

void write_legacy_vtk(const MeshData& mesh, const std::filesystem::path& path) {
  const VtkErrors errors;
  vtkNew<vtkUnstructuredGridWriter> writer;
  writer->SetFileTypeToBinary();
  writer->SetFileName(path.c_str());
  writer->SetInputData(make_grid(mesh));
  if (writer->Write() != 1 || writer->GetErrorCode() != 0 || !errors.first().empty()) {
    throw Error(fmt::format(
        "{}: the file cannot be written; {}", path.string(),
        errors.first().empty() ? "check the folder, its permissions and the disk's space" : errors.first()));
  }
}

}  // namespace dartcast
