// The surface of a barrel: staves that bulge, and two heads.
#pragma once

#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// SI units.
struct BarrelOptions {
  double height = 0.5;        ///< along z
  double radius = 0.2;        ///< of the heads
  double bulge = 0.05;        ///< by how much the radius is greater in the middle
  std::uint32_t staves = 24;  ///< around, each of them flat across
  std::uint32_t rows = 16;    ///< of quadrilaterals along a stave
  std::uint32_t rings = 4;    ///< of faces on each head, a fan of triangles in the middle
  Vec3 centre = {0.0, 0.0, 0.0};
};

/// A closed surface in space, its faces counterclockwise seen from the outside: what check_and_repair_surface() accepts
/// as it is. The radius at height s from the middle is radius + bulge (1 - (2 s / height)^2), at the staves' edges.
/// Points: those of the staves, staves (rows + 1) of them from the lower head up; then those inside the lower and the
/// upper head. They are at equal distances along heights and radii, so that they sample the barrel, too. Regions: 1
/// "staves", 2 "heads".
///
/// Throws InvalidArgument where a length is not positive (bulge: negative) or not finite, staves are fewer than 3 or
/// more than 2^14, rows or rings none or more than 2^14.
MeshData generate_barrel(const BarrelOptions& options = {});

}  // namespace dartcast
