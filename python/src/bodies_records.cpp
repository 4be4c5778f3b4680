// The records of dartcast/bodies.hpp, and the functions that sample surfaces.

#include "bodies_handle.hpp"
#include "dartcast/bodies.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::bodies_records {
namespace {

// A member that can be read only.
template <class T, class M>
auto shown(M T::*member) {
  return [member](const T& t) { return reading(t.*member); };
}

// Checkpoints cannot be made or changed in Python: bodies trust the ones that they get.
void bind_checkpoint(py::module_& m) {
  using Checkpoint = BodiesCheckpoint;
  using Particle = BodiesCheckpoint::Particle;
  py::class_<Checkpoint> checkpoint(m, "BodiesCheckpoint", doc("BodiesCheckpoint"));
  py::class_<Particle>(checkpoint, "Particle", doc("BodiesCheckpoint::Particle"))
      .def_property_readonly("state", shown(&Particle::state))
      .def_property_readonly("held_weights", shown(&Particle::held_weights))
      .def_property_readonly("velocity", shown(&Particle::velocity))
      .def_property_readonly("fate", shown(&Particle::fate))
      .def_property_readonly(
          "on",
          [](const Particle& p) { return std::vector<CellFace>(p.on.face.begin(), p.on.face.begin() + p.on.count); },
          doc("TouchedFaces"));
  checkpoint.def_property_readonly("steps", shown(&Checkpoint::steps))
      .def_property_readonly("counters", shown(&Checkpoint::counters))
      .def_property_readonly("ids", shown(&Checkpoint::ids), doc("BodiesCheckpoint::ids"))
      .def_property_readonly("fits", shown(&Checkpoint::fits), doc("BodiesCheckpoint::fits"))
      .def_property_readonly("impulses", shown(&Checkpoint::impulses))
      .def_property_readonly("particles", shown(&Checkpoint::particles))
      .def_property_readonly("surfaces", shown(&Checkpoint::surfaces));
}

}  // namespace

void bind(py::module_& m) {
  class_of<BodiesStep>().def_property_readonly(
      "edges", [](const BodiesStep& s) { return rows_of(s.edges); },
      about("BodiesStep::edges", "A structured array with the columns of SolidStep.contacts."));
  bind_checkpoint(m);
}

}  // namespace dartcast::python::bodies_records
