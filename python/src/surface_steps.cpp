// Steps of particles on a surface: contacts, responses, one particle and many.
#include <algorithm>
#include <string>

#include "surface_places.hpp"

namespace py = pybind11;

namespace dartcast::python::surface_steps {
namespace {

// The lists that a step fills for Python.
struct TraceLists {
  std::vector<SurfaceContact> contacts;
  std::vector<SurfaceCrossing> crossings;
};

struct ReportArrays {
  py::array steps;
  py::array contacts;
};

AfterSurfaceContact after_contact(const py::object& answer) {
  if (answer.is_none()) return {};
  if (py::isinstance<AfterSurfaceContact>(answer)) return answer.cast<AfterSurfaceContact>();
  py::detail::make_caster<Vec3> displacement;
  if (displacement.load(answer, true)) return {py::detail::cast_op<Vec3&>(displacement), false};
  throw py::type_error(
      "respond: expected a dartcast.AfterSurfaceContact, a displacement of three numbers, or None to stop; got " +
      py::repr(answer).cast<std::string>());
}

// The function lives as long as the call. Contacts come from any thread, without Python's lock.
SurfaceContactCallback callback(const py::object& respond) {
  if (respond.is_none()) return {};
  if (PyCallable_Check(respond.ptr()) == 0) throw py::type_error("respond: expected a function of a SurfaceContact");
  const py::handle function = respond;
  return [function](const SurfaceContact& contact) {
    const py::gil_scoped_acquire acquire;
    return after_contact(function(contact));
  };
}

// The place is changed at the end, under Python's lock, so that nobody sees half of it.
SurfaceStep step_one(SurfaceHandle& surface, SurfacePlace& place, const Vec3& displacement,
                     const Typed<"SurfaceRespond | None">& respond, const SurfaceOptions& options, TraceLists* trace,
                     std::uint32_t particle) {
  const Use use = surface.use();
  const SurfaceContactCallback answer = callback(respond);
  const SurfaceOptions own_options = options;
  SurfacePlace moved = place;
  TraceLists lists;
  SurfaceStep result;
  {
    const py::gil_scoped_release release;
    result = dartcast::step(surface.surface, moved, displacement, answer, own_options,
                            {&lists.contacts, &lists.crossings}, particle);
  }
  place = moved;
  if (trace != nullptr) {
    trace->contacts.insert(trace->contacts.end(), lists.contacts.begin(), lists.contacts.end());
    trace->crossings.insert(trace->crossings.end(), lists.crossings.begin(), lists.crossings.end());
  }
  return result;
}

ReportArrays advance_many(SurfaceHandle& surface, const Typed<"Records">& places, const Typed<"Points">& displacements,
                          const Typed<"SurfaceRespond | None">& respond, const SurfaceOptions& options,
                          Threads threads) {
  const Use use = surface.use();
  const std::span<PlaceRow> rows = writable_place_rows(places, "places");
  const std::span<const Vec3> ways = vectors(displacements, "displacements");
  const SurfaceContactCallback answer = callback(respond);
  const SurfaceOptions own_options = options;
  std::vector<SurfacePlace> moved = places_of(rows);
  SurfaceReport report;
  {
    const py::gil_scoped_release release;
    report = advance(surface.surface, moved, ways, answer, own_options, threads);
  }
  std::transform(moved.begin(), moved.end(), rows.begin(), [](const SurfacePlace& p) { return row_of(p); });
  return {rows_of(report.steps), rows_of(report.contacts)};
}

py::array_t<double> tangent_of(SurfaceHandle& surface, SimplexId triangle, unsigned corner, double angle,
                               double length) {
  const Use use = surface.use();
  return array_of(tangent(surface.surface, triangle, corner, angle, length));
}

void bind_contacts(py::module_& m) {
  m.def(
      "reflected",
      [](const SurfaceContact& contact, const Vec3& v, double restitution) {
        return reflected(contact, v, restitution);
      },
      py::arg("contact"), py::arg("v"), py::arg("restitution") = 1.0, doc("reflected"));
  m.def(
      "slid", [](const SurfaceContact& contact, const Vec3& v) { return slid(contact, v); }, py::arg("contact"),
      py::arg("v"), doc("slid"));
}

void bind_records(py::module_& m) {
  py::class_<TraceLists>(m, "SurfaceTrace", doc("SurfaceTrace"))
      .def(py::init<>())
      .def_property_readonly(
          "contacts", [](const TraceLists& t) { return t.contacts; }, "The contacts so far, as a fresh list.")
      .def_property_readonly(
          "crossings", [](const TraceLists& t) { return t.crossings; }, "The crossings so far, as a fresh list.");
  py::class_<ReportArrays>(m, "SurfaceReport", doc("SurfaceReport"))
      .def_property_readonly(
          "steps", [](const ReportArrays& r) { return r.steps; },
          "One row per particle: a structured array with the fields of SurfaceStep.")
      .def_property_readonly(
          "contacts", [](const ReportArrays& r) { return r.contacts; },
          "By particle, then by time: a structured array with the fields of SurfaceContact; its dart is dart_cell and "
          "dart.");
}

}  // namespace

void bind(py::module_& m) {
  bind_records(m);
  bind_contacts(m);
  const std::string answers =
      "\n\nrespond: a function that gets a SurfaceContact. It returns the displacement for the rest of the step (three "
      "numbers, or an AfterSurfaceContact), or None: the particle then stays at the wall. An exception that it raises "
      "comes out of this call.";
  const std::string one = doc("step") + answers + " trace: a SurfaceTrace, to which the step adds.";
  m.def("step", &step_one, py::arg("surface"), py::arg("place"), py::arg("displacement"),
        py::arg("respond") = py::none(), py::arg("options") = SurfaceOptions{}, py::arg("trace") = nullptr,
        py::arg("particle") = 0, one.c_str());
  m.def("tangent", &tangent_of, about("tangent"));
  const std::string many =
      doc("advance") + answers + "\n\nplaces: an array of places (surface_places()), changed in place.";
  m.def("advance", &advance_many, py::arg("surface"), py::arg("places"), py::arg("displacements"),
        py::arg("respond") = py::none(), py::arg("options") = SurfaceOptions{}, py::arg("threads") = Threads{},
        many.c_str());
}

}  // namespace dartcast::python::surface_steps
