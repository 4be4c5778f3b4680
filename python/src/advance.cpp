// Binds the steps of dartcast/environment.hpp: advance() with every kind of response, and traces.
#include <string>
#include <vector>

#include "bind.hpp"
#include "callbacks.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/response.hpp"
#include "environment_parts.hpp"
#include "responding.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

StepReport advance_by_library(Environment& environment, Particles& particles, std::span<const Vec3> targets,
                              const WallResponses& responses, const StepArguments& call) {
  const ResponseArrays motion(call, particles, targets);
  const py::gil_scoped_release release;
  StepReport report = environment.advance(
      particles, targets, respond_with(responses, motion.velocities(), motion.statuses(), call.dt, call.acceleration),
      call.options);
  hold_stopped(report, responses, motion.velocities(), motion.statuses(), call.dt, call.acceleration);
  return report;
}

StepReport advance(const EnvironmentHandle& h, ParticlesHandle& set, const py::object& targets,
                   const py::object& respond, const StepArguments& call) {
  const auto to = vectors(targets, "targets");
  const Use use(*h.usage, the_environment);
  const Use other(*set.usage, the_particles);
  Environment& environment = *h.environment;
  if (respond.is_none()) {
    const py::gil_scoped_release release;
    return environment.advance(set.particles, to, {}, call.options);
  }
  if (const auto responses = library_responses(respond, environment.map()))
    return advance_by_library(environment, set.particles, to, *responses, call);
  require_function(respond);
  if (call.per_contact) {
    const auto callback = contact_callback(respond);
    const py::gil_scoped_release release;
    return environment.advance(set.particles, to, callback, call.options);
  }
  const auto callback = round_callback(respond);
  const py::gil_scoped_release release;
  return environment.advance_in_rounds(set.particles, to, callback, call.options);
}

std::vector<Trace> trace(const EnvironmentHandle& h, ParticlesHandle& set, std::size_t particle,
                         const py::object& targets, const py::object& respond, const StepOptions& options) {
  const auto to = vectors(targets, "targets");
  const Use use(*h.usage, the_environment);
  const Use other(*set.usage, the_particles);
  const ContactCallback callback = respond.is_none() ? ContactCallback{} : contact_callback(respond);
  const py::gil_scoped_release release;
  return h.environment->trace(set.particles, particle, to, callback, options);
}

constexpr const char* advance_doc = R"(

targets: float64 (n, 3). respond: what happens at walls.

- None: a particle stops at its first contact.
- A response of the library: Reflect(0.5, friction=0.1), Slide(), Stick(), Absorb(), Escape(); or a dict of them by the
  names of patches, where "" stands for all other walls. It changes `velocities`, float64 (n, 3), and `statuses`, uint8
  (n,), in place; without velocities they are those that lead to the targets in the time dt. Particles that were absorbed
  or escaped must be removed by the caller. acceleration: see Acceleration.
- A function respond(contacts, walls) of all contacts of a round: every particle stops at its next contact, the function
  answers all of them, and they continue against the walls as these move in the step. It gets the structured arrays of
  StepReport.contacts and walls, and returns the displacements for the rest of the step, float64 (m, 3), relative to the
  walls; or a pair of them and `along`, a bool or bool (m,) (see AfterContact); or None. A displacement of zero lets the
  particle stay at the wall, and move with it.
- With per_contact a function respond(contact, walls, earlier) of one contact: a Contact and two lists of WallHit. It
  returns three numbers, an AfterContact, or None. It is called from several threads, one at a time.

An exception of a function comes out as itself; the particles are then as before.)";

}  // namespace

void bind_advance(py::module_& m, EnvironmentClass& c) {
  bind_callbacks(m);
  c.def(
      "advance",
      [](const EnvironmentHandle& h, ParticlesHandle& set, const py::object& targets, const py::object& respond,
         py::object velocities, py::object statuses, double dt, const Acceleration& acceleration, bool per_contact,
         const StepOptions& options) {
        return advance(h, set, targets, respond,
                       {std::move(velocities), std::move(statuses), dt, acceleration, per_contact, options});
      },
      py::arg("particles"), py::arg("targets"), py::arg("respond") = py::none(), py::kw_only(),
      py::arg("velocities") = py::none(), py::arg("statuses") = py::none(), py::arg("dt") = 1.0,
      py::arg("acceleration") = Acceleration{}, py::arg("per_contact") = false, py::arg("options") = StepOptions{},
      (std::string(doc("Environment::advance")) + advance_doc).c_str());
  c.def(
      "check_advance",
      [](const EnvironmentHandle& h, ParticlesHandle& set, const StepOptions& options) {
        const Use use(*h.usage, the_environment);
        const Use other(*set.usage, the_particles);
        h.environment->check_advance(set.particles, options);
      },
      py::arg("particles"), py::arg("options") = StepOptions{}, doc("Environment::check_advance"));
  c.def("trace", &trace, py::arg("particles"), py::arg("particle"), py::arg("targets"), py::arg("respond") = py::none(),
        py::arg("options") = StepOptions{},
        (std::string(doc("Environment::trace")) + "\n\nrespond: a function of one contact, as for advance().").c_str());
  c.def(
      "awaits_advance",
      [](const EnvironmentHandle& h, ParticlesHandle& set) {
        const Use use(*h.usage, the_environment);
        const Use other(*set.usage, the_particles);
        return h.environment->awaits_advance(set.particles);
      },
      py::arg("particles"), doc("Environment::awaits_advance"));
}

}  // namespace dartcast::python
