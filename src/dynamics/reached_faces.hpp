// The faces of a cell that a box may reach while both move.
#pragma once

#include <cstdint>

#include "base/instruction_set.hpp"
#include "dartcast/cell_shape.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::detail {

/// A box in a frame that moves: by `shift` in the time in which the vertices go from before to after.
struct MovingBox {
  Vec3 low, high, shift;
};

/// Bit f is set unless all points of face f lie beyond one side of the box, both before and after. The same with every
/// instruction set. `vertices`: of the cell, in the order of the shape's local numbers. `before` and `after` may be the
/// same. Precondition: the shape has at most 64 points and 64 faces. Cost: 310 instructions for a hexahedron.
std::uint64_t reached_faces(const Shape& shape, const std::uint32_t* vertices, const Vec3* before, const Vec3* after,
                            const MovingBox& box, InstructionSet set = best_instruction_set());

namespace portable {
std::uint64_t faces_in_reach(const Shape& shape, const std::uint32_t* vertices, const Vec3* before, const Vec3* after,
                             const MovingBox& box);
}  // namespace portable
namespace avx2 {
std::uint64_t faces_in_reach(const Shape& shape, const std::uint32_t* vertices, const Vec3* before, const Vec3* after,
                             const MovingBox& box);
}  // namespace avx2

}  // namespace dartcast::detail
