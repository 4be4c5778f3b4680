// The catheters of a simulation, each moved as its plan says.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "dartcast/catheter.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/component.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

class CathetersComponent final : public SimulationComponent {
 public:
  /// `dt`: of a step, s.
  CathetersComponent(Environment& environment, double dt) : environment_(environment), dt_(dt) {}

  /// Throws Error that names the catheter if its entry is not in the lumen.
  void add(const CatheterScene& scene);

  void steer(std::size_t i, const CatheterInput& input);

  /// Those with edges, each for one joint move.
  [[nodiscard]] std::vector<MovePartner*> partners();

  void step(double begin) override;
  void update_after_edit(const ComplexEditReport& edit, OrphanPolicy orphaned) override;
  void save(SimulationState& state) const override;
  void restore(const SimulationState& state) override;
  [[nodiscard]] Audit audit() const override;
  [[nodiscard]] StateHash state_hash() const override;

  [[nodiscard]] const std::deque<Catheter>& catheters() const { return catheters_; }
  [[nodiscard]] std::span<const CatheterScene> scenes() const { return scenes_; }
  /// The last step of each.
  [[nodiscard]] std::span<const CatheterStep> last_steps() const { return last_; }
  [[nodiscard]] std::vector<CatheterSummary> summaries() const;
  /// A camera's places along a catheter, from its entry inwards. Empty if nothing is inserted.
  [[nodiscard]] CameraPath camera_path(std::size_t i) const;

 private:
  Environment& environment_;
  double dt_;
  std::vector<CatheterScene> scenes_;
  std::vector<std::optional<CatheterInput>> steered_;  // by hand
  std::deque<Catheter> catheters_;                     // they cannot be moved
  std::vector<CatheterStep> last_;
  std::vector<CatheterTotals> totals_;
};

}  // namespace dartcast
