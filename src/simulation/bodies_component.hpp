// The bodies of a simulation, with the surfaces that follow them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bodies/carried_surface.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/component.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

class BodiesComponent final : public SimulationComponent {
 public:
  /// A body's surface as it was put into the scene, and how it follows the particles.
  struct Skin {
    MeshData mesh;
    CarriedSurface carried;
  };

  BodiesComponent(Environment& environment, const SimulationOptions& options, const WallResponses& responses)
      : environment_(environment), options_(options), responses_(responses) {}

  /// A body without a name and a surface. Throws as Bodies::add().
  AddBodyResult add(std::span<const Vec3> points, const BodyOptions& options);
  /// Throws Error that names the body: its surface is a file or cannot be sampled, or particles are in no free cell
  /// (how many, and the first).
  void add(const BodyScene& scene);

  /// For one joint move; null if no body has edges.
  [[nodiscard]] MovePartner* partner();

  void step(double begin) override;
  void update_after_edit(const ComplexEditReport& edit, OrphanPolicy orphaned) override;
  void save(SimulationState& state) const override;
  void restore(const SimulationState& state) override;
  [[nodiscard]] Audit audit() const override;
  [[nodiscard]] StateHash state_hash() const override;

  /// None until the first is added.
  [[nodiscard]] const std::optional<Bodies>& bodies() const { return bodies_; }
  [[nodiscard]] std::optional<Bodies>& bodies() { return bodies_; }
  /// The last step.
  [[nodiscard]] const BodiesStep& last_step() const { return last_; }
  [[nodiscard]] const std::string& name(std::size_t body) const { return names_[bodies_->id(body)]; }
  /// None for a body without a surface.
  [[nodiscard]] const std::optional<Skin>& skin(std::size_t body) const { return skins_[bodies_->id(body)]; }
  /// The points of the skin() now. Precondition: it has one.
  [[nodiscard]] std::vector<Vec3> surface_points(std::size_t body) const;
  [[nodiscard]] std::vector<BodySummary> summaries() const;

 private:
  Bodies& made();
  void add_named(const BodyScene& scene);

  Environment& environment_;
  const SimulationOptions& options_;
  const WallResponses& responses_;
  std::optional<Bodies> bodies_;
  std::vector<std::string> names_;          // by id
  std::vector<std::optional<Skin>> skins_;  // by id
  BodiesStep last_;
};

}  // namespace dartcast
