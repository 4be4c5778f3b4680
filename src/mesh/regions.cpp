// Selects the free cells of a mesh, by region or by values of an array.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "dartcast/error.hpp"
#include "dartcast/mesh_selection.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {
namespace {

std::string name_of(const MeshData& mesh, std::int32_t tag) {
  const auto name = mesh.region_names.find(tag);
  return name == mesh.region_names.end() ? std::to_string(tag) : fmt::format("{} ({})", name->second, tag);
}

// The tags of the named regions.
std::set<std::int32_t> tags_of(const MeshData& mesh, std::span<const std::string> regions) {
  std::set<std::int32_t> present;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) present.insert(region_of(mesh, c));
  std::set<std::int32_t> wanted;
  for (const std::string& region : regions) {
    const std::size_t before = wanted.size();
    for (const std::int32_t tag : present) {
      const auto name = mesh.region_names.find(tag);
      const bool named = name != mesh.region_names.end() && name->second == region;
      if (named || std::to_string(tag) == region) wanted.insert(tag);
    }
    if (wanted.size() == before) {
      std::vector<std::string> names;
      for (const std::int32_t tag : present) names.push_back(name_of(mesh, tag));
      throw InvalidMesh(
          fmt::format("the mesh has no region '{}'; its regions are: {}", region, fmt::join(names, ", ")));
    }
  }
  return wanted;
}

}  // namespace

std::vector<std::uint32_t> cells_of_region(const MeshData& mesh, const std::string& region) {
  const std::set<std::int32_t> wanted = tags_of(mesh, {&region, 1});
  std::vector<std::uint32_t> cells;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (wanted.count(region_of(mesh, c)) > 0) cells.push_back(static_cast<std::uint32_t>(c));
  }
  return cells;
}

void select_free_regions(MeshData& mesh, std::span<const std::string> regions) {
  const std::set<std::int32_t> wanted = tags_of(mesh, regions);
  std::vector<std::uint8_t> free(mesh.cell_count());
  for (std::size_t c = 0; c < free.size(); ++c) free[c] = wanted.count(region_of(mesh, c)) > 0 ? 1 : 0;
  mesh.free = std::move(free);
}

void select_free_values(MeshData& mesh, const std::string& array, std::span<const double> values) {
  const auto found = std::find_if(mesh.cell_data.begin(), mesh.cell_data.end(),
                                  [&](const DataArray& a) { return a.name == array && a.components == 1; });
  if (found == mesh.cell_data.end()) {
    std::vector<std::string> names;
    for (const DataArray& a : mesh.cell_data) names.push_back(a.name);
    throw InvalidMesh(fmt::format("the mesh has no cell array '{}' of one component; its cell arrays are: {}", array,
                                  names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  std::vector<std::uint8_t> free(mesh.cell_count());
  for (std::size_t c = 0; c < free.size(); ++c) {
    free[c] = std::find(values.begin(), values.end(), found->values[c]) != values.end() ? 1 : 0;
  }
  if (std::find(free.begin(), free.end(), 1) == free.end()) {
    throw InvalidMesh(fmt::format("no cell has one of the values {} in array '{}'", fmt::join(values, ", "), array));
  }
  mesh.free = std::move(free);
}

}  // namespace dartcast
