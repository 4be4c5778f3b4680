// Finds the arrays of a scene's field in its mesh.
#include "simulation/scene_field.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

constexpr std::size_t components = 3;

const DataArray* find_array(const std::vector<DataArray>& arrays, const std::string& name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(),
                                  [&](const DataArray& a) { return a.name == name && a.components == components; });
  return found != arrays.end() ? &*found : nullptr;
}

std::string list_of(const std::vector<DataArray>& arrays) {
  std::vector<std::string> known;
  for (const DataArray& a : arrays) known.push_back(fmt::format("{} ({})", a.name, a.components));
  return known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "));
}

[[noreturn]] void throw_missing(const MeshData& mesh, const std::string& name, std::optional<FieldPlace> at) {
  const bool points = at != FieldPlace::cells;
  const bool cells = at != FieldPlace::points;
  std::string message = fmt::format("the mesh has no {} array '{}' of {} components",
                                    points && cells ? "point or cell" : (points ? "point" : "cell"), name, components);
  if (points) message += fmt::format("; its point arrays (components) are: {}", list_of(mesh.point_data));
  if (cells) message += fmt::format("; its cell arrays (components) are: {}", list_of(mesh.cell_data));
  throw InvalidMesh(message);
}

const DataArray& array_of(const MeshData& mesh, const std::string& name, std::optional<FieldPlace> at,
                          FieldPlace& place) {
  place = FieldPlace::points;
  if (at != FieldPlace::cells) {
    if (const DataArray* found = find_array(mesh.point_data, name)) return *found;
  }
  place = FieldPlace::cells;
  if (at != FieldPlace::points) {
    if (const DataArray* found = find_array(mesh.cell_data, name)) return *found;
  }
  throw_missing(mesh, name, at);
}

std::vector<std::string> names_of(const MeshData& mesh, const FieldScene& scene) {
  if (!is_pattern(scene.array)) return {scene.array};
  std::vector<std::string> all;
  const auto add = [&](const std::vector<DataArray>& arrays) {
    for (const DataArray& a : arrays) {
      if (a.components == components && all.end() == std::find(all.begin(), all.end(), a.name)) all.push_back(a.name);
    }
  };
  if (scene.at != FieldPlace::cells) add(mesh.point_data);
  if (scene.at != FieldPlace::points) add(mesh.cell_data);
  std::vector<std::string> names = numbered(scene.array, all);
  if (names.empty()) throw_missing(mesh, scene.array, scene.at);
  return names;
}

/// The digits that stand in place of the star; empty where the name does not fit.
std::string_view number_in(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  const std::string_view before = pattern.substr(0, star);
  const std::string_view after = pattern.substr(star + 1);
  if (name.size() < pattern.size() || !name.starts_with(before) || !name.ends_with(after)) return {};
  const std::string_view number = name.substr(star, name.size() + 1 - pattern.size());
  return number.find_first_not_of("0123456789") == std::string_view::npos ? number : std::string_view();
}

}  // namespace

bool is_pattern(std::string_view name) { return name.find('*') != std::string_view::npos; }

std::vector<std::string> numbered(std::string_view pattern, const std::vector<std::string>& names) {
  struct Entry {
    std::string_view digits;  // without zeros in front
    std::string name;
  };
  std::vector<Entry> entries;
  for (const std::string& name : names) {
    std::string_view digits = number_in(pattern, name);
    if (digits.empty()) continue;
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    entries.push_back({digits, name});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    if (a.digits.size() != b.digits.size()) return a.digits.size() < b.digits.size();
    return a.digits != b.digits ? a.digits < b.digits : a.name < b.name;
  });
  std::vector<std::string> result;
  for (Entry& e : entries) result.push_back(std::move(e.name));
  return result;
}

std::vector<Vec3> field_values(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at) {
  FieldPlace place = FieldPlace::points;
  const std::vector<double>& values = array_of(mesh, array, at, place).values;
  std::vector<Vec3> result(values.size() / components);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return result;
}

FieldPlace field_place(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at) {
  FieldPlace place = FieldPlace::points;
  array_of(mesh, array, at, place);
  return place;
}

std::vector<double> sample_times(std::string_view owner, const std::vector<double>& times, double spacing,
                                 std::size_t count, std::string_view items) {
  if (!times.empty()) {
    if (times.size() != count)
      throw InvalidArgument(
          fmt::format("{} has {} times for {} {}: give one for each", owner, times.size(), count, items));
    return times;
  }
  if (count > 1 && !(spacing > 0.0))
    throw InvalidArgument(fmt::format("{} has {} {}, but no times: give times or spacing", owner, count, items));
  std::vector<double> result(count);
  for (std::size_t k = 0; k < count; ++k) result[k] = static_cast<double>(k) * spacing;
  return result;
}

FieldSamples field_samples_of(const FieldScene& scene, const MeshData& mesh) {
  const std::vector<std::string> names = names_of(mesh, scene);
  const FieldPlace place = field_place(mesh, names.front(), scene.at);
  std::vector<std::vector<Vec3>> values;
  for (const std::string& name : names) values.push_back(field_values(mesh, name, place));
  std::vector<double> times =
      sample_times(fmt::format("the field '{}'", scene.array), scene.times, scene.spacing, names.size(), "arrays");
  FieldSamples samples = field_samples(std::move(times), std::move(values), place, scene.period);
  samples.interpolation = scene.interpolation;
  return samples;
}

std::optional<VectorField> scene_field(const FieldScene& scene, const std::string& name, const MeshData& mesh,
                                       const CellComplex& complex) {
  if (!scene.given()) return {};
  if (!scene.samples.read && !scene.files.empty())
    throw InvalidArgument(name + "'s files have not been read; call load_scene_files() first");
  FieldSamples samples = scene.samples.read ? scene.samples : field_samples_of(scene, mesh);
  samples.name = name;
  return VectorField(complex, std::move(samples), scene.frame);
}

}  // namespace dartcast
