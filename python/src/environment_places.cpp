// Binds the places of dartcast/environment.hpp: location, adding particles, restoring them.
#include <string>
#include <vector>

#include "bind.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/simulation.hpp"
#include "environment_parts.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

struct LocationRow {
  std::uint8_t place;
  std::uint8_t kind;
  std::uint16_t simplex;
  std::uint32_t cell;
  std::uint16_t dart;
};

struct AddRow {
  std::uint8_t place;
  std::uint8_t kind;
  std::uint16_t simplex;
  std::uint32_t cell;
  std::uint16_t dart;
  std::uint32_t particle;
};

template <class Row>
void set_location(const Location& l, Row& row) {
  row.place = static_cast<std::uint8_t>(l.place);
  row.kind = static_cast<std::uint8_t>(l.kind);
  row.simplex = l.simplex.simplex;
  row.cell = l.simplex.cell.value;
  row.dart = l.dart.number;
}

py::object locate(const EnvironmentHandle& h, const py::object& x) {
  const Use use(*h.usage, the_environment);
  if (py::detail::make_caster<Vec3> one; one.load(x, true)) {
    return py::cast(h.environment->locate(py::detail::cast_op<Vec3&>(one)));
  }
  const auto points = vectors(x, "points");
  std::vector<LocationRow> rows(points.size());
  {
    const py::gil_scoped_release release;
    const std::vector<Location> found = h.environment->locate(points);
    for (std::size_t i = 0; i < rows.size(); ++i) set_location(found[i], rows[i]);
  }
  return array_of(std::move(rows));
}

py::object add(const EnvironmentHandle& h, ParticlesHandle& particles, const py::object& positions,
               const std::optional<SimplexId>& simplex) {
  const Use use(*h.usage, the_environment);
  const Use other(*particles.usage, the_particles);
  if (simplex) return py::bool_(h.environment->add(particles.particles, *simplex, vector(positions, "positions")));
  const auto points = vectors(positions, "positions");
  std::vector<AddRow> rows(points.size());
  {
    const py::gil_scoped_release release;
    const std::vector<AddResult> added = h.environment->add(particles.particles, points);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      set_location(added[i].location, rows[i]);
      rows[i].particle = added[i].particle;
    }
  }
  return array_of(std::move(rows));
}

// A simulation that is made for it adds the particles: its numbers are those of the scenes.
std::shared_ptr<ParticlesHandle> add_random(const EnvironmentHandle& h, std::size_t count, std::uint64_t seed) {
  const Use use(*h.usage, the_environment);
  const py::gil_scoped_release release;
  SimulationOptions options;
  options.seed = seed;
  Simulation simulation(*h.environment, options);
  simulation.add_random(count, {});
  auto made = std::make_shared<ParticlesHandle>();
  made->particles = simulation.particles();
  return made;
}

std::shared_ptr<ParticlesHandle> restored(const EnvironmentHandle& h, const std::vector<ParticleState>& states,
                                          const std::vector<Weights>& weights) {
  if (states.size() != weights.size()) {
    throw InvalidArgument("restored: " + std::to_string(weights.size()) + " weights for " +
                          std::to_string(states.size()) + " states: one for each is needed");
  }
  const Use use(*h.usage, the_environment);
  auto made = std::make_shared<ParticlesHandle>();
  made->particles = h.environment->restored(states, weights);
  return made;
}

}  // namespace

void bind_places(EnvironmentClass& c) {
  PYBIND11_NUMPY_DTYPE(LocationRow, place, kind, simplex, cell, dart);
  PYBIND11_NUMPY_DTYPE(AddRow, place, kind, simplex, cell, dart, particle);
  c.def(
      "locate", &locate, py::arg("points"),
      (std::string(doc("Environment::locate")) +
       "\n\npoints: one point, which gives a Location; or float64 (n, 3), which gives a structured array (place, kind, "
       "simplex, cell, dart). The cell is dartcast.NONE outside.")
          .c_str());
  c.def(
      "add", &add, py::arg("particles"), py::arg("positions"), py::arg("simplex") = py::none(),
      (std::string(doc("Environment::add")) +
       "\n\npositions: float64 (n, 3). Returns a structured array as locate() does, with the index of each `particle`, "
       "dartcast.NONE where none was added. With a `simplex`: one position, and the result is a bool.")
          .c_str());
  c.def("add_random", &add_random, py::arg("count"), py::arg("seed") = 1,
        "A new set of particles at random places of the free cells, uniformly by volume: those of "
        "Simulation.add_random() with this seed. Raises InvalidArgument where no cell is free.");
  c.def("restored", &restored, py::arg("states"), py::arg("weights"), doc("Environment::restored"));
}

}  // namespace dartcast::python
