// Meshes by name: boxes of cubes, of each kind of cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "dartcast/generators.hpp"

namespace dartcast::test {

/// The cell types of space that a cube can be cut into.
inline constexpr std::array<CellType, 4> cube_types = {CellType::tetrahedron, CellType::hexahedron, CellType::prism,
                                                       CellType::pyramid};

/// A kind of box: its cells are of one type, or of all types of cube_types.
struct BoxKind {
  CellType type = CellType::hexahedron;
  bool mixed = false;
};
inline constexpr std::array<BoxKind, 5> box_kinds = {
    {{cube_types[0]}, {cube_types[1]}, {cube_types[2]}, {cube_types[3]}, {CellType::hexahedron, true}}};

/// Makes the box of the kind with this number. Other numbers leave it as it is: tests count meshes without a box on.
inline void set_kind(BoxOptions& box, int number) {
  const auto kind = static_cast<std::size_t>(number);
  if (kind >= box_kinds.size()) return;
  box.type = box_kinds[kind].type;
  box.mixed = box_kinds[kind].mixed;
}

/// A type that no cell has, as a damaged mesh may.
inline constexpr auto no_cell_type = static_cast<CellType>(77);

/// A box of unit cubes, or of cells cut from them.
inline MeshData unit_box(std::array<std::uint32_t, 3> cells, CellType type = CellType::hexahedron) {
  BoxOptions box;
  box.cells = cells;
  box.size = {double(cells[0]), double(cells[1]), double(cells[2])};
  box.type = type;
  return generate_box(box);
}

/// A cube with edges of this size, of n x n x n hexahedra.
inline MeshData cube_of(std::uint32_t n, double size) {
  BoxOptions box;
  box.cells = {n, n, n};
  box.size = {size, size, size};
  return generate_box(box);
}

/// n x n x n unit cubes, or cells cut from them.
inline MeshData cubes(std::uint32_t n, CellType type = CellType::hexahedron, double blocked_share = 0.0,
                      double jitter = 0.0, std::uint64_t seed = 1) {
  BoxOptions box;
  box.cells = {n, n, n};
  box.size = {double(n), double(n), double(n)};
  box.type = type;
  box.blocked_share = blocked_share;
  box.jitter = jitter;
  box.seed = seed;
  return generate_box(box);
}

}  // namespace dartcast::test
