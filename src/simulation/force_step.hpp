// The way of particles under ForceOptions and a law of the user's, in a segment of a step. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/simulation.hpp"
#include "simulation/eddies.hpp"
#include "simulation/force_kernel.hpp"
#include "simulation/moving_vertices.hpp"
#include "simulation/particle_set.hpp"
#include "simulation/sampled_fields.hpp"

namespace dartcast {

/// Throws InvalidArgument if the options contradict each other, or lack a number that a term needs.
void check_forces(const SimulationOptions& options, bool planar);
/// Empty, or what is wrong with a particle's material for these forces, behind "a particle's".
[[nodiscard]] std::string wrong_material(const Material& material, const ForceOptions& forces);

/// The loss of a particle to drag in a segment, for each kg of its mass.
struct DragLoss {
  Vec3 momentum;        ///< m/s
  double energy = 0.0;  ///< J/kg: the work against drag
};

/// Its scheme is the exponential midpoint rule. Coefficients and field at the start predict the middle of the segment;
/// those at the middle are then held over the whole. The field at the middle is that of the particle's simplex,
/// continued with its gradient. It changes by no more than it does within the simplex.
class ForceStep {
 public:
  /// All outlive it.
  ForceStep(const Environment& environment, const MovingVertices& motion, const SimulationOptions& options,
            const Eddies& eddies, const SampledFields& sampled);

  void set_law(ParticleLaw law) { law_ = std::move(law); }
  [[nodiscard]] bool acts() const { return law_ || !options_.forces.terms.empty(); }
  /// Times of a segment at which the fields must stand: its start, its middle, its end.
  [[nodiscard]] std::size_t moments() const { return needs_rates() ? 3 : 2; }

  /// Null: none.
  struct Fields {
    const VectorField* velocity;
    const VectorField* force;
  };
  /// Throws InvalidArgument if a term needs more than the field has.
  void check(const Fields& fields) const;

  /// Each stands at moments() of the segment. `begin`, `duration`: of the segment, s.
  struct Segment {
    Fields fields;
    double begin;
    double duration;
    bool moving;                 ///< particles have positions from before the last move
    std::uint64_t moment;        ///< number of the segment in the run, for random numbers
    std::span<DragLoss> losses;  ///< of each particle that moves, to be filled in; empty: not asked for
  };
  /// Gives velocities and targets to all particles that are alive and not held. Throws what the law throws, and
  /// InvalidArgument if the law's values cannot be used. Velocities are then unchanged.
  void aim(const Segment& segment, ParticleSet& set, std::span<Vec3> targets);

 private:
  // Samples of a field, by particle.
  struct Sampled {
    std::vector<Vec3> values;
    std::vector<VelocityGradient> gradients;
    std::vector<double> spreads;
    std::vector<Vec3> rates;
    std::vector<Vec3> mesh;

    void resize(std::size_t size);
    [[nodiscard]] detail::SamplesOfField block(std::size_t begin, std::size_t size);
  };

  [[nodiscard]] bool needs_rates() const { return law_ || terms_.pressure_gradient || terms_.virtual_mass; }
  void sample_start(const Segment& segment, ParticleSet& set, std::size_t begin, std::size_t end);
  void predict_middle(const Segment& segment, const ParticleSet& set, std::size_t begin, std::size_t end);
  void finish(const Segment& segment, ParticleSet& set, std::span<Vec3> targets, std::size_t begin, std::size_t end);
  void note_losses(const Segment& segment, const ParticleSet& set, std::size_t begin, std::size_t end) const;
  void draw_eddies(const Segment& segment, ParticleSet& set, std::size_t begin, std::size_t end);
  void sample(const Segment& segment, const VectorField& field, const ParticleSet& set, std::size_t moment,
              std::span<const Vec3> ways, Sampled& to, std::size_t begin, std::size_t end) const;
  void sample_one(const Segment& segment, const VectorField& field, const ParticleState& state, std::size_t moment,
                  Sampled& to, std::size_t i) const;
  void continue_samples(const Segment& segment, const VectorField& field, const ParticleSet& set, Sampled& samples,
                        std::size_t begin, std::size_t end) const;
  void apply(const Segment& segment, const ParticleSet& set, std::span<const Vec3> velocities, std::size_t begin,
             std::size_t end);
  void call_law(const ParticleSet& set, std::span<const Vec3> velocities, double time);
  void move(const ParticleSet& set, double duration, std::size_t begin, std::size_t end);
  void add_thermal_motion(const Segment& segment, const ParticleSet& set, std::size_t begin, std::size_t end);
  [[nodiscard]] LawResult result(std::size_t begin, std::size_t size);
  [[nodiscard]] LawParticles particles(const ParticleSet& set, std::span<const Vec3> velocities, std::size_t begin,
                                       std::size_t size) const;
  [[nodiscard]] LawSamples samples(std::size_t begin, std::size_t size) const;

  const Environment& environment_;
  const MovingVertices& motion_;
  const SimulationOptions& options_;
  const Eddies& eddies_;
  const SampledFields& sampled_;
  detail::ForceTerms terms_;
  ParticleLaw law_;
  Sampled fluid_;
  Sampled force_;
  std::vector<Vec3> accelerations_;
  std::vector<double> rates_;
  std::vector<Vec3> rotations_;
  std::vector<Vec3> velocities_;  // in the middle, then at the end
  std::vector<Vec3> ways_;        // to there
  std::vector<Vec3> eddy_velocities_;
  std::vector<Vec3> positions_;  // for the law
};

}  // namespace dartcast
