// Matches of equal faces of cells, and the faces on the boundary.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// The faces that one cell alone uses.
struct BoundaryFaces {
  std::vector<std::uint32_t> corners;  ///< counterclockwise seen from the outside; of an edge, as its cell has it
  std::vector<std::size_t> offsets = {0};
  std::vector<std::uint32_t> cells;  ///< the cell of each face

  [[nodiscard]] std::size_t size() const { return cells.size(); }
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t f) const {
    return {corners.data() + offsets[f], offsets[f + 1] - offsets[f]};
  }
};

/// How the cells of a mesh meet.
struct FaceMatch {
  BoundaryFaces boundary;
  std::vector<std::uint32_t> crowded;                   ///< a cell for each face that three or more cells use
  std::vector<std::array<std::uint32_t, 2>> same_side;  ///< for each face that two cells use from the same side: they
  std::vector<std::uint32_t> twisted;  ///< a cell for each face that two cells use with corners in another order
  std::size_t parts = 0;               ///< groups of cells connected by faces, other than those of same_side
  std::vector<std::uint32_t> part;     ///< per cell: one cell of its group, the same for all of them
};

/// Matches all faces by their corners. Baffles (MeshData::baffle_tags) do not connect cells; `with_baffles`: both their
/// sides are on the boundary. Precondition: connectivity is well formed and no face repeats a corner. Cost: linear in the
/// number of faces, apart from a sort of the faces around each point; 28 bytes a face.
FaceMatch match_faces(const MeshData& mesh, bool with_baffles = false);

}  // namespace dartcast
