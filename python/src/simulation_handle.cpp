// How simulations live in Python: their environment, their callbacks, their end.
#include "simulation_handle.hpp"

#include <string>
#include <thread>
#include <utility>

namespace py = pybind11;

namespace dartcast::python {
namespace {

// Marks it as in use for ever. Other threads may use it until then.
void expire(Usage& usage) {
  const py::gil_scoped_release release;
  while (!usage.begin()) std::this_thread::yield();
}

WallResponse response_of(const py::handle& given) {
  py::detail::make_caster<WallResponse> caster;
  if (!caster.load(given, true)) {
    throw py::type_error(
        "responses: expected a response such as dartcast.Reflect(0.5), a dict of them by the names of patches, or "
        "dartcast.WallResponses; got " +
        py::repr(given).cast<std::string>());
  }
  return py::detail::cast_op<WallResponse&>(caster);
}

}  // namespace

std::shared_ptr<py::object> shared_object(py::object object) {
  return {new py::object(std::move(object)), [](py::object* p) {
            const py::gil_scoped_acquire acquire;
            delete p;
          }};
}

SimulationOwner::SimulationOwner(std::shared_ptr<EnvironmentHandle> environment, const SimulationOptions& options)
    : callers_(std::move(environment)) {
  const Use use(*callers_->usage, "the Environment");
  Environment& own = callers_->changeable("make an environment for each simulation");
  const SimulationOptions own_options = options;
  {
    const py::gil_scoped_release release;
    simulation_ = std::make_unique<Simulation>(own, own_options);
  }
  callers_->borrowed = true;
}

SimulationOwner::SimulationOwner(const Scene& scene, Threads threads, std::unique_ptr<PythonRanks> ranks,
                                 Partition partition)
    : ranks_(std::move(ranks)), simulation_(std::make_unique<Simulation>(scene, threads, ranks_.get(), partition)) {}

SimulationOwner::SimulationOwner(const Scene& scene, const SimulationCheckpoint& saved, Threads threads,
                                 Simulation::AfterEdit after_edit, std::unique_ptr<PythonRanks> ranks,
                                 Partition partition)
    : ranks_(std::move(ranks)),
      simulation_(std::make_unique<Simulation>(scene, saved, threads, std::move(after_edit), ranks_.get(), partition)) {
}

// A thread that reads frames for the simulation may wait for Python's lock.
SimulationOwner::~SimulationOwner() {
  {
    const py::gil_scoped_release release;
    simulation_.reset();
  }
  if (callers_) callers_->borrowed = false;
}

SimulationHandle::SimulationHandle(std::shared_ptr<SimulationOwner> made) : owner(std::move(made)) {
  environment = owner->callers();
  if (environment) return;
  environment = std::make_shared<EnvironmentHandle>();
  environment->owner = owner;
  // The simulation of a scene owns its environment; `borrowed` keeps Python from changing it.
  environment->environment = const_cast<Environment*>(&owner->simulation().environment());
  environment->borrowed = true;
}

Simulation::AfterEdit after_edit_callback(py::object function) {
  if (function.is_none()) return {};
  if (PyCallable_Check(function.ptr()) == 0)
    throw py::type_error("after_edit: expected a function of the environment, or None");
  return [shared = shared_object(std::move(function))](const Environment& environment) {
    const py::gil_scoped_acquire acquire;
    const auto lent = std::make_shared<EnvironmentHandle>();
    lent->environment = const_cast<Environment*>(&environment);  // kept from changes by `borrowed`
    lent->borrowed = true;
    try {
      (*shared)(lent);
    } catch (...) {
      expire(*lent->usage);
      throw;
    }
    expire(*lent->usage);
  };
}

WallResponses wall_responses(const py::object& given, const Environment& environment) {
  if (given.is_none()) return WallResponses{};
  if (py::isinstance<WallResponses>(given)) return given.cast<WallResponses>();
  if (!py::isinstance<py::dict>(given)) return WallResponses(response_of(given));
  WallResponses responses;
  for (const auto& [name, response] : py::reinterpret_borrow<py::dict>(given))
    responses.set(environment.map().patch(name.cast<std::string>()), response_of(response));
  return responses;
}

}  // namespace dartcast::python
