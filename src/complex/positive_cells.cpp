// Runs the filter of four cells with the instruction set of the machine.
#include "complex/positive_cells.hpp"

namespace dartcast::detail {

unsigned not_proved_positive(const Shape& shape, const std::array<const std::uint32_t*, 4>& vertices,
                             const Vec3* positions, [[maybe_unused]] InstructionSet set) {
  constexpr unsigned all = 0xf;
  if (shape.point_count() > max_filtered_points) return all;
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::proved_positive(shape, vertices, positions) ^ all;
#endif
  return portable::proved_positive(shape, vertices, positions) ^ all;
}

}  // namespace dartcast::detail
