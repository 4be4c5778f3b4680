// Rectangles of squares in the plane, each square one quadrilateral, cut into triangles, or merged into hexagons.
#pragma once

#include <array>
#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

struct RectangleOptions {
  std::array<std::uint32_t, 2> cells = {1, 1};  ///< squares along x and y
  std::array<double, 2> origin = {0.0, 0.0};    ///< the lowest corner
  std::array<double, 2> size = {1.0, 1.0};      ///< edge lengths of the whole rectangle
  CellType type = CellType::quadrilateral;      ///< each square is 1 quadrilateral or 2 triangles; or see below
  bool mixed = false;                           ///< instead of `type`: all three at random, still conforming
  double blocked_share = 0.0;  ///< this share of the squares (rounded to whole squares) is blocked at random
  double jitter = 0.0;         ///< inner lattice points move by up to jitter / 2 square edges along each axis
  std::uint64_t seed = 1;      ///< for all that is random: the same seed gives the same bits everywhere
};

/// The largest jitter that leaves every cell strictly convex, so that its fan from any corner is positive. A corner of
/// a square keeps at least 1 - 2 jitter of its area, one of a hexagon 1 - 3 jitter.
inline constexpr double largest_square_jitter = 0.45;
inline constexpr double largest_polygon_jitter = 0.3;

/// A conforming mesh of a rectangle, all z = 0. Point (i, j) of the lattice lies at origin + size * i / nx and so on:
/// exactly on integers where size equals cells. Points come in the order i + (nx + 1) j, and so do squares, x fastest.
/// Polygons are hexagons: of every third inner point of the lattice ((i + j) a multiple of 3) the six triangles around
/// it are merged, and the point is left out; what is left of the squares are quadrilaterals and triangles. Hexagons
/// come after all other cells. Patches 1 to 4 ("xmin", "xmax", "ymin", "ymax") are the rectangle's sides. `free` is
/// filled where a square is to be blocked; cells are merged only from squares that are all free or all blocked.
///
/// Throws InvalidArgument: no squares along an axis, 2^29 cells or more, a size that is not positive, a number that is
/// not finite, a share outside [0, 1], a jitter that is negative or above the largest, cells of space asked for. Cost:
/// about 0.1 us a cell.
MeshData generate_rectangle(const RectangleOptions& options);

}  // namespace dartcast
