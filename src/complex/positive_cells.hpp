// Which of four cells of one shape have positive simplices, as far as a filter proves it: a cell in each lane of a
// vector.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/instruction_set.hpp"
#include "dartcast/cell_shape.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::detail {

/// Bit i is set if the bound of orient3d(), taken of the cell's extent, does not prove all simplices of cell i
/// positive. Cells of very many points are always left open. The same with every instruction set. `vertices`: of each
/// cell, in the order of the shape's local numbers; may be those of one cell again. Cost: about 2 ns a simplex and cell
/// if four differ.
unsigned not_proved_positive(const Shape& shape, const std::array<const std::uint32_t*, 4>& vertices,
                             const Vec3* positions, InstructionSet set = best_instruction_set());

inline constexpr std::size_t max_filtered_points = 64;

// Bit i is set if all simplices of cell i are proved positive. Precondition: the shape has at most
// max_filtered_points.
namespace portable {
unsigned proved_positive(const Shape& shape, const std::array<const std::uint32_t*, 4>& vertices,
                         const Vec3* positions);
}  // namespace portable
namespace avx2 {
unsigned proved_positive(const Shape& shape, const std::array<const std::uint32_t*, 4>& vertices,
                         const Vec3* positions);
}  // namespace avx2

}  // namespace dartcast::detail
