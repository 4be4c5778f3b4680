// Steps of particles on a surface: contacts, responses, one particle and many.
#include <algorithm>
#include <string>
#include <utility>

#include "surface_places.hpp"

namespace py = pybind11;

namespace dartcast::python::surface_steps {
namespace {

// Rows of the arrays of many steps and contacts.
// NOLINTBEGIN(modernize-avoid-c-arrays): entries of arrays of NumPy
struct StepRow {
  std::uint8_t end;
  std::uint32_t contacts;
  std::uint32_t crossings;
  double length;
  double direction[3];
  double remaining[3];
};
struct ContactRow {
  std::uint32_t particle;
  std::uint8_t kind;
  std::uint32_t dart_cell;
  std::uint16_t dart;
  std::uint16_t patch;
  double time_of_impact;
  PlaceRow place;
  double point[3];
  double normal[3];
  double sides[2][3];
  double displacement[3];
  double unused[3];
};
// NOLINTEND(modernize-avoid-c-arrays)

void put(double* out, const Vec3& v) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

StepRow row_of(const SurfaceStep& s) {
  StepRow row{};
  row.end = static_cast<std::uint8_t>(s.end);
  row.contacts = s.contacts;
  row.crossings = s.crossings;
  row.length = s.length;
  put(row.direction, s.direction);
  put(row.remaining, s.remaining);
  return row;
}

ContactRow row_of(const SurfaceContact& c) {
  ContactRow row{};
  row.particle = c.particle;
  row.kind = static_cast<std::uint8_t>(c.kind);
  row.dart_cell = c.dart.cell.value;
  row.dart = c.dart.number;
  row.patch = c.patch.value;
  row.time_of_impact = c.time_of_impact;
  row.place = python::row_of(c.place);
  put(row.point, c.point);
  put(row.normal, c.normal);
  put(row.sides[0], c.sides[0]);
  put(row.sides[1], c.sides[1]);
  put(row.displacement, c.displacement);
  put(row.unused, c.unused);
  return row;
}

template <class Row, class T>
py::array rows_of(const std::vector<T>& all) {
  std::vector<Row> rows;
  rows.reserve(all.size());
  for (const T& one : all) rows.push_back(row_of(one));
  return array_of(std::move(rows));
}

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
SurfaceStep step_one(SurfaceHandle& surface, SurfacePlace& place, const Vec3& displacement, const py::object& respond,
                     const SurfaceOptions& options, TraceLists* trace, std::uint32_t particle) {
  const SurfaceUse use(surface);
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

ReportArrays advance_many(SurfaceHandle& surface, const py::object& places, const py::object& displacements,
                          const py::object& respond, const SurfaceOptions& options, Threads threads) {
  const SurfaceUse use(surface);
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
  std::transform(moved.begin(), moved.end(), rows.begin(), [](const SurfacePlace& p) { return python::row_of(p); });
  return {rows_of<StepRow>(report.steps), rows_of<ContactRow>(report.contacts)};
}

py::array_t<double> tangent_of(SurfaceHandle& surface, SimplexId triangle, unsigned corner, double angle,
                               double length) {
  const SurfaceUse use(surface);
  return array_of(tangent(surface.surface, triangle, corner, angle, length));
}

void bind_contacts(py::module_& m) {
  Record<SurfaceContact>(m, "SurfaceContact")
      .field("particle", &SurfaceContact::particle)
      .field("kind", &SurfaceContact::kind)
      .field("dart", &SurfaceContact::dart)
      .field("patch", &SurfaceContact::patch)
      .field("time_of_impact", &SurfaceContact::time_of_impact)
      .field("place", &SurfaceContact::place)
      .field("point", &SurfaceContact::point)
      .field("normal", &SurfaceContact::normal)
      .field("sides", &SurfaceContact::sides)
      .field("displacement", &SurfaceContact::displacement)
      .field("unused", &SurfaceContact::unused)
      .finish();
  Record<AfterSurfaceContact>(m, "AfterSurfaceContact")
      .field("displacement", &AfterSurfaceContact::displacement)
      .field("along", &AfterSurfaceContact::along)
      .finish();
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
  bind_enum<SurfaceEnd>(m, "SurfaceEnd",
                        {{"ARRIVED", SurfaceEnd::arrived},
                         {"STOPPED", SurfaceEnd::stopped},
                         {"LIMIT", SurfaceEnd::limit},
                         {"HELD", SurfaceEnd::held}});
  Record<SurfaceOptions>(m, "SurfaceOptions")
      .field("max_contacts", &SurfaceOptions::max_contacts)
      .field("max_crossings", &SurfaceOptions::max_crossings)
      .finish();
  Record<SurfaceStep>(m, "SurfaceStep")
      .field("end", &SurfaceStep::end)
      .field("contacts", &SurfaceStep::contacts)
      .field("crossings", &SurfaceStep::crossings)
      .field("length", &SurfaceStep::length)
      .field("direction", &SurfaceStep::direction)
      .field("remaining", &SurfaceStep::remaining)
      .finish();
  Record<SurfaceCrossing>(m, "SurfaceCrossing")
      .field("time", &SurfaceCrossing::time)
      .field("point", &SurfaceCrossing::point)
      .field("kind", &SurfaceCrossing::kind)
      .field("dart", &SurfaceCrossing::dart)
      .field("place", &SurfaceCrossing::place)
      .finish();
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
  PYBIND11_NUMPY_DTYPE(StepRow, end, contacts, crossings, length, direction, remaining);
  PYBIND11_NUMPY_DTYPE(ContactRow, particle, kind, dart_cell, dart, patch, time_of_impact, place, point, normal, sides,
                       displacement, unused);
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
  m.def("tangent", &tangent_of, py::arg("surface"), py::arg("triangle"), py::arg("corner"), py::arg("angle"),
        py::arg("length") = 1.0, doc("tangent"));
  const std::string many =
      doc("advance") + answers + "\n\nplaces: an array of places (surface_places()), changed in place.";
  m.def("advance", &advance_many, py::arg("surface"), py::arg("places"), py::arg("displacements"),
        py::arg("respond") = py::none(), py::arg("options") = SurfaceOptions{}, py::arg("threads") = Threads{},
        many.c_str());
}

}  // namespace dartcast::python::surface_steps
