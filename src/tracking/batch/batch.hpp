// The steps of many particles at once, as far as floating-point filters alone decide them: the usual case, made fast.
//
// The batch makes no decision of its own. If a sign is not proved, or anything else is out of the ordinary, it defers
// the unchanged step to Stepper (tracking/step.hpp). Both have the same result if both take a step: ties between
// facets are broken by the walk's own functions. The batch walks up to the first wall; Stepper continues from there.
// If a step is split and the target is far, the batch walks its first slice. If particles stop at walls, it says where
// the mesh carries them by the end. Only the counts may differ. Walks to far targets ask other questions. And if
// rounding carries a particle out of its simplex, Stepper puts it back and walks from there, though its target is
// inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/instruction_set.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "tracking/batch/particle_cache.hpp"
#include "tracking/batch/simplex_cache.hpp"
#include "tracking/step_state.hpp"

namespace dartcast::detail {

/// Particles in one call, at most.
inline constexpr std::size_t max_batch = 1024;

struct BatchScene {
  const CellComplex* complex = nullptr;
  bool moved = false;         ///< as for Stepper
  bool caches_match = false;  ///< the caches are of these states, before the move
  StepOptions options;
  bool walls_match = true;          ///< no wall is new since the caches' flags were set
  bool stops = false;               ///< particles stop at the first wall: nothing responds
  const Vec3* positions = nullptr;  ///< of all vertices by the end of the step; null: as the complex has them

  [[nodiscard]] const Vec3* now() const { return positions != nullptr ? positions : complex->positions().data(); }
};

/// How much of a step the batch did: all, nothing, or the number of its StepState. A number means that the step has
/// come to its first wall, or to the end of its first slice; its state is unchanged then.
using StepStatus = std::uint16_t;
inline constexpr StepStatus step_complete = 0xffff;
inline constexpr StepStatus step_untouched = 0xfffe;

/// One entry per particle in each.
struct BatchSteps {
  std::span<ParticleState> states;
  std::span<VertexNumbers> vertices;  ///< of each state
  /// moved: of previous geometry; else of barycentric coordinates. Read if they match; written for each step taken.
  SimplexCacheSpan caches;
  std::span<const Vec3> targets;
  std::span<StepStatus> status;     ///< out
  std::vector<StepState>& partial;  ///< out; empty before
};

/// Takes the steps that it can, and counts them. The same bits with every instruction set. Preconditions: as for
/// Stepper::step(). Cost: about 20 ns a step, in large scenes too, as memory is prefetched.
void step_batch(const BatchScene& scene, const BatchSteps& steps, Counters& counters,
                InstructionSet set = best_instruction_set());

/// Whether all points are in the exact range, and have the bits of flushed() (dartcast/predicates.hpp).
bool all_as_decided(std::span<const Vec3> points);

}  // namespace dartcast::detail
