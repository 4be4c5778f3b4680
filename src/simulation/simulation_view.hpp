// Views of a simulation's parts, for the library's writers, tests and benches. Nothing can be changed through them.
#pragma once

#include <cstdint>

#include "dartcast/mesh_part.hpp"
#include "dartcast/simulation.hpp"
#include "environment/part_environment.hpp"
#include "simulation/bodies_component.hpp"
#include "simulation/catheters_component.hpp"
#include "simulation/particle_system.hpp"
#include "simulation/solids_component.hpp"

namespace dartcast {

struct SimulationView {
  const ParticleSystem& particles;
  const SolidsComponent& solids;
  const BodiesComponent& bodies;
  const CathetersComponent& catheters;
  const PartEnvironment* part;  ///< none: the environment is whole
  const MeshPart* part_mesh;    ///< likewise
  std::uint64_t balanced;       ///< how often cells have moved to other ranks
};

/// Its references hold as long as the simulation; its pointers until the next step.
SimulationView view_of(const Simulation& simulation);

}  // namespace dartcast
