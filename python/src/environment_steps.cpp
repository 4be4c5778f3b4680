// Binds dartcast/environment.hpp: steps of particles and their traces.
#include "bind.hpp"
#include "support/environments.hpp"

namespace py = pybind11;

namespace dartcast::python {

const char* const respond_text =
    "\n\nrespond: None: a particle stops at its first contact. A response (Reflect(0.5, friction=0.1), Slide(), "
    "Stick(), Absorb(), Escape()), WallResponses, or a dict of responses by name or number of the patch, with the "
    "general one at None (without it: Reflect()): needs velocities and dt, and works as respond_with(): velocities, "
    "float64 (n, 3), and statuses, uint8 (n,) of ParticleStatus or None, are written in place. A ContactCallback of "
    "respond_with().\n\nA function respond(contacts, walls) answers all contacts of a round at once: the next contact "
    "of each particle that has one. It gets structured arrays as StepReport.contacts and .walls. It returns the "
    "displacement of each for the rest of the step, relative to the wall: float64 (contacts, 3), where a row of zeros "
    "lets the particle stay at the wall; or None: all stay; or a tuple of the displacements and bool (contacts,): "
    "which run along the wall (AfterContact.along).\n\nWith per_contact=True a function respond(contact, walls, "
    "earlier) answers one contact at a time: a Contact and lists of WallHit. It returns a displacement, an "
    "AfterContact, or None to stay. It is called from several threads, one at a time.\n\nAn exception raised in a "
    "function comes out of the call, and the particles are as before.";

void expect_positions_before(const EnvironmentHandle& e, const ParticlesHandle& p, const char* call) {
  e.expect_no_writing(call);
  if (e.overwritten && e.environment->awaits_advance(p.particles)) {
    throw InvalidArgument(std::string(call) +
                          ": these particles await the last move, but a next_points() block that raised has written "
                          "over the positions before it: add() their positions to a new set");
  }
}

Targets::Targets(const py::object& given, const RespondArguments& arguments, const char* name)
    : targets_(vectors(given, name)) {
  if (PyCallable_Check(arguments.respond.ptr()) == 0) return;
  own_.assign(targets_.begin(), targets_.end());
  targets_ = own_;
}

namespace environment_steps {
namespace {

StepReport advance(const EnvironmentHandle& h, ParticlesHandle& p, const Typed<"Points">& given,
                   DARTCAST_RESPOND_PARAMETERS) {
  const RespondArguments arguments{respond, velocities, statuses, dt, acceleration, per_contact};
  const Targets targets(given, arguments);
  const UseBoth use(h, p);
  expect_positions_before(h, p, "advance");
  Environment& e = h.changeable("step the simulation");
  const Answers answers(arguments, e.map(), p.particles.size());
  const StepOptions chosen = options;
  const py::gil_scoped_release release;
  if (answers.in_rounds() && e.tally() == nullptr)
    return e.advance_in_rounds(p.particles, targets.get(), answers.round(), chosen);
  return e.advance(p.particles, targets.get(), answers.each("advance"), chosen);
}

std::vector<Trace> trace(const EnvironmentHandle& h, const ParticlesHandle& p, std::size_t particle,
                         const Typed<"Points">& given, DARTCAST_RESPOND_PARAMETERS) {
  const RespondArguments arguments{respond, velocities, statuses, dt, acceleration, per_contact};
  const Targets targets(given, arguments);
  const UseBoth use(h, p);
  expect_positions_before(h, p, "trace");
  const Answers answers(arguments, h.environment->map(), p.particles.size());
  const StepOptions chosen = options;
  const py::gil_scoped_release release;
  return h.environment->trace(p.particles, particle, targets.get(), answers.each("trace"), chosen);
}

}  // namespace

void bind(EnvironmentClass& c) {
  c.def("advance", &advance, py::arg("particles"), py::arg("targets"), DARTCAST_RESPOND_ARGUMENTS,
        (std::string(doc("Environment::advance")) + "\n\ntargets: float64 (n, 3)." + respond_text).c_str());
  c.def("trace", &trace, py::arg("particles"), py::arg("particle"), py::arg("targets"), DARTCAST_RESPOND_ARGUMENTS,
        about("Environment::trace",
              "targets: float64 (n, 3). The other arguments are as in advance(), but a function answers one contact at "
              "a time."));
}

}  // namespace environment_steps
}  // namespace dartcast::python
