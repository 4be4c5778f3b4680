// Cells that a search through them rests on: whether they stay positive while their vertices move.
#pragma once

#include <optional>
#include <span>

#include "dartcast/cell_complex.hpp"
#include "dynamics/near_walls.hpp"

namespace dartcast {

/// The last time known before a simplex of these cells becomes flat, or nothing: 0 if one is from the start.
std::optional<double> first_flat_time(const CellComplex& complex, std::span<const Cell> cells,
                                      const VertexMotion& walls);

}  // namespace dartcast
