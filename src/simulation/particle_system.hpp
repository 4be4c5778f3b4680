// The particles of a simulation, points and spheres: injection, forces, contacts, and what becomes of them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "dartcast/simulation.hpp"
#include "environment/part_environment.hpp"
#include "simulation/aiming.hpp"
#include "simulation/component.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/particle_share.hpp"
#include "simulation/seeding.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/sphere_contacts.hpp"

namespace dartcast {

/// Its step also moves the vertices: with collisions between the spheres' impulses and their walk. A function with the name
/// of one of Simulation's does the work of that function.
class ParticleSystem final : public SimulationComponent {
 public:
  ParticleSystem(Environment& environment, MovingVertices& motion, const SimulationOptions& options);

  [[nodiscard]] Aiming& aiming() { return aiming_; }
  /// Called in each step when the inlets have injected, before anything moves; empty: nothing is.
  void set_after_injection(std::function<void()> call) { after_injection_ = std::move(call); }
  /// The environment is a part of one that ranks share by cells. Precondition: there are no particles.
  void set_part(PartEnvironment& part);
  /// The particles as bytes, for each rank those in the cells that owner(cell) gives it.
  [[nodiscard]] std::vector<std::string> packed_for(const std::function<std::uint32_t(Cell)>& owner) const;
  /// Puts these in place of all particles: those that all ranks have packed for this one, whose environment is of
  /// another part, and stands where that one stood.
  void take_over(const std::vector<std::string>& packed);
  void add_inlet(Patch patch, double rate, const Vec3& velocity, double radius, std::span<const double> user_data);
  std::vector<AddResult> add(std::span<const Vec3> positions, const Vec3& velocity, double radius,
                             std::span<const double> user_data);
  std::vector<AddResult> add(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                             std::span<const double> radii, std::span<const double> user_data);
  void add_random(std::size_t count, const Vec3& velocity, double radius, std::span<const double> user_data);

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
  [[nodiscard]] const ParticleShare& share() const { return share_; }
  [[nodiscard]] std::uint64_t next_id() const { return set_.next_id; }
  [[nodiscard]] const UpdateReport& last_update() const { return last_update_; }  ///< of the last edit
  [[nodiscard]] std::span<const std::uint64_t> absorbed_by_edit() const {
    return absorbed_by_edit_;
  }  ///< ids, last edit
  [[nodiscard]] double time() const { return motion_.time(); }
  [[nodiscard]] const Particles& particles() const { return set_.states; }
  [[nodiscard]] const ParticleTable& table() const { return set_.table; }
  [[nodiscard]] std::span<const std::uint64_t> ids() const { return table()[set_.table.id]; }
  [[nodiscard]] std::span<const Vec3> velocities() const { return table()[set_.table.velocity]; }
  [[nodiscard]] std::span<const ParticleStatus> fates() const { return table()[set_.table.fate]; }
  [[nodiscard]] std::span<const std::uint32_t> contact_counts() const { return table()[set_.table.contact_count]; }
  [[nodiscard]] std::span<const double> radii() const { return table()[set_.table.radius]; }
  [[nodiscard]] std::span<const std::uint8_t> held() const { return table()[set_.table.held]; }
  [[nodiscard]] std::span<double> user_data(std::size_t i) {
    return set_.table[set_.table.user_data].subspan(i * width(), width());
  }
  [[nodiscard]] std::span<const double> user_data(std::size_t i) const {
    return table()[set_.table.user_data].subspan(i * width(), width());
  }
  [[nodiscard]] const SimulationTotals& totals() const { return totals_; }
  [[nodiscard]] SphereContacts& sphere_contacts() { return contacts_; }
  [[nodiscard]] const SphereContacts& sphere_contacts() const { return contacts_; }

 private:
  struct Inlet {
    Patch patch;
    PatchSampler sampler;  // empty while it is closed
    double rate;
    Vec3 velocity;
    double radius;
    std::vector<double> user_data;
  };
  // In particle_system.cpp.
  void move_vertices();
  void advance_segment(unsigned segment);
  void count_contacts();
  void mark_held();
  void remove_gone();
  // In particle_system_add.cpp.
  void inject();
  void check_motion(const Vec3& velocity, double radius, std::string_view whose) const;
  void check_user_data(std::span<const double> values) const;
  std::vector<AddResult> add_own(std::span<const Vec3> positions);
  void complete_next(const AddResult& added, const Vec3& velocity, double radius, std::span<const double> user_data);
  template <class Sampler>
  void add_sampled(const Sampler& sampler, std::size_t count, const Vec3& velocity, double radius,
                   std::span<const double> user_data);
  template <class Sampler>
  std::vector<std::uint64_t> place(const Sampler& sampler, std::uint64_t first, std::uint64_t count);
  [[nodiscard]] std::size_t width() const { return options_.user_data.size(); }
  // In particle_system_part.cpp.
  [[nodiscard]] std::optional<SampledPart> sampled_part() const;
  [[nodiscard]] ParticleState whole_state(std::size_t i) const;
  StepReport advance_in_part(const Acceleration& acceleration);
  template <class Sampler>
  std::vector<std::uint64_t> place_in_part(const Sampler& sampler, std::uint64_t first, std::uint64_t count);
  [[nodiscard]] std::vector<std::uint64_t> of_all_ranks(const std::vector<std::uint64_t>& ids) const;
  // In particle_system_edit.cpp.
  void remove_absorbed(const UpdateReport& report, std::span<const ParticleState> before);
  // In particle_system_checkpoint.cpp.
  [[nodiscard]] bool is_mine(std::uint64_t id, const ParticleState& state) const;
  void put_in_place_of_all(const SavedParticles& saved);
  [[nodiscard]] bool collides() const { return options_.collisions && set_.spheres > 0; }
  [[nodiscard]] ContactCallback response(double dt);

  Environment& environment_;
  MovingVertices& motion_;
  SimulationOptions options_;
  ParticleShare share_;
  PartEnvironment* part_ = nullptr;  // none: the environment is whole
  WallResponses responses_;
  std::vector<Inlet> inlets_;

  ParticleSet set_;
  std::vector<std::uint8_t> departed_;  // in this step, to other ranks; empty: none
  Aiming aiming_;
  SphereStepper stepper_;
  SimultaneousStepper simultaneous_stepper_;
  SphereContacts contacts_;
  std::uint64_t absorbed_between_ = 0;  // by edits since the last step
  SimulationStep last_;
  UpdateReport last_update_;
  std::vector<std::uint64_t> absorbed_by_edit_;
  std::function<void()> after_injection_;
  SimulationTotals totals_;
  StateHash gone_;
};

}  // namespace dartcast
