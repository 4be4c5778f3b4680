// Mazes in the plane: rooms full of obstacles, joined by doors.
#pragma once

#include <array>
#include <cstdint>

#include "dartcast/mesh_data.hpp"

namespace dartcast {

struct MazeOptions {
  std::array<std::uint32_t, 2> rooms = {4, 4};  ///< columns and rows
  std::uint32_t room_cells = 8;                 ///< squares along a room's edge
  std::uint32_t door_cells = 2;                 ///< squares that a door is wide
  std::uint32_t obstacles = 4;                  ///< squares blocked in each room; fewer where more would cut it
  double extra_doors = 0.1;  ///< doors that no room needs: this share (rounded down) of the walls left without one
  std::array<double, 2> origin = {0.0, 0.0};  ///< the lowest corner
  std::array<double, 2> size = {1.0, 1.0};    ///< edge lengths of the whole maze
  CellType type = CellType::quadrilateral;    ///< cells, as in RectangleOptions
  bool mixed = false;
  double jitter = 0.0;     ///< as in RectangleOptions, with its bounds
  std::uint64_t seed = 1;  ///< for all that is random: the same seed gives the same bits everywhere
};

/// A generate_rectangle() of columns (room_cells + 1) - 1 by rows (room_cells + 1) - 1 squares. Between rooms the
/// squares are blocked, one deep, apart from doors; a random spanning tree of the rooms has them, and some other walls.
/// Within rooms obstacles are blocked one by one where what is left of the room and its doors stays connected. So all
/// free cells are connected by edges between free cells, and every room has some. All boundary edges are in patch 1,
/// "border".
///
/// Throws InvalidArgument: no rooms along an axis, rooms without squares, doors without squares or wider than a room,
/// as many obstacles as a room has squares, a share outside [0, 1], and as generate_rectangle() does. Cost: about 0.1
/// us a cell, and of obstacles about 10 ns times the squares of a room each.
MeshData generate_maze(const MazeOptions& options);

}  // namespace dartcast
