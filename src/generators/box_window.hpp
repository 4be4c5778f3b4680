// Some cubes of a generated box, to the same bits as in the whole. Not installed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dartcast/generators.hpp"

namespace dartcast {

/// The cubes [low, high) along each axis.
struct BoxWindow {
  std::array<std::uint32_t, 3> low = {0, 0, 0};
  std::array<std::uint32_t, 3> high = {0, 0, 0};

  [[nodiscard]] std::size_t cubes() const {
    return std::size_t{high[0] - low[0]} * (high[1] - low[1]) * (high[2] - low[2]);
  }
};

/// Cells and patch faces of these cubes, and their points, each in the order of the whole. Precondition: the window is in
/// the box; if it is not all of it, nothing is mixed or blocked at random. Throws as generate_box().
MeshData generate_box_window(const BoxOptions& options, const BoxWindow& window);

/// The number in a box that is not mixed.
std::uint32_t cells_per_cube(CellType type);

}  // namespace dartcast
