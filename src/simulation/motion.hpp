// One step of a prescribed motion at one time, applied to vertices: four at a time, in the lanes of vectors.
#pragma once

#include <cstddef>
#include <span>

#include "base/elementary.hpp"
#include "base/instruction_set.hpp"
#include "dartcast/deformation.hpp"

namespace dartcast::detail {

/// The values that are the same for all vertices.
struct Motion {
  /// `step` outlives it. Precondition: its axis has length 1 or 0, and so has its direction, across the axis.
  Motion(const DeformationStep& step, double time);

  const DeformationStep* step;
  double turns;                   ///< of the period, less the whole ones
  double amount;                  ///< the amplitude times the sine of the turns
  SineCosine angle = {0.0, 1.0};  ///< rotate, swing
};

/// Moves consecutive vertices. `first`: the number of the first of them, for the values that a step has for each vertex.
/// The same bits with every instruction set and however the vertices are divided. Cost: 3 to 10 ns a vertex.
void apply(const Motion& motion, std::span<Vec3> vertices, std::size_t first,
           InstructionSet set = best_instruction_set());

namespace portable {
void apply(const Motion& motion, std::span<Vec3> vertices, std::size_t first);
}  // namespace portable
namespace avx2 {
void apply(const Motion& motion, std::span<Vec3> vertices, std::size_t first);
}  // namespace avx2

}  // namespace dartcast::detail
