// Files that have the same cells as a scene's mesh, some of which the scene may leave out.
#pragma once

#include <cstdint>
#include <vector>

#include "dartcast/mesh_files.hpp"

namespace dartcast {

/// Cells of an input file that a scene's mesh has.
class CellsOfScene {
 public:
  /// All of them.
  CellsOfScene() = default;
  /// Those of this mesh, which leaves bad cells out.
  explicit CellsOfScene(const MeshData& mesh);

  [[nodiscard]] bool are_all() const { return sources_.empty(); }
  /// A file's mesh, with its arrays: checked and repaired, without the other cells and their points. Throws InvalidMesh with
  /// the file's name if it is refused.
  [[nodiscard]] MeshData mesh_of(MeshFile file) const;

 private:
  std::vector<std::uint32_t> sources_;  // ascending; empty: all
};

}  // namespace dartcast
