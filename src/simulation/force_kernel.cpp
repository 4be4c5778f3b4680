// Samples, forces and motion with the instruction set of the machine.
#include "simulation/force_kernel.hpp"

namespace dartcast::detail {

void sample_field(const FieldAtPoints& field, const StageParticles& particles, const SamplesOfField& samples,
                  std::span<std::uint8_t> sampled, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::sample_field(field, particles, samples, sampled);
#endif
  portable::sample_field(field, particles, samples, sampled);
}

void shift_samples(const SamplesOfField& samples, std::span<const Vec3> ways, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::shift_samples(samples, ways);
#endif
  portable::shift_samples(samples, ways);
}

void apply_forces(const ForceTerms& terms, const LawParticles& particles, const LawSamples& samples,
                  const LawResult& result, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::apply_forces(terms, particles, samples, result);
#endif
  portable::apply_forces(terms, particles, samples, result);
}

void move_held(const HeldMotion& motion, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::move_held(motion);
#endif
  portable::move_held(motion);
}

void draw_ways(const RandomWays& random, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::draw_ways(random);
#endif
  portable::draw_ways(random);
}

void add_thermal_motion(const ThermalMotion& motion, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::add_thermal_motion(motion);
#endif
  portable::add_thermal_motion(motion);
}

}  // namespace dartcast::detail
