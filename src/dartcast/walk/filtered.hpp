// The steps of many particles at once, as far as the filter alone decides them: the usual case, made fast.
//
// It decides nothing of its own: where a sign is not proved, a wall is met, or anything else is out of the ordinary,
// the step is left as it was for Stepper (walk/step.hpp), which comes to the same result wherever both do.
#pragma once

#include <cstdint>
#include <span>

#include "dartcast/geometry/complex.hpp"
#include "dartcast/walk/counters.hpp"
#include "dartcast/walk/state.hpp"

namespace dartcast::detail {

/// Particles in one call, at most.
inline constexpr std::size_t filtered_batch = 512;

struct FilteredScene {
  const Complex* complex = nullptr;
  bool moved = false;      ///< as for Stepper
  double tolerance = 0.0;  ///< as in StepOptions
};

/// Takes the steps that it can, counts them, and marks the others with 1 in `left`. All spans: one entry per particle.
/// Preconditions: as for Stepper::step(). Cost: about 20 ns a step; memory is asked for ahead of time, so that a large
/// scene costs little more than a small one.
void step_filtered(const FilteredScene& scene, std::span<State> states, std::span<const Vec3> targets,
                   std::span<std::uint8_t> left, Counters& counters);

}  // namespace dartcast::detail
