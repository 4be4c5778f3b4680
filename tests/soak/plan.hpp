// The parts of a case's simulation, each there or not, drawn from the case.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/events.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "soak/case.hpp"
#include "soak/scene.hpp"

namespace dartcast::soak {

class Plan {
 public:
  Plan(const Case& c, const SceneMesh& scene);

  [[nodiscard]] SimulationOptions options(Ranks* ranks) const;
  [[nodiscard]] bool collides() const { return has_spheres() && has(4); }
  [[nodiscard]] bool has_field() const { return has(12); }
  /// Whether all particles fly alike: without fields, random motion and walls, and with one size.
  [[nodiscard]] bool flies_freely() const;
  [[nodiscard]] bool has_parcels() const { return has(3); }
  [[nodiscard]] bool has_inlet() const;
  /// Whether scene() takes D from an array: that of diffusivity(), or numbers at random.
  [[nodiscard]] bool has_varying_diffusion() const { return has(28) && !collides(); }
  [[nodiscard]] bool has_linear_diffusion() const { return has_varying_diffusion() && has(29); }
  [[nodiscard]] double diffusivity(const Vec3& x) const;
  [[nodiscard]] Vec3 diffusivity_gradient() const;
  /// Adds all parts. Those that find no place are left out, alike in all that are made so. `particles`: whether there are
  /// any; a checkpoint brings them.
  void fill(Simulation& s, bool particles) const;
  /// Its points, motion and fields as a scene in space, without all that ranks by cells refuse.
  [[nodiscard]] Scene scene() const;

 private:
  [[nodiscard]] bool has(unsigned bit) const { return ((choice_ >> bit) & 1U) != 0; }
  [[nodiscard]] bool has_spheres() const { return case_[Knob::spheres] != 0; }
  [[nodiscard]] std::vector<double> user_data() const;
  [[nodiscard]] Vec3 velocity() const;
  [[nodiscard]] std::unique_ptr<Random> in(std::uint64_t part) const;
  [[nodiscard]] Vec3 place(Random& random) const;
  [[nodiscard]] ForceOptions forces() const;
  [[nodiscard]] Material material() const;
  [[nodiscard]] WallResponse response() const;
  [[nodiscard]] std::vector<Vec3> field() const;
  [[nodiscard]] DeformationStep deformation() const;
  void add_diffusivity(Scene& s) const;
  [[nodiscard]] StatisticsOptions statistics() const;
  [[nodiscard]] std::vector<Event> events() const;
  void add_body(Simulation& s) const;
  void add_solid(Simulation& s, int number) const;
  void add_catheter(Simulation& s) const;

  const Case& case_;
  const SceneMesh& scene_;
  bool space_;
  std::string door_;  // the patch of inlets; empty: there is none
  std::uint64_t choice_;
};

}  // namespace dartcast::soak
