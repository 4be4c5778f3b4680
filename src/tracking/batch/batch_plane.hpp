// The steps of many particles of the plane at once.
//
// Each is the walk of tracking/walk.hpp, sign for sign, but taken a triangle of every particle at a time, so that
// memory is asked for ahead of time; and what a step that ends where it began need not know is not worked out. What
// follows at a wall, and all that is out of the ordinary, is left to Stepper (tracking/step.hpp), as in space
// (tracking/batch/batch.hpp): the states are the same in the end, and so are the counts, but where riding along rounds
// a particle out of its triangle, or to its very target.
#pragma once

#include "tracking/batch/batch.hpp"

namespace dartcast::detail {

/// Takes the steps that it can, and counts them. No trails are read or left. Preconditions: the complex is of the
/// plane; else as for Stepper::step(). Cost: about 20 ns a step.
void step_plane(const BatchScene& scene, const BatchSteps& steps, Counters& counters);

}  // namespace dartcast::detail
