// Binds dartcast/events.hpp: events and their log.
#include "dartcast/events.hpp"

#include "bind.hpp"
#include "simulation_handle.hpp"

namespace py = pybind11;

namespace dartcast::python::events {
void bind(py::module_& m) {
  m.def(
      "name_of", [](EventKind kind) { return name_of(kind); }, py::arg("kind"), doc("name_of"));
  m.def(
      "apply",
      [](SimulationHandle& simulation, const Event& event) {
        const Use use = simulation.use();
        const Event own_event = event;
        const py::gil_scoped_release release;
        return apply(simulation.get(), own_event);
      },
      about("apply"));
}

}  // namespace dartcast::python::events
