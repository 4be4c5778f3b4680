// Points and faces of .vtp files.
#include <fmt/format.h>

#include <cmath>

#include "dartcast/error.hpp"
#include "formats/vtk.hpp"
#include "formats/vtk/vtk_grid.hpp"

namespace dartcast {

namespace {

std::string group_of(const VtkArray& array, std::size_t row) {
  if (array.is_text) return array.texts[row];
  const double value = array.values[row];
  return std::abs(value) < 1e15 && value == std::floor(value) ? fmt::format("{:.0f}", value)
                                                              : fmt::format("{:g}", value);
}

/// The array of the groups: the first name that there is.
const VtkArray* groups_in(const VtkGrid& grid) {
  for (const char* name : {"patch", "region", "ModelFaceID"}) {
    const VtkArray* array = find_array(grid.cell_data, name);
    if (array != nullptr && array->components == 1) return array;
  }
  return nullptr;
}

}  // namespace

PointFile read_vtp_points(std::string_view content, std::uint64_t max_memory) {
  VtkGrid grid = read_vtk_xml_grid(content, "PolyData", max_memory);
  PointFile file{std::move(grid.points), {}};
  for (VtkArray& a : grid.point_data) file.arrays.push_back({std::move(a.name), a.components, std::move(a.values)});
  return file;
}

VtpFaces read_vtp_faces(std::string_view content, std::uint64_t max_memory) {
  VtkGrid grid = read_vtk_xml_grid(content, "PolyData", max_memory);
  join_pieces(grid);
  VtpFaces out{std::move(grid.points), {}, {}, {}};
  const VtkArray* groups = groups_in(grid);
  for (std::size_t c = 0; c < grid.types.size(); ++c) {
    if (grid.types[c] == vtk_triangle_strip) throw InvalidMesh("triangle strips are not read: write triangles");
    if (grid.types[c] != vtk_polygon) continue;
    out.faces.emplace_back(grid.connectivity.begin() + static_cast<std::ptrdiff_t>(grid.offsets[c]),
                           grid.connectivity.begin() + static_cast<std::ptrdiff_t>(grid.offsets[c + 1]));
    if (groups != nullptr) out.groups.push_back(group_of(*groups, c));
  }
  const VtkArray* ids = find_array(grid.point_data, "GlobalNodeID");
  for (std::size_t p = 0; ids != nullptr && p < ids->items(); ++p) out.ids.push_back(ids->values[p * ids->components]);
  return out;
}

}  // namespace dartcast
