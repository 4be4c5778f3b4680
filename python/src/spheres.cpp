// Binds dartcast/spheres.hpp.
#include "dartcast/spheres.hpp"

#include "bind.hpp"
#include "support/environments.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::spheres {
namespace {

struct StepperHandle {
  SphereStepper stepper;
  Usage usage = {};
};

// Numbers that a function of Python cannot change while the call runs.
std::vector<double> copied(const py::object& given, const char* name) {
  const auto values = numbers(given, name);
  return {values.begin(), values.end()};
}

SphereReport advance(StepperHandle& s, const EnvironmentHandle& h, ParticlesHandle& p, const py::object& given_radii,
                     const py::object& given, const py::object& respond, const py::object& velocities,
                     const py::object& statuses, const py::object& dt, const py::object& acceleration, bool per_contact,
                     const StepOptions& options, const py::object& given_clearances) {
  const RespondArguments arguments{respond, velocities, statuses, dt, acceleration, per_contact};
  const Targets targets(given, arguments);
  const auto radii = copied(given_radii, "radii");
  const auto clearances = given_clearances.is_none() ? std::vector<double>{} : copied(given_clearances, "clearances");
  const Use use_stepper(s.usage, "the SphereStepper");
  const UseBoth use(h, p);
  expect_positions_before(h, p, "advance");
  if (!given_clearances.is_none() && clearances.size() != p.particles.size())
    throw InvalidArgument("clearances: one for each particle is needed, or None");
  Environment& e = h.changeable("step the simulation");
  const Answers answers(arguments, e.map(), p.particles.size());
  const ContactCallback& each = answers.each("spheres");
  const StepOptions chosen = options;
  const py::gil_scoped_release release;
  return s.stepper.advance(e, p.particles, radii, targets.get(), each, chosen, clearances);
}

struct SimultaneousHandle {
  SimultaneousStepper stepper;
  Usage usage = {};
};

StepReport advance_simultaneously(SimultaneousHandle& s, const EnvironmentHandle& h, ParticlesHandle& p,
                                  const py::object& given, const py::object& respond, const py::object& velocities,
                                  const py::object& statuses, const py::object& dt, const py::object& acceleration,
                                  bool per_contact, const StepOptions& options) {
  const RespondArguments arguments{respond, velocities, statuses, dt, acceleration, per_contact};
  const Targets targets(given, arguments);
  const Use use_stepper(s.usage, "the SimultaneousStepper");
  const UseBoth use(h, p);
  expect_positions_before(h, p, "advance");
  Environment& e = h.changeable("step the simulation");
  const Answers answers(arguments, e.map(), p.particles.size());
  const ContactCallback& each = answers.each("points");
  const StepOptions chosen = options;
  const py::gil_scoped_release release;
  return s.stepper.advance(e, p.particles, targets.get(), each, chosen);
}

SphereReport advance_once(const EnvironmentHandle& h, ParticlesHandle& p, const py::object& radii,
                          const py::object& targets, const py::object& respond, const py::object& velocities,
                          const py::object& statuses, const py::object& dt, const py::object& acceleration,
                          bool per_contact, const StepOptions& options) {
  StepperHandle once;
  return advance(once, h, p, radii, targets, respond, velocities, statuses, dt, acceleration, per_contact, options,
                 py::none());
}

}  // namespace

void bind(py::module_& m) {
  const std::string arguments =
      "\n\nradii: float64 (n,). targets: float64 (n, 3). The other arguments are as in Environment.advance(), but a "
      "function answers one contact at a time.";
  py::class_<SphereReport>(m, "SphereReport", "The report of a step of spheres.")
      .def_readonly("step", &SphereReport::step, doc("SphereReport::step"))
      .def_property_readonly(
          "overlaps", [](const SphereReport& r) { return rows_of(r.overlaps); },
          "Walls that spheres overlapped at the start of their step, by particle, then the deepest first, as a "
          "structured array: particle, cell and face (of the free cell), depth (radius - distance), left (largest "
          "depth, in any wall, after the sphere was moved out; 0: none), point (on the wall), normal (unit, from the "
          "point to the centre).");
  py::class_<StepperHandle>(m, "SphereStepper", doc("SphereStepper"))
      .def(py::init<>())
      .def("advance", &advance, py::arg("environment"), py::arg("particles"), py::arg("radii"), py::arg("targets"),
           DARTCAST_RESPOND_ARGUMENTS, py::arg("clearances") = py::none(),
           (std::string(doc("SphereStepper::advance")) + arguments).c_str());
  py::class_<SimultaneousHandle>(m, "SimultaneousStepper", doc("SimultaneousStepper"))
      .def(py::init<>())
      .def(
          "advance", &advance_simultaneously, py::arg("environment"), py::arg("particles"), py::arg("targets"),
          DARTCAST_RESPOND_ARGUMENTS,
          (std::string(doc("SimultaneousStepper::advance")) + "\n\ntargets: float64 (n, 3). The other arguments are as "
                                                              "in Environment.advance(), but a function answers one "
                                                              "contact at a time.")
              .c_str());
  m.def("advance_spheres", &advance_once, py::arg("environment"), py::arg("particles"), py::arg("radii"),
        py::arg("targets"), DARTCAST_RESPOND_ARGUMENTS, (std::string(doc("advance_spheres")) + arguments).c_str());
}

}  // namespace dartcast::python::spheres
