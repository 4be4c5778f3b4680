// Binds dartcast/events.hpp: events and their log.
#include "dartcast/events.hpp"

#include <string>

#include "bind.hpp"
#include "simulation_handle.hpp"

namespace py = pybind11;

namespace dartcast::python::events {
namespace {

void bind_subdivision(py::module_& m) {
  Record<AdaptiveSubdivisionOptions>(m, "AdaptiveSubdivisionOptions")
      .field("max_particles", &AdaptiveSubdivisionOptions::max_particles)
      .field("min_particles", &AdaptiveSubdivisionOptions::min_particles)
      .field("smallest", &AdaptiveSubdivisionOptions::smallest)
      .field("edits", &AdaptiveSubdivisionOptions::edits)
      .finish();
  Record<SubdivisionRefusal>(m, "SubdivisionRefusal")
      .field("cell", &SubdivisionRefusal::cell)
      .field("particles", &SubdivisionRefusal::particles)
      .field("reason", &SubdivisionRefusal::reason)
      .finish();
  Record<SubdivisionChange>(m, "SubdivisionChange")
      .field("merged", &SubdivisionChange::merged)
      .field("what", &SubdivisionChange::what)
      .finish();
  Record<AdaptiveSubdivisionReport>(m, "AdaptiveSubdivisionReport")
      .field("subdivided", &AdaptiveSubdivisionReport::subdivided)
      .field("merged", &AdaptiveSubdivisionReport::merged)
      .field("waiting", &AdaptiveSubdivisionReport::waiting)
      .field("refused", &AdaptiveSubdivisionReport::refused)
      .field("changes", &AdaptiveSubdivisionReport::changes)
      .finish();
}

// Each kind of event names itself.
template <class T>
void finish_kind(Record<T>& record) {
  record.finish().attr("kind") = py::cast(T::kind);
}

void bind_kinds(py::module_& m) {
  bind_enum<EventKind>(m, "EventKind",
                       {{"CUT", EventKind::cut},
                        {"CARVE", EventKind::carve},
                        {"LIGATURE", EventKind::ligature},
                        {"RECONNECT", EventKind::reconnect},
                        {"OPEN", EventKind::open},
                        {"CLOSE", EventKind::close}});
  Record<Cut> cut(m, "Cut");
  cut.field("surface", &Cut::surface).field("width", &Cut::width);
  finish_kind(cut);
  Record<Carve> carve(m, "Carve");
  carve.field("tool", &Carve::tool).field("what", &Carve::what).field("whole_cells", &Carve::whole_cells);
  finish_kind(carve);
  Record<Ligature> ligature(m, "Ligature");
  ligature.field("plane", &Ligature::plane)
      .field("place", &Ligature::place)
      .field("tying", &Ligature::tying)
      .field("duration", &Ligature::duration);
  finish_kind(ligature);
  Record<Reconnect> reconnect(m, "Reconnect");
  reconnect.field("a", &Reconnect::a)
      .field("b", &Reconnect::b)
      .field("within", &Reconnect::within)
      .field("options", &Reconnect::options);
  finish_kind(reconnect);
  Record<OpenCells> open(m, "OpenCells");
  open.field("cells", &OpenCells::cells);
  finish_kind(open);
  Record<CloseCells> close(m, "CloseCells");
  close.field("cells", &CloseCells::cells);
  finish_kind(close);
  Record<Event>(m, "Event")
      .field("at", &Event::at)
      .field("what", &Event::what)
      .field("orphaned", &Event::orphaned)
      .field("required", &Event::required)
      .finish();
  m.def(
      "name_of", [](EventKind kind) { return name_of(kind); }, py::arg("kind"), doc("name_of"));
  m.def("kind_of", &kind_of, py::arg("event"), doc("kind_of"));
}

void bind_log(py::module_& m) {
  Record<EventReport>(m, "EventReport")
      .field("kind", &EventReport::kind)
      .field("step", &EventReport::step)
      .field("time", &EventReport::time)
      .field("cells_removed", &EventReport::cells_removed)
      .field("cells_added", &EventReport::cells_added)
      .field("cells_opened", &EventReport::cells_opened)
      .field("cells_blocked", &EventReport::cells_blocked)
      .field("cells_whole", &EventReport::cells_whole)
      .field("particles_in_opened", &EventReport::particles_in_opened)
      .field("particles_touched", &EventReport::particles_touched)
      .field("particles_located", &EventReport::particles_located)
      .field("particles_moved", &EventReport::particles_moved)
      .field("particles_held", &EventReport::particles_held)
      .field("particles_absorbed", &EventReport::particles_absorbed)
      .field("boundary_shift", &EventReport::boundary_shift)
      .field("seconds", &EventReport::seconds)
      .field("refused", &EventReport::refused)
      .finish();
  Record<EventLog> log(m, "EventLog");
  log.field("changes", &EventLog::changes)
      .field("events", &EventLog::events)
      .field("mended", &EventLog::mended)
      .field("left", &EventLog::left)
      .field("subdivided", &EventLog::subdivided)
      .field("merged", &EventLog::merged)
      .field("refused", &EventLog::refused)
      .field("in_opened", &EventLog::in_opened);
  using Change = EventLog::Change;
  auto change = Record<Change>(log.finish(), "Change", "EventLog::Change")
                    .field("step", &Change::step)
                    .field("event", &Change::event)
                    .field("what", &Change::what)
                    .finish();
  change.attr("REMESHING") = std::uint32_t{Change::remeshing};
  change.attr("SUBDIVIDING") = std::uint32_t{Change::subdividing};
  change.attr("MERGING") = std::uint32_t{Change::merging};
}

}  // namespace

void bind(py::module_& m) {
  bind_subdivision(m);
  bind_kinds(m);
  bind_log(m);
  m.def(
      "apply",
      [](SimulationHandle& simulation, const Event& event) {
        const Use use = simulation.use();
        const Event own_event = event;
        const py::gil_scoped_release release;
        return apply(simulation.get(), own_event);
      },
      py::arg("simulation"), py::arg("event"), doc("apply"));
}

}  // namespace dartcast::python::events
