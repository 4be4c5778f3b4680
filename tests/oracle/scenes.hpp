// Small random meshes for tests: every cell type, warped faces, slivers, obstacles, any numbering of the points.
#pragma once

#include <cstdint>
#include <string>

#include "dartcast/mesh_data.hpp"

namespace dartcast::oracle {

enum class SceneKind { tetrahedra, hexahedra, prisms, pyramids, mixed, octahedra, flat_corners, slivers };
inline constexpr int scene_kinds = 8;

std::string name_of(SceneKind kind);

/// A conforming mesh of some ten to two hundred cells, all that is random drawn from the seed: the size, a share of
/// blocked cells, the numbers of the points, a displacement of each point (which warps faces) times `warp` in [0, 1], a
/// rotation, a scale by a power of two and a shift. With a large warp some cells may be invalid; with 0 none is.
/// Flat corners are hexahedra with
/// vertices in the middle of some edges: simplices are flat unless faces and cells get Steiner points. Slivers are
/// tetrahedra of which some are squashed to about 1e-12 of their volume.
MeshData random_scene(SceneKind kind, std::uint64_t seed, double warp);

/// The same with points on integers, nothing warped, rotated or squashed. Coordinates up to 16, edges of length 2 and
/// more (4 sqrt(2) and the like in octahedra: their corners are integers too).
MeshData lattice_scene(SceneKind kind, std::uint64_t seed);

/// Some hundred hexahedra, and among them other cells where seed % 4 is 1; on integers where it is 0, else as
/// random_scene().
MeshData long_box(std::uint64_t seed);

}  // namespace dartcast::oracle
