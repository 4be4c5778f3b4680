// Keeps those cells of a file that a scene's mesh has, by their places in the input file.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "dartcast/mesh_check.hpp"
#include "formats/checked_file.hpp"
#include "formats/scene_files.hpp"

namespace dartcast {

namespace {

std::uint32_t source_of(const MeshData& mesh, std::size_t c) {
  return mesh.source.empty() ? static_cast<std::uint32_t>(c) : mesh.source[c];
}

}  // namespace

CellsOfScene::CellsOfScene(const MeshData& mesh) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) sources_.push_back(source_of(mesh, c));
  std::sort(sources_.begin(), sources_.end());
}

MeshData CellsOfScene::mesh_of(MeshFile file) const {
  if (are_all() || file.mesh.types.empty()) return valid_file(std::move(file)).mesh;
  MeshData& all = file.mesh;
  MeshData mesh;
  for (const DataArray& a : all.cell_data) mesh.cell_data.push_back({a.name, a.components, {}});
  for (std::size_t c = 0; c < all.cell_count(); ++c) {
    if (!std::binary_search(sources_.begin(), sources_.end(), source_of(all, c))) continue;
    mesh.add_cell(all.types[c], all.cell(c));
    for (std::size_t a = 0; a < all.cell_data.size(); ++a) {
      const DataArray& from = all.cell_data[a];
      const auto first = from.values.begin() + static_cast<std::ptrdiff_t>(c * from.components);
      mesh.cell_data[a].values.insert(mesh.cell_data[a].values.end(), first,
                                      first + static_cast<std::ptrdiff_t>(from.components));
    }
  }
  mesh.points = std::move(all.points);
  mesh.point_data = std::move(all.point_data);
  check_and_repair(mesh);  // drops the points of the other cells
  return mesh;
}

}  // namespace dartcast
