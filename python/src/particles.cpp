// Binds Particles of dartcast/environment.hpp. All arrays are copies: a later call cannot move them.
#include "bind.hpp"
#include "dartcast/environment.hpp"
#include "support/environments.hpp"
#include "support/members.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::particles {
namespace {

using Class = py::class_<ParticlesHandle, ParticlesPointer>;
constexpr const char* the_set = "the set of particles";

// A fresh array with one entry or one row of three for each state.
template <class T, class Get>
py::array_t<T> column(const ParticlesHandle& h, const Get& get) {
  const Use use(*h.usage, the_set);
  const auto states = h.particles.states();
  py::array_t<T> made(static_cast<py::ssize_t>(states.size()));
  T* out = made.mutable_data();
  for (std::size_t i = 0; i < states.size(); ++i) out[i] = get(states[i]);
  return made;
}

std::vector<Vec3> positions(const Particles& particles) {
  std::vector<Vec3> points;
  for (const ParticleState& s : particles.states()) points.push_back(s.position);
  return points;
}

void bind_columns(Class& c) {
  property(c, "positions", &positions, "float64 (n, 3), a read-only copy.");
  const auto state = [&](const char* name, auto type, auto get, const char* text) {
    using T = decltype(type);
    c.def_property_readonly(
        name, [get](const ParticlesHandle& h) { return read_only(column<T>(h, get)); }, text);
  };
  state(
      "cells", std::uint32_t{}, [](const ParticleState& s) { return s.cell.value; },
      "The cell of each particle: uint32 (n,), a read-only copy.");
  state(
      "simplices", std::uint16_t{}, [](const ParticleState& s) { return s.simplex; },
      "The number of each particle's simplex in its cell: uint16 (n,), a read-only copy.");
  state(
      "touching_counts", std::uint8_t{}, [](const ParticleState& s) { return s.touching_count; },
      "The number of walls that each particle touches: uint8 (n,), a read-only copy. `states` names them.");
  state(
      "held", bool{}, [](const ParticleState& s) { return s.held; },
      "Whether each particle is held: bool (n,), a read-only copy. See ParticleState.");
  c.def_property_readonly(
      "states",
      [](const ParticlesHandle& h) {
        const Use use(*h.usage, the_set);
        return read_only(rows_of(h.particles.states()));
      },
      "All states as a structured array, a copy: position, cell, simplex, touching_count, held, touching_cell and "
      "touching_face (3 each; the first touching_count count). Environment.restored() takes it.");
  c.def_property_readonly(
      "vertex_numbers",
      [](const ParticlesHandle& h) {
        const Use use(*h.usage, the_set);
        const auto numbers = h.particles.vertex_numbers();
        return read_only(py::array_t<std::uint32_t>({static_cast<py::ssize_t>(numbers.size()), py::ssize_t{4}},
                                                    numbers.empty() ? nullptr : numbers.data()->data()));
      },
      about("Particles::vertex_numbers", "uint32 (n, 4), a read-only copy."));
  c.def(
      "held_weights",
      [](const ParticlesHandle& h, std::size_t i) {
        const Use use(*h.usage, the_set);
        expect_number(i, h.particles.size(), "particle");
        const Weights w = h.particles.held_weights(i);
        return py::array_t<double>(static_cast<py::ssize_t>(w.size()), w.data());
      },
      about("Particles::held_weights", "float64 (4,)."));
  c.def(
      "held_weights",
      [](const ParticlesHandle& h) {
        const Use use(*h.usage, the_set);
        py::array_t<double> made({static_cast<py::ssize_t>(h.particles.size()), py::ssize_t{4}});
        double* out = made.mutable_data();
        for (std::size_t i = 0; i < h.particles.size(); ++i) {
          for (const double w : h.particles.held_weights(i)) *out++ = w;
        }
        return made;
      },
      "Those of all particles: float64 (n, 4); to be saved with `states`.");
}

void bind_changes(Class& c) {
  members_of_Particles(c);
  c.def(
      "replace",
      [](ParticlesHandle& h, const Typed<"Integers">& given, const ParticlesHandle& by) {
        const auto which = indices(given, "which");
        if (&h == &by)
          throw InvalidArgument("replace: a set cannot replace its own particles: give one that was selected()");
        const Use other(*by.usage, "the other set of particles");
        change(h, [&](Particles& particles) { particles.replace(which, by.particles); });
      },
      about("Particles::replace"));
}

ParticlesPointer copy_of(const ParticlesHandle& h) {
  return read_long(h, [](const Particles& particles) { return kept(particles); });
}

}  // namespace

void bind(py::module_& m) {
  Class c(m, "Particles", doc("Particles"));
  c.def(py::init([] { return std::make_shared<ParticlesHandle>(); }), "An empty set.");
  c.def(py::init([](const Typed<"Records">& states, const Typed<"Floats | None">& weights) {
          return kept(Particles(states_of(states, "states"), weights_of(weights, py::len(states))));
        }),
        py::arg("states"), py::arg("weights") = py::none(),
        "A set that belongs to no environment, as unpickled: Environment.restored() takes its states and "
        "held_weights().");
  c.def("__len__", calling<ParticlesHandle>(&Particles::size));
  c.def(
      "__getitem__",
      [](const ParticlesHandle& h, std::size_t i) {
        const Use use(*h.usage, the_set);
        expect_number(i, h.particles.size(), "particle");
        return h.particles[i];
      },
      py::arg("i"), "The state of a particle, a copy.");
  c.def("__copy__", &copy_of);
  c.def("__deepcopy__", [](const ParticlesHandle& h, const py::dict& /*memo*/) { return copy_of(h); });
  c.def("copy", &copy_of, "A set of its own with the same particles.");
  bind_columns(c);
  bind_changes(c);
}

}  // namespace dartcast::python::particles
