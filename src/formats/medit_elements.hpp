// The sections of Medit's files, ASCII and binary.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "dartcast/mesh_data.hpp"
#include "formats/second_order.hpp"

namespace dartcast {

/// A section of elements. Those of higher order have their corners first.
struct MeditSection {
  std::string_view name;
  int code;             ///< in .meshb
  std::size_t corners;  ///< of the linear element
  std::size_t points;   ///< of this one
  unsigned dimension;
  CellType type;  ///< of a cell of space
};

inline constexpr std::array<MeditSection, 14> medit_sections = {{{"Tetrahedra", 8, 4, 4, 3, CellType::tetrahedron},
                                                                 {"Hexahedra", 10, 8, 8, 3, CellType::hexahedron},
                                                                 {"Prisms", 9, 6, 6, 3, CellType::prism},
                                                                 {"Pyramids", 49, 5, 5, 3, CellType::pyramid},
                                                                 {"Triangles", 6, 3, 3, 2, {}},
                                                                 {"Quadrilaterals", 7, 4, 4, 2, {}},
                                                                 {"Edges", 5, 2, 2, 1, {}},
                                                                 {"TetrahedraP2", 30, 4, 10, 3, CellType::tetrahedron},
                                                                 {"HexahedraQ2", 33, 8, 27, 3, CellType::hexahedron},
                                                                 {"PrismsP2", 86, 6, 18, 3, CellType::prism},
                                                                 {"PyramidsP2", 87, 5, 14, 3, CellType::pyramid},
                                                                 {"TrianglesP2", 24, 3, 6, 2, {}},
                                                                 {"QuadrilateralsQ2", 27, 4, 9, 2, {}},
                                                                 {"EdgesP2", 25, 2, 3, 1, {}}}};

/// Adds the element at a place of its section.
inline void add_medit_element(const MeditSection& section, std::span<const std::uint32_t> corners, std::int32_t tag,
                              std::size_t place, ParsedMesh& parsed) {
  if (section.points > section.corners && !take_higher_order(parsed, place)) return;
  if (section.dimension == 1) {
    parsed.add_edge(corners[0], corners[1], tag);
  } else if (section.dimension == 2) {
    parsed.mesh.add_patch_face(corners, tag);
  } else {
    parsed.mesh.add_cell(section.type, corners);
    parsed.mesh.regions.push_back(tag);
  }
}

}  // namespace dartcast
