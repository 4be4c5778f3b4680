// Binds the particles of dartcast/environment.hpp: a set whose states are read as arrays.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "bind.hpp"
#include "dartcast/environment.hpp"
#include "environment_parts.hpp"
#include "support/handles.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

using Handle = ParticlesHandle;
constexpr const char* what = "the set of particles";

// Copies one value of each state.
template <class T, class Get>
py::array column(Handle& h, Get get) {
  const Use use(*h.usage, what);
  const auto states = h.particles.states();
  py::array_t<T> made(static_cast<py::ssize_t>(states.size()));
  std::transform(states.begin(), states.end(), made.mutable_data(), get);
  return read_only(made);
}

py::array positions(Handle& h) {
  const Use use(*h.usage, what);
  return particle_positions(h.particles);
}

py::array vertex_numbers(Handle& h) {
  const Use use(*h.usage, what);
  const auto numbers = h.particles.vertex_numbers();
  py::array_t<std::uint32_t> made({static_cast<py::ssize_t>(numbers.size()), py::ssize_t{4}});
  if (!numbers.empty()) std::copy_n(numbers.front().data(), 4 * numbers.size(), made.mutable_data());
  return read_only(made);
}

Weights held_weights(Handle& h, std::size_t i) {
  const Use use(*h.usage, what);
  if (i >= h.particles.size()) throw py::index_error("there is no particle " + std::to_string(i));
  return h.particles.held_weights(i);
}

ParticleState state(Handle& h, py::ssize_t i) {
  const Use use(*h.usage, what);
  const auto size = static_cast<py::ssize_t>(h.particles.size());
  if (i < -size || i >= size) throw py::index_error("there is no particle " + std::to_string(i));
  return h.particles[static_cast<std::size_t>(i < 0 ? i + size : i)];
}

void add_columns(py::class_<Handle, std::shared_ptr<Handle>>& c) {
  c.def_property_readonly("positions", &positions, "float64 (n, 3), m.");
  c.def_property_readonly(
      "cells", [](Handle& h) { return column<std::uint32_t>(h, [](const ParticleState& s) { return s.cell.value; }); },
      "uint32 (n,): the cell of each particle.");
  c.def_property_readonly(
      "simplices", [](Handle& h) { return column<std::uint16_t>(h, [](const ParticleState& s) { return s.simplex; }); },
      "uint16 (n,): the simplex of that cell.");
  c.def_property_readonly(
      "touching_counts",
      [](Handle& h) { return column<std::uint8_t>(h, [](const ParticleState& s) { return s.touching_count; }); },
      "uint8 (n,): the number of walls that each particle touches.");
  c.def_property_readonly(
      "held", [](Handle& h) { return column<bool>(h, [](const ParticleState& s) { return s.held; }); },
      "bool (n,): whether its simplex is not positive now, or its cell is blocked.");
  c.def_property_readonly("vertex_numbers", &vertex_numbers,
                          (std::string(doc("Particles::vertex_numbers")) + "\n\nuint32 (n, 4).").c_str());
}

void add_changes(py::class_<Handle, std::shared_ptr<Handle>>& c) {
  c.def(
      "remove",
      [](Handle& h, const py::object& given) {
        const auto removed = marks(given, "marks");
        const Use use(*h.usage, what);
        h.particles.remove(removed);
      },
      py::arg("marks"), (std::string(doc("Particles::remove")) + " bool or uint8 (n,).").c_str());
  c.def(
      "reorder",
      [](Handle& h, const py::object& order) {
        const auto numbers = indices(order, "order");
        const Use use(*h.usage, what);
        h.particles.reorder(numbers);
      },
      py::arg("order"), doc("Particles::reorder"));
  c.def(
      "selected",
      [](Handle& h, const py::object& which) {
        const auto numbers = indices(which, "which");
        const Use use(*h.usage, what);
        return std::make_shared<Handle>(Handle{h.particles.selected(numbers)});
      },
      py::arg("which"), doc("Particles::selected"));
  c.def(
      "replace",
      [](Handle& h, const py::object& which, Handle& by) {
        const auto numbers = indices(which, "which");
        if (&h == &by) throw InvalidArgument("replace: a set cannot replace particles of itself");
        const Use use(*h.usage, what);
        const Use other(*by.usage, what);
        h.particles.replace(numbers, by.particles);
      },
      py::arg("which"), py::arg("by"), doc("Particles::replace"));
}

}  // namespace

py::array particle_positions(const Particles& particles) {
  const auto states = particles.states();
  py::array_t<double> made({static_cast<py::ssize_t>(states.size()), py::ssize_t{3}});
  auto* out = reinterpret_cast<Vec3*>(made.mutable_data());
  for (std::size_t i = 0; i < states.size(); ++i) out[i] = states[i].position;
  return read_only(made);
}

void bind_particles(py::module_& m) {
  py::class_<Handle, std::shared_ptr<Handle>> c(m, "Particles", doc("Particles"));
  c.def(py::init<>());
  c.def("__len__", [](Handle& h) { return h.particles.size(); });
  c.def("__getitem__", &state, py::arg("i"), "The state of one particle.");
  c.def("held_weights", &held_weights, py::arg("i"), doc("Particles::held_weights"));
  c.def("__copy__", [](Handle& h) {
    const Use use(*h.usage, what);
    return std::make_shared<Handle>(Handle{h.particles});
  });
  c.def("__deepcopy__", [](Handle& h, const py::dict& /*memo*/) {
    const Use use(*h.usage, what);
    return std::make_shared<Handle>(Handle{h.particles});
  });
  c.def("__repr__", [](Handle& h) { return "Particles(" + std::to_string(h.particles.size()) + ")"; });
  add_columns(c);
  add_changes(c);
}

}  // namespace dartcast::python
