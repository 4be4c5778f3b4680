// Reads the faces of .vtp files: polygons and triangle strips, with the arrays at points and faces.
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/parsed_mesh.hpp"
#include "formats/vtk/vtk_errors.hpp"
#include "formats/vtk/vtp_read.hpp"
#include "formats/vtk/vtu_check.hpp"

namespace dartcast {

namespace {

std::uint32_t point_number(vtkIdType id) {
  return id >= 0 && id < static_cast<vtkIdType>(no_point) ? static_cast<std::uint32_t>(id) : no_point;
}

// The numbers of VTK's cells: vertices, lines, polygons, strips.
void read_faces(vtkPolyData& data, VtpFaces& out) {
  const vtkIdType first = data.GetNumberOfVerts() + data.GetNumberOfLines();
  std::vector<std::uint32_t> corners;
  const auto each = [](vtkCellArray& cells, auto&& visit) {
    for (vtkIdType c = 0; c < cells.GetNumberOfCells(); ++c) {
      vtkIdType size = 0;
      const vtkIdType* ids = nullptr;
      cells.GetCellAtId(c, size, ids);
      visit(c, ids, size);
    }
  };
  if (data.GetNumberOfStrips() > 0) throw InvalidMesh("triangle strips are not read: write triangles");
  if (data.GetPolys() == nullptr || !data.GetPolys()->IsValid())
    throw InvalidMesh("the faces do not fit their offsets");
  each(*data.GetPolys(), [&](vtkIdType c, const vtkIdType* ids, vtkIdType size) {
    corners.clear();
    for (vtkIdType k = 0; k < size; ++k) corners.push_back(point_number(ids[k]));
    out.faces.push_back(corners);
    out.rows.push_back(static_cast<std::size_t>(first + c));
  });
}

// The texts of an array's items, from the first name that there is.
void read_groups(vtkPolyData& data, VtpFaces& out) {
  vtkFieldData& arrays = *data.GetCellData();
  for (const char* name : {"patch", "region", "ModelFaceID"}) {
    vtkAbstractArray* array = arrays.GetAbstractArray(name);
    if (array == nullptr || array->GetNumberOfComponents() != 1) continue;
    if (array->GetNumberOfTuples() != data.GetNumberOfCells())
      throw InvalidMesh(fmt::format("array '{}' has {} items for {} cells", name, array->GetNumberOfTuples(),
                                    data.GetNumberOfCells()));
    for (const std::size_t row : out.rows)
      out.groups.push_back(array->GetVariantValue(static_cast<vtkIdType>(row)).ToString());
    return;
  }
}

void read_ids(vtkPolyData& data, VtpFaces& out) {
  vtkDataArray* ids = data.GetPointData()->GetArray("GlobalNodeID");
  if (ids == nullptr || ids->GetNumberOfTuples() != data.GetNumberOfPoints()) return;
  for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i) out.ids.push_back(ids->GetComponent(i, 0));
}

}  // namespace

VtpFaces read_vtp_faces(std::string_view content, std::uint64_t max_memory) {
  check_vtu(content, "PolyData", max_memory);
  const VtkErrors errors;
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->ReadFromInputStringOn();
  reader->SetInputString(std::string(content));
  reader->Update();
  vtkPolyData& data = *reader->GetOutput();
  if (reader->GetErrorCode() != 0 || !errors.first().empty() || data.GetPoints() == nullptr)
    throw InvalidMesh(errors.first().empty() ? "this is no .vtp file with points"
                                             : fmt::format("VTK cannot read the file: {}", errors.first()));
  VtpFaces out;
  for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
    double p[3];
    data.GetPoint(i, p);
    out.points.push_back({p[0], p[1], p[2]});
  }
  read_faces(data, out);
  read_groups(data, out);
  read_ids(data, out);
  return out;
}

}  // namespace dartcast
