// Binds dartcast/cutting.hpp.
#include "dartcast/cutting.hpp"

#include "bind.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::cutting {
namespace {

using Cells = std::vector<Cell>;
using Tools = std::vector<ConvexTool>;

void expect_tools(const Tools& tools) {
  for (const ConvexTool& tool : tools) {
    for (const Plane& plane : tool.planes) expect_plane(plane);
  }
}

void bind_planes() {
  class_of<Plane>()
      .def(
          "height", [](const Plane& plane, const Typed<"Vector or Points">& x) -> Typed<"float or Floats"> {
            if (!is_array(x, 2)) return py::float_(plane.height(vector(x, "x")));
            std::vector<double> heights;
            for (const Vec3& p : vectors(x, "x")) heights.push_back(plane.height(p));
            return array_of(std::move(heights));
          },
          py::arg("x"), "The distance of a point from the plane, positive above. Of an array (n, 3): float64 (n,).")
      .def("turned", &Plane::turned, "The plane with the other side up.");
}

void bind_tools(py::module_& m) {
  m.def("thicken", static_cast<Tools (*)(const Plane&, double)>(&thicken), py::arg("plane"), py::arg("width"),
        doc("thicken"));
  m.def("thicken", static_cast<Tools (*)(const Disc&, double)>(&thicken), py::arg("disc"), py::arg("width"));
  m.def("thicken", static_cast<Tools (*)(const BladePath&, double)>(&thicken), py::arg("path"), py::arg("width"));
  m.def(
      "cells_near",
      [](const ComplexHandle& h, const Tools& tools, std::optional<Cell> start) {
        expect_tools(tools);
        return read_long(h, [&](const CellComplex& complex) {
          return start ? cells_near(complex, tools, *start) : cells_near(complex, tools);
        });
      },
      py::arg("complex"), py::arg("tools"), py::arg("start") = py::none(), doc("cells_near"));
}

// `where`: the cell to start from, or a place.
Cells tie(const EditHandle& h, const Plane& given, const Typed<"Cell | Vector">& where) {
  const Plane plane = given;
  expect_plane(plane);
  if (PyIndex_Check(where.ptr()) != 0 && !py::isinstance<py::array>(where)) {
    const auto start = where.cast<Cell>();
    return change(h, [&](ComplexEdit& e) { return ligature(e, plane, start); });
  }
  const Vec3 place = vector(where, "place");
  if (!is_finite(place)) throw InvalidArgument("place: it must be finite");
  return change(h, [&](ComplexEdit& e) { return ligature(e, plane, place); });
}

void bind_tying(py::module_& m) {
  m.def("ligature", &tie, py::arg("edit"), py::arg("plane"), py::arg("start"),
        about("ligature", "start: a cell, or three numbers: the place."));
  m.def(
      "draw_together",
      [](const ComplexHandle& h, const Cells& section, const Plane& plane, const TyingOptions& options,
         const Typed<"Points">& positions) {
        expect_plane(plane);
        const auto given = vectors(positions, "positions");
        std::vector<Vec3> moved(given.begin(), given.end());
        read(h, [&](const CellComplex& complex) { draw_together(complex, section, plane, options, moved); });
        return moved;
      },
      about("draw_together", "Returns the changed positions; the given ones stay as they are."));
}

void bind_joining(py::module_& m) { function(m, "reconnect", &reconnect); }

}  // namespace

void bind(py::module_& m) {
  bind_planes();
  bind_tools(m);
  static constexpr std::array<Argument, 5> names = {
      {{"edit"}, {"cells"}, {"surface"}, {"width"}, {"options", [] { return py::cast(CarveOptions()); }}}};
  const auto bind_cut = [&]<class Surface>(Carved (*make)(ComplexEdit&, std::span<const Cell>, const Surface&, double,
                                                          const CarveOptions&)) {
    function(m, "cut", make, {doc("cut"), names});
  };
  bind_cut.operator()<Plane>(&cut);
  bind_cut.operator()<Disc>(&cut);
  bind_cut.operator()<BladePath>(&cut);
  bind_tying(m);
  bind_joining(m);
}

}  // namespace dartcast::python::cutting
