// Binds dartcast/audit.hpp.
#include "dartcast/audit.hpp"

#include "bind.hpp"
#include "support/environments.hpp"
#include "support/map_checks.hpp"

namespace py = pybind11;

namespace dartcast::python::audit {
namespace {

Audit audit_of(const ComplexHandle& h, const ParticlesHandle& p, Threads threads) {
  check_threads(threads);
  const Use use(*p.usage, "the set of particles");
  return read_long(h, [&](const CellComplex& complex) { return dartcast::audit(complex, p.particles, threads); });
}

// All particles of a set in one call.
void add_all(StateHash& hash, const Typed<"Integers">& given_ids, const ParticlesHandle& p,
             const Typed<"Points">& given, const Typed<"Integers | None">& given_fates) {
  const auto velocities = vectors(given, "velocities");
  const auto ids = given_ids.cast<std::vector<std::uint64_t>>();
  const auto statuses =
      given_fates.is_none() ? std::vector<std::uint64_t>(ids.size()) : given_fates.cast<std::vector<std::uint64_t>>();
  const Use use(*p.usage, "the set of particles");
  const std::size_t count = p.particles.size();
  if (ids.size() != count || velocities.size() != count || statuses.size() != count)
    throw InvalidArgument("StateHash.add: one id, velocity and fate for each particle are needed");
  for (std::size_t i = 0; i < count; ++i) hash.add(ids[i], p.particles[i], velocities[i], statuses[i]);
}

}  // namespace

void bind(py::module_& m) {
  m.def("audit", &audit_of, about("audit"));
  py::class_<StateHash>(m, "StateHash", doc("StateHash"))
      .def(py::init(
               [](const std::optional<StateHash::Words>& words) { return words ? StateHash(*words) : StateHash(); }),
           py::arg("words") = py::none(), doc("StateHash::StateHash"))
      .def_property_readonly(
          "words", [](const StateHash& h) -> Typed<"tuple[int, int]"> { return py::tuple(py::cast(h.words())); },
          "Two numbers below 2^64, from which StateHash(words) makes an equal hash.")
      .def("add", &StateHash::add, about("StateHash::add"))
      .def("add", &add_all, py::arg("ids"), py::arg("particles"), py::arg("velocities"),
           py::arg("statuses") = py::none(),
           "Adds all particles of a set: one id, velocity and fate (0 where None) for each.")
      .def("__iadd__", &StateHash::operator+=, py::arg("other"))
      .def("__eq__",
           [](const StateHash& a, const py::object& b) {
             return py::isinstance<StateHash>(b) && a == b.cast<const StateHash&>();
           })
      .def("__copy__", [](const StateHash& h) { return StateHash(h); })
      .def("hex", &StateHash::hex, doc("StateHash::hex"))
      .def("__repr__", [](const StateHash& h) { return "<StateHash " + h.hex() + ">"; });
}

}  // namespace dartcast::python::audit
