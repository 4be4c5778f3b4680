// Meshes made by the library: boxes, octahedra, vessels, barrels; rectangles and mazes of the plane.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

// Boxes of cubes, each cube one hexahedron or cut into smaller cells.

/// Options of generate_box().
struct BoxOptions {
  std::array<std::uint32_t, 3> cells = {1, 1, 1};  ///< cubes along x, y and z
  Vec3 origin = {0.0, 0.0, 0.0};                   ///< the lowest corner
  std::optional<Vec3> size = {};                   ///< edge lengths of the whole box; none: cubes of edge 1
  CellType type = CellType::hexahedron;            ///< each cube is 1 hexahedron, 6 tetrahedra, 2 prisms or 6 pyramids
  bool mixed = false;          ///< instead of `type`: each cube cut at random, all four types, still conforming
  bool blocked_layer = false;  ///< the outermost cubes are blocked
  double blocked_share = 0.0;  ///< share of the other cubes (rounded to whole cubes) that is blocked at random
  double jitter = 0.0;         ///< inner lattice points move by up to jitter / 2 cube edges along each axis
  std::uint64_t seed = 1;      ///< for all that is random: the same seed gives the same bits everywhere
};

/// The largest jitter with which no tetrahedron of a cube is inverted, however its corners are moved.
inline constexpr double surely_valid_jitter = 1.0 / 3.0;

/// A conforming mesh of a box. Point (i, j, k) of the lattice has number i + (nx + 1) (j + (ny + 1) k). It lies at
/// origin + size * i / nx and so on, exactly on integers if size equals cells. The middle points of cubes that are cut
/// from their middle (pyramids) follow; each is the mean of the cube's corners. Cubes come in the same order, x
/// fastest, and the cells of a cube one after another. Patches 1 to 6 ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")
/// are the sides of the box. `free` is filled if a cube is blocked. Up to surely_valid_jitter all hexahedra, prisms and
/// tetrahedra are valid. With more, cells may become invalid, and the more cells the likelier.
///
/// Throws InvalidArgument for no cubes along an axis, 2^29 cells or more, and polyhedra. It also throws for a size
/// that is not positive, a number that is not finite, and a share or jitter outside [0, 1]. Cost: about 0.15 us per
/// hexahedron.
MeshData generate_box(const BoxOptions& options);

/// The bar of Jund, Cazier and Dufourd (2009): 5 x 5 x 28 unit cubes whose outer layer is blocked.
BoxOptions bar_options();

/// generate_box(bar_options()).
MeshData generate_bar();

// A block of truncated octahedra: real polyhedra that fill space.

/// Options of generate_octahedra().
struct OctahedraOptions {
  std::array<std::uint32_t, 3> cells = {1, 1, 1};  ///< cubes of the packing's lattice; two octahedra in each
  Vec3 origin = {0.0, 0.0, 0.0};
  std::optional<Vec3> size = {};  ///< edge lengths of the lattice: cells cubes of size / cells; none: of edge 1
  bool blocked_layer = false;     ///< the octahedra at the block's boundary are blocked
  double blocked_share = 0.0;     ///< share of the others (rounded to whole cells) that is blocked at random
  std::uint64_t seed = 1;         ///< for all that is random: the same seed gives the same bits everywhere
};

/// A conforming mesh of 2 nx ny nz polyhedra, each with 8 hexagons and 6 squares: the body-centred cubic packing. Cube
/// (i, j, k), x fastest, has one octahedron around its middle and one around its highest corner. So the block reaches
/// half a cube beyond `size`. Coordinates are origin + size u / (4 n) with integers u. If size / (4 cells) is a
/// double of few digits they are exact, and every face is exactly planar. Patch 1, "boundary", is the block's ragged
/// outside. `free` is filled if a cell is blocked.
///
/// Throws InvalidArgument for no cubes along an axis, and 2^29 cells or more. It also throws for a size that is not
/// positive, a number that is not finite, and a share outside [0, 1]. Cost: about 2 us per cell.
MeshData generate_octahedra(const OctahedraOptions& options);

