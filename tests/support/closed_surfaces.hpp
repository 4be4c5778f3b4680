// Closed surfaces to sample from.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "dartcast/mesh_data.hpp"

namespace dartcast::test {

void add_face(MeshData& mesh, std::initializer_list<std::uint32_t> corners);

/// The box from `low` to `high`, of six quadrilaterals, outwards.
MeshData cuboid(const Vec3& low, const Vec3& high);

/// A torus around z, of quadrilaterals that are not plane.
MeshData torus(double radius, double tube, std::uint32_t around = 24, std::uint32_t across = 12);

/// A solid of many right angles on a small lattice: cubes (x, y, z) and their outer faces, for ties of every kind.
MeshData lattice_solid(const std::vector<std::array<int, 3>>& cubes);

}  // namespace dartcast::test
