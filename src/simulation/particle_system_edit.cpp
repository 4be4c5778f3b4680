// Updates particles, field and inlets after an edit of the environment.
#include <algorithm>

#include "simulation/particle_system.hpp"

namespace dartcast {

void ParticleSystem::update_after_edit(const ComplexEditReport& edit, OrphanPolicy orphaned) {
  const std::vector<ParticleState> before(set_.states.states().begin(), set_.states.states().end());
  contacts_.forget_walls();
  last_update_ = environment_.update_after_edit(set_.states, orphaned);
  remove_absorbed(last_update_, before);
  aiming_.update_after_edit(edit);
  for (Inlet& inlet : inlets_) inlet.sampler.update_after_edit(environment_.complex(), edit);
}

void ParticleSystem::remove_absorbed(const UpdateReport& report, std::span<const ParticleState> before) {
  std::vector<std::uint8_t> marks(ids().size(), 0);
  std::uint64_t absorbed = 0;
  absorbed_by_edit_.clear();
  for (const OrphanedParticle& p : report.orphaned) {
    if (p.outcome != OrphanPolicy::absorb) continue;
    marks[p.particle] = 1;
    ++absorbed;
    absorbed_by_edit_.push_back(ids()[p.particle]);
    gone_.add(ids()[p.particle], before[p.particle], set_.velocities()[p.particle],
              static_cast<std::uint64_t>(ParticleStatus::absorbed));
  }
  if (absorbed == 0) return;
  totals_.absorbed += absorbed;
  absorbed_between_ += absorbed;
  set_.remove_rows(marks);
}

}  // namespace dartcast
