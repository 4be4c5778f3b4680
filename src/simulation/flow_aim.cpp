// Aims particles in a flow with the instruction set of the machine.
#include "simulation/flow_aim.hpp"

namespace dartcast::detail {

void aim_in_flow(const FlowScene& scene, const FlowParticles& particles, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::aim_in_flow(scene, particles);
#endif
  portable::aim_in_flow(scene, particles);
}

void find_flow(const FlowScene& scene, const FlowParticles& particles, [[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx2) return avx2::find_flow(scene, particles);
#endif
  portable::find_flow(scene, particles);
}

}  // namespace dartcast::detail
