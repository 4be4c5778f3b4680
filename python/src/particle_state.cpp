// Binds dartcast/particle_state.hpp.
#include "dartcast/particle_state.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::particle_state {
namespace {

void check_state(const CombinatorialMap& map, const ParticleState& s) {
  expect_simplex(map, s.at());
  if (s.touching_count > s.touching.size()) throw InvalidArgument("state: it can touch 3 walls at most");
  for (std::size_t i = 0; i < s.touching_count; ++i) expect_face(map, s.touching[i]);
}

void bind_functions(py::module_& m) {
  m.def(
      "forecast",
      [](const MapHandle& h, const ParticleState& state, const Corners& corners) {
        return read(h, [&](const CombinatorialMap& map) {
          check_state(map, state);
          return forecast(map, state, corners);
        });
      },
      about("forecast"));
  m.def(
      "placement",
      [](const MapHandle& h, SimplexId simplex, const Corners& corners, const Vec3& x) {
        return read(h, [&](const CombinatorialMap& map) {
          expect_simplex(map, simplex);
          return placement(map, simplex, corners, x);
        });
      },
      about("placement"));
}

}  // namespace

void bind(py::module_& m) {
  register_rows();
  class_of<ParticleState>().def(
      "at", [](const ParticleState& s) { return or_none(s.at()); }, doc("ParticleState::at"));
  bind_functions(m);
}

}  // namespace dartcast::python::particle_state
