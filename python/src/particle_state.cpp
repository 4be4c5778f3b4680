// Binds dartcast/particle_state.hpp: single states and places. Those of many are arrays (particles.cpp).
#include "dartcast/particle_state.hpp"

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

void bind_state(py::module_& m) {
  Record<ParticleState>(m, "ParticleState")
      .field("position", &ParticleState::position)
      .field("cell", &ParticleState::cell)
      .field("simplex", &ParticleState::simplex)
      .field("touching_count", &ParticleState::touching_count)
      .field("held", &ParticleState::held)
      .field("touching", &ParticleState::touching)
      .finish()
      .def("at", &ParticleState::at, "The simplex that the particle is in.")
      .def("put", &ParticleState::put, py::arg("s"), py::arg("p"), "Puts the particle at p in the simplex s.");
  Record<Forecast>(m, "Forecast")
      .field("kind", &Forecast::kind)
      .field("dart", &Forecast::dart)
      .field("face", &Forecast::face)
      .finish();
}

}  // namespace

void bind_particle_state(py::module_& m) {
  bind_enum<Place>(m, "Place", {{"FREE", Place::free}, {"BLOCKED", Place::blocked}, {"OUTSIDE", Place::outside}});
  bind_state(m);
  Record<Location>(m, "Location")
      .field("place", &Location::place)
      .field("simplex", &Location::simplex)
      .field("kind", &Location::kind)
      .field("dart", &Location::dart)
      .finish();
  Record<Placement>(m, "Placement").field("kind", &Placement::kind).field("dart", &Placement::dart).finish();
}

}  // namespace dartcast::python
