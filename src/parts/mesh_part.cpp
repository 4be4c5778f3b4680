// Parts of a whole mesh, and what a rank makes of its part.
#include "dartcast/mesh_part.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "dartcast/error.hpp"
#include "parts/bisected.hpp"
#include "parts/part_cutter.hpp"
#include "parts/part_of_rank.hpp"

namespace dartcast {

std::vector<std::uint32_t> partition(const MeshData& mesh, std::uint32_t parts) {
  std::vector<std::uint64_t> weights(mesh.cell_count());
  for (std::size_t c = 0; c < weights.size(); ++c) weights[c] = weight_of_cell(mesh, c);
  return bisected(middles_of(mesh), {}, weights, parts);
}

MeshPart mesh_part(const MeshData& whole, std::span<const std::uint32_t> owners, std::uint32_t parts,
                   std::uint32_t part) {
  if (owners.size() != whole.cell_count())
    throw InvalidArgument(fmt::format("mesh_part: {} owners for {} cells", owners.size(), whole.cell_count()));
  for (const std::uint32_t owner : owners) {
    if (owner >= parts || part >= parts)
      throw InvalidArgument(fmt::format("mesh_part: there is no part {} of {}", std::max(owner, part), parts));
  }
  PartCutter cutter(whole, owners, parts);
  return cutter.cut(cutter.cells_of(part), part);
}

MeshData own_mesh(const MeshPart& part) {
  const MeshData& all = part.mesh;
  MeshData own;
  own.points = all.points;
  own.region_names = all.region_names;
  own.point_data = all.point_data;
  std::vector<std::uint32_t> which;
  for (std::uint32_t c = 0; c < all.cell_count(); ++c) {
    if (part.owners[c] != part.part) continue;
    which.push_back(c);
    own.add_cell(all.types[c], all.cell(c));
    own.source.push_back(all.source[c]);
    if (!all.regions.empty()) own.regions.push_back(all.regions[c]);
    if (!all.free.empty()) own.free.push_back(all.free[c]);
  }
  own.cell_data = taken(all.cell_data, which);
  return own;
}

MeshData whole_mesh(MeshPart part) {
  const std::int32_t unknown = unknown_tag_of(part.mesh);
  part.mesh.patch_names.erase(unknown);
  std::erase(part.mesh.patch_order, unknown);
  return std::move(part.mesh);
}

PartCells part_cells(const MeshPart& part) {
  std::array<std::vector<PartCells::Entry>, 5> cells;
  for (std::size_t c = 0; c < part.cells.size(); ++c)
    cells[part.handles[c].pool()].push_back({part.handles[c], part.owners[c]});
  return {part.part, std::move(cells)};
}

}  // namespace dartcast
