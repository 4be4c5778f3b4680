// Named groups of faces, by what lies on both sides of them.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// The faces of a patch.
struct PatchFaces {
  std::size_t walls = 0;           ///< with a free cell on one side alone, or baffles
  std::size_t blocked = 0;         ///< of blocked cells alone
  std::vector<std::size_t> inner;  ///< between two free cells; indices in the file
};

/// By the patches' names, or tags if they have none. Those without faces are there, too. Precondition:
/// check_and_repair() found the mesh valid. Cost: n log n in the patch faces, and a look at each face of the cells.
std::map<std::string, PatchFaces> faces_of_patches(const MeshData& mesh);

/// A warning of kind "inner_faces": of patch faces between two free cells, which are no walls. Its places are theirs.
Finding inner_patch_faces(const MeshData& mesh);

/// Throws InvalidMesh if one of the patches has no face that is a wall, with the reason. Names of no patch are passed
/// over.
void expect_walls(const MeshData& mesh, std::span<const std::string> patches);

}  // namespace dartcast
