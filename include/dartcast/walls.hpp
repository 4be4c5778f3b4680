// The walls of free cells as triangles: for viewers, and for other programs that look for contacts.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/ids.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

/// Entry i of triangles and faces belongs to the same triangle. They change by edits alone: as long as
/// Environment::edit_count() is the same, only places do.
struct WallTriangles {
  std::vector<Vertex> vertices;  ///< in increasing order
  /// Places in `vertices`, clockwise as seen from the free side. In the plane a wall is a side: the third repeats the
  /// second.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<CellFace> faces;  ///< the wall, of its free cell

  /// Where the vertices are now. Precondition: `positions` are those of the complex.
  [[nodiscard]] std::vector<Vec3> points(std::span<const Vec3> positions) const;
};

/// The triangles of all walls of free cells, in the order of cells, their faces and the faces' fans. Cost: linear in the
/// cells.
WallTriangles wall_triangles(const CellComplex& complex);

}  // namespace dartcast
