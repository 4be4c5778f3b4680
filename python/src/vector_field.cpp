// Binds dartcast/vector_field.hpp. A field keeps the complex that it was made for, and is used with that one alone.
#include "dartcast/vector_field.hpp"

#include <algorithm>
#include <cmath>

#include "bind.hpp"
#include "support/edit_reports.hpp"
#include "support/map_checks.hpp"
#include "support/motions.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::vector_field {
namespace {

constexpr const char* the_field = "the field";

void expect_same(const FieldHandle& h, const ComplexHandle& complex) {
  if (h.complex->complex != complex.complex)
    throw InvalidArgument("complex: the field was made for another one: give that, or make a field for this one");
}

void expect_followed(const FieldHandle& h) {
  if (h.complex->complex->positions().size() > h.vertices)
    throw InvalidArgument("the field has missed an edit: call update_after_edit() of the field first");
}

void expect_times(std::span<const double> times) {
  const auto finite = [](double t) { return std::isfinite(t); };
  if (times.empty() || !std::all_of(times.begin(), times.end(), finite))
    throw InvalidArgument("times: at least one is needed, and all must be finite");
}

// Calls f(complex) without Python's lock, while nothing else uses the field and its complex.
template <class Function>
auto with_complex(const FieldHandle& h, const ComplexHandle& complex, const Function& f) {
  expect_same(h, complex);
  const Use use(h.usage, the_field);
  return read_long(complex, f);
}

template <class Values>
FieldPointer make(const ComplexPointer& complex, const Values& values, FieldFrame frame) {
  return read_long(*complex, [&](const CellComplex& c) {
    return FieldPointer(new FieldHandle{complex, VectorField(c, values, frame), 1, c.positions().size()});
  });
}

Vec3 value_at(const FieldHandle& h, const ComplexHandle& complex, SimplexId simplex, const std::array<double, 4>& w,
              const Corners& now, std::size_t moment) {
  return with_complex(h, complex, [&](const CellComplex& c) {
    expect_simplex(c.map(), simplex);
    expect_followed(h);
    if (moment >= h.moments)
      throw InvalidArgument("moment: " + std::to_string(h.moments) + " times are set; call set_times()");
    return h.field.at(c, simplex, w, now, moment);
  });
}

void set_times(FieldHandle& h, const std::vector<double>& times, const ComplexHandle& complex, Threads threads) {
  check_threads(threads);
  expect_times(times);
  with_complex(h, complex, [&](const CellComplex& c) {
    expect_followed(h);
    if (h.field.steady()) return;
    h.moments = 0;  // where a sample cannot be read
    h.field.set_times(times, c, threads);
    h.moments = times.size();
  });
}

void update_after_edit(FieldHandle& h, const ComplexEditReport& edit, const ComplexHandle& complex) {
  with_complex(h, complex, [&](const CellComplex& c) {
    expect_report(edit, c.positions().size());
    h.field.update_after_edit(edit, c);
    h.vertices = c.positions().size();
    if (!h.field.steady() && h.field.place() == FieldPlace::points) h.moments = 0;
  });
}

void bind_samples(py::module_& m) {
  bind_enum<FieldFrame>(m, "FieldFrame", {{"SPACE", FieldFrame::space}, {"MESH", FieldFrame::mesh}});
  bind_enum<Interpolation>(m, "Interpolation", {{"LINEAR", Interpolation::linear}, {"CUBIC", Interpolation::cubic}});
  bind_enum<FieldPlace>(m, "FieldPlace", {{"POINTS", FieldPlace::points}, {"CELLS", FieldPlace::cells}});
  Record<FieldSamples>(m, "FieldSamples")
      .field("name", &FieldSamples::name)
      .field("place", &FieldSamples::place)
      .field("times", &FieldSamples::times)
      .field("read", &FieldSamples::read)
      .field("period", &FieldSamples::period)
      .field("interpolation", &FieldSamples::interpolation)
      .finish();
  m.def("field_samples", &field_samples, py::arg("times"), py::arg("values"), py::arg("place") = FieldPlace::points,
        py::arg("period") = 0.0, doc("field_samples"));
}

void bind_members(py::class_<FieldHandle, FieldPointer>& c) {
  const auto member = [&](const char* name, const char* text, auto get) {
    c.def_property_readonly(
        name,
        [get](const FieldHandle& h) {
          const Use use(h.usage, the_field);
          return without_writing(py::cast(get(h.field)));
        },
        text);
  };
  member("frame", doc("FieldFrame"), [](const VectorField& f) { return f.frame(); });
  member("place", doc("FieldPlace"), [](const VectorField& f) { return f.place(); });
  member("steady", "Whether it has one sample.", [](const VectorField& f) { return f.steady(); });
  member("values", doc("VectorField::values"), [](const VectorField& f) { return f.values(); });
  member("rest", doc("VectorField::rest"), [](const VectorField& f) { return f.rest(); });
}

}  // namespace

void bind(py::module_& m) {
  bind_samples(m);
  py::class_<FieldHandle, FieldPointer> c(m, "VectorField", "A field of vectors at the points or cells of a mesh.");
  c.def(py::init(&make<FieldSamples>), py::arg("complex").none(false), py::arg("samples"),
        py::arg("frame") = FieldFrame::space, doc("VectorField::VectorField"));
  c.def(py::init([](const ComplexPointer& complex, const py::object& values, FieldFrame frame) {
          return make(complex, vectors(values, "values"), frame);
        }),
        py::arg("complex").none(false), py::arg("values"), py::arg("frame") = FieldFrame::space,
        "A steady field: one vector for each point of the mesh, float64 (n, 3).");
  bind_members(c);
  c.def(
      "hold",
      [](FieldHandle& h, double begin, double end) {
        expect_times(std::array{begin, end});
        const Use use(h.usage, the_field);
        const py::gil_scoped_release release;
        h.field.hold(begin, end);
      },
      py::arg("begin"), py::arg("end"), doc("VectorField::hold"));
  c.def("set_times", &set_times, py::arg("times"), py::arg("complex"), py::arg("threads") = Threads{},
        doc("VectorField::set_times"));
  c.def("update_after_edit", &update_after_edit, py::arg("edit"), py::arg("complex"),
        doc("VectorField::update_after_edit"));
  c.def("at", &value_at, py::arg("complex"), py::arg("simplex"), py::arg("w"), py::arg("now"), py::arg("moment") = 0,
        doc("VectorField::at"));
  m.attr("VelocityField") = m.attr("VectorField");
}

}  // namespace dartcast::python::vector_field
