// The statistics of a simulation: it has no particles of its own, and observes those of the particle system.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "dartcast/cell_tally.hpp"
#include "dartcast/statistics.hpp"
#include "simulation/component.hpp"
#include "simulation/particle_system.hpp"
#include "simulation/start_times.hpp"
#include "simulation/tally_plan.hpp"

namespace dartcast {

/// A particle that left in the last step.
struct Leaving {
  std::uint64_t id = 0;
  ParticleStatus status = ParticleStatus::escaped;  // or absorbed
  Patch patch;                                      // where it left
  double age = 0.0;                                 // s
  std::uint64_t number = 1;                         // of particles that it stands for
  std::uint32_t of_class = 0;
};

/// It steps after the particles and before edits that end a step: contacts then still name cells that exist. A step
/// finds what has happened; count() adds that to the totals. In between the first rank gets what all have found.
class StatisticsComponent final : public SimulationComponent {
 public:
  explicit StatisticsComponent(const ParticleSystem& particles) : particles_(particles) {}

  /// Starts anew. Throws as Simulation::set_statistics().
  void set_options(const StatisticsOptions& options);
  [[nodiscard]] const StatisticsOptions& options() const { return options_; }
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }
  /// Whether steps list parcels.
  [[nodiscard]] bool lists_parcels() const {
    return options_.hits && (options_.impacts || particles_.parcels().exist());
  }
  /// None if no quantity is kept by cell.
  [[nodiscard]] CellTally* tally() { return tally_ ? &*tally_ : nullptr; }
  /// The plan of the tally and of classes; none if there are neither.
  [[nodiscard]] const TallyPlan* plan() const { return plan_ ? &*plan_ : nullptr; }
  [[nodiscard]] double& seconds() { return statistics_.seconds; }
  /// Throws InvalidArgument if the state is of a simulation with other statistics.
  void check(const SimulationState& state) const;

  /// After the injection, before anything moves.
  void note_start();
  void step(double begin) override;
  /// Adds what the last step has found to the totals.
  void count();
  [[nodiscard]] const std::vector<Leaving>& leavings() const { return leavings_; }
  /// In place of what this rank has found.
  void set_found(std::vector<PlanePassage> passages, std::vector<PathPoint> points, std::vector<Leaving> leavings);
  void update_after_edit(const ComplexEditReport& edit, OrphanPolicy orphaned) override;
  void save(SimulationState& state) const override;
  void restore(const SimulationState& state) override;
  /// Whether the tally adds up.
  [[nodiscard]] Audit audit() const override;
  [[nodiscard]] StateHash state_hash() const override { return {}; }

 private:
  [[nodiscard]] bool observes_motion() const {
    return options_.residence || !options_.planes.empty() || options_.pathlines() || (plan_ && plan_->needs_ages());
  }
  [[nodiscard]] std::uint64_t number_of(std::size_t i) const { return numbers_.empty() ? 1 : numbers_[i]; }
  void keep_on_first(std::vector<std::uint64_t> words);
  void find_ends();
  void find_passages(double begin);
  void find_leavings(double begin);
  void add_path_points(double begin);
  void add_contacts(std::size_t i, std::size_t first, std::size_t end, double begin);
  [[nodiscard]] bool has_pathline(std::uint64_t id) const;

  const ParticleSystem& particles_;
  StatisticsOptions options_;
  Statistics statistics_;
  std::optional<TallyPlan> plan_;
  std::optional<CellTally> tally_;
  StartTimes starts_;
  std::vector<Leaving> leavings_;  // of the last step, by id
  // The particles of the step, as they were after the injection.
  std::vector<std::uint64_t> ids_;
  std::vector<Vec3> before_;
  std::vector<std::uint64_t> numbers_;  // empty: each stands for itself
  std::vector<std::uint32_t> classes_;  // empty: there are none
  std::size_t first_new_ = 0;           // those from here on take their first step
  std::vector<Vec3> start_velocities_;  // of these
  std::vector<Vec3> after_;
  std::vector<std::uint32_t> now_;  // the number of each particle after the step
};

}  // namespace dartcast
