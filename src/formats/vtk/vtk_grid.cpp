// Cells and arrays of a data set of VTK.
#include "formats/vtk/vtk_grid.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

/// A polyhedron in VTK's way: its number of faces, then for each face its number of corners and the corners.
void add_faces(std::span<const std::int64_t> numbers, const PointRange& range, VtkGrid& grid) {
  const auto refuse = [&] {
    throw InvalidMesh(fmt::format("the faces of polyhedron {} do not fit its numbers", grid.types.size()));
  };
  if (numbers.empty()) throw InvalidMesh(fmt::format("polyhedron {} has no faces", grid.types.size()));
  std::size_t at = 1;
  for (std::int64_t f = 0; f < numbers[0]; ++f) {
    if (at >= numbers.size()) refuse();
    const std::int64_t n = numbers[at++];
    if (n < 0 || n > static_cast<std::int64_t>(numbers.size() - at)) refuse();
    grid.connectivity.push_back(static_cast<std::uint32_t>(n));
    for (const std::int64_t id : numbers.subspan(at, static_cast<std::size_t>(n)))
      grid.connectivity.push_back(range.point(id));
    at += static_cast<std::size_t>(n);
  }
  if (numbers[0] < 0 || at != numbers.size()) refuse();
}

}  // namespace

const VtkArray* find_array(const std::vector<VtkArray>& arrays, std::string_view name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const VtkArray& a) { return a.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

void add_cell(std::uint8_t type, std::span<const std::int64_t> ids, const PointRange& range, VtkGrid& grid) {
  if (type == vtk_polyhedron) {
    if (!ids.empty()) grid.connectivity.push_back(static_cast<std::uint32_t>(ids[0]));
    add_faces(ids, range, grid);
  } else {
    for (const std::int64_t id : ids) grid.connectivity.push_back(range.point(id));
  }
  grid.types.push_back(type);
  grid.offsets.push_back(grid.connectivity.size());
}

}  // namespace dartcast
