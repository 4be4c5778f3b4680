// Reads points from .vtp and .csv files.
#include "formats/point_file.hpp"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <array>
#include <string_view>

#include "dartcast/error.hpp"
#include "formats/csv_table.hpp"
#include "formats/file_text.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk_errors.hpp"
#include "formats/vtu_check.hpp"

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

std::vector<Vec3> read_csv(const std::filesystem::path& path, const ReadOptions& options) {
  CsvTable table(path, options.max_memory);
  std::array<std::size_t, 3> columns{};
  for (std::size_t k = 0; k < 3; ++k) columns[k] = table.column(std::string_view("xyz").substr(k, 1), "x, y and z");
  const std::vector<double> values = table.rows(columns);
  std::vector<Vec3> points;
  for (std::size_t at = 0; at < values.size(); at += 3) points.push_back({values[at], values[at + 1], values[at + 2]});
  return points;
}

}  // namespace

PointFile read_points(const std::filesystem::path& path, const ReadOptions& options) {
  if (!std::filesystem::is_regular_file(path)) throw Error(fmt::format("{}: there is no such file", path.string()));
  if (path.extension() == ".vtp") return read_vtp(path, options);
  if (path.extension() == ".csv") return {read_csv(path, options), {}};
  throw Error(fmt::format("{}: points are read from .vtp and .csv files", path.string()));
}

}  // namespace dartcast
