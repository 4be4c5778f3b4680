// Binds dartcast/environment.hpp: particles that are added, saved and restored.
#include <algorithm>
#include <cstring>

#include "bind.hpp"
#include "dartcast/simulation.hpp"
#include "support/environments.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::environment_adding {
namespace {

constexpr const char* remedy = "add particles by the simulation";

py::array add(const EnvironmentHandle& h, ParticlesHandle& p, const Typed<"Points">& given) {
  const auto positions = vectors(given, "positions");
  const UseBoth use(h, p);
  std::vector<AddResult> added;
  {
    Environment& e = h.changeable(remedy);
    const py::gil_scoped_release release;
    added = e.add(p.particles, positions);
  }
  return rows_of(added);
}

Typed<"tuple[Particles, Records]"> add_new(const EnvironmentHandle& h, const Typed<"Points">& given) {
  auto made = std::make_shared<ParticlesHandle>();
  const py::array places = add(h, *made, given);
  return py::make_tuple(made, places);
}

bool add_to_simplex(const EnvironmentHandle& h, ParticlesHandle& p, SimplexId simplex, const Vec3& position) {
  const UseBoth use(h, p);
  return h.changeable(remedy).add(p.particles, simplex, position);
}

ParticlesPointer added_random(const EnvironmentHandle& h, std::size_t count, std::uint64_t seed) {
  auto made = std::make_shared<ParticlesHandle>();
  const UseBoth use(h, *made);
  Environment& e = h.changeable(remedy);
  const py::gil_scoped_release release;
  add_random(e, made->particles, count, seed);
  return made;
}

std::vector<Weights> weights_of(const py::object& given, std::size_t count) {
  std::vector<Weights> weights(count);
  if (given.is_none()) return weights;
  const bool right = py::isinstance<py::array_t<double, py::array::c_style>>(given) &&
                     py::reinterpret_borrow<py::array>(given).ndim() == 2 &&
                     py::reinterpret_borrow<py::array>(given).shape(1) == 4 &&
                     py::reinterpret_borrow<py::array>(given).shape(0) == static_cast<py::ssize_t>(count);
  if (!right) refuse_array(given, "weights", "float64 (n, 4), one row for each state", "Particles.held_weights()");
  if (count > 0) std::memcpy(weights.data(), py::reinterpret_borrow<py::array>(given).data(), count * sizeof(Weights));
  return weights;
}

ParticlesPointer restored(const EnvironmentHandle& h, const Typed<"Records">& given,
                          const Typed<"Floats | None">& weights) {
  const auto states = states_of(given, "states");
  const auto kept = weights_of(weights, states.size());
  const bool has_held = std::any_of(states.begin(), states.end(), [](const ParticleState& s) { return s.held; });
  if (weights.is_none() && has_held)
    throw InvalidArgument("restored: some particles are held: give held_weights() as they were saved");
  const Use use(*h.usage, "the environment");
  const py::gil_scoped_release release;
  auto made = std::make_shared<ParticlesHandle>();
  made->particles = h.environment->restored(states, kept);
  return made;
}

}  // namespace

void bind(EnvironmentClass& c) {
  c.def("add", &add, py::arg("particles"), py::arg("positions"),
        about("Environment::add",
              "positions: float64 (n, 3). Returns a structured array, one row for each position: particle (its index "
              "in the set; NONE unless the place is free), place, kind, simplex, dart, cell, dart_cell."));
  c.def("add", &add_to_simplex, py::arg("particles"), py::arg("simplex"), py::arg("position"));
  c.def("add", &add_new, py::arg("positions"), "Adds to a new set: returns (particles, places).");
  c.def("add_random", &added_random, py::arg("count"), py::arg("seed") = 1, about("add_random", "Returns a new set."));
  c.def("restored", &restored, py::arg("states"), py::arg("weights") = py::none(),
        about("Environment::restored",
              "states: as Particles.states gives them. weights: as Particles.held_weights() gives them; None where no "
              "particle is held."));
}

}  // namespace dartcast::python::environment_adding
