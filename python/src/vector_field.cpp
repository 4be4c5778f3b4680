// Binds dartcast/vector_field.hpp. Samples may be arrays, or a function of Python that reads them.
#include "dartcast/vector_field.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "bind.hpp"
#include "motion_handles.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

constexpr const char* the_field = "the VectorField";
using Class = py::class_<FieldHandle, std::shared_ptr<FieldHandle>>;

std::shared_ptr<FieldHandle> from_values(const ComplexHandle& complex, const py::object& values, FieldFrame frame) {
  const auto given = vectors(values, "values");
  const Use use(*complex.usage, "the complex");
  return std::make_shared<FieldHandle>(FieldHandle{VectorField(*complex.complex, given, frame), complex.complex});
}

std::shared_ptr<FieldHandle> from_samples(const ComplexHandle& complex, const FieldSamples& samples, FieldFrame frame) {
  const Use use(*complex.usage, "the complex");
  const py::gil_scoped_release release;
  return std::make_shared<FieldHandle>(FieldHandle{VectorField(*complex.complex, samples, frame), complex.complex});
}

void require_complex(const FieldHandle& field, const ComplexHandle& complex) {
  if (field.complex != complex.complex) throw InvalidArgument("the field was made for another complex");
}

void set_times(FieldHandle& h, const std::vector<double>& times, const ComplexHandle& complex, Threads threads) {
  if (times.empty()) throw InvalidArgument("set_times: at least one time is needed");
  require_complex(h, complex);
  const Use use(*h.usage, the_field);
  const Use other(*complex.usage, "the complex");
  const py::gil_scoped_release release;
  h.field.set_times(times, *complex.complex, threads);
  h.moments = times.size();
}

// Throws where the field has no value in the simplex, or stands at no such time.
void require_value(const FieldHandle& h, const CellComplex& complex, SimplexId simplex, std::size_t moment) {
  const CombinatorialMap& map = complex.map();
  if (!map.contains(simplex.cell) || simplex.simplex >= map.shape(simplex.cell).simplices().size())
    throw InvalidArgument("at: there is no such simplex");
  if (moment >= h.moments && !(h.field.steady() && h.moments > 0))
    throw InvalidArgument("at: moment " + std::to_string(moment) + ", but " + std::to_string(h.moments) +
                          " times are set: call set_times() first");
  const auto vertices = complex.vertices(simplex);
  const auto known = [&](std::size_t size) {
    return std::all_of(vertices.begin(), vertices.end(), [&](Vertex v) { return v.value < size; });
  };
  const bool at_points = h.field.place() == FieldPlace::points;
  if ((at_points && !known(h.field.values().size())) ||
      (h.field.frame() == FieldFrame::mesh && !known(h.field.rest().size())))
    throw InvalidArgument("at: the field has missed an edit: call update_after_edit() after each");
}

Vec3 at(FieldHandle& h, const ComplexHandle& complex, SimplexId simplex, const std::array<double, 4>& w,
        const std::array<Vec3, 4>& now, std::size_t moment) {
  require_complex(h, complex);
  const Use use(*h.usage, the_field);
  const Use other(*complex.usage, "the complex");
  require_value(h, *complex.complex, simplex, moment);
  return h.field.at(*complex.complex, simplex, w, now, moment);
}

void update_after_edit(FieldHandle& h, const ComplexEditReport& edit, const ComplexHandle& complex) {
  require_complex(h, complex);
  const Use use(*h.usage, the_field);
  const Use other(*complex.usage, "the complex");
  require_edit(edit, complex.complex->positions().size());
  h.field.update_after_edit(edit, *complex.complex);
  if (!h.field.steady()) h.moments = 0;
}

void add_queries(Class& c) {
  c.def_property_readonly(
      "frame", [](const FieldHandle& h) { return h.field.frame(); }, "A FieldFrame.");
  c.def_property_readonly(
      "place", [](const FieldHandle& h) { return h.field.place(); }, "A FieldPlace.");
  c.def_property_readonly(
      "steady", [](const FieldHandle& h) { return h.field.steady(); }, "Whether it has one sample.");
  c.def_property_readonly(
      "values",
      [](const FieldHandle& h) {
        const Use use(*h.usage, the_field);
        if (h.moments == 0) throw InvalidArgument("values: no times are set after an edit: call set_times() first");
        return read_only(array_of(h.field.values()));
      },
      doc("VectorField::values"));
  c.def_property_readonly(
      "rest",
      [](const FieldHandle& h) {
        const Use use(*h.usage, the_field);
        return read_only(array_of(h.field.rest()));
      },
      doc("VectorField::rest"));
}

}  // namespace

void bind_vector_field(py::module_& m) {
  bind_enum<FieldFrame>(m, "FieldFrame", {{"SPACE", FieldFrame::space}, {"MESH", FieldFrame::mesh}});
  bind_enum<FieldPlace>(m, "FieldPlace", {{"POINTS", FieldPlace::points}, {"CELLS", FieldPlace::cells}});
  Record<FieldSamples>(m, "FieldSamples")
      .field("name", &FieldSamples::name)
      .field("place", &FieldSamples::place)
      .field("times", &FieldSamples::times)
      .field("read", &FieldSamples::read)
      .field("period", &FieldSamples::period)
      .finish();
  m.def("field_samples", &field_samples, py::arg("times"), py::arg("values"), py::arg("place") = FieldPlace::points,
        py::arg("period") = 0.0, (std::string(doc("field_samples")) + "\n\nvalues: a list of float64 (n, 3).").c_str());
  Class c(m, "VectorField", doc("VectorField"));
  c.def(py::init(&from_samples), py::arg("complex"), py::arg("samples"), py::arg("frame") = FieldFrame::space,
        doc("VectorField::VectorField"));
  c.def(py::init(&from_values), py::arg("complex"), py::arg("values"), py::arg("frame") = FieldFrame::space,
        "A steady field at the points: float64 (n, 3).");
  add_queries(c);
  c.def(
      "hold",
      [](FieldHandle& h, double begin, double end) {
        const Use use(*h.usage, the_field);
        const py::gil_scoped_release release;
        h.field.hold(begin, end);
      },
      py::arg("begin"), py::arg("end"), doc("VectorField::hold"));
  c.def("set_times", &set_times, py::arg("times"), py::arg("complex"), py::arg("threads") = 0,
        doc("VectorField::set_times"));
  c.def("update_after_edit", &update_after_edit, py::arg("edit"), py::arg("complex"),
        doc("VectorField::update_after_edit"));
  c.def("at", &at, py::arg("complex"), py::arg("simplex"), py::arg("w"), py::arg("now"), py::arg("moment") = 0,
        doc("VectorField::at"));
  m.attr("VelocityField") = m.attr("VectorField");
}

}  // namespace dartcast::python
