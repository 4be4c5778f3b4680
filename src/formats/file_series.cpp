// Finds the files of a series.
#include "formats/file_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/format_table.hpp"
#include "formats/openfoam.hpp"
#include "formats/xml_tags.hpp"
#include "simulation/series.hpp"

namespace dartcast {

namespace {

double time_of(const XmlTag& tag) {
  const std::string text = tag.attribute("timestep", "");
  if (text.empty()) tag.fail("a DataSet has no timestep");
  double time = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(time))
    tag.fail(fmt::format("timestep \"{}\" is not a finite number", text));
  return time;
}

void add_dataset(const XmlTag& tag, const std::filesystem::path& folder, FieldSeries& series) {
  const std::string file = tag.attribute("file", "");
  if (file.empty()) tag.fail("a DataSet has no file");
  const double time = time_of(tag);
  if (!series.times.empty() && time == series.times.back())
    tag.fail(fmt::format("two files at the time {}: collections of several parts are not supported", time));
  if (!series.times.empty() && time < series.times.back())
    tag.fail(fmt::format("the time {} stands after {}: times must increase", time, series.times.back()));
  series.files.push_back(folder / file);
  series.times.push_back(time);
}

/// The series that has times of its own; no files if it has none.
FieldSeries series_with_times(const NamedSeries& named) {
  const std::filesystem::path& first = named.files.front();
  if (named.files.size() != 1) return {};
  if (ending_of(first) == ".pvd") return read_pvd(first);
  if (is_openfoam_case(first)) return named.array.empty() ? openfoam_points(first) : openfoam_field(first, named.array);
  return {};
}

}  // namespace

FieldSeries numbered_files(const std::filesystem::path& pattern) {
  const std::string name = pattern.filename().string();
  const std::filesystem::path folder = pattern.has_parent_path() ? pattern.parent_path() : ".";
  if (std::count(name.begin(), name.end(), '*') != 1)
    throw Error(fmt::format("{}: give one star, in the file's name, for the number", pattern.string()));
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    names.push_back(entry.path().filename().string());
  }
  FieldSeries series;
  for (const std::string& file : numbered(name, names)) series.files.push_back(folder / file);
  if (series.files.empty())
    throw Error(fmt::format("{}: there is no file with a whole number in place of the star", pattern.string()));
  return series;
}

FieldSeries read_pvd(const std::filesystem::path& path) {
  FieldSeries series;
  try {
    const std::string content = read_bytes(path);
    read_xml(content, [&](const XmlTag& tag) {
      if (tag.name == "DataSet" && tag.opens) add_dataset(tag, path.parent_path(), series);
    });
    if (series.files.empty()) throw InvalidMesh("the collection has no DataSet");
  } catch (const InvalidMesh& e) {
    throw Error(fmt::format("{}: the collection cannot be read: {}", path.string(), e.what()));
  }
  return series;
}

void check_exist(std::span<const std::filesystem::path> files) {
  for (const std::filesystem::path& file : files) {
    if (!std::filesystem::is_regular_file(file) && !is_openfoam(file))
      throw InvalidMesh(fmt::format("{}: no such file", file.string()));
  }
}

bool names_series(const std::filesystem::path& file) {
  // A case, whether it is there or not.
  const bool folder = mesh_format_of(file) == nullptr && ending_of(file) != ".vtp";
  return is_pattern(file.filename().string()) || ending_of(file) == ".pvd" || folder;
}

FieldSeries file_series(const NamedSeries& named) {
  const std::filesystem::path& first = named.files.front();
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
