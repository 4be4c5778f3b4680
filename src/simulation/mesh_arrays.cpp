// Finds the arrays of a mesh that a scene names.
#include "simulation/mesh_arrays.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "dartcast/error.hpp"
#include "mesh/point_weights.hpp"
#include "simulation/series.hpp"

namespace dartcast {

namespace {

const DataArray* find_array(const std::vector<DataArray>& arrays, const std::string& name, std::size_t components) {
  const auto found = std::find_if(arrays.begin(), arrays.end(),
                                  [&](const DataArray& a) { return a.name == name && a.components == components; });
  return found != arrays.end() ? &*found : nullptr;
}

std::string list_of(const std::vector<DataArray>& arrays) {
  std::vector<std::string> known;
  for (const DataArray& a : arrays) known.push_back(fmt::format("{} ({})", a.name, a.components));
  return known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "));
}

[[noreturn]] void throw_missing(const MeshData& mesh, const std::string& name, std::optional<FieldPlace> at,
                                std::size_t components) {
  const bool points = at != FieldPlace::cells;
  const bool cells = at != FieldPlace::points;
  std::string message = fmt::format("the mesh has no {} array '{}' of {} components",
                                    points && cells ? "point or cell" : (points ? "point" : "cell"), name, components);
  if (points) message += fmt::format("; its point arrays (components) are: {}", list_of(mesh.point_data));
  if (cells) message += fmt::format("; its cell arrays (components) are: {}", list_of(mesh.cell_data));
  throw InvalidMesh(message);
}

// Points come first.
std::pair<const DataArray&, FieldPlace> array_of(const MeshData& mesh, const std::string& name,
                                                 std::optional<FieldPlace> at, std::size_t components = 3) {
  if (at != FieldPlace::cells) {
    if (const DataArray* found = find_array(mesh.point_data, name, components)) return {*found, FieldPlace::points};
  }
  if (at != FieldPlace::points) {
    if (const DataArray* found = find_array(mesh.cell_data, name, components)) return {*found, FieldPlace::cells};
  }
  throw_missing(mesh, name, at, components);
}

std::vector<Vec3> as_vectors(std::span<const double> values) {
  std::vector<Vec3> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return result;
}

// Arrays of a mesh. Those at cells are brought to the points if they are wanted there; the weights are made once.
class PlacedArrays {
 public:
  PlacedArrays(const MeshData& mesh, std::optional<FieldPlace> at) : mesh_(mesh), at_(at) {}

  [[nodiscard]] FieldPlace place(const std::string& name, std::size_t components = 3) const {
    return from_cells(name, components) != nullptr ? FieldPlace::points : array_of(mesh_, name, at_, components).second;
  }
  std::vector<double> values(const std::string& name, std::size_t components = 3) {
    const DataArray* const cells = from_cells(name, components);
    if (cells == nullptr) return array_of(mesh_, name, at_, components).first.values;
    if (!weights_) weights_ = weights_of_cells(mesh_);
    return values_at_points(*weights_, cells->values, components);
  }

 private:
  [[nodiscard]] const DataArray* from_cells(const std::string& name, std::size_t components) const {
    const bool wanted = at_ == FieldPlace::points && find_array(mesh_.point_data, name, components) == nullptr;
    return wanted ? find_array(mesh_.cell_data, name, components) : nullptr;
  }

  const MeshData& mesh_;
  std::optional<FieldPlace> at_;
  std::optional<PointWeights> weights_;
};

std::vector<std::string> names_of(const MeshData& mesh, const FieldScene& scene) {
  if (!is_pattern(scene.array)) return {scene.array};
  std::vector<std::string> all;
  const auto add = [&](const std::vector<DataArray>& arrays) {
    for (const DataArray& a : arrays) {
      if (a.components == 3 && all.end() == std::find(all.begin(), all.end(), a.name)) all.push_back(a.name);
    }
  };
  if (scene.at != FieldPlace::cells) add(mesh.point_data);
  add(mesh.cell_data);
  std::vector<std::string> names = numbered(scene.array, all);
  if (names.empty()) throw_missing(mesh, scene.array, scene.at, 3);
  return names;
}

}  // namespace

const std::vector<double>& point_values(const MeshData& mesh, const std::string& array, std::size_t components) {
  return array_of(mesh, array, FieldPlace::points, components).first.values;
}

std::vector<Vec3> field_values(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at) {
  return as_vectors(PlacedArrays(mesh, at).values(array));
}

FieldPlace field_place(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at) {
  return PlacedArrays(mesh, at).place(array);
}

FieldSamples field_samples_of(const FieldScene& scene, const MeshData& mesh) {
  const std::vector<std::string> names = names_of(mesh, scene);
  const FieldPlace place = field_place(mesh, names.front(), scene.at);
  PlacedArrays arrays(mesh, place);
  std::vector<std::vector<Vec3>> values;
  for (const std::string& name : names) values.push_back(as_vectors(arrays.values(name)));
  std::vector<double> times =
      sample_times(fmt::format("the field '{}'", scene.array), scene.times, scene.spacing, names.size(), "arrays");
  FieldSamples samples = field_samples(std::move(times), std::move(values), place, scene.period);
  samples.interpolation = scene.interpolation;
  return samples;
}

std::string component_name(const std::string& array, std::size_t components, std::size_t k) {
  constexpr const char* axes[] = {"x", "y", "z"};
  constexpr const char* symmetric[] = {"xx", "xy", "xz", "yy", "yz", "zz"};
  switch (components) {
    case 1: return array;
    case 3: return fmt::format("{}_{}", array, axes[k]);
    case 6: return fmt::format("{}_{}", array, symmetric[k]);
    case 9: return fmt::format("{}_{}{}", array, axes[k / 3], axes[k % 3]);
    default: return fmt::format("{}_{}", array, k);
  }
}

ArrayInMesh array_in_mesh(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at) {
  const auto named = [&](const DataArray& a) { return a.name == array; };
  const DataArray* found = nullptr;
  const auto look = [&](const std::vector<DataArray>& arrays) {
    const auto it = std::find_if(arrays.begin(), arrays.end(), named);
    if (found == nullptr && it != arrays.end()) found = &*it;
  };
  if (at != FieldPlace::cells) look(mesh.point_data);
  look(mesh.cell_data);
  if (found == nullptr || found->components == 0)
    throw InvalidMesh(
        fmt::format("the mesh has no array '{}'; its point arrays (components) are: {}; its cell arrays: {}", array,
                    list_of(mesh.point_data), list_of(mesh.cell_data)));
  PlacedArrays arrays(mesh, at);
  return {found->components, arrays.place(array, found->components), arrays.values(array, found->components)};
}

std::vector<Vec3> three_components(const ArrayInMesh& array, std::size_t part) {
  const std::size_t first = 3 * part;
  std::vector<Vec3> out(array.values.size() / array.components);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto at = [&](std::size_t k) { return k < array.components ? array.values[i * array.components + k] : 0.0; };
    out[i] = {at(first), at(first + 1), at(first + 2)};
  }
  return out;
}

ArraySamples array_samples_of(const MeshData& mesh, const std::string& array, std::optional<FieldPlace> at) {
  const ArrayInMesh found = array_in_mesh(mesh, array, at);
  ArraySamples samples{array, found.components, {}};
  for (std::size_t part = 0; 3 * part < found.components; ++part) {
    samples.parts.push_back(field_samples({0.0}, {three_components(found, part)}, found.place));
    samples.parts.back().vectors = false;
  }
  return samples;
}

}  // namespace dartcast
