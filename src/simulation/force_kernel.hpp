// The fluid at particles, the forces of ForceOptions, the exact motion under them, and random motion: a particle in each lane
// of a vector.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/instruction_set.hpp"
#include "base/keyed_random.hpp"
#include "dartcast/forces.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/response.hpp"
#include "tracking/batch/particle_cache.hpp"

namespace dartcast::detail {

/// A field at points, as it is sampled. Arrays hold an entry for each vertex.
struct FieldAtPoints {
  const Vec3* now = nullptr;
  const Vec3* before = nullptr;   ///< positions before the last move; `now` if nothing moves
  const Vec3* values = nullptr;   ///< at the stage's time
  const Vec3* earlier = nullptr;  ///< and `later`: values whose difference gives the rates
  const Vec3* later = nullptr;
  const Vec3* rest = nullptr;  ///< positions at rest; null in space's frame
  bool planar = false;
  bool moving = false;    ///< particles still have positions relative to `before`
  bool carries = false;   ///< the mesh's velocity is part of the field's
  double per_move = 0.0;  ///< 1 / s: the inverse of the time of the last move
  double per_time = 0.0;  ///< 1 / s: the inverse of the time from `earlier` to `later`
};

/// Samples of a field at consecutive particles; all spans have the same size, or are empty if nothing is asked for.
struct SamplesOfField {
  std::span<Vec3> values;
  std::span<VelocityGradient> gradients;
  std::span<double> spreads;  ///< the square of the greatest difference of values from a simplex's first corner
  std::span<Vec3> rates;
  std::span<Vec3> mesh;  ///< the mesh's velocity
};

/// Particles of a block: consecutive, all spans of the same size.
struct StageParticles {
  std::span<const ParticleState> states;
  std::span<const VertexNumbers> vertices;
  std::span<const Vec3> ways;  ///< as seen from the mesh, to where rates are sampled; empty: at the particles
};

/// The forces that are the same for all particles.
struct ForceTerms {
  enum class Drag : std::uint8_t { none, stokes, schiller_naumann, putnam };
  Drag drag = Drag::none;
  bool buoyancy = false;
  bool pressure_gradient = false;
  bool virtual_mass = false;
  bool saffman_mei = false;
  bool lorentz = false;
  Fluid fluid;
  Vec3 gravity;
  Vec3 electric_field;
  Vec3 magnetic_field;
  bool brownian = false;
};

/// Samples a field at points. Bit k of sampled[i] is set if this was done for particle 4 i + k. It is left to the
/// caller if the simplex is a sliver. `sampled`: a byte for each four particles, and for those that remain.
void sample_field(const FieldAtPoints& field, const StageParticles& particles, const SamplesOfField& samples,
                  std::span<std::uint8_t> sampled, InstructionSet set = best_instruction_set());

/// Moves samples by these ways: along the gradient, but by no more than the spread.
void shift_samples(const SamplesOfField& samples, std::span<const Vec3> ways,
                   InstructionSet set = best_instruction_set());

/// Fills in the result. `particles`: those of its spans that the terms need. The span of rotations may be empty without the
/// Lorentz force.
void apply_forces(const ForceTerms& terms, const LawParticles& particles, const LawSamples& samples,
                  const LawResult& result, InstructionSet set = best_instruction_set());

/// Moves particles for a time under a result that is held, exact but for rounding, with the rotations of Boris' scheme.
/// `ends`: the velocities then.
struct HeldMotion {
  std::span<const Vec3> starts;
  std::span<const Vec3> fluid;
  LawResult result;
  double duration = 0.0;
  std::span<Vec3> ends;
  std::span<Vec3> ways;
};
void move_held(const HeldMotion& motion, InstructionSet set = best_instruction_set());

/// Random ways: three normal deviates each, times a length. In the plane z is 0.
struct RandomWays {
  RandomMoment moment;
  double length = 0.0;
  bool planar = false;
  std::span<const std::uint64_t> ids;
  std::span<Vec3> ways;
};
void draw_ways(const RandomWays& random, InstructionSet set = best_instruction_set());

/// The random motion that a fluid's molecules add within a time, in which velocities relax at these rates. Velocity and way are
/// drawn together, from the exact law of G. E. Uhlenbeck and L. S. Ornstein, 1930.
struct ThermalMotion {
  RandomMoment moment;
  bool planar = false;
  double duration = 0.0;
  double energy = 0.0;         ///< k T, J
  double added_density = 0.0;  ///< of the fluid that moves along, kg / m^3
  std::span<const std::uint64_t> ids;
  std::span<const double> diameters;
  std::span<const double> densities;
  std::span<const double> rates;
  std::span<Vec3> ends;  ///< and `ways`: are added to
  std::span<Vec3> ways;
};
void add_thermal_motion(const ThermalMotion& motion, InstructionSet set = best_instruction_set());

namespace portable {
void sample_field(const FieldAtPoints& field, const StageParticles& particles, const SamplesOfField& samples,
                  std::span<std::uint8_t> sampled);
void shift_samples(const SamplesOfField& samples, std::span<const Vec3> ways);
void apply_forces(const ForceTerms& terms, const LawParticles& particles, const LawSamples& samples,
                  const LawResult& result);
void move_held(const HeldMotion& motion);
void draw_ways(const RandomWays& random);
void add_thermal_motion(const ThermalMotion& motion);
}  // namespace portable
namespace avx2 {
void sample_field(const FieldAtPoints& field, const StageParticles& particles, const SamplesOfField& samples,
                  std::span<std::uint8_t> sampled);
void shift_samples(const SamplesOfField& samples, std::span<const Vec3> ways);
void apply_forces(const ForceTerms& terms, const LawParticles& particles, const LawSamples& samples,
                  const LawResult& result);
void move_held(const HeldMotion& motion);
void draw_ways(const RandomWays& random);
void add_thermal_motion(const ThermalMotion& motion);
}  // namespace avx2

}  // namespace dartcast::detail
