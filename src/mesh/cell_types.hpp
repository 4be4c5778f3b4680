// The faces of the standard cell types, as corner numbers, counterclockwise seen from the outside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Number of corners of a standard type; 0 for a polyhedron or a polygon.
std::size_t corner_count(CellType type);

/// The type of a cell of the plane with so many corners.
constexpr CellType plane_type(std::size_t corners) {
  return corners == 3 ? CellType::triangle : corners == 4 ? CellType::quadrilateral : CellType::polygon;
}

/// The tag of a cell's region.
inline std::int32_t region_of(const MeshData& mesh, std::size_t c) {
  return mesh.regions.empty() ? 0 : mesh.regions[c];
}

/// Faces of a standard type as lists of corner numbers in the order of MeshData. Empty for a polyhedron or a
/// polygon.
std::span<const std::vector<std::uint8_t>> standard_faces(CellType type);

/// Calls visit(span of point indices) for each face of cell c, counterclockwise seen from the outside. In the plane,
/// for each edge in the direction of the cell's corners. Precondition: the cell's connectivity is well formed (see
/// check_and_repair()).
template <class Visit>
void for_each_face(const MeshData& mesh, std::size_t c, Visit&& visit) {
  const auto corners = mesh.cell(c);
  if (mesh.types[c] == CellType::polyhedron) {
    std::size_t at = 1;
    for (std::uint32_t f = 0; f < corners[0]; ++f) {
      const std::size_t n = corners[at];
      visit(corners.subspan(at + 1, n));
      at += n + 1;
    }
    return;
  }
  std::uint32_t face[4] = {};
  if (mesh.types[c] == CellType::polygon) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      face[0] = corners[i];
      face[1] = corners[(i + 1) % corners.size()];
      visit(std::span<const std::uint32_t>(face, 2));
    }
    return;
  }
  for (const auto& numbers : standard_faces(mesh.types[c])) {
    std::size_t n = 0;
    for (const std::uint8_t k : numbers) face[n++] = corners[k];
    visit(std::span<const std::uint32_t>(face, n));
  }
}

}  // namespace dartcast
