// Reads points from .vtp and .csv files.
#include "formats/point_file.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "dartcast/error.hpp"
#include "formats/csv_table.hpp"
#include "formats/vtk_functions.hpp"

namespace dartcast {

namespace {

std::vector<Vec3> read_csv(const std::filesystem::path& path, const ReadOptions& options) {
  CsvTable table(path, options.max_memory);
  std::array<std::size_t, 3> columns{};
  for (std::size_t k = 0; k < 3; ++k) columns[k] = table.column(std::string_view("xyz").substr(k, 1), "x, y and z");
  const std::vector<double> values = table.rows(columns);
  std::vector<Vec3> points;
  for (std::size_t at = 0; at < values.size(); at += 3) points.push_back({values[at], values[at + 1], values[at + 2]});
  return points;
}

PointFile read_vtp(const std::filesystem::path& path, const ReadOptions& options) {
  if (vtk_functions.read_vtp == nullptr)
    throw Error(fmt::format("{}: {}", path.string(), needs_vtk("read .vtp files", "write the points to a .csv file")));
  return vtk_functions.read_vtp(path, options);
}

}  // namespace

PointFile read_points(const std::filesystem::path& path, const ReadOptions& options) {
  if (!std::filesystem::is_regular_file(path)) throw Error(fmt::format("{}: there is no such file", path.string()));
  if (path.extension() == ".vtp") return read_vtp(path, options);
  if (path.extension() == ".csv") return {read_csv(path, options), {}};
  throw Error(fmt::format("{}: points are read from .vtp and .csv files", path.string()));
}

}  // namespace dartcast
