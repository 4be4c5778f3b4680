// Binds dartcast/cell_shape.hpp. A shape in Python is a copy of that of the cell.
#include "dartcast/cell_shape.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::cell_shape {
namespace {

using Class = py::class_<Shape, std::shared_ptr<Shape>>;
using Number = std::uint16_t;

void expect_dart_of(const Shape& s, Number dart) { expect_number(dart, s.dart_count(), "dart"); }
void expect_face_of(const Shape& s, Number face) { expect_number(face, s.face_count(), "face"); }
void expect_triangle(const Shape& s, Number face, Number t) {
  expect_face_of(s, face);
  expect_number(t, s.triangle_count(face), "triangle of the face");
}

template <class Function>
auto of_dart(const Function& f) {
  return [f](const Shape& s, Number dart) {
    expect_dart_of(s, dart);
    return (s.*f)(dart);
  };
}
template <class Function>
auto of_face(const Function& f) {
  return [f](const Shape& s, Number face) {
    expect_face_of(s, face);
    return (s.*f)(face);
  };
}

Shape::Feature feature(const Shape& s, const std::vector<Number>& points) {
  if (points.empty() || points.size() > 4) throw InvalidArgument("points: expected 1 to 4 of one simplex");
  for (const Number p : points) expect_number(p, s.point_count(), "point");
  return s.feature(points);
}

void bind_sizes(Class& c) {
  c.def_property_readonly("dimension", &Shape::dimension, doc("Shape::dimension"));
  c.def_property_readonly("corner_count", &Shape::corner_count, "Number of corners.");
  c.def_property_readonly("point_count", &Shape::point_count, doc("Shape::point_count"));
  c.def_property_readonly("face_count", &Shape::face_count, "Number of faces.");
  c.def_property_readonly("dart_count", &Shape::dart_count, "Number of darts.");
  c.def_property_readonly(
      "key", [](const Shape& s) { return s.key(); }, "The ShapeKey: a copy.");
  c.def_property_readonly("bytes", &Shape::bytes, "Size in memory.");
  c.def_property_readonly(
      "simplices",
      [](const Shape& s) { return read_only<py::array>(array_of(std::span<const ImplicitSimplex>(s.simplices()))); },
      "The implicit simplices: a structured array with `vertex` (4), the local numbers of the corners, and `across` "
      "(4): what is beyond the facet opposite to each. `index` is a simplex, or 0x8000 + a face; `place` is a facet of "
      "that simplex, or a triangle of the face's fan.");
}

void bind_darts(Class& c) {
  c.def("origin", of_dart(&Shape::origin), py::arg("dart"), "The corner that the dart starts from.");
  c.def("face_of", of_dart(&Shape::face_of), py::arg("dart"), "The face of the dart.");
  c.def("phi1", of_dart(&Shape::phi1), py::arg("dart"), "The next dart of the face.");
  c.def("phi_1", of_dart(&Shape::phi_1), py::arg("dart"), "The dart before it in the face.");
  c.def(
      "phi2",
      [](const Shape& s, Number dart) {
        if (s.dimension() == 2) throw InvalidArgument("phi2 leads out of a polygon: ask the map");
        expect_dart_of(s, dart);
        return s.phi2(dart);
      },
      py::arg("dart"),
      "The same edge of the other face of the cell. Raises InvalidArgument where the cell is a polygon.");
  c.def("first_dart", of_face(&Shape::first_dart), py::arg("face"), "The first dart of a face.");
  c.def("degree", of_face(&Shape::degree), py::arg("face"), "The number of darts of a face.");
  c.def(
      "corners",
      [](const Shape& s, Number face) {
        expect_face_of(s, face);
        return array_of(s.corners(face));
      },
      py::arg("face"), "The local numbers of a face's corners: uint16 (n,).");
}

void bind_fans(Class& c) {
  c.def("triangle_count", of_face(&Shape::triangle_count), about("Shape::triangle_count"));
  c.def(
      "triangle",
      [](const Shape& s, Number face, Number t) {
        expect_triangle(s, face, t);
        return s.triangle(face, t);
      },
      about("Shape::triangle"));
  c.def(
      "triangle_from_other_side",
      [](const Shape& s, Number face, Number t) {
        expect_triangle(s, face, t);
        return s.triangle_from_other_side(face, t);
      },
      about("Shape::triangle_from_other_side"));
  c.def(
      "entry",
      [](const Shape& s, Number face, Number t) {
        expect_triangle(s, face, t);
        return s.entry(face, t);
      },
      about("Shape::entry"));
  c.def("face_of_point", &Shape::face_of_point, about("Shape::face_of_point"));
  c.def("feature", &feature, about("Shape::feature"));
}

}  // namespace

void bind(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(Across, index, place);
  PYBIND11_NUMPY_DTYPE(ImplicitSimplex, vertex, across);
  Class c(m, "Shape", doc("Shape"));
  c.def(py::init<ShapeKey>(), about("Shape::Shape"));
  bind_sizes(c);
  bind_darts(c);
  bind_fans(c);
}

}  // namespace dartcast::python::cell_shape
