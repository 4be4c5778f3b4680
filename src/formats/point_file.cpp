// Reads points from .vtp, .pvtp and .csv files.
#include "formats/point_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "dartcast/error.hpp"
#include "formats/csv_table.hpp"
#include "formats/file_text.hpp"
#include "formats/read_memory.hpp"
#include "formats/vtk.hpp"
#include "formats/xml_pieces.hpp"

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
  try {
    check_memory(memory_of_vtk({.file = file_bytes(path)}), options.max_memory);
    return read_vtp_points(read_bytes(path), options.max_memory);
  } catch (const InvalidMesh& e) {
    throw Error(fmt::format("{}: the points cannot be read: {}", path.string(), e.what()));
  }
}

// Behind the points and values of the pieces so far.
void append(const PointFile& piece, PointFile& all, const std::filesystem::path& path) {
  if (piece.points.empty()) return;
  if (all.points.empty())
    for (const DataArray& a : piece.arrays) all.arrays.push_back({a.name, a.components, {}});
  const bool same = std::equal(
      piece.arrays.begin(), piece.arrays.end(), all.arrays.begin(), all.arrays.end(),
      [](const DataArray& a, const DataArray& b) { return a.name == b.name && a.components == b.components; });
  if (!same) throw Error(fmt::format("{}: the piece has other arrays than those before it", path.string()));
  all.points.insert(all.points.end(), piece.points.begin(), piece.points.end());
  for (std::size_t k = 0; k < piece.arrays.size(); ++k) {
    const std::vector<double>& values = piece.arrays[k].values;
    all.arrays[k].values.insert(all.arrays[k].values.end(), values.begin(), values.end());
  }
}

// The pieces stand beside the file that names them.
PointFile read_pieces(const std::filesystem::path& path, const ReadOptions& options) {
  PointFile all;
  try {
    for (const auto& piece : named_pieces(path, read_bytes(path), ".vtp")) append(read_vtp(piece, options), all, piece);
  } catch (const InvalidMesh& e) {
    throw Error(fmt::format("{}: the points cannot be read: {}", path.string(), e.what()));
  }
  return all;
}

}  // namespace

PointFile read_points(const std::filesystem::path& path, const ReadOptions& options) {
  if (!std::filesystem::is_regular_file(path)) throw Error(fmt::format("{}: there is no such file", path.string()));
  if (path.extension() == ".vtp") return read_vtp(path, options);
  if (path.extension() == ".pvtp") return read_pieces(path, options);
  if (path.extension() == ".csv") return {read_csv(path, options), {}};
  throw Error(fmt::format("{}: points are read from .vtp, .pvtp and .csv files", path.string()));
}

}  // namespace dartcast
