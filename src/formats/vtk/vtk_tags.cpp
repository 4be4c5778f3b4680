// Regions and patches of a VTK grid, from its cell arrays.
#include "formats/vtk/vtk_tags.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/vtu_write.hpp"

namespace dartcast {
namespace {

/// Tags of the rows of an array, and the names if they are texts.
struct Tags {
  std::vector<std::int32_t> values;
  std::map<std::int32_t, std::string> names;
};

/// Whether the array's values can be tags: whole numbers of 32 bits, or texts, one each.
bool are_tags(const VtkArray* array, const std::vector<std::uint32_t>& rows) {
  if (array == nullptr || array->components != 1) return false;
  return array->is_text || std::all_of(rows.begin(), rows.end(), [&](std::uint32_t row) {
           const double x = array->values[row];
           return std::abs(x) <= INT32_MAX && x == std::floor(x);
         });
}

/// Texts get tags from 1 on, by their first row; an empty one 0. Precondition: are_tags().
Tags tags_of(const VtkArray& array, const std::vector<std::uint32_t>& rows) {
  Tags tags;
  std::map<std::string, std::int32_t> known = {{"", 0}};
  for (const std::uint32_t row : rows) {
    if (!array.is_text) {
      tags.values.push_back(static_cast<std::int32_t>(array.values[row]));
      continue;
    }
    const auto [found, fresh] = known.try_emplace(array.texts[row], static_cast<std::int32_t>(known.size()));
    if (fresh) tags.names[found->second] = found->first;
    tags.values.push_back(found->second);
  }
  return tags;
}

/// Names written as "tag name".
std::map<std::int32_t, std::string> written_names(const VtkGrid& grid, const char* array_name) {
  std::map<std::int32_t, std::string> names;
  const VtkArray* array = find_array(grid.field, array_name);
  for (std::size_t i = 0; array != nullptr && i < array->texts.size(); ++i) {
    const std::string& text = array->texts[i];
    const std::size_t space = text.find(' ');
    if (space == std::string::npos || space == 0 || space > 11) continue;
    const long tag = std::strtol(text.c_str(), nullptr, 10);
    if (std::abs(tag) <= INT32_MAX) names[static_cast<std::int32_t>(tag)] = text.substr(space + 1);
  }
  return names;
}

/// Sets regions, and patches by the same array.
void copy_regions(const VtkGrid& grid, const Places& places, MeshData& mesh) {
  for (const char* name : {"region", "gmsh:physical", "medit:ref"}) {
    const VtkArray* array = find_array(grid.cell_data, name);
    if (array == nullptr || array->is_text || !are_tags(array, places.cells) || !are_tags(array, places.faces))
      continue;
    mesh.regions = tags_of(*array, places.cells).values;
    mesh.patch_tags = tags_of(*array, places.faces).values;
    break;
  }
  mesh.region_names = written_names(grid, "region_names");
  mesh.patch_names = written_names(grid, "patch_names");
}

[[noreturn]] void refuse_patches(const VtkGrid& grid, const std::string& name, const std::string& why) {
  std::vector<std::string> known;
  for (const VtkArray& other : grid.cell_data) known.push_back(other.name);
  throw InvalidMesh(fmt::format("patches from the cell array '{}': {}; the cell arrays are: {}", name, why,
                                known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
}

const VtkArray& array_of_patches(const VtkGrid& grid, const Places& places, const std::string& name) {
  const VtkArray* array = find_array(grid.cell_data, name);
  if (array == nullptr) refuse_patches(grid, name, "there is no such array");
  if (places.faces.empty())
    refuse_patches(grid, name,
                   "the file has no boundary cells (triangles, quadrilaterals or polygons; in the plane lines): write "
                   "them too, or divide the walls with patches = { angle = 30 }");
  if (!are_tags(array, places.faces))
    refuse_patches(grid, name, "its values at boundary cells must be whole numbers of 32 bits, or texts, one each");
  return *array;
}

}  // namespace

bool copy_tags(const VtkGrid& grid, const Places& places, const std::string& patch_array, MeshData& mesh) {
  copy_regions(grid, places, mesh);
  if (const VtkArray* baffles = find_array(grid.field, baffle_patches)) {
    for (const std::string& tag : baffles->texts)
      mesh.baffle_tags.push_back(static_cast<std::int32_t>(std::strtol(tag.c_str(), nullptr, 10)));
    if (!patch_array.empty() && patch_array != "patch")
      refuse_patches(grid, patch_array, "the walls of the file's baffles are in the array patch");
  }
  if (!patch_array.empty()) {
    Tags tags = tags_of(array_of_patches(grid, places, patch_array), places.faces);
    mesh.patch_tags = std::move(tags.values);
    if (patch_array != "patch" || !tags.names.empty()) mesh.patch_names = std::move(tags.names);
  }
  const VtkArray* array = find_array(grid.cell_data, "patch");
  if (places.faces.empty() || !are_tags(array, places.faces)) return false;
  if (patch_array.empty()) {
    Tags tags = tags_of(*array, places.faces);
    mesh.patch_tags = std::move(tags.values);
    if (!tags.names.empty()) mesh.patch_names = std::move(tags.names);
  }
  return !array->is_text && std::all_of(places.cells.begin(), places.cells.end(),
                                        [&](std::uint32_t row) { return array->values[row] == 0.0; });
}

}  // namespace dartcast
