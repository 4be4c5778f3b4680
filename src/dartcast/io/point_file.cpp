#include "dartcast/io/point_file.hpp"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "dartcast/base/error.hpp"
#include "dartcast/io/file_text.hpp"
#include "dartcast/io/read_memory.hpp"
#include "dartcast/io/vtk_errors.hpp"
#include "dartcast/io/vtu_check.hpp"

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

// Calls check(); refusals get the file's name.
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

// The fields of a line between commas, without the blanks and quotes around them.
std::vector<std::string_view> fields(std::string_view line) {
  std::vector<std::string_view> result;
  constexpr std::string_view around = " \t\r\"";
  while (true) {
    const std::size_t end = line.find(',');
    std::string_view field = line.substr(0, end);
    field.remove_prefix(std::min(field.find_first_not_of(around), field.size()));
    field = field.substr(0, field.find_last_not_of(around) + 1);
    result.push_back(field);
    if (end == std::string_view::npos) return result;
    line.remove_prefix(end + 1);
  }
}

std::array<std::size_t, 3> find_columns(const std::filesystem::path& path, const std::string& header) {
  std::array<std::size_t, 3> columns{};
  const auto names = fields(header);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string_view name = std::string_view("xyz").substr(k, 1);
    while (columns[k] < names.size() && names[columns[k]] != name) ++columns[k];
    if (columns[k] == names.size()) {
      throw Error(fmt::format("{}:1: there is no column '{}'; the first line must name the columns x, y and z",
                              path.string(), name));
    }
  }
  return columns;
}

std::vector<Vec3> read_csv(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) throw Error(fmt::format("{}: the file cannot be read, or is empty", path.string()));
  const auto columns = find_columns(path, line);
  std::vector<Vec3> result;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto values = fields(line);
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string_view text = columns[k] < values.size() ? values[columns[k]] : std::string_view();
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), p[k]);
      if (error != std::errc() || end != text.data() + text.size() || text.empty()) {
        throw Error(fmt::format("{}:{}: '{}' is not a number", path.string(), number, text));
      }
    }
    result.push_back({p[0], p[1], p[2]});
  }
  return result;
}

}  // namespace

PointFile read_points(const std::filesystem::path& path, const ReadOptions& options) {
  if (!std::filesystem::is_regular_file(path)) throw Error(fmt::format("{}: there is no such file", path.string()));
  if (path.extension() == ".vtp") return read_vtp(path, options);
  if (path.extension() == ".csv") {
    with_file_name(path, [&] { check_memory(memory_of_text(file_bytes(path)), options.max_memory); });
    return {read_csv(path), {}};
  }
  throw Error(fmt::format("{}: points are read from .vtp and .csv files", path.string()));
}

}  // namespace dartcast
