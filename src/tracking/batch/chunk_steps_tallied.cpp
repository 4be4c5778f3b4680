// The steps of a chunk that are added to a tally.
#include "tracking/batch/chunk_steps.inl"

namespace dartcast::detail {

template void BatchStepper::step_chunk<true>(const BatchScene& scene, const BatchParticles& particles,
                                             std::span<const Vec3> targets, std::size_t begin, std::size_t end,
                                             ChunkSteps& steps) const;

}  // namespace dartcast::detail
