// Binds dartcast/audit.hpp.
#include "dartcast/audit.hpp"

#include <string>

#include "bind.hpp"
#include "environment_parts.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {

void bind_audit(py::module_& m) {
  Record<Audit>(m, "Audit")
      .field("checked", &Audit::checked)
      .field("failed", &Audit::failed)
      .field("first", &Audit::first)
      .finish()
      .def("__iadd__", &Audit::operator+=, py::arg("other"), "Adds the counts of another audit.");
  m.def(
      "audit",
      [](const ComplexHandle& complex, ParticlesHandle& particles, Threads threads) {
        const Use use(*complex.usage, "the complex");
        const Use other(*particles.usage, the_particles);
        const py::gil_scoped_release release;
        return audit(*complex.complex, particles.particles, threads);
      },
      py::arg("complex"), py::arg("particles"), py::arg("threads") = 0, doc("audit"));
  py::class_<StateHash>(m, "StateHash", doc("StateHash"))
      .def(py::init<>())
      .def(py::init<const StateHash::Words&>(), py::arg("words"))
      .def("words", &StateHash::words, "Two numbers of 64 bits, to make the hash again.")
      .def("add", &StateHash::add, py::arg("id"), py::arg("state"), py::arg("velocity"), py::arg("fate") = 0,
           doc("StateHash::add"))
      .def("__iadd__", &StateHash::operator+=, py::arg("other"), "Adds the hash of other particles.")
      .def("__eq__", [](const StateHash& a, const StateHash& b) { return a == b; })
      .def("hex", &StateHash::hex, doc("StateHash::hex"))
      .def("__repr__", [](const StateHash& h) { return "StateHash(" + h.hex() + ")"; });
}

}  // namespace dartcast::python
