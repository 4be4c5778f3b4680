// Binds dartcast/shared_environment.hpp. All arrays are copies: a later call cannot move them.
#include "dartcast/shared_environment.hpp"

#include "bind.hpp"
#include "ranks.hpp"
#include "support/environments.hpp"
#include "support/handles.hpp"
#include "support/members.hpp"
#include "support/python.hpp"
#include "support/respond.hpp"

namespace py = pybind11;

namespace dartcast::python::shared_environment {
namespace {

constexpr const char* the_environment = "the SharedEnvironment";
constexpr const char* the_particles = "the SharedParticles";

struct EnvironmentOfRanks {
  PythonRanks ranks;
  std::unique_ptr<SharedEnvironment> environment;
  mutable Usage usage;

  explicit EnvironmentOfRanks(const py::object& all) : ranks(all) {}
  [[nodiscard]] Use use() const { return Use(usage, the_environment); }
  [[nodiscard]] SharedEnvironment& target() { return *environment; }
};

struct ParticlesOfRanks {
  SharedParticles particles;
  mutable Usage usage;

  explicit ParticlesOfRanks(std::size_t width) : particles(width) {}
  [[nodiscard]] Use use() const { return Use(usage, the_particles); }
  [[nodiscard]] const SharedParticles& object() const { return particles; }
};

using EnvironmentOf = py::class_<EnvironmentOfRanks, std::shared_ptr<EnvironmentOfRanks>>;
using ParticlesOf = py::class_<ParticlesOfRanks, std::shared_ptr<ParticlesOfRanks>>;

std::shared_ptr<EnvironmentOfRanks> make(const MeshPart& part, const Typed<"Ranks">& ranks, Threads threads) {
  check_threads(threads);
  auto made = std::make_shared<EnvironmentOfRanks>(ranks);
  MeshPart own = part;
  const py::gil_scoped_release release;
  made->environment = std::make_unique<SharedEnvironment>(std::move(own), made->ranks, threads);
  return made;
}

template <class F>
auto compute(EnvironmentOfRanks& e, ParticlesOfRanks& p, F&& f) {
  const Use use(p.usage, the_particles);
  return change(e, [&](SharedEnvironment& own) { return f(own, p.particles); });
}

py::array_t<std::uint8_t> places_array(const std::vector<Place>& places) {
  std::vector<std::uint8_t> values;
  for (const Place p : places) values.push_back(static_cast<std::uint8_t>(p));
  return array_of(std::move(values));
}

SharedStep advance(EnvironmentOfRanks& e, ParticlesOfRanks& p, const Typed<"Points">& targets,
                   const Typed<"Callable[[Contact, list[WallHit], list[WallHit]], object] | None">& respond,
                   const StepOptions& options) {
  const auto wanted = vectors(targets, "targets");
  if (!respond.is_none() && PyCallable_Check(respond.ptr()) == 0)
    throw py::type_error("respond: a function of a contact, its walls and the earlier ones, or None");
  const Answers answers({respond, py::none(), py::none(), py::none(), py::none(), true},
                        e.environment->environment().map(), p.particles.size());
  const StepOptions chosen = options;
  return compute(e, p, [&](SharedEnvironment& own, SharedParticles& particles) {
    return own.advance(particles, wanted, respond.is_none() ? ContactCallback() : answers.each("advance"), chosen);
  });
}

std::vector<Vec3> positions_of(const SharedParticles& p) {
  std::vector<Vec3> values;
  for (const ParticleState& s : p.particles().states()) values.push_back(s.position);
  return values;
}

std::vector<Cell> cells_of(const SharedParticles& p) {
  std::vector<Cell> values;
  for (const ParticleState& s : p.particles().states()) values.push_back(s.cell);
  return values;
}

std::size_t checked(const ParticlesOfRanks& p, std::size_t particle) {
  if (particle >= p.particles.size())
    throw InvalidArgument("there is no particle " + std::to_string(particle) + ": there are " +
                          std::to_string(p.particles.size()));
  return particle;
}

void bind_shared_particles(py::module_& m) {
  ParticlesOf c(m, "SharedParticles", doc("SharedParticles"));
  c.def(py::init([](std::size_t width) {
          constexpr std::size_t most = 1 << 16;
          if (width > most) throw InvalidArgument("SharedParticles: at most 65536 numbers for a particle");
          return std::make_shared<ParticlesOfRanks>(width);
        }),
        py::arg("width") = 0, about("SharedParticles::SharedParticles"))
      .def("__len__", calling<ParticlesOfRanks>(&SharedParticles::size))
      .def(
          "user_data",
          [](const ParticlesOfRanks& p, std::size_t particle) {
            const Use use(p.usage, the_particles);
            return array_of(p.particles.user_data(checked(p, particle)));
          },
          py::arg("particle"), "The particle's numbers. A copy: set_user_data() changes them.")
      .def(
          "set_user_data",
          [](ParticlesOfRanks& p, std::size_t particle, const std::vector<double>& values) {
            const Use use(p.usage, the_particles);
            const std::span<double> own = p.particles.user_data(checked(p, particle));
            if (values.size() != own.size())
              throw InvalidArgument("set_user_data: " + std::to_string(values.size()) + " numbers; the width is " +
                                    std::to_string(own.size()));
            std::copy(values.begin(), values.end(), own.begin());
          },
          py::arg("particle"), py::arg("values"), "Sets the particle's numbers.");
  members_of_SharedParticles(c);
  property(c, "positions", &positions_of, "float64 (n, 3), a read-only copy.");
  property(c, "cells", &cells_of, "The cell of each particle in the rank's own map: uint32 (n,), a read-only copy.");
}

void bind_steps(EnvironmentOf& c) {
  c.def("advance", &advance, py::arg("particles"), py::arg("targets"), py::arg("respond") = py::none(),
        py::arg("options") = StepOptions{},
        about("SharedEnvironment::advance",
              "targets: float64 (n, 3). respond(contact, walls, earlier) answers one contact at a time, as with "
              "Environment.advance(per_contact=True); None: a particle stays at its first contact."));
  const auto counting = [&c](const char* name, auto f) {
    c.def(
        name,
        [f](EnvironmentOfRanks& e, ParticlesOfRanks& p) {
          return compute(e, p, [f](SharedEnvironment& own, SharedParticles& particles) { return (own.*f)(particles); });
        },
        about(std::string("SharedEnvironment::") + name));
  };
  counting("count", &SharedEnvironment::count);
  counting("audit", &SharedEnvironment::audit);
}

}  // namespace

void bind(py::module_& m) {
  bind_shared_particles(m);
  EnvironmentOf c(m, "SharedEnvironment", doc("SharedEnvironment"));
  c.def(py::init(&make),
        about("SharedEnvironment::SharedEnvironment", "ranks: as mpi_ranks() gives them, or a subclass of Ranks."))
      .def_property_readonly(
          "part", [](EnvironmentOfRanks& e) { return e.environment->part(); }, "This rank's part: a copy.")
      .def_property_readonly(
          "positions",
          [](EnvironmentOfRanks& e) {
            const Use use(e.usage, the_environment);
            return read_only(array_of(e.environment->environment().positions()));
          },
          "Where the part's points are: float64 (n, 3), a read-only copy.")
      .def(
          "whole",
          [](EnvironmentOfRanks& e, Cell here) {
            const Use use(e.usage, the_environment);
            if (!e.environment->environment().map().contains(here))
              throw InvalidArgument("whole: there is no such cell on this rank");
            return e.environment->whole(here);
          },
          about("SharedEnvironment::whole"))
      .def(
          "add",
          [](EnvironmentOfRanks& e, ParticlesOfRanks& p, const Typed<"Points">& positions) {
            const auto x = vectors(positions, "positions");
            return places_array(compute(
                e, p, [&](SharedEnvironment& own, SharedParticles& particles) { return own.add(particles, x); }));
          },
          about("SharedEnvironment::add", "Returns uint8 (n,) of Place."));
  members_of_SharedEnvironment(c);
  bind_steps(c);
}

}  // namespace dartcast::python::shared_environment
