// The particles of a simulation, points and spheres: injection, forces, contacts, and what becomes of them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/simulation.hpp"
#include "environment/part_environment.hpp"
#include "simulation/aiming.hpp"
#include "simulation/component.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/parcels.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/particle_share.hpp"
#include "simulation/periodic_images.hpp"
#include "simulation/sampled_fields.hpp"
#include "simulation/seeding.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/sphere_contacts.hpp"
#include "simulation/tally_plan.hpp"

namespace dartcast {

class Inlets;
struct InletCone;

/// Its step also moves the vertices: with collisions between the spheres' impulses and their walk. A function with the name
/// of one of Simulation's does the work of that function.
class ParticleSystem final : public SimulationComponent {
 public:
  ParticleSystem(Environment& environment, Followers& followers, MovingVertices& motion,
                 const SimulationOptions& options);

  [[nodiscard]] Aiming& aiming() { return aiming_; }
  [[nodiscard]] SampledFields& sampled() { return sampled_; }
  [[nodiscard]] const PeriodicImages& images() const { return images_; }
  /// Gives all particles the values of the sampled arrays at their places now, and adds their integrals over a duration.
  void take_samples(double duration = 0.0) { sampled_.take(set_, motion_.time(), duration); }
  /// Steps are added to it by this plan; null: to none.
  void set_tally(CellTally* tally, const TallyPlan* plan) {
    tally_ = tally;
    plan_ = plan;
    aiming_.count_losses(plan != nullptr && plan->needs_losses());
  }
  [[nodiscard]] const Parcels& parcels() const { return parcels_; }
  /// Whether steps list the parcels of contacts.
  void list_parcels(bool listed) { lists_parcels_ = listed; }
  /// The environment is a part of one that ranks share by cells. Precondition: there are no particles.
  void set_part(PartEnvironment& part);
  [[nodiscard]] std::optional<SampledPart> sampled_part() const;
  /// The particles as bytes, for each rank those in the cells that owner(cell) gives it.
  [[nodiscard]] std::vector<std::string> packed_for(const std::function<std::uint32_t(Cell)>& owner) const;
  /// Puts these in place of all particles: those that all ranks have packed for this one, whose environment is of
  /// another part, and stands where that one stood.
  void take_over(const std::vector<std::string>& packed);
  std::vector<AddResult> add(std::span<const Vec3> positions, const NewParticle& particle);
  std::vector<AddResult> add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                             std::span<const double> radii, std::span<const double> user_data,
                             std::span<const Material> materials);
  void add_random(std::size_t count, const NewParticle& particle);
  /// Begins a step.
  void inject(Inlets& inlets);

  void step(double begin) override;
  void update_after_edit(const ComplexEditReport& edit, OrphanPolicy orphaned) override;
  void save(SimulationState& state) const override;
  void restore(const SimulationState& state) override;
  [[nodiscard]] Audit audit() const override;
  [[nodiscard]] StateHash state_hash() const override;
  [[nodiscard]] SimulationEnergy energy() const;

  [[nodiscard]] const SimulationOptions& options() const { return options_; }
  [[nodiscard]] const WallResponses& responses() const { return responses_; }
  [[nodiscard]] const Environment& environment() const { return environment_; }
  [[nodiscard]] const SimulationStep& last_step() const { return last_; }
  /// Takes the step of all ranks in place of this one's.
  void set_last_step(SimulationStep step) { last_ = std::move(step); }
  [[nodiscard]] ParticleShare share() const { return ParticleShare(options_.ranks); }
  /// The effects of the last edit.
  struct Edited {
    UpdateReport report;
    struct Absorbed {
      std::uint64_t id = 0;
      std::uint64_t number = 1;  ///< of particles that it stands for
    };
    std::vector<Absorbed> absorbed;
    std::uint64_t since_step = 0;  ///< absorbed by all edits since the last step
  };
  [[nodiscard]] const Edited& edited() const { return edited_; }
  [[nodiscard]] const MovingVertices& motion() const { return motion_; }
  [[nodiscard]] ParticleSet& set() { return set_; }
  [[nodiscard]] const ParticleSet& set() const { return set_; }
  [[nodiscard]] const SimulationTotals& totals() const { return totals_; }
  [[nodiscard]] SphereContacts& sphere_contacts() { return contacts_; }
  [[nodiscard]] const SphereContacts& sphere_contacts() const { return contacts_; }

 private:
  // In particle_system.cpp.
  [[nodiscard]] bool collides() const { return options_.collisions && set_.spheres > 0; }
  void move_vertices();
  void advance_segment(unsigned segment, std::vector<std::uint8_t>& departed);
  [[nodiscard]] ContactCallback answer(const Acceleration& acceleration);
  [[nodiscard]] ContactCallback response(double dt);
  void take_back_amounts(const StepReport& report, std::span<const double> amounts);
  void count_contacts();
  void mark_held();
  void remove_gone(std::span<const std::uint8_t> departed);
  void remove_absorbed(const UpdateReport& report, std::span<const ParticleState> before);
  // In particle_system_add.cpp.
  std::vector<AddResult> add_own(std::span<const Vec3> positions);
  template <class Sampler>
  void add_sampled(const Sampler& sampler, std::uint64_t count, const NewParticle& particle);
  void send_out(const InletCone& cone, std::size_t first);
  // In particle_system_part.cpp.
  [[nodiscard]] ParticleState whole_state(std::size_t i) const;
  StepReport advance_in_part(const Acceleration& acceleration, std::vector<std::uint8_t>& departed);
  // In particle_system_checkpoint.cpp.
  [[nodiscard]] bool is_mine(std::uint64_t id, const ParticleState& state) const;
  void put_in_place_of_all(const SavedParticles& saved);

  Environment& environment_;
  MovingVertices& motion_;
  SimulationOptions options_;
  CellTally* tally_ = nullptr;
  const TallyPlan* plan_ = nullptr;  // of the tally
  bool lists_parcels_ = false;
  PartEnvironment* part_ = nullptr;  // none: the environment is whole
  WallResponses responses_;
  ParticleSet set_;
  Parcels parcels_;
  Aiming aiming_;
  SampledFields sampled_;
  PeriodicImages images_;
  SphereStepper stepper_;
  SimultaneousStepper simultaneous_stepper_;
  SphereContacts contacts_;
  SimulationStep last_;
  Edited edited_;
  SimulationTotals totals_;
  StateHash gone_;
};

}  // namespace dartcast
