// The parts of a simulation.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "dartcast/simulation.hpp"
#include "simulation/bodies_component.hpp"
#include "simulation/catheters_component.hpp"
#include "simulation/event_scheduler.hpp"
#include "simulation/particle_system.hpp"

namespace dartcast {

struct Simulation::Parts {
  /// `own`: the environment, where the simulation has made it; none where it is another's.
  Parts(Simulation& simulation, std::unique_ptr<Environment> own, Environment& used, const SimulationOptions& options)
      : own_environment(std::move(own)),
        environment(used),
        particles(used, options),
        bodies(used, particles.options(), particles.responses()),
        catheters(used, options.dt),
        events(simulation, used, options.dt) {}

  std::unique_ptr<Environment> own_environment;
  Environment& environment;
  ParticleSystem particles;
  BodiesComponent bodies;
  CathetersComponent catheters;
  /// All components, in the order of a step. Particles come first: they move the environment.
  std::vector<SimulationComponent*> components = {&particles, &bodies, &catheters};
  EventScheduler events;
  AfterEdit after_edit;
  bool replaying = false;  // earlier edits: bodies and catheters are restored afterwards
  double seconds_solids = 0.0;
};

}  // namespace dartcast
