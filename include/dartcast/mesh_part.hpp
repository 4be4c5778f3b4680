// Parts of a mesh that is spread over ranks (dartcast/ranks.hpp), so that none needs to hold the whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/generators.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// The patch of the faces behind which a rank does not know the mesh: the last one. No wall that a particle may meet has it.
inline constexpr const char* unknown_patch = "behind the ghosts";

/// A part's own cells and the ghosts: all cells that share a point with one of these. Cells and points are in the order of
/// the whole mesh, and so are the patches. Every comparison of two numbers has the same result in the part and in the whole.
struct MeshPart {
  MeshData mesh;                      ///< `source`: as in the whole
  std::uint32_t part = 0;             ///< its number
  std::uint32_t parts = 1;            ///< of the whole
  std::vector<std::uint32_t> points;  ///< the number of each in the whole mesh
  std::vector<std::uint32_t> cells;
  std::vector<std::uint32_t> owners;  ///< the part of each cell
  std::vector<Cell> handles;          ///< of each cell, in the map of the whole mesh
};

/// A part for each cell: halves of equal weight along the longest side of the cells' middles, again and again (M. J. Berger,
/// S. H. Bokhari, "A partitioning strategy for nonuniform problems on multiprocessors", 1987). Blocked cells weigh a tenth:
/// they take memory, and no time. Throws InvalidArgument if there are fewer cells than parts. Cost: linear in the
/// cells for each doubling of the parts, about 0.1 us a cell.
std::vector<std::uint32_t> partition(const MeshData& mesh, std::uint32_t parts);

/// Cuts a part out. `owners`: the part of each cell of the whole, each less than `parts`. Throws InvalidArgument if their
/// number does not match. Precondition: check_and_repair() has found nothing to repair, and the cells are of space. Cost:
/// linear in the whole mesh.
MeshPart mesh_part(const MeshData& whole, std::span<const std::uint32_t> owners, std::uint32_t parts,
                   std::uint32_t part);

/// Whether box_part() takes these options.
bool has_parts(const BoxOptions& options);

/// One of `parts` parts of generate_box(), to the same bits, made without the rest: its cubes, and the cubes around them.
/// Throws InvalidArgument as generate_box(), if there are fewer cubes than parts, and if has_parts() is false. Cubes
/// that are mixed or blocked at random depend on all others. Cost: that of the part.
MeshPart box_part(const BoxOptions& options, std::uint32_t parts, std::uint32_t part);

}  // namespace dartcast
