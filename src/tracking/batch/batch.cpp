// Runs the kernel of the batch with the instruction set of the machine.
#include "tracking/batch/batch.hpp"

#include "dartcast/predicates.hpp"
#include "tracking/batch/batch_kernel.hpp"

namespace dartcast::detail {

void step_batch(const BatchScene& scene, const BatchSteps& steps, Counters& counters,
                [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::step(scene, steps, counters);
#endif
  portable::step(scene, steps, counters);
}

bool all_as_decided(std::span<const Vec3> points) {
  if (points.empty()) return true;
  const double* x = &points[0].x;
#if defined(__x86_64__)
  if (best_instruction_set() == InstructionSet::avx2)
    return avx2::all_between(x, 3 * points.size(), smallest_magnitude, largest_magnitude);
#endif
  return portable::all_between(x, 3 * points.size(), smallest_magnitude, largest_magnitude);
}

}  // namespace dartcast::detail
