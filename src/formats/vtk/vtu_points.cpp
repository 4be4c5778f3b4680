// The points of a .vtu file, and a hash of its cells.
#include "formats/vtk.hpp"
#include "formats/vtk/vtk_grid.hpp"

namespace dartcast {
namespace {

// Multiplications mix low bits into high ones, shifts bring them back (as in MurmurHash3, A. Appleby).
std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0xff51afd7ed558ccdU;
  return hash ^ (hash >> 32U);
}

}  // namespace

VtuPoints read_vtu_points(std::string_view content, std::uint64_t max_memory) {
  VtkGrid grid = read_vtk_xml_grid(content, "UnstructuredGrid", max_memory, false);
  join_pieces(grid);
  std::uint64_t hash = grid.types.size();
  for (const std::uint8_t type : grid.types) hash = mixed(hash, type);
  for (const std::size_t offset : grid.offsets) hash = mixed(hash, offset);
  for (const std::uint32_t point : grid.connectivity) hash = mixed(hash, point);
  return {std::move(grid.points), hash};
}

}  // namespace dartcast
