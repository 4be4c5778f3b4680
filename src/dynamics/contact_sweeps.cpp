// Runs the iterations over packets of contacts on threads, with the instruction set of the machine.
#include "dynamics/contact_sweeps.hpp"

namespace dartcast::detail {

// An iteration is two stages: all regions, and the contacts between them. It goes through them backwards and forwards
// in turn; the last time forwards.
template <class Sweep>
void ContactPackets::sweep(unsigned iterations, Threads threads, Sweep&& one) {
  const std::size_t regions = parts_.size() - 1;
  const auto is_forwards = [&](std::size_t iteration) { return (iterations - iteration) % 2 == 1; };
  if (regions == 0) {
    for (unsigned i = 0; i < iterations; ++i) one(parts_[0].begin, parts_[0].end, is_forwards(i));
    return;
  }
  counts_.clear();
  for (unsigned i = 0; i < iterations; ++i) {
    counts_.push_back(is_forwards(i) ? regions : 1);
    counts_.push_back(is_forwards(i) ? 1 : regions);
  }
  parallel_stages(counts_, 1, threads, [&](std::size_t stage, std::size_t begin, std::size_t end) {
    const bool forwards = is_forwards(stage / 2);
    const bool between = (stage % 2 == 1) == forwards;
    for (std::size_t k = begin; k < end; ++k) {
      const Part& part = parts_[between ? regions : k];
      one(part.begin, part.end, forwards);
    }
  });
}

void ContactPackets::start(std::span<ContactBody> bodies, Threads threads, [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data()};
  sweep(1, threads, [&](std::size_t begin, std::size_t end, bool) {
#if defined(__x86_64__)
    if (set == InstructionSet::avx2) return avx2::start_packets(spans, bodies.data(), begin, end);
#endif
    portable::start_packets(spans, bodies.data(), begin, end);
  });
}

void ContactPackets::solve(std::span<ContactBody> bodies, unsigned iterations, Threads threads,
                           [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data()};
  sweep(iterations, threads, [&](std::size_t begin, std::size_t end, bool forwards) {
#if defined(__x86_64__)
    if (set == InstructionSet::avx2) return avx2::solve_packets(spans, bodies.data(), begin, end, forwards);
#endif
    portable::solve_packets(spans, bodies.data(), begin, end, forwards);
  });
}

void ContactPackets::position_correction(std::span<ContactBody> bodies, unsigned iterations, Threads threads,
                                         [[maybe_unused]] InstructionSet set) {
  const PacketSpans spans = {packets_.data(), impulses_.data(), surfaces_.data(), corrections_.data()};
  sweep(iterations, threads, [&](std::size_t begin, std::size_t end, bool forwards) {
#if defined(__x86_64__)
    if (set == InstructionSet::avx2) return avx2::correct_packets(spans, bodies.data(), begin, end, forwards);
#endif
    portable::correct_packets(spans, bodies.data(), begin, end, forwards);
  });
}

}  // namespace dartcast::detail
