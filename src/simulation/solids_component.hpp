// Makes rigid tools from plain data, and moves them as a part of a simulation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/solids.hpp"
#include "simulation/component.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/rigid_pose.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

/// The tools of a simulation. One that turns goes on chords of its arcs, in slices of a step. If the vertices of the
/// environment move, solids and walls make their step together, with all else that stops walls. Then the particles' step
/// calls move_with() in place of Environment::move().
class SolidsComponent final : public SimulationComponent {
 public:
  /// `dt`: of a step, s.
  SolidsComponent(Environment& environment, const MovingVertices& motion, double dt)
      : environment_(environment), motion_(motion), dt_(dt) {}

  /// Throws Error that names the solid: its shape is a file or has a defect, or its place is refused.
  void add(const SolidScene& scene);
  void steer(std::size_t solid, const Vec3& velocity, const Vec3& turn);
  /// Moves the environment to these positions, as far as the solids and these partners let it. They all move with it:
  /// the solids from the time `begin` on.
  void move_with(double begin, std::span<const Vec3> positions, std::vector<MovePartner*> partners);

  void step(double begin) override;
  void update_after_edit(const ComplexEditReport& edit, OrphanPolicy orphaned) override;
  void save(SimulationState& state) const override;
  void restore(const SimulationState& state) override;
  [[nodiscard]] Audit audit() const override;
  [[nodiscard]] StateHash state_hash() const override;

  /// None until the first is added.
  [[nodiscard]] const std::optional<SolidSet>& solids() const { return solids_; }
  [[nodiscard]] const SolidStep& last_step() const { return last_; }
  [[nodiscard]] const std::string& name(std::size_t solid) const { return tools_[solid].scene.name; }
  /// Its shape, where it was put first.
  [[nodiscard]] const SolidMesh& mesh(std::size_t solid) const { return tools_[solid].mesh; }
  [[nodiscard]] std::vector<SolidSummary> summaries() const;

 private:
  struct Tool {
    SolidScene scene;         // without its shape
    SolidMesh mesh;           // where it was put first
    RigidPose pose;           // where it is
    RigidPose wanted;         // where it should be
    RigidWay way;             // of the step
    double separation = 0.0;  // kept from walls if it turns
    bool steered = false;     // by hand, by its one move
    std::uint64_t contacts = 0;
    std::uint64_t stopped = 0;

    // Writes where its points are at a pose.
    template <class Out>
    void put(const RigidPose& at, Out out) const {
      const Vec3 pivot = scene.pivot + at.displacement;
      for (const Vec3& x : mesh.points) *out++ = pivot + rotated(at.rotation, x - scene.pivot);
    }
  };

  void add_named(const SolidScene& scene);
  [[nodiscard]] std::vector<std::uint32_t> met_by(const SolidScene& scene) const;
  void check_turns(const Tool& tool) const;
  [[nodiscard]] double slices(const Tool& tool, const Vec3& turn) const;
  [[nodiscard]] SolidWay way(double begin);
  [[nodiscard]] static bool turns(const Tool& tool);
  [[nodiscard]] static SolidArc arc_of(const Tool& tool);
  void follow(const SolidStep& step);

  [[nodiscard]] bool walls_were_stopped() const { return walls_before_ < 1.0 || walls_now_ < 1.0; }

  Environment& environment_;
  const MovingVertices& motion_;
  double dt_;
  std::optional<SolidSet> solids_;
  std::vector<Tool> tools_;
  SolidStep last_;
  bool moved_ = false;         // in this step, with the environment
  double walls_before_ = 1.0;  // the shares that the walls made of the last two moves
  double walls_now_ = 1.0;
  std::vector<VertexPlaces> places_at_edits_;  // of steps at which the walls had been stopped
};

/// The vertices of one solid.
inline std::vector<Vec3> vertices_of(const SolidSet& solids, std::size_t solid) {
  const auto first = solids.first_vertices();
  const auto vertices = solids.positions().subspan(first[solid], first[solid + 1] - first[solid]);
  return {vertices.begin(), vertices.end()};
}

}  // namespace dartcast
