// Boxes of cells of all kinds side by side: hexahedra, prisms, pyramids, tetrahedra, polyhedra of 6 to about 60 faces.
#pragma once

#include <array>
#include <cstdint>

#include "base/random.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

/// A box of unit cubes, conforming. Some boxes of up to 3 x 3 x 3 cubes are one polyhedron, whose faces are those of its
/// cubes. Each other cube is a hexahedron or a polyhedron, or it is cut into two prisms, or into pyramids and tetrahedra.
MeshData patchwork(std::array<std::uint32_t, 3> cubes, Random& random);

}  // namespace dartcast::test
