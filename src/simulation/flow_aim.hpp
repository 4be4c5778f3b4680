// Velocities and targets of particles that a velocity field carries: a particle in each lane of a vector.
#pragma once

#include <cstdint>
#include <span>

#include "base/instruction_set.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/response.hpp"
#include "tracking/batch/particle_cache.hpp"

namespace dartcast::detail {

/// The values that are the same for all particles in a step. Arrays hold an entry for each vertex.
struct FlowScene {
  const Vec3* now = nullptr;
  const Vec3* before = nullptr;  ///< positions before the last move; `now` if nothing moves
  const Vec3* values = nullptr;  ///< of the field
  const Vec3* rest = nullptr;    ///< positions at rest; null in space's frame
  bool planar = false;
  bool moving = false;       ///< particles still have positions relative to `before`
  double per_move = 0.0;     ///< 1 / s: the inverse of the time of the last move
  double dt = 0.0;           ///< s
  bool drags = false;        ///< otherwise a particle has the velocity of the flow
  double lost = 0.0;         ///< share of the velocity relative to the flow that drag takes in this time
  Vec3 terminal = {};        ///< velocity relative to the flow that gravity and drag lead to
  const Vec3* at = nullptr;  ///< positions of vertices where find_flow() is to find the particles
};

/// Consecutive particles. All spans have the same size, but that of `aimed` is a quarter of it, rounded down.
struct FlowParticles {
  std::span<const ParticleState> states;
  std::span<const VertexNumbers> vertices;
  std::span<const ParticleStatus> statuses;
  std::span<Vec3> velocities;
  std::span<Vec3> targets;
  std::span<std::uint8_t> aimed;
};

/// Gives particles new velocities and targets, as Aiming does one by one, with the same bits in every instruction set.
/// Bit k of aimed[i] is set if this was done for particle 4 i + k. It is left to the caller if the particle is held or
/// not alive, or its simplex is a sliver. Fewer than four at the end are left to the caller, too.
void aim_in_flow(const FlowScene& scene, const FlowParticles& particles, InstructionSet set = best_instruction_set());

/// The same for the velocity of the flow alone, by scene.at. It reads neither velocities nor targets.
void find_flow(const FlowScene& scene, const FlowParticles& particles, InstructionSet set = best_instruction_set());

namespace portable {
void aim_in_flow(const FlowScene& scene, const FlowParticles& particles);
void find_flow(const FlowScene& scene, const FlowParticles& particles);
}  // namespace portable
namespace avx2 {
void aim_in_flow(const FlowScene& scene, const FlowParticles& particles);
void find_flow(const FlowScene& scene, const FlowParticles& particles);
}  // namespace avx2

}  // namespace dartcast::detail
