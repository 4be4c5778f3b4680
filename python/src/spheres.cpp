// Binds dartcast/spheres.hpp.
#include "dartcast/spheres.hpp"

#include <string>
#include <vector>

#include "bind.hpp"
#include "callbacks.hpp"
#include "environment_parts.hpp"
#include "responding.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

/// A stepper as Python holds it.
struct StepperHandle {
  SphereStepper stepper;
  Usage usage;
};

SphereReport advance_spheres_with(SphereStepper& stepper, const EnvironmentHandle& h, ParticlesHandle& set,
                                  const py::object& radii, const py::object& targets, const py::object& respond,
                                  const py::object& clearances, const StepArguments& call) {
  const auto to = vectors(targets, "targets");
  const auto sizes = numbers(radii, "radii");
  const auto clear = clearances.is_none() ? std::span<const double>{} : numbers(clearances, "clearances");
  const Use use(*h.usage, the_environment);
  const Use other(*set.usage, the_particles);
  Environment& environment = *h.environment;
  const auto responses = respond.is_none() ? std::nullopt : library_responses(respond, environment.map());
  if (!responses) {
    if (!respond.is_none()) require_function(respond);
    const ContactCallback callback = respond.is_none() ? ContactCallback{} : contact_callback(respond);
    const py::gil_scoped_release release;
    return stepper.advance(environment, set.particles, sizes, to, callback, call.options, clear);
  }
  const ResponseArrays motion(call, set.particles, to);
  const py::gil_scoped_release release;
  SphereReport report =
      stepper.advance(environment, set.particles, sizes, to,
                      respond_with(*responses, motion.velocities(), motion.statuses(), call.dt, call.acceleration),
                      call.options, clear);
  hold_stopped(report.step, *responses, motion.velocities(), motion.statuses(), call.dt, call.acceleration);
  return report;
}

constexpr const char* arguments = R"(

radii, clearances: float64 (n,). targets: float64 (n, 3). respond: as for Environment.advance(); a function is one of one
contact.)";

}  // namespace

void bind_spheres(py::module_& m) {
  Record<SphereOverlap>(m, "SphereOverlap")
      .field("particle", &SphereOverlap::particle)
      .field("depth", &SphereOverlap::depth)
      .field("left", &SphereOverlap::left)
      .field("face", &SphereOverlap::face)
      .field("point", &SphereOverlap::point)
      .field("normal", &SphereOverlap::normal)
      .finish();
  py::class_<SphereReport>(m, "SphereReport", doc("SphereReport"))
      .def_readonly("step", &SphereReport::step, doc("SphereReport::step"))
      .def_property_readonly(
          "overlaps", [](const SphereReport& r) { return r.overlaps; }, doc("SphereReport::overlaps"));
  py::class_<StepperHandle>(m, "SphereStepper", doc("SphereStepper"))
      .def(py::init<>())
      .def(
          "advance",
          [](StepperHandle& s, const EnvironmentHandle& h, ParticlesHandle& set, const py::object& radii,
             const py::object& targets, const py::object& respond, py::object velocities, py::object statuses,
             double dt, const Acceleration& acceleration, const StepOptions& options, const py::object& clearances) {
            const Use use(s.usage, "the SphereStepper");
            return advance_spheres_with(s.stepper, h, set, radii, targets, respond, clearances,
                                        {std::move(velocities), std::move(statuses), dt, acceleration, true, options});
          },
          py::arg("environment"), py::arg("particles"), py::arg("radii"), py::arg("targets"),
          py::arg("respond") = py::none(), py::kw_only(), py::arg("velocities") = py::none(),
          py::arg("statuses") = py::none(), py::arg("dt") = 1.0, py::arg("acceleration") = Acceleration{},
          py::arg("options") = StepOptions{}, py::arg("clearances") = py::none(),
          (std::string(doc("SphereStepper::advance")) + arguments).c_str());
  m.def(
      "advance_spheres",
      [](const EnvironmentHandle& h, ParticlesHandle& set, const py::object& radii, const py::object& targets,
         const py::object& respond, py::object velocities, py::object statuses, double dt,
         const Acceleration& acceleration, const StepOptions& options) {
        SphereStepper stepper;
        return advance_spheres_with(stepper, h, set, radii, targets, respond, py::none(),
                                    {std::move(velocities), std::move(statuses), dt, acceleration, true, options});
      },
      py::arg("environment"), py::arg("particles"), py::arg("radii"), py::arg("targets"),
      py::arg("respond") = py::none(), py::kw_only(), py::arg("velocities") = py::none(),
      py::arg("statuses") = py::none(), py::arg("dt") = 1.0, py::arg("acceleration") = Acceleration{},
      py::arg("options") = StepOptions{}, (std::string(doc("advance_spheres")) + arguments).c_str());
}

}  // namespace dartcast::python
