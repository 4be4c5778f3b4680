// The steps of many particles at once, as far as the filter alone decides them: the usual case, made fast.
//
// It decides nothing of its own: where a sign is not proved, or anything else is out of the ordinary, the step is left
// as it was for Stepper (tracking/step.hpp), which comes to the same result wherever both do; ties between facets are
// broken by the walk's own functions. What follows at a wall is left to Stepper, too. (Only the counts may differ:
// where riding along rounds a particle out of its simplex, Stepper puts it back and walks from there, though its target
// is inside.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/instruction_set.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "tracking/batch/simplex_cache.hpp"
#include "tracking/step.hpp"

namespace dartcast::detail {

/// Particles in one call, at most.
inline constexpr std::size_t max_batch = 1024;

struct BatchScene {
  const CellComplex* complex = nullptr;
  bool moved = false;         ///< as for Stepper
  bool caches_match = false;  ///< they are of the states; trails: before the move
  double tolerance = 0.0;     ///< as in StepOptions
  bool walls_match = true;    ///< no wall is new since the marks were made
};

/// The numbers of the vertices of the simplex that a particle is in: kept beside its state, so that a step that ends in
/// the same simplex need not look them up.
using VertexNumbers = std::array<std::uint32_t, 4>;

inline VertexNumbers vertex_numbers(const CellComplex& complex, SimplexId s) {
  const auto v = complex.vertices(s);
  return {v[0].value, v[1].value, v[2].value, v[3].value};
}

/// What is kept of a particle at p: a trail; coordinates are left to the next step. `positions`: of all vertices.
SimplexCacheEntry cache_entry_of(CacheKind kind, std::span<const Vec3> positions, const VertexNumbers& vertices,
                                 const Vec3& p);

/// What was done of a step: all, nothing, or, where it has come to its first wall, the number of its Begun; its state
/// is as it was, then.
using StepStatus = std::uint16_t;
inline constexpr StepStatus step_complete = 0xffff;
inline constexpr StepStatus step_untouched = 0xfffe;

/// One entry per particle in each.
struct BatchSteps {
  std::span<ParticleState> states;
  std::span<VertexNumbers> vertices;  ///< of each state
  SimplexCacheSpan caches;  ///< moved: trails; else coordinates, or empty: none are kept. In where they match; out for
                            ///< each step taken
  std::span<const Vec3> targets;
  std::span<StepStatus> taken;        ///< out
  std::vector<PartialStep>& partial;  ///< out; empty before
  std::vector<WallImpact>& impacts;   ///< of these; out; empty before
};

/// Takes the steps that it can, and counts them. The same bits with every instruction set. Preconditions: as for
/// Stepper::step(). Cost: about 20 ns a step; memory is asked for ahead of time, so that a large scene costs little
/// more than a small one.
void step_batch(const BatchScene& scene, const BatchSteps& steps, Counters& counters,
                InstructionSet set = best_instruction_set());

/// Whether all points are in the exact range, and flushed() (dartcast/predicates.hpp).
bool all_as_decided(std::span<const Vec3> points);

}  // namespace dartcast::detail
