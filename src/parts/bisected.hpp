// Parts of equal weight by recursive bisection, also of cells that lie on several ranks. Not installed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/ranks.hpp"

namespace dartcast {

inline constexpr std::uint64_t weight_of_free_cell = 10;
/// Blocked cells take memory, and no time.
inline std::uint64_t weight_of_cell(const MeshData& mesh, std::size_t c) {
  return mesh.free.empty() || mesh.free[c] != 0 ? weight_of_free_cell : 1;
}

/// A point in each cell: the mean of the corners of its faces.
std::vector<Vec3> middles_of(const MeshData& mesh);

/// The part of each cell. Cells are divided into halves of equal weight along the longest side of their middles' box,
/// until there are so many parts. `numbers`: of the cells in the whole, which order those at the same place; empty:
/// their own indices. `ranks`: each gives other cells, and gets the parts of these; the result for a cell does not
/// depend on how they are spread. Throws InvalidArgument if there are fewer cells than parts. `weights`: > 0.
std::vector<std::uint32_t> bisected(std::span<const Vec3> middles, std::span<const std::uint32_t> numbers,
                                    std::span<const std::uint64_t> weights, std::uint32_t parts,
                                    Ranks* ranks = nullptr);

}  // namespace dartcast
