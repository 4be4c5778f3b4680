// A small mesh with every type of cell side by side, one with a polyhedron too, and one cell that touches it in a
// vertex only.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

inline void add(MeshData& mesh, CellType type, std::vector<std::uint32_t> corners) { mesh.add_cell(type, corners); }

/// Adds a tetrahedron, turned so that it is positive.
void add_tetrahedron(MeshData& mesh, std::array<std::uint32_t, 4> v);

/// Cell 0: the unit cube as a hexahedron; 1: a pyramid on its side x = 1; 2: a prism on its side y = 1; 3, 4:
/// tetrahedra on the pyramid; 5: a tetrahedron on the prism; 6: the cube below it as a polyhedron; 7: a tetrahedron
/// that shares only vertex 4 with the rest.
MeshData mixed_mesh();

/// The same mesh with point i called order[i].
MeshData renumbered(const MeshData& mesh, std::span<const std::uint32_t> order);

/// A permutation of n numbers, the same for the same random numbers.
template <class Random>
std::vector<std::uint32_t> permutation(std::size_t n, Random& random) {
  std::vector<std::uint32_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = static_cast<std::uint32_t>(i);
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
  return order;
}

}  // namespace dartcast::test
