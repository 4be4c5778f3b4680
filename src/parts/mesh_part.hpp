// One part of a mesh that is spread over several ranks. Not installed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "parts/part_cells.hpp"

namespace dartcast {

/// The patch of the faces behind which a rank does not know the mesh: the last one. No wall that a particle may meet has it.
inline constexpr const char* unknown_patch = "behind the ghosts";

/// A part's own cells and the ghosts: all cells that share a point with one of these. Cells and points are in the order of
/// the whole mesh, and so are the patches.
struct MeshPart {
  MeshData mesh;
  std::vector<std::uint32_t> points;  ///< the number of each in the whole mesh
  std::vector<std::uint32_t> cells;
  std::vector<std::uint32_t> owners;  ///< the part of each cell
  std::vector<Cell> handles;          ///< of each cell, in the map of the whole mesh
};

/// `parts`: the part of each cell of the whole. Precondition: check_and_repair() has found nothing to repair. Cost: linear
/// in the whole mesh.
MeshPart mesh_part(const MeshData& whole, std::span<const std::uint32_t> parts, std::uint32_t part);

/// The part without its ghosts; points are those of the part.
MeshData own_mesh(const MeshPart& part, std::uint32_t rank);

/// The cells of a part by their handles. `rank`: that has the part.
PartCells part_cells(const MeshPart& part, unsigned rank);

/// The part of each cell: halves of equal weight along the longest side, again and again, until there are so many parts
/// (M. J. Berger, S. H. Bokhari, "A partitioning strategy for nonuniform problems on multiprocessors", 1987). `weights`: of
/// each cell; empty: all weigh the same. Throws InvalidArgument where there are fewer cells than parts.
std::vector<std::uint32_t> bisected(const MeshData& mesh, std::uint32_t parts, std::span<const double> weights = {});

}  // namespace dartcast
