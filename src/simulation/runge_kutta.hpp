// The classical Runge-Kutta scheme for particles that follow a velocity field.
#pragma once

#include <span>

#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/vector_field.hpp"
#include "simulation/flow_aim.hpp"

namespace dartcast {

struct RungeKuttaStep {
  const CellComplex& complex;
  const VectorField& field;            ///< set to three times: the step's start, middle and end
  double dt;                           ///< s
  bool moving;                         ///< vertices go from their previous positions to their positions in the step
  std::span<const Vec3> halfway = {};  ///< `moving`: the positions of all vertices in the middle of the step
};

/// The mean velocity of the step. The step's target is then the particle's position plus dt times the velocity. A stage
/// is only a place where the field is evaluated: it changes no state, and its rounding decides nothing. The way to a
/// stage is an exact walk from the particle, in the mesh as it is at the stage's time. It passes faces of periodic
/// pairs. If a wall is in the way, the field at the contact counts. If an invalid cell is in the way, the field at the
/// particle counts. Preconditions: the particle is not held; `moving`: its state is from before the move. Cost: four
/// evaluations, three short walks.
Vec3 runge_kutta_velocity(const RungeKuttaStep& step, const ParticleState& particle);

/// The same for many, to the same bits. The stages of most particles go through the batch, the others one by one.
/// Targets and `aimed` are not used. Velocities of particles that are held or not alive stay as they are.
void runge_kutta_velocities(const RungeKuttaStep& step, const detail::FlowParticles& particles);

}  // namespace dartcast
