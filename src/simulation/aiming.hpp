// The forces on particles, and where they lead in a step. Not installed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dartcast/simulation.hpp"
#include "simulation/eddies.hpp"
#include "simulation/flow_aim.hpp"
#include "simulation/force_step.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/sampled_fields.hpp"

namespace dartcast {

/// Gravity, drag, the velocity field and the force of a simulation; or its forces and its user's law.
class Aiming {
 public:
  /// All outlive it.
  Aiming(const Environment& environment, Followers& followers, const MovingVertices& motion,
         const SimulationOptions& options, const WallResponses& responses, const SampledFields& sampled);

  void set_field(VelocityField field) { field_ = std::move(field); }
  void set_force(VectorField force) { force_ = std::move(force); }
  /// Throws InvalidArgument if there is no field. `what` needs it.
  void check_field(std::string_view what) const;
  /// Brings the field alone to a time.
  void set_field_time(double time);
  /// The field at a corner of a simplex, relative to the mesh by its last move, which an edit ends. Precondition: the field
  /// stands at the time.
  [[nodiscard]] Vec3 flow_at_corner(SimplexId at, unsigned corner) const;
  /// Gives particles from this one on the field's velocity at their places. Throws as check_field().
  void start_with_field(ParticleSet& set, std::size_t first, double time);
  void set_law(ParticleLaw law);
  /// Reads what the next step needs of the fields' files, before that step changes anything. Throws as
  /// VectorField::hold(), and InvalidArgument if an integrator has no field to follow.
  void load_step();

  [[nodiscard]] const Eddies& eddies() const { return eddies_; }
  [[nodiscard]] std::size_t numbers_of_eddies() const { return eddies_.act() ? eddy_numbers.size() : 0; }

  /// Brings the fields to the times of a segment of a step.
  void set_times(double begin, double duration);
  /// The number of the next segment in the run, for random numbers.
  void set_moment(std::uint64_t moment) { moment_ = moment; }
  /// Gives each particle the velocity and the target of a segment. `moving`: their positions are from before the last move.
  void aim(ParticleSet& set, double dt, bool moving);
  /// Targets of stuck particles are known only once their walls have moved.
  void aim_stuck(ParticleSet& set, double dt);
  /// By particle.
  [[nodiscard]] std::span<Vec3> targets() { return targets_; }
  /// From now on aim() also finds what particles lose to drag, or not.
  void count_losses(bool counted) { counts_losses_ = counted; }
  /// By particle; empty if they are not counted.
  [[nodiscard]] std::span<const DragLoss> losses() const { return losses_; }
  /// The acceleration that contacts know of: none if a field or a force changes velocities, too. Drag reduces it.
  [[nodiscard]] Acceleration acceleration(double dt) const;

 private:
  struct Segment {
    const Particles& particles;
    std::span<const ParticleStatus> statuses;
    std::span<Vec3> velocities;
    double dt;    // s
    double lost;  // share of the velocity relative to the flow that drag takes
    bool moving;
  };
  struct Aim {
    Vec3 velocity;
    Vec3 target;
  };

  [[nodiscard]] Segment segment_of(ParticleSet& set, double dt, bool moving);
  void aim_at_field(const Segment& segment);
  void aim_by_runge_kutta(const Segment& segment);
  void aim_by_forces(const Segment& segment, ParticleSet& set);
  void add_eddies(const Segment& segment, ParticleSet& set);
  void note_losses(const Segment& segment, std::span<const Vec3> before);
  [[nodiscard]] bool diffuses() const { return options_.diffusion > 0.0 || !options_.diffusivity.empty(); }
  void check_sampled(std::string_view what, const std::string& name) const;
  void diffuse(const Segment& segment, const ParticleSet& set);
  [[nodiscard]] ForceStep::Fields fields() const;
  void aim_one(const Segment& segment, std::size_t i);
  void aim_in_flight(const Segment& segment, std::size_t begin, std::size_t end);
  void find_halfway();
  [[nodiscard]] detail::FlowParticles of_segment(const Segment& segment, std::size_t begin, std::size_t end,
                                                 std::span<std::uint8_t> aimed);
  [[nodiscard]] detail::FlowScene flow_scene(const Segment& segment) const;
  [[nodiscard]] Aim aim_at(const Segment& segment, std::size_t i) const;
  [[nodiscard]] Vec3 accelerated(const Segment& segment, const Vec3& v, const Vec3& flow, const Vec3& force) const;
  [[nodiscard]] double lost_to_drag(double dt) const;

  const Environment& environment_;
  const MovingVertices& motion_;
  const SimulationOptions& options_;
  const WallResponses& responses_;
  const SampledFields& sampled_;
  std::optional<VelocityField> field_;
  std::optional<VectorField> force_;  // accelerations, on top of gravity
  Eddies eddies_;
  ForceStep forces_;
  double begin_ = 0.0;  // of the segment, s
  std::uint64_t moment_ = 0;
  std::vector<Vec3> targets_;
  std::vector<Vec3> halfway_;  // vertices in the middle of a move
  bool counts_losses_ = false;
  std::vector<DragLoss> losses_;
};

}  // namespace dartcast
