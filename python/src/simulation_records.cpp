// The records of dartcast/simulation.hpp: options, reports, summaries.
#include <string>
#include <utility>

#include "simulation_handle.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::simulation_records {
namespace {

struct LeftRow {
  std::uint64_t id;
  std::uint8_t status;
  Row3 position;
  std::uint32_t contact;
};

py::array left_rows(const std::vector<LeftParticle>& left) {
  std::vector<LeftRow> rows;
  rows.reserve(left.size());
  for (const LeftParticle& p : left) {
    rows.push_back({p.id, static_cast<std::uint8_t>(p.status), {p.position.x, p.position.y, p.position.z}, p.contact});
  }
  return array_of(std::move(rows));
}

void bind_options(py::module_& m) {
  bind_enum<Integrator>(m, "Integrator", {{"EULER", Integrator::euler}, {"RK4", Integrator::rk4}});
  bind_enum<WallMotion>(m, "WallMotion",
                        {{"CARRIED", WallMotion::carried}, {"SIMULTANEOUS", WallMotion::simultaneous}});
  bind_enum<Partition>(m, "Partition", {{"PARTICLES", Partition::particles}, {"CELLS", Partition::cells}});
  Record<CollisionOptions>(m, "CollisionOptions")
      .field("restitution", &CollisionOptions::restitution)
      .field("friction", &CollisionOptions::friction)
      .field("density", &CollisionOptions::density)
      .field("iterations", &CollisionOptions::iterations)
      .field("position_iterations", &CollisionOptions::position_iterations)
      .finish();
  Record<SimulationOptions>(m, "SimulationOptions")
      .field("dt", &SimulationOptions::dt)
      .field("gravity", &SimulationOptions::gravity)
      .field("drag", &SimulationOptions::drag)
      .field("response", &SimulationOptions::response)
      .field("patch_responses", &SimulationOptions::patch_responses)
      .field("substeps", &SimulationOptions::substeps)
      .field("integrator", &SimulationOptions::integrator)
      .field("wall_motion", &SimulationOptions::wall_motion)
      .field("seed", &SimulationOptions::seed)
      .field("step", &SimulationOptions::step)
      .field("collisions", &SimulationOptions::collisions)
      .field("body_collisions", &SimulationOptions::body_collisions)
      .field("user_data", &SimulationOptions::user_data)
      .finish();
}

void bind_step_record(py::module_& m) {
  Record<SimulationStep>(m, "SimulationStep")
      .field("duration", &SimulationStep::duration)
      .field("report", &SimulationStep::report)
      .field("contact_ids", &SimulationStep::contact_ids)
      .field("injected", &SimulationStep::injected)
      .field("absorbed", &SimulationStep::absorbed)
      .field("escaped", &SimulationStep::escaped)
      .field("collisions", &SimulationStep::collisions)
      .finish()
      .def_property_readonly(
          "overlaps", [](const SimulationStep& s) { return rows_of(s.overlaps); },
          "A structured array, as SphereReport.overlaps.")
      .def_property_readonly(
          "left", [](const SimulationStep& s) { return left_rows(s.left); },
          (std::string(doc("SimulationStep::left")) + " A structured array (id, status, position, contact).").c_str())
      .def_property_readonly(
          "contact_sources", [](const SimulationStep& s) { return s.contact_sources; },
          doc("SimulationStep::contact_sources"))
      .def_property_readonly(
          "contacts", [](const py::object& self) { return py::object(self.attr("report").attr("contacts")); },
          (std::string(doc("SimulationStep::contacts")) + "\n\nAs StepReport.contacts.").c_str());
}

void bind_totals(py::module_& m) {
  Record<SimulationTotals>(m, "SimulationTotals")
      .field("start", &SimulationTotals::start)
      .field("injected", &SimulationTotals::injected)
      .field("absorbed", &SimulationTotals::absorbed)
      .field("escaped", &SimulationTotals::escaped)
      .field("counters", &SimulationTotals::counters)
      .field("collisions", &SimulationTotals::collisions)
      .field("wall_overlaps", &SimulationTotals::wall_overlaps)
      .field("deepest_in_wall", &SimulationTotals::deepest_in_wall)
      .field("contacts_by_patch", &SimulationTotals::contacts_by_patch)
      .field("seconds_detect", &SimulationTotals::seconds_detect)
      .field("seconds_deform", &SimulationTotals::seconds_deform)
      .field("seconds_collide", &SimulationTotals::seconds_collide)
      .field("seconds_respond", &SimulationTotals::seconds_respond)
      .finish();
  Record<SimulationEnergy>(m, "SimulationEnergy")
      .field("kinetic", &SimulationEnergy::kinetic)
      .field("potential", &SimulationEnergy::potential)
      .finish();
  Record<SimulationEdit>(m, "SimulationEdit")
      .field("edit", &SimulationEdit::edit)
      .field("particles", &SimulationEdit::particles)
      .finish();
  py::class_<SimulationCheckpoint>(m, "SimulationCheckpoint", doc("SimulationCheckpoint"))
      .def_property_readonly("steps", &SimulationCheckpoint::steps, "Steps done before it.");
}

void bind_summaries(py::module_& m) {
  Record<BodySummary>(m, "BodySummary")
      .field("name", &BodySummary::name)
      .field("particles", &BodySummary::particles)
      .field("gone", &BodySummary::gone)
      .field("centre", &BodySummary::centre)
      .field("energy", &BodySummary::energy)
      .finish();
  Record<CatheterTotals>(m, "CatheterTotals")
      .field("worst_segment", &CatheterTotals::worst_segment)
      .field("refused", &CatheterTotals::refused)
      .finish();
  Record<SolidSummary>(m, "SolidSummary")
      .field("name", &SolidSummary::name)
      .field("vertices", &SolidSummary::vertices)
      .field("pivot", &SolidSummary::pivot)
      .field("contacts", &SolidSummary::contacts)
      .field("stopped", &SolidSummary::stopped)
      .field("stuck", &SolidSummary::stuck)
      .finish();
  Record<CatheterSummary>(m, "CatheterSummary")
      .field("name", &CatheterSummary::name)
      .field("inserted", &CatheterSummary::inserted)
      .field("measured_length", &CatheterSummary::measured_length)
      .field("totals", &CatheterSummary::totals)
      .field("tip", &CatheterSummary::tip)
      .finish();
}

}  // namespace

void bind(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(LeftRow, id, status, position, contact);
  m.attr("SMALLEST_DT") = smallest_dt;
  m.attr("LARGEST_DT") = largest_dt;
  m.attr("SMALLEST_DENSITY") = smallest_density;
  m.attr("LARGEST_DENSITY") = largest_density;
  bind_options(m);
  bind_step_record(m);
  bind_totals(m);
  bind_summaries(m);
}

}  // namespace dartcast::python::simulation_records
