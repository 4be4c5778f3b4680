// The functions that every part of a simulation has: particles, bodies, catheters.
#pragma once

#include "dartcast/audit.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"

namespace dartcast {

struct SimulationState;

/// A part of a simulation with particles of its own in the environment. A new one is a class with these functions, a
/// member of SimulationState for what it saves, and a line in the list of Simulation::Parts.
class SimulationComponent {
 public:
  SimulationComponent() = default;
  SimulationComponent(const SimulationComponent&) = delete;
  SimulationComponent& operator=(const SimulationComponent&) = delete;
  virtual ~SimulationComponent() = default;

  /// One step. `begin`: its time, s. The particles move the environment in their step, which comes first.
  virtual void step(double begin) = 0;
  /// After each edit of the environment.
  virtual void update_after_edit(const ComplexEditReport& edit, OrphanPolicy orphaned) = 0;
  /// Writes its own member of the state.
  virtual void save(SimulationState& state) const = 0;
  /// Goes on from its member of the state, in an environment that stands as it did then. Throws InvalidArgument,
  /// nothing changed, if the state does not fit.
  virtual void restore(const SimulationState& state) = 0;
  [[nodiscard]] virtual Audit audit() const = 0;
  [[nodiscard]] virtual StateHash state_hash() const = 0;
};

}  // namespace dartcast
