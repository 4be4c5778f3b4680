// Tables of the standard cell types: corners and faces.
#include "mesh/cell_types.hpp"

namespace dartcast {

std::size_t corner_count(CellType type) {
  switch (type) {
    case CellType::tetrahedron: return 4;
    case CellType::hexahedron: return 8;
    case CellType::prism: return 6;
    case CellType::pyramid: return 5;
    case CellType::triangle: return 3;
    case CellType::quadrilateral: return 4;
    case CellType::polyhedron:
    case CellType::polygon: break;
  }
  return 0;
}

std::span<const std::vector<std::uint8_t>> standard_faces(CellType type) {
  using Faces = std::vector<std::vector<std::uint8_t>>;
  static const Faces tetrahedron = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  static const Faces hexahedron = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  static const Faces prism = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  static const Faces pyramid = {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  static const Faces triangle = {{0, 1}, {1, 2}, {2, 0}};
  static const Faces quadrilateral = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  switch (type) {
    case CellType::tetrahedron: return tetrahedron;
    case CellType::hexahedron: return hexahedron;
    case CellType::prism: return prism;
    case CellType::pyramid: return pyramid;
    case CellType::triangle: return triangle;
    case CellType::quadrilateral: return quadrilateral;
    case CellType::polyhedron:
    case CellType::polygon: break;
  }
  return {};
}

}  // namespace dartcast
