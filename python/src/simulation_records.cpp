// The records of dartcast/simulation.hpp: options, reports, summaries.
#include <string>

#include "simulation_handle.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::simulation_records {
namespace {

void bind_step_record() {
  class_of<SimulationStep>()
      .def_property_readonly(
          "overlaps", [](const SimulationStep& s) { return rows_of(s.overlaps); },
          "A structured array, as SphereReport.overlaps.")
      .def_property_readonly(
          "left", [](const SimulationStep& s) { return rows_of(s.left); },
          (std::string(doc("SimulationStep::left")) + " A structured array (id, status, position, contact).").c_str())
      .def_property_readonly(
          "contact_sources", [](const SimulationStep& s) { return s.contact_sources; },
          doc("SimulationStep::contact_sources"))
      .def_property_readonly(
          "contacts",
          [](const SimulationStep& s) { return rows_of(s.report.contacts.contacts, s.report.contacts.walls); },
          about("SimulationStep::contacts", "As StepReport.contacts."));
}

}  // namespace

void bind(py::module_& m) {
  bind_step_record();
  py::class_<SimulationCheckpoint>(m, "SimulationCheckpoint", doc("SimulationCheckpoint"))
      .def_property_readonly("steps", &SimulationCheckpoint::steps, "Steps done before it.");
}

}  // namespace dartcast::python::simulation_records
