// Looks for the faces in reach with the instruction set of the machine.
#include "dynamics/reached_faces.hpp"

namespace dartcast::detail {

std::uint64_t reached_faces(const Shape& shape, const std::uint32_t* vertices, const Vec3* before, const Vec3* after,
                            const MovingBox& box, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::faces_in_reach(shape, vertices, before, after, box);
#endif
  return portable::faces_in_reach(shape, vertices, before, after, box);
}

}  // namespace dartcast::detail
