// Finds the files of a series, whatever names them.
#include "scene/file_series.hpp"

#include <fmt/format.h>

#include <cmath>

#include "dartcast/error.hpp"
#include "formats/format_table.hpp"
#include "formats/openfoam.hpp"
#include "simulation/scene_field.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;

/// The series that has times of its own; no files where it has none.
FieldSeries series_with_times(const NamedSeries& named) {
  const fs::path& first = named.files.front();
  if (named.files.size() != 1) return {};
  if (ending_of(first) == ".pvd") return read_pvd(first);
  if (is_openfoam_case(first)) return named.array.empty() ? openfoam_points(first) : openfoam_field(first, named.array);
  return {};
}

}  // namespace

void check_exist(std::span<const fs::path> files) {
  for (const fs::path& file : files) {
    if (!fs::is_regular_file(file) && !is_openfoam(file))
      throw InvalidMesh(fmt::format("{}: no such file", file.string()));
  }
}

bool names_series(const fs::path& file) {
  // A case, whether it is there or not.
  const bool folder = mesh_format_of(file) == nullptr && ending_of(file) != ".vtp";
  return is_pattern(file.filename().string()) || ending_of(file) == ".pvd" || folder;
}

FieldSeries file_series(const NamedSeries& named) {
  const fs::path& first = named.files.front();
  FieldSeries series = series_with_times(named);
  if (!series.files.empty()) {
    if (!named.times.empty() || named.spacing > 0.0)
      throw InvalidArgument(fmt::format("{} has times of its own: leave out times and spacing", first.string()));
  } else {
    series = named.files.size() == 1 && is_pattern(first.filename().string()) ? numbered_files(first)
                                                                              : FieldSeries{named.files, {}};
    series.times = sample_times(named.owner, named.times, named.spacing, series.files.size(), "files");
  }
  for (std::size_t k = 0; k < series.times.size(); ++k) {
    if (std::isfinite(series.times[k]) && (k == 0 || series.times[k] > series.times[k - 1])) continue;
    throw InvalidArgument(fmt::format("{}: its time {} must be finite and after that of the file before it",
                                      series.files[k].string(), series.times[k]));
  }
  return series;
}

}  // namespace dartcast
