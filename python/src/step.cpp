// Binds dartcast/step.hpp: options, reports and traces of steps.
#include "dartcast/step.hpp"

#include <string>
#include <vector>

#include "bind.hpp"
#include "contact_arrays.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

struct HeldRow {
  std::uint32_t particle;
  std::uint32_t cell;
};

struct StoppedRow {
  std::uint32_t particle;
  double unused[3];
};

py::array held_array(const std::vector<HeldParticle>& held) {
  std::vector<HeldRow> rows;
  rows.reserve(held.size());
  for (const HeldParticle& h : held) rows.push_back({h.particle, h.cell.value});
  return array_of(std::move(rows));
}

py::array stopped_array(const std::vector<StoppedParticle>& stopped) {
  std::vector<StoppedRow> rows;
  rows.reserve(stopped.size());
  for (const StoppedParticle& s : stopped) rows.push_back({s.particle, {s.unused.x, s.unused.y, s.unused.z}});
  return array_of(std::move(rows));
}

void bind_counters(py::module_& m) {
  Record<TestCounts>(m, "TestCounts").field("tests", &TestCounts::tests).field("exact", &TestCounts::exact).finish();
  Record<Counters>(m, "Counters")
      .field("particle_steps", &Counters::particle_steps)
      .field("orientation", &Counters::orientation)
      .field("histogram", &Counters::histogram)
      .field("forecast_kept", &Counters::forecast_kept)
      .field("updated_by_deformation", &Counters::updated_by_deformation)
      .field("steps_split", &Counters::steps_split)
      .field("contacts", &Counters::contacts)
      .field("unfinished", &Counters::unfinished)
      .finish()
      .def("__iadd__", &Counters::operator+=, py::arg("other"), "Adds the counts of other steps.")
      .attr("HISTOGRAM_SIZE") = Counters::histogram_size;
}

void bind_report(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(HeldRow, particle, cell);
  PYBIND11_NUMPY_DTYPE(StoppedRow, particle, unused);
  py::class_<StepReport>(m, "StepReport", doc("StepReport"))
      .def_property_readonly(
          "contacts", [](const StepReport& r) { return read_only(contact_array(r.contacts)); },
          "By particle, then by time: a structured array with the fields of Contact. `patch` and `normal` are those of "
          "the wall met first; its walls are walls[first_wall : first_wall + wall_count], those met earlier in the "
          "step "
          "walls[first_wall - earlier : first_wall].")
      .def_property_readonly(
          "walls", [](const StepReport& r) { return read_only(wall_array(r.contacts.walls)); },
          "The walls of all contacts: a structured array with the fields of WallHit; its face is (cell, face).")
      .def_property_readonly(
          "held", [](const StepReport& r) { return read_only(held_array(r.held)); },
          "By particle: a structured array (particle, cell).")
      .def_property_readonly(
          "stopped", [](const StepReport& r) { return read_only(stopped_array(r.stopped)); },
          "By particle: a structured array (particle, unused).")
      .def_readonly("counters", &StepReport::counters, doc("StepReport::counters"))
      .def("__repr__", [](const StepReport& r) {
        return "StepReport(" + std::to_string(r.contacts.contacts.size()) + " contacts, " +
               std::to_string(r.held.size()) + " held, " + std::to_string(r.stopped.size()) + " stopped)";
      });
}

void bind_trace(py::module_& m) {
  Record<StepResult>(m, "StepResult")
      .field("held", &StepResult::held)
      .field("invalid_cell", &StepResult::invalid_cell)
      .field("stopped", &StepResult::stopped)
      .field("unused", &StepResult::unused)
      .finish();
  Record<Crossing>(m, "Crossing")
      .field("time", &Crossing::time)
      .field("point", &Crossing::point)
      .field("from_", &Crossing::from, "from")
      .field("to", &Crossing::to)
      .field("kind", &Crossing::kind)
      .field("dart", &Crossing::dart)
      .field("contacts", &Crossing::contacts)
      .finish();
  py::class_<Trace>(m, "Trace", doc("Trace"))
      .def_readonly("before", &Trace::before, "The state before the step.")
      .def_readonly("start", &Trace::start, doc("Trace::start"))
      .def_property_readonly(
          "crossings", [](const Trace& t) { return t.crossings; }, "By time: a list of Crossing.")
      .def_property_readonly(
          "contacts", [](const Trace& t) { return read_only(contact_array(t.contacts)); },
          "By time: as StepReport.contacts.")
      .def_property_readonly(
          "walls", [](const Trace& t) { return read_only(wall_array(t.contacts.walls)); }, "As StepReport.walls.")
      .def_readonly("after", &Trace::after, doc("Trace::after"))
      .def_readonly("end", &Trace::end, doc("Trace::end"))
      .def_readonly("result", &Trace::result, doc("Trace::result"));
}

}  // namespace

void bind_step(py::module_& m) {
  bind_counters(m);
  Record<StepOptions>(m, "StepOptions")
      .field("max_contacts", &StepOptions::max_contacts)
      .field("tolerance", &StepOptions::tolerance)
      .field("max_parts", &StepOptions::max_parts)
      .finish();
  bind_report(m);
  bind_trace(m);
}

}  // namespace dartcast::python
