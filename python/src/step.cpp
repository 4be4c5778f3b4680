// Binds dartcast/step.hpp. The lists of a report are structured arrays.
#include "dartcast/step.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/pickles.hpp"
#include "support/python.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::step {
namespace {

// The contacts and walls of a list, for a class that has one.
template <class T, class Get>
void bind_contacts(py::class_<T>& c, const Get& list) {
  c.def_property_readonly(
      "contacts", [list](const T& t) { return rows_of(list(t).contacts, list(t).walls); },
      "Contacts by particle, then by time, as a structured array: particle, kind, last, patch, time_of_impact, point, "
      "normal, wall_displacement, displacement, unused, first_wall, wall_count, earlier, together, cell, dart. Patch "
      "and normal are those of the wall met first. See Contact.");
  c.def_property_readonly(
      "walls", [list](const T& t) { return rows_of(std::span<const WallHit>(list(t).walls)); },
      "The walls of all contacts as a structured array: cell, face, triangle, patch, normal. Those of a contact are "
      "walls[first_wall : first_wall + wall_count]. The walls met earlier in the step are the `earlier` rows before "
      "them.");
  const auto walls = [&](const char* name, auto of, const char* text) {
    c.def(
        name,
        [list, of](const T& t, std::size_t i) {
          const ContactList& contacts = list(t);
          expect_number(i, contacts.contacts.size(), "contact");
          const std::span<const WallHit> found = of(contacts, contacts.contacts[i]);
          return std::vector<WallHit>(found.begin(), found.end());
        },
        py::arg("contact"), text);
  };
  walls(
      "walls_of", [](const ContactList& l, const Contact& of) { return l.walls_of(of); },
      "The walls of a contact, given by its index, as a list of WallHit: for reflected() and slid().");
  walls(
      "earlier_walls_of", [](const ContactList& l, const Contact& of) { return l.earlier_walls_of(of); },
      doc("ContactList::earlier_walls_of"));
}

void bind_step_report(py::module_& m) {
  py::class_<StepReport> c(m, "StepReport", "The report of a step: its contacts, and the particles that it stopped.");
  bind_contacts(c, [](const StepReport& r) -> const ContactList& { return r.contacts; });
  c.def_property_readonly(
      "crossings", [](const StepReport& r) { return rows_of(r.contacts.crossings); },
      "Periodic crossings by particle, then by time, as a structured array: particle, pair, back, contacts, time, "
      "from_cell, from_face, to_cell, to_face, point, turn (rows of the rotation). See PeriodicCrossing in "
      "contact.hpp.");
  c.def_property_readonly(
      "held", [](const StepReport& r) { return rows_of(r.held); },
      "Particles that a cell kept from their step, as a structured array: particle, cell (the invalid cell, its own or "
      "one on its path; or its own blocked cell).");
  c.def_property_readonly(
      "stopped", [](const StepReport& r) { return rows_of(r.stopped); },
      "Particles stopped at a contact before their target, as a structured array: particle, unused (displacement left, "
      "relative to the wall).");
  c.def_property_readonly(
      "counters", [](const StepReport& r) { return r.counters; }, doc("Counters"));
  pickle_by_bytes(c, [](StepReport& r) {
    return std::tie(r.contacts.contacts, r.contacts.walls, r.contacts.crossings, r.held, r.stopped, r.counters);
  });
}

void bind_trace(py::module_& m) {
  py::class_<Trace> c(m, "Trace", doc("Trace"));
  bind_contacts(c, [](const Trace& t) -> const ContactList& { return t.contacts; });
  const auto member = [&](const char* name, auto get) {
    c.def_property_readonly(
        name, [get](const Trace& t) { return get(t); }, doc(std::string("Trace::") + name));
  };
  member("before", [](const Trace& t) { return t.before; });
  member("start", [](const Trace& t) { return t.start; });
  member("crossings", [](const Trace& t) { return t.crossings; });
  member("after", [](const Trace& t) { return t.after; });
  member("end", [](const Trace& t) { return t.end; });
  member("result", [](const Trace& t) { return t.result; });
}

}  // namespace

void bind(py::module_& m) {
  class_of<StepOptions>().def(
      "check", [](const StepOptions& o, const std::string& caller) { check(o, caller.c_str()); },
      py::arg("caller") = "check", doc("check"));
  bind_step_report(m);
  bind_trace(m);
}

}  // namespace dartcast::python::step
