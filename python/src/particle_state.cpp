// Binds dartcast/particle_state.hpp.
#include "dartcast/particle_state.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"

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
      py::arg("map"), py::arg("state"), py::arg("corners"), doc("forecast"));
  m.def(
      "placement",
      [](const MapHandle& h, SimplexId simplex, const Corners& corners, const Vec3& x) {
        return read(h, [&](const CombinatorialMap& map) {
          expect_simplex(map, simplex);
          return placement(map, simplex, corners, x);
        });
      },
      py::arg("map"), py::arg("simplex"), py::arg("corners"), py::arg("x"), doc("placement"));
}

}  // namespace

void bind(py::module_& m) {
  bind_enum<Place>(m, "Place", {{"FREE", Place::free}, {"BLOCKED", Place::blocked}, {"OUTSIDE", Place::outside}});
  Record<ParticleState>(m, "ParticleState")
      .field("position", &ParticleState::position)
      .field("cell", &ParticleState::cell)
      .field("simplex", &ParticleState::simplex)
      .field("touching_count", &ParticleState::touching_count)
      .field("held", &ParticleState::held)
      .field("touching", &ParticleState::touching)
      .def("at", &ParticleState::at, doc("ParticleState::at"))
      .def("put", &ParticleState::put, py::arg("s"), py::arg("p"), doc("ParticleState::put"))
      .finish();
  Record<Forecast>(m, "Forecast")
      .field("kind", &Forecast::kind)
      .field("dart", &Forecast::dart)
      .field("face", &Forecast::face)
      .finish();
  Record<Placement>(m, "Placement").field("kind", &Placement::kind).field("dart", &Placement::dart).finish();
  Record<Location>(m, "Location")
      .field("place", &Location::place)
      .field("simplex", &Location::simplex)
      .field("kind", &Location::kind)
      .field("dart", &Location::dart)
      .finish();
  bind_functions(m);
}

}  // namespace dartcast::python::particle_state
