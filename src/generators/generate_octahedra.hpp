// A block of truncated octahedra: real polyhedra that fill space.
#pragma once

#include <array>
#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

struct OctahedraOptions {
  std::array<std::uint32_t, 3> cells = {1, 1, 1};  ///< cubes of the packing's lattice; two octahedra in each
  Vec3 origin = {0.0, 0.0, 0.0};
  Vec3 size = {1.0, 1.0, 1.0};  ///< edge lengths of the lattice: cells cubes of size / cells
  bool blocked_layer = false;   ///< the octahedra at the block's boundary are blocked
  double blocked_share = 0.0;   ///< of the others, this share (rounded to whole cells) is blocked at random
  std::uint64_t seed = 1;       ///< for all that is random: the same seed gives the same bits everywhere
};

/// A conforming mesh of 2 nx ny nz polyhedra, each with 8 hexagons and 6 squares: the body-centred cubic packing. Cube
/// (i, j, k), x fastest, has one octahedron around its middle and one around its highest corner, so the block reaches
/// half a cube beyond `size`. Coordinates are origin + size u / (4 n) with integers u: where size / (4 cells) is a
/// double of few digits, they are exact, and every face is exactly plane. Patch 1, "boundary": the block's ragged
/// outside. `free` is filled where a cell is blocked.
///
/// Throws InvalidArgument: no cubes along an axis, 2^29 cells or more, a size that is not positive, a number that is
/// not finite, a share outside [0, 1]. Cost: about 2 us per cell.
MeshData generate_octahedra(const OctahedraOptions& options);

}  // namespace dartcast
