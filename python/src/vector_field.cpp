// Binds dartcast/vector_field.hpp. A field keeps the complex that it was made for, and is used with that one alone.
#include "dartcast/vector_field.hpp"

#include <algorithm>
#include <cmath>

#include "bind.hpp"
#include "support/edit_reports.hpp"
#include "support/members.hpp"
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

void bind_samples(py::module_& m) { m.def("field_samples", &field_samples, about("field_samples")); }

void bind_members(py::class_<FieldHandle, FieldPointer>& c) {
  property(c, "frame", &VectorField::frame, doc("FieldFrame"));
  property(c, "place", &VectorField::place, doc("FieldPlace"));
  members_of_VectorField(c);
  property(
      c, "values", +[](const VectorField& field) { return field.values(); }, doc("VectorField::values"));
}

}  // namespace

void bind(py::module_& m) {
  bind_samples(m);
  py::class_<FieldHandle, FieldPointer> c(m, "VectorField", "A field of vectors at the points or cells of a mesh.");
  c.def(py::init(&make<FieldSamples>), py::arg("complex").none(false), py::arg("samples"),
        py::arg("frame") = FieldFrame::space, doc("VectorField::VectorField"));
  c.def(py::init([](const ComplexPointer& complex, const Typed<"Points">& values, FieldFrame frame) {
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
      about("VectorField::hold"));
  c.def("set_times", &set_times, about("VectorField::set_times"));
  c.def("update_after_edit", &update_after_edit, about("VectorField::update_after_edit"));
  c.def("at", &value_at, about("VectorField::at"));
  m.attr("VelocityField") = m.attr("VectorField");
}

}  // namespace dartcast::python::vector_field