// A blood vessel that branches: one inlet, two outlets, tissue around.

/// SI units: metres, radians, metres per second.
struct VesselOptions {
  double radius = 3e-3;                                   ///< of the trunk's lumen
  double trunk_length = 30e-3;                            ///< along the centre line, in whole steps
  std::array<double, 2> branch_lengths = {36e-3, 30e-3};  ///< left, right
  double branch_radius = 0.79;  ///< of each branch, as a share of `radius`; Murray's law asks for 0.794
  double branch_angle = 0.6;    ///< between the trunk's and each branch's direction, in one plane
  double out_of_plane = 0.5;    ///< by how much the trunk and, further on, the branches turn out of that plane
  double tissue_thickness = 1.5e-3;
  std::uint32_t core = 6;           ///< cells across the square in the middle of each half of the lumen
  std::uint32_t rings = 3;          ///< rings of cells around that square
  std::uint32_t tissue_layers = 2;  ///< layers of cells through the tissue
  double step_length = 0.9e-3;      ///< of a cell along the centre line
  double peak_speed = 0.3;          ///< of the flow, in the middle of the inlet
};

/// A conforming mesh of hexahedra, with prisms where the tissue between the branches starts. The trunk comes along z
/// and consists of two halves sewn along a plane. At the carina (the origin) they separate, and each becomes round
/// along its own branch, the left one towards -x, the right one towards +x. The default options give 20,948 cells,
/// 15,012 of them lumen.
///
/// Regions: 1 "lumen" (free), 2 "tissue" (blocked).
///
/// Patches: 1 "inlet", 2 "outlet_left", 3 "outlet_right" (the ends of the lumen), 4 "wall" (the faces between lumen and
/// tissue, seen from the lumen), 5 "outer" (the outside of the tissue, with its ends).
///
/// Point data:
///
///  - "velocity" (3): along the vessel, a paraboloid over the inlet, 0 on the wall and in the tissue. The flux through
///    each section is the same, half of it in each branch. Between sections the field is free of divergence as far as
///    the mesh resolves it.
///  - "pulse_direction" (3): from the centre line to the point, in its section. If points move by a times this, the
///    vessel widens by a share a in radius.
///  - "path_length" (1): along the centre line from the inlet.
///
/// Throws InvalidArgument if an option is out of the range in which every cell is positive:
///
///  - radius > 0, trunk_length >= 4 radii, branch_lengths >= 6 radii;
///  - branch_radius in [0.7, 0.85], branch_angle in [0.4, 0.8], out_of_plane in [0, 0.7];
///  - tissue_thickness in [0.2, 0.8] radii, step_length in [0.02, 0.5] radii;
///  - core in [2, 64], rings in [1, 32], tissue_layers in [1, 32], peak_speed finite.
///
/// Cost: about 2 us per cell.
MeshData generate_vessel(const VesselOptions& options = {});

// The surface of a barrel: staves that bulge, and two heads.

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

/// A closed surface in space, with faces counterclockwise as seen from the outside. check_and_repair_surface() accepts
/// it unchanged. The radius at height s from the middle is radius + bulge (1 - (2 s / height)^2), at the staves' edges.
/// Points: those of the staves, staves (rows + 1) of them from the lower head up; then those inside the lower and the
/// upper head. They are at equal distances along heights and radii, so that they also sample the barrel. Regions: 1
/// "staves", 2 "heads".
///
/// Throws InvalidArgument if a length is not positive (bulge: negative) or not finite. It also throws for fewer than 3
/// staves, and rows or rings of 0, and for more than 2^14 of any.
MeshData generate_barrel(const BarrelOptions& options = {});

// Rectangles of squares in the plane, each square one quadrilateral, cut into triangles, or merged into hexagons.

