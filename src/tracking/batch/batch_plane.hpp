// The steps of many particles of the plane at once.
//
// Each step is the walk of tracking/walk.hpp, sign for sign. The batch takes one triangle of every walk at a time, so
// that memory is prefetched. A step that ends in its first triangle computes less. Walls, and all that is out of the
// ordinary, are deferred to Stepper (tracking/step.hpp), as in space (tracking/batch/batch.hpp). The states are the
// same in the end. The counts are the same, too, except if rounding carries a particle out of its triangle, or to
// its very target.
#pragma once

#include "tracking/batch/batch.hpp"

namespace dartcast::detail {

/// Takes the steps that it can, and counts them. Caches are neither read nor written. Preconditions: the complex is of
/// the plane; else as for Stepper::step(). Cost: about 15 ns a step.
void step_plane(const BatchScene& scene, const BatchSteps& steps, Counters& counters,
                InstructionSet set = best_instruction_set());

}  // namespace dartcast::detail
