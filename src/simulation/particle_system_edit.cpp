// Edits of the environment between the steps of a flow, and what goes along with them.
#include <algorithm>

#include "dartcast/error.hpp"
#include "dartcast/simulation.hpp"

namespace dartcast {

SimulationEdit Simulation::edit(const std::function<void(ComplexEdit&)>& make, OrphanPolicy orphaned) {
  const std::vector<ParticleState> before(particles_.states().begin(), particles_.states().end());
  SimulationEdit done;
  done.edit = environment_.edit(make);
  clear_.clear();
  done.particles = environment_.update_after_edit(particles_, orphaned);
  remove_absorbed(done.particles, before);
  if (deformation_) deformation_->update_after_edit(done.edit, environment_.positions().size());
  if (field_) field_->update_after_edit(done.edit, environment_.complex());
  reopen_inlets();
  if (after_edit_) after_edit_(orphaned);
  return done;
}

void Simulation::remove_absorbed(const UpdateReport& report, std::span<const ParticleState> before) {
  std::vector<std::uint8_t> marks(ids_.size(), 0);
  std::uint64_t absorbed = 0;
  for (const OrphanedParticle& p : report.orphaned) {
    if (p.outcome != OrphanPolicy::absorb) continue;
    marks[p.particle] = 1;
    ++absorbed;
    gone_.add(ids_[p.particle], before[p.particle], velocities_[p.particle],
              static_cast<std::uint64_t>(ParticleStatus::absorbed));
  }
  if (absorbed == 0) return;
  totals_.absorbed += absorbed;
  absorbed_between_ += absorbed;
  remove_marked(marks);
}

void Simulation::reopen_inlets() {
  for (Inlet& inlet : inlets_) {
    inlet.sampler.reset();
    if (has_free_face(environment_.map(), inlet.patch)) inlet.sampler.emplace(environment_.complex(), inlet.patch);
  }
}

RepairReport Simulation::repair(const RepairOptions& options) {
  std::vector<Cell> invalid;
  for (const InvalidCell& c : environment_.validity(static_cast<std::size_t>(-1)).first) invalid.push_back(c.cell);
  RepairReport report;
  if (invalid.empty()) return report;
  edit([&](ComplexEdit& e) { report = dartcast::repair(e, invalid, options); });
  return report;
}

void Simulation::pull(std::span<const Vec3> displacement, double duration) {
  const auto positions = environment_.positions();
  const bool plane = environment_.map().dimension() == 2;
  if (plane && std::any_of(displacement.begin(), displacement.end(), [](const Vec3& d) { return d.z != 0.0; }))
    throw InvalidArgument("flow: a pull moves points out of the plane: in the plane every z must be 0");
  if (!deformation_) deformation_.emplace(std::vector<DeformationStep>{}, positions);
  deformation_->add_pull(displacement, time(), time() + duration);
}

}  // namespace dartcast
