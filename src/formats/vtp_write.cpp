// Writes points, lines and polygons with data as .vtp.
#include "formats/vtp_write.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include "dartcast/error.hpp"
#include "formats/vtk_errors.hpp"

namespace dartcast {

VtpWriter::VtpWriter(std::size_t count, const std::function<Vec3(std::size_t)>& point) : count_(count) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 x = point(i);
    points->SetPoint(static_cast<vtkIdType>(i), x.x, x.y, x.z);
  }
  data_->SetPoints(points);
}

void VtpWriter::add_vertices() {
  vtkNew<vtkCellArray> vertices;
  for (std::size_t i = 0; i < count_; ++i) {
    const auto id = static_cast<vtkIdType>(i);
    vertices->InsertNextCell(1, &id);
  }
  data_->SetVerts(vertices);
}

void VtpWriter::add_line() {
  vtkNew<vtkCellArray> lines;
  if (count_ > 0) lines->InsertNextCell(static_cast<int>(count_));
  for (std::size_t i = 0; i < count_; ++i) lines->InsertCellPoint(static_cast<vtkIdType>(i));
  data_->SetLines(lines);
}

void VtpWriter::add_polygons(std::span<const std::size_t> offsets, std::span<const std::uint32_t> corners) {
  vtkNew<vtkCellArray> polygons;
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    polygons->InsertNextCell(static_cast<int>(offsets[i + 1] - offsets[i]));
    for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k) polygons->InsertCellPoint(corners[k]);
  }
  data_->SetPolys(polygons);
}

void VtpWriter::add(const std::string& name, const std::function<double(std::size_t)>& value) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfTuples(static_cast<vtkIdType>(count_));
  double* out = array->GetPointer(0);
  for (std::size_t i = 0; i < count_; ++i) out[i] = value(i);
  data_->GetPointData()->AddArray(array);
}

void VtpWriter::add_flags(const std::string& name, const std::function<bool(std::size_t)>& flag) {
  vtkNew<vtkUnsignedCharArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfTuples(static_cast<vtkIdType>(count_));
  unsigned char* out = array->GetPointer(0);
  for (std::size_t i = 0; i < count_; ++i) out[i] = flag(i) ? 1 : 0;
  data_->GetPointData()->AddArray(array);
}

void VtpWriter::add_vectors(const std::string& name, const std::function<Vec3(std::size_t)>& value) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(count_));
  double* out = array->GetPointer(0);
  for (std::size_t i = 0; i < count_; ++i) {
    const Vec3 v = value(i);
    out[3 * i] = v.x;
    out[3 * i + 1] = v.y;
    out[3 * i + 2] = v.z;
  }
  data_->GetPointData()->AddArray(array);
}

void VtpWriter::write(const std::filesystem::path& path) const {
  const VtkErrors errors;
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(data_);
  writer->EncodeAppendedDataOff();
  if (writer->Write() != 1 || writer->GetErrorCode() != 0 || !errors.first().empty()) {
    throw Error(fmt::format("{}: the file cannot be written; check the folder and the disk's space", path.string()));
  }
}

}  // namespace dartcast
