// Runs the iterations over packets of contacts with the instruction set of the machine.
#include "dynamics/contact_sweeps.hpp"

namespace dartcast::detail {

void ContactPackets::start(std::span<ContactBody> bodies, [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data(), packets_.size()};
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::start_all(spans, bodies.data());
#endif
  portable::start_all(spans, bodies.data());
}

void ContactPackets::solve(std::span<ContactBody> bodies, unsigned iterations, [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data(), packets_.size()};
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::solve_all(spans, bodies.data(), iterations);
#endif
  portable::solve_all(spans, bodies.data(), iterations);
}

void ContactPackets::position_correction(std::span<ContactBody> bodies, unsigned iterations,
                                         [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data(), packets_.size()};
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::correct_all(spans, bodies.data(), iterations);
#endif
  portable::correct_all(spans, bodies.data(), iterations);
}

}  // namespace dartcast::detail
