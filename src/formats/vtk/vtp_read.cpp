// Reads points from .vtp files, after a check of their content.
#include "formats/vtk/vtp_read.hpp"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk/vtk_errors.hpp"
#include "formats/vtk/vtu_check.hpp"

namespace dartcast {

namespace {

DataArray to_array(vtkDataArray& from) {
  DataArray array{
      from.GetName() != nullptr ? from.GetName() : "", static_cast<std::size_t>(from.GetNumberOfComponents()), {}};
  for (vtkIdType i = 0; i < from.GetNumberOfTuples(); ++i) {
    for (int k = 0; k < from.GetNumberOfComponents(); ++k) array.values.push_back(from.GetComponent(i, k));
  }
  return array;
}

// Calls check(), and adds the file's name to its errors.
template <class Check>
void with_file_name(const std::filesystem::path& path, Check&& check) {
  try {
    check();
  } catch (const InvalidMesh& e) {
    throw Error(fmt::format("{}: the points cannot be read: {}", path.string(), e.what()));
  }
}

}  // namespace

PointFile read_vtp(const std::filesystem::path& path, const ReadOptions& options) {
  with_file_name(path, [&] {
    check_memory(memory_of_vtk({.file = 2 * file_bytes(path)}), options.max_memory);
    check_vtu(read_bytes(path), "PolyData", options.max_memory);
  });
  const VtkErrors errors;
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkPolyData& data = *reader->GetOutput();
  vtkPoints* points = data.GetPoints();
  if (reader->GetErrorCode() != 0 || !errors.first().empty() || points == nullptr) {
    throw Error(fmt::format("{}: the points cannot be read: {}", path.string(),
                            errors.first().empty() ? "this is no .vtp file with points" : errors.first()));
  }
  PointFile file;
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i) {
    const double* p = points->GetPoint(i);
    file.points.push_back({p[0], p[1], p[2]});
  }
  for (int i = 0; i < data.GetPointData()->GetNumberOfArrays(); ++i) {
    if (vtkDataArray* array = data.GetPointData()->GetArray(i)) file.arrays.push_back(to_array(*array));
  }
  return file;
}

}  // namespace dartcast
