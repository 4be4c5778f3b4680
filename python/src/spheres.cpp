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

SphereReport advance(StepperHandle& s, const EnvironmentHandle& h, ParticlesHandle& p,
                     const Typed<"Floats">& given_radii, const Typed<"Points">& given, DARTCAST_RESPOND_PARAMETERS,
                     const Typed<"Floats | None">& given_clearances) {
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
                                  const Typed<"Points">& given, DARTCAST_RESPOND_PARAMETERS) {
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

SphereReport advance_once(const EnvironmentHandle& h, ParticlesHandle& p, const Typed<"Floats">& radii,
                          const Typed<"Points">& targets, DARTCAST_RESPOND_PARAMETERS) {
  StepperHandle once;
  return advance(once, h, p, radii, targets, respond, velocities, statuses, dt, acceleration, per_contact, options,
                 py::none());
}

}  // namespace

void bind(py::module_& m) {
  const std::string arguments =
      "\n\nradii: float64 (n,). targets: float64 (n, 3). The other arguments are as in Environment.advance(), but a "
      "function answers one contact at a time.";
  py::class_<StepperHandle>(m, "SphereStepper", doc("SphereStepper"))
      .def(py::init<>())
      .def("advance", &advance, py::arg("environment"), py::arg("particles"), py::arg("radii"), py::arg("targets"),
           DARTCAST_RESPOND_ARGUMENTS, py::arg("clearances") = py::none(),
           (std::string(doc("SphereStepper::advance")) + arguments).c_str());
  py::class_<SimultaneousHandle>(m, "SimultaneousStepper", doc("SimultaneousStepper"))
      .def(py::init<>())
      .def("advance", &advance_simultaneously, py::arg("environment"), py::arg("particles"), py::arg("targets"),
           DARTCAST_RESPOND_ARGUMENTS,
           about("SimultaneousStepper::advance",
                 "targets: float64 (n, 3). The other arguments are as in Environment.advance(), but a function answers "
                 "one contact at a time."));
  m.def("advance_spheres", &advance_once, py::arg("environment"), py::arg("particles"), py::arg("radii"),
        py::arg("targets"), DARTCAST_RESPOND_ARGUMENTS, (std::string(doc("advance_spheres")) + arguments).c_str());
}

}  // namespace dartcast::python::spheres
