// Boxes of cubes, each cube one hexahedron or cut into smaller cells.
#pragma once

#include <array>
#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

struct BoxOptions {
  std::array<std::uint32_t, 3> cells = {1, 1, 1};  ///< cubes along x, y and z
  Vec3 origin = {0.0, 0.0, 0.0};                   ///< the lowest corner
  Vec3 size = {1.0, 1.0, 1.0};                     ///< edge lengths of the whole box
  CellType type = CellType::hexahedron;            ///< each cube is 1 hexahedron, 6 tetrahedra, 2 prisms or 6 pyramids
  bool mixed = false;          ///< instead of `type`: each cube cut at random, all four types, still conforming
  bool blocked_layer = false;  ///< the outermost cubes are blocked
  double blocked_share = 0.0;  ///< of the other cubes, this share (rounded to whole cubes) is blocked at random
  double jitter = 0.0;         ///< inner lattice points move by up to jitter / 2 cube edges along each axis
  std::uint64_t seed = 1;      ///< for all that is random: the same seed gives the same bits everywhere
};

/// A conforming mesh of a box. Point (i, j, k) of the lattice has number i + (nx + 1) (j + (ny + 1) k) and lies at
/// origin + size * i / nx and so on: exactly on integers where size equals cells. The middle points of cubes cut from
/// their middle (pyramids) follow; each is the mean of the cube's corners. Cubes come in the same order, x fastest, and
/// the cells of a cube one after another. Patches 1 to 6 ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax") are the box's
/// sides. `free` is filled where a cube is blocked. Where jitter is more than about 0.5, cells may turn invalid.
///
/// Throws InvalidArgument: no cubes along an axis, 2^29 cells or more, a size that is not positive, a number that is
/// not finite, a share outside [0, 1], a jitter outside [0, 1], polyhedra asked for. Cost: about 0.15 us per
/// hexahedron.
MeshData generate_box(const BoxOptions& options);

/// The bar of Jund, Cazier and Dufourd (2009): 5 x 5 x 28 unit cubes whose outer layer is blocked.
BoxOptions bar_options();

/// generate_box(bar_options()).
MeshData generate_bar();

}  // namespace dartcast
