// Parts of a mesh that go to other ranks. Not installed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/mesh_part.hpp"
#include "dartcast/ranks.hpp"

namespace dartcast {

/// The rank that will have each cell of the part: own ones as given, and ghosts beside own cells as their ranks say. Others
/// keep their owner. `next`: of each cell; only those of own cells are read. Collective.
std::vector<std::uint32_t> next_owners(const MeshPart& part, std::vector<std::uint32_t> next, Ranks& ranks);

/// The part that this rank has once each cell is with its next owner. `next`: of next_owners(). Each rank sends its own
/// cells to those that will have them, as own cells or as ghosts. Collective. Cost: linear in the parts.
MeshPart moved_part(const MeshPart& part, std::span<const std::uint32_t> next, Ranks& ranks);

}  // namespace dartcast
