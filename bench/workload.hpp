// A workload: a scene, particles in it, and how both move.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/random.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/vector_field.hpp"

namespace dartcast::bench {

enum class Scene : std::uint8_t {
  box,      ///< size^3 unit cubes, the outer layer and a share of the others blocked; particles fly at random
  lattice,  ///< the same box; particles on its planes, lines and points, that move along its directions
  squares,  ///< size^2 unit squares of the plane, the outer layer and a tenth of the others blocked, as the box
  tube,     ///< 1,000 prisms over a regular polygon of `size` corners, one upon another
  bar,      ///< the paper's 5 x 5 x 28 cubes, as scenes/bar_static.toml and scenes/bar_deforming.toml
  vessel    ///< the branching vessel; particles are carried by its flow, and back where they meet a wall or an end
};

struct WorkloadOptions {
  std::string name;  ///< of the row: "W1"
  Scene scene = Scene::box;
  std::uint32_t size = 10;
  bool deforms = false;
  std::size_t particles = 1000;
  bool cell_order = false;  ///< particles sorted by cell at the start, else at random
  std::size_t steps = 1000;
  double step_length = 0.1;             ///< of a particle, in cells
  double blocked_share = 0.1;           ///< boxes and squares: of the cells that are not in the outer layer
  std::vector<unsigned> threads = {1};  ///< of dartcast; several take turns, a step each
  bool against_competitors = true;
};

MeshData mesh_of(const WorkloadOptions& options);
/// A point array of three components. Precondition: the mesh has it.
std::vector<Vec3> vectors(const MeshData& mesh, std::string_view name);
/// Empty where the scene stands still. In boxes and squares no vertex moves by more than 0.06 cells a step, whatever
/// the size.
std::vector<DeformationStep> deformation_of(const WorkloadOptions& options, const MeshData& mesh);

/// Carries particles through one scene, a step after another: aim(), then environment().move() where the scene deforms,
/// environment().advance(particles(), targets()), and update_after_edit() with its report. The same bits in every run.
class Workload {
 public:
  explicit Workload(const WorkloadOptions& options);

  [[nodiscard]] Environment& environment() { return environment_; }
  [[nodiscard]] const Environment& environment() const { return environment_; }
  [[nodiscard]] Particles& particles() { return particles_; }
  [[nodiscard]] std::span<const Vec3> targets() const { return targets_; }
  [[nodiscard]] bool deforms() const { return options_.deforms; }
  [[nodiscard]] double cell_size() const { return cell_size_; }

  /// Steps aimed at so far.
  [[nodiscard]] std::uint64_t step() const { return step_; }
  /// Where all vertices are after so many steps. Precondition: the scene deforms.
  void positions_after(std::uint64_t step, std::span<Vec3> out) const;

  /// Computes the next step's targets and, where the scene deforms, the next positions of all vertices.
  void aim();
  /// Turns back the particles that have met walls.
  void update_after_edit(const StepReport& report);

 private:
  Workload(const WorkloadOptions& options, MeshData mesh);

  void add_particles();
  void add_on_lattice(std::size_t count, Random& random);
  void sort_by_cell();
  void set_velocities(Random& random);
  [[nodiscard]] Vec3 carried(std::size_t particle, std::span<const Vec3> next) const;
  [[nodiscard]] Vec3 rebound(const Vec3& v, const Contact& contact, std::span<const WallHit> walls) const;

  WorkloadOptions options_;
  double dt_ = 1.0;
  double cell_size_ = 1.0;
  double speed_ = 0.0;  // that walls give back; 0: they give back what they take
  Vec3 gravity_;
  std::uint64_t step_ = 0;
  Environment environment_;
  Particles particles_;
  std::optional<Deformation> deformation_;
  std::optional<VelocityField> field_;
  std::vector<Vec3> velocities_;  // in a field: x is the direction, forward or back
  std::vector<Vec3> targets_;
};

}  // namespace dartcast::bench
