// A step of a motion at a time, and its application with the instruction set of the machine.
#include "simulation/motion.hpp"

#include <cmath>

namespace dartcast::detail {

// Without whole turns, sine and cosine lose no digits however long a run is.
Motion::Motion(const DeformationStep& s, double time)
    : step(&s), turns(std::fmod(time / s.period, 1.0)), amount(s.amplitude * sine_cosine_of_turns(turns).sine) {
  if (s.kind == DeformationKind::rotate) angle = sine_cosine_of_turns(turns);
  if (s.kind == DeformationKind::swing) angle = sine_cosine(amount);
}

void apply(const Motion& motion, std::span<Vec3> vertices, std::size_t first, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::apply(motion, vertices, first);
#endif
  portable::apply(motion, vertices, first);
}

}  // namespace dartcast::detail