/// Options of generate_rectangle().
struct RectangleOptions {
  std::array<std::uint32_t, 2> cells = {1, 1};     ///< squares along x and y
  std::array<double, 2> origin = {0.0, 0.0};       ///< the lowest corner
  std::optional<std::array<double, 2>> size = {};  ///< edge lengths of the whole rectangle; none: squares of edge 1
  CellType type = CellType::quadrilateral;         ///< each square is 1 quadrilateral or 2 triangles; or see below
  bool mixed = false;                              ///< instead of `type`: all three at random, still conforming
  double blocked_share = 0.0;  ///< this share of the squares (rounded to whole squares) is blocked at random
  double jitter = 0.0;         ///< inner lattice points move by up to jitter / 2 square edges along each axis
  std::uint64_t seed = 1;      ///< for all that is random: the same seed gives the same bits everywhere
};

/// The largest jitter with which every cell is strictly convex, so that its fan from any corner is positive. A corner
/// of a square keeps at least 1 - 2 jitter of its area, one of a hexagon 1 - 3 jitter.
inline constexpr double largest_square_jitter = 0.45;
inline constexpr double largest_polygon_jitter = 0.3;

/// A conforming mesh of a rectangle, all z = 0. Point (i, j) of the lattice lies at origin + size * i / nx and so on:
/// exactly on integers if size equals cells. Points come in the order i + (nx + 1) j, and so do squares, x fastest.
///
/// Polygons are hexagons. Around every third inner point of the lattice ((i + j) a multiple of 3) the six triangles are
/// merged, and the point is left out. The remaining parts of the squares are quadrilaterals and triangles. Hexagons
/// come after all other cells.
///
/// Patches 1 to 4 ("xmin", "xmax", "ymin", "ymax") are the sides of the rectangle. `free` is filled if a square is
/// blocked. Cells are merged only from squares that are all free or all blocked.
///
/// Throws InvalidArgument for no squares along an axis, 2^29 cells or more, and cells of space. It also throws for a
/// size that is not positive, and a number that is not finite. So do a share outside [0, 1] and a jitter that is
/// negative or above the largest. Cost: about 0.1 us a cell.
MeshData generate_rectangle(const RectangleOptions& options);

// Mazes in the plane: rooms full of obstacles, joined by doors.

/// Options of generate_maze().
struct MazeOptions {
  std::array<std::uint32_t, 2> rooms = {4, 4};  ///< columns and rows
  std::uint32_t room_cells = 8;                 ///< squares along a room's edge
  std::uint32_t door_cells = 2;                 ///< squares that a door is wide
  std::uint32_t obstacles = 4;                  ///< squares blocked in each room; fewer if more would cut it
  double extra_doors =
      0.1;  ///< share (rounded down) of the walls without a door that get one although no room needs it
  std::array<double, 2> origin = {0.0, 0.0};       ///< the lowest corner
  std::optional<std::array<double, 2>> size = {};  ///< edge lengths of the whole maze; none: squares of edge 1
  CellType type = CellType::quadrilateral;         ///< cells, as in RectangleOptions
  bool mixed = false;
  double jitter = 0.0;     ///< as in RectangleOptions, with its bounds
  std::uint64_t seed = 1;  ///< for all that is random: the same seed gives the same bits everywhere
};

/// A generate_rectangle() of columns (room_cells + 1) - 1 by rows (room_cells + 1) - 1 squares. Between rooms the
/// squares are blocked, one deep, apart from doors. A random spanning tree of the rooms has doors, and so have some
/// other walls. Within rooms obstacles are blocked one by one, if the rest of the room and its doors stays
/// connected. So all free cells are connected by edges between free cells, and every room has some. All boundary edges
/// are in patch 1, "border".
///
/// Throws InvalidArgument for no rooms along an axis, rooms without squares, and doors without squares or wider than
/// a room. It also throws for as many obstacles as a room has squares, a share outside [0, 1], and as
/// generate_rectangle() does. Cost: about 0.1 us a cell, and for each obstacle about 10 ns times the squares of a
/// room.
MeshData generate_maze(const MazeOptions& options);

}  // namespace dartcast
