// Binds dartcast/shared_environment.hpp. All arrays are copies: a later call cannot move them.
#include "dartcast/shared_environment.hpp"

#include "bind.hpp"
#include "ranks.hpp"
#include "support/environments.hpp"
#include "support/handles.hpp"
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
};

struct ParticlesOfRanks {
  SharedParticles particles;
  mutable Usage usage;

  explicit ParticlesOfRanks(std::size_t width) : particles(width) {}
};

using EnvironmentOf = py::class_<EnvironmentOfRanks, std::shared_ptr<EnvironmentOfRanks>>;
using ParticlesOf = py::class_<ParticlesOfRanks, std::shared_ptr<ParticlesOfRanks>>;

std::shared_ptr<EnvironmentOfRanks> make(const MeshPart& part, const py::object& ranks, Threads threads) {
  check_threads(threads);
  auto made = std::make_shared<EnvironmentOfRanks>(ranks);
  MeshPart own = part;
  const py::gil_scoped_release release;
  made->environment = std::make_unique<SharedEnvironment>(std::move(own), made->ranks, threads);
  return made;
}

// Calls f(environment) without Python's lock.
template <class F>
auto compute(EnvironmentOfRanks& e, F&& f) {
  const Use use(e.usage, the_environment);
  const py::gil_scoped_release release;
  return f(*e.environment);
}

template <class F>
auto compute(EnvironmentOfRanks& e, ParticlesOfRanks& p, F&& f) {
  const Use use(p.usage, the_particles);
  return compute(e, [&](SharedEnvironment& own) { return f(own, p.particles); });
}

py::array places_array(const std::vector<Place>& places) {
  std::vector<std::uint8_t> values;
  for (const Place p : places) values.push_back(static_cast<std::uint8_t>(p));
  return array_of(std::move(values));
}

SharedStep advance(EnvironmentOfRanks& e, ParticlesOfRanks& p, const py::object& targets, const py::object& respond,
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

py::array positions_of(const ParticlesOfRanks& p) {
  const Use use(p.usage, the_particles);
  std::vector<Vec3> values;
  for (const ParticleState& s : p.particles.particles().states()) values.push_back(s.position);
  return read_only(array_of(std::span<const Vec3>(values)));
}

py::array cells_of(const ParticlesOfRanks& p) {
  const Use use(p.usage, the_particles);
  std::vector<std::uint32_t> values;
  for (const ParticleState& s : p.particles.particles().states()) values.push_back(s.cell.value);
  return read_only(array_of(std::move(values)));
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
        py::arg("width") = 0, doc("SharedParticles::SharedParticles"))
      .def("__len__", [](const ParticlesOfRanks& p) { return p.particles.size(); })
      .def_property_readonly(
          "size", [](const ParticlesOfRanks& p) { return p.particles.size(); }, "The number of particles here.")
      .def_property_readonly(
          "width", [](const ParticlesOfRanks& p) { return p.particles.width(); }, "The numbers of each particle.")
      .def_property_readonly(
          "ids",
          [](const ParticlesOfRanks& p) {
            const Use use(p.usage, the_particles);
            return read_only(array_of(p.particles.ids()));
          },
          "uint64 (n,), a read-only copy: in the order of adding, from 0.")
      .def_property_readonly("positions", &positions_of, "float64 (n, 3), a read-only copy.")
      .def_property_readonly("cells", &cells_of,
                             "The cell of each particle in the rank's own map: uint32 (n,), a read-only copy.")
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
}

void bind_steps(EnvironmentOf& c) {
  c.def("advance", &advance, py::arg("particles"), py::arg("targets"), py::arg("respond") = py::none(),
        py::arg("options") = StepOptions{},
        (std::string(doc("SharedEnvironment::advance")) +
         "\n\ntargets: float64 (n, 3). respond(contact, walls, earlier) answers one contact at a time, as with "
         "Environment.advance(per_contact=True); None: a particle stays at its first contact.")
            .c_str())
      .def(
          "count",
          [](EnvironmentOfRanks& e, ParticlesOfRanks& p) {
            return compute(e, p,
                           [](SharedEnvironment& own, SharedParticles& particles) { return own.count(particles); });
          },
          py::arg("particles"), doc("SharedEnvironment::count"))
      .def(
          "audit",
          [](EnvironmentOfRanks& e, ParticlesOfRanks& p) {
            return compute(e, p,
                           [](SharedEnvironment& own, SharedParticles& particles) { return own.audit(particles); });
          },
          py::arg("particles"), doc("SharedEnvironment::audit"));
}

}  // namespace

void bind(py::module_& m) {
  bind_shared_particles(m);
  Record<SharedStep>(m, "SharedStep")
      .field("report", &SharedStep::report)
      .field("contact_ids", &SharedStep::contact_ids)
      .field("left", &SharedStep::left)
      .field("come", &SharedStep::come)
      .finish();
  EnvironmentOf c(m, "SharedEnvironment", doc("SharedEnvironment"));
  c.def(py::init(&make), py::arg("part"), py::arg("ranks"), py::arg("threads") = Threads{},
        (std::string(doc("SharedEnvironment::SharedEnvironment")) +
         "\n\nranks: as mpi_ranks() gives them, or a subclass of Ranks.")
            .c_str())
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
          py::arg("here"), doc("SharedEnvironment::whole"))
      .def(
          "add",
          [](EnvironmentOfRanks& e, ParticlesOfRanks& p, const py::object& positions) {
            const auto x = vectors(positions, "positions");
            return places_array(compute(
                e, p, [&](SharedEnvironment& own, SharedParticles& particles) { return own.add(particles, x); }));
          },
          py::arg("particles"), py::arg("positions"),
          (std::string(doc("SharedEnvironment::add")) + "\n\nReturns uint8 (n,) of Place.").c_str())
      .def(
          "move",
          [](EnvironmentOfRanks& e, const py::object& positions) {
            const auto x = vectors(positions, "positions");
            compute(e, [&](SharedEnvironment& own) { own.move(x); });
          },
          py::arg("positions"), doc("SharedEnvironment::move"));
  bind_steps(c);
}

}  // namespace dartcast::python::shared_environment
