// Binds dartcast/environment.hpp: particles that are added, saved and restored.
#include <algorithm>

#include "bind.hpp"
#include "dartcast/simulation.hpp"
#include "support/environments.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python {

Added added_of(std::span<const AddResult> results) {
  py::array_t<bool> is_in(static_cast<py::ssize_t>(results.size()));
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const bool added = results[i].location.place == Place::free;
    is_in.mutable_at(static_cast<py::ssize_t>(i)) = added;
    if (added) indices.push_back(results[i].particle);
  }
  const std::size_t left_out = results.size() - indices.size();
  if (2 * left_out > results.size()) {
    const std::string text = "add: " + std::to_string(left_out) + " of " + std::to_string(results.size()) +
                             " positions are in no free cell, and were not added: are they in the unit of the mesh? " +
                             "locate() says where each one is";
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
  }
  return py::make_tuple(is_in, array_of(std::move(indices)));
}

namespace environment_adding {
namespace {

constexpr const char* remedy = "add particles by the simulation";

Added add(const EnvironmentHandle& h, ParticlesHandle& p, const Typed<"Points">& given) {
  const auto positions = vectors(given, "positions");
  const UseBoth use(h, p);
  std::vector<AddResult> added;
  {
    Environment& e = h.changeable(remedy);
    const py::gil_scoped_release release;
    added = e.add(p.particles, positions);
  }
  return added_of(added);
}

Typed<"tuple[Particles, NDArray[bool]]"> add_new(const EnvironmentHandle& h, const Typed<"Points">& given) {
  auto made = std::make_shared<ParticlesHandle>();
  const auto added = py::tuple(add(h, *made, given));
  return py::make_tuple(made, added[0]);
}

bool add_to_simplex(const EnvironmentHandle& h, ParticlesHandle& p, SimplexId simplex, const Vec3& position) {
  const UseBoth use(h, p);
  return h.changeable(remedy).add(p.particles, simplex, position);
}

bool add_at(const EnvironmentHandle& h, ParticlesHandle& p, SimplexId simplex, const Weights& weights) {
  const UseBoth use(h, p);
  return h.changeable(remedy).add_at(p.particles, simplex, weights);
}

ParticlesPointer added_random(const EnvironmentHandle& h, std::size_t count, std::uint64_t seed) {
  auto made = std::make_shared<ParticlesHandle>();
  const UseBoth use(h, *made);
  Environment& e = h.changeable(remedy);
  const py::gil_scoped_release release;
  add_random(e, made->particles, count, seed);
  return made;
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
              "positions: float64 (n, 3). Returns a tuple: bool (n,), which positions lie in a free cell, and the "
              "indices that these have in the set, uint32 (m,). Warns where more than half of them do not. locate() "
              "says where each position is."));
  c.def("add", &add_to_simplex, py::arg("particles"), py::arg("simplex"), py::arg("position"));
  c.def("add_at", &add_at, py::arg("particles"), py::arg("simplex"), py::arg("weights"),
        about("Environment::add_at", "weights: four floats."));
  c.def("add", &add_new, py::arg("positions"), "Adds to a new set: returns the set, and which positions were added.");
  c.def("add_random", &added_random, py::arg("count"), py::arg("seed") = 1, about("add_random", "Returns a new set."));
  c.def("restored", &restored, py::arg("states"), py::arg("weights") = py::none(),
        about("Environment::restored",
              "states: as Particles.states gives them. weights: as Particles.held_weights() gives them; None where no "
              "particle is held."));
}

}  // namespace environment_adding
}  // namespace dartcast::python
