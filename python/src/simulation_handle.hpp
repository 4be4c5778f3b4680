// The simulation as Python holds it.
#pragma once

#include <memory>
#include <utility>

#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "ranks.hpp"
#include "support/handles.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace dartcast::python {

/// A simulation with what it needs. Its environment is its own, or the caller's, which it alone changes as long as it
/// lives.
class SimulationOwner {
 public:
  SimulationOwner(std::shared_ptr<EnvironmentHandle> environment, const SimulationOptions& options);
  // `ranks`: none: one process.
  SimulationOwner(const Scene& scene, Threads threads, std::unique_ptr<PythonRanks> ranks, Partition partition);
  SimulationOwner(const Scene& scene, const SimulationCheckpoint& saved, Threads threads,
                  Simulation::AfterEdit after_edit, std::unique_ptr<PythonRanks> ranks, Partition partition);
  SimulationOwner(const SimulationOwner&) = delete;
  SimulationOwner& operator=(const SimulationOwner&) = delete;
  ~SimulationOwner();

  [[nodiscard]] Simulation& simulation() const { return *simulation_; }
  /// Null if the simulation has made it.
  [[nodiscard]] const std::shared_ptr<EnvironmentHandle>& callers() const { return callers_; }

 private:
  std::shared_ptr<EnvironmentHandle> callers_;
  std::unique_ptr<PythonRanks> ranks_;
  std::unique_ptr<Simulation> simulation_;
};

/// One mark of use serves the simulation, its environment, its bodies and its catheters.
struct SimulationHandle {
  std::shared_ptr<SimulationOwner> owner;
  std::shared_ptr<EnvironmentHandle> environment;

  explicit SimulationHandle(std::shared_ptr<SimulationOwner> made);

  [[nodiscard]] Simulation& get() const { return owner->simulation(); }
  [[nodiscard]] Use use() const { return Use(*environment->usage, "the Simulation"); }
  [[nodiscard]] const Simulation& object() const { return get(); }
  [[nodiscard]] Simulation& target() const { return get(); }
};

/// A Python object that code without Python's lock may copy and destroy.
std::shared_ptr<pybind11::object> shared_object(pybind11::object object);

/// A function that gets the environment at the end of each edit, and can read it until it returns; nothing
/// if it is None.
Simulation::AfterEdit after_edit_callback(pybind11::object function);

/// The answers at walls: WallResponses, a single response, a dict of them by the names of patches, or None.
WallResponses wall_responses(const pybind11::object& given, const Environment& environment);

// The parts of simulation::bind().
namespace simulation_records {
void bind(pybind11::module_& m);
}
namespace simulation_state {
void bind(pybind11::class_<SimulationHandle, std::shared_ptr<SimulationHandle>>& simulation);
}

}  // namespace dartcast::python
