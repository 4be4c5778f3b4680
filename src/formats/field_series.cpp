// Finds the files of a series.
#include "formats/field_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/xml_tags.hpp"
#include "simulation/scene_field.hpp"

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

}  // namespace dartcast
