// Binds dartcast/cutting.hpp.
#include "dartcast/cutting.hpp"

#include "bind.hpp"
#include "support/edits.hpp"
#include "support/map_checks.hpp"
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

void bind_planes(py::module_& m) {
  Record<Plane>(m, "Plane")
      .field("normal", &Plane::normal)
      .field("offset", &Plane::offset)
      .finish()
      .def(
          "height",
          [](const Plane& plane, const py::object& x) -> py::object {
            if (!py::isinstance<py::array>(x) || py::reinterpret_borrow<py::array>(x).ndim() != 2)
              return py::float_(plane.height(vector(x, "x")));
            std::vector<double> heights;
            for (const Vec3& p : vectors(x, "x")) heights.push_back(plane.height(p));
            return array_of(std::move(heights));
          },
          py::arg("x"), "The distance of a point from the plane, positive above. Of an array (n, 3): float64 (n,).")
      .def("turned", &Plane::turned, "The plane with the other side up.");
  m.def("plane_through", &plane_through, py::arg("point"), py::arg("normal"), doc("plane_through"));
  Record<SectionOptions>(m, "SectionOptions")
      .field("snap", &SectionOptions::snap)
      .field("finest", &SectionOptions::finest)
      .finish()
      .attr("MIN_SNAP") = SectionOptions::min_snap;
  Record<Section>(m, "Section")
      .field("below", &Section::below)
      .field("above", &Section::above)
      .field("whole", &Section::whole)
      .finish();
  m.def(
      "split_by_plane",
      [](const EditHandle& h, const Cells& cells, const Plane& given, const SectionOptions& options) {
        const Plane plane = given;
        expect_plane(plane);
        return change(h, [&, own = options](ComplexEdit& e) { return split_by_plane(e, cells, plane, own); });
      },
      py::arg("edit"), py::arg("cells"), py::arg("plane"), py::arg("options") = SectionOptions{},
      doc("split_by_plane"));
}

void bind_tools(py::module_& m) {
  Record<ConvexTool>(m, "ConvexTool")
      .field("planes", &ConvexTool::planes)
      .field("finest", &ConvexTool::finest)
      .finish();
  Record<Disc>(m, "Disc")
      .field("centre", &Disc::centre)
      .field("normal", &Disc::normal)
      .field("radius", &Disc::radius)
      .field("sides", &Disc::sides)
      .finish();
  Record<BladePath>(m, "BladePath").field("places", &BladePath::places).finish();
  m.def("thicken", static_cast<Tools (*)(const Plane&, double)>(&thicken), py::arg("plane"), py::arg("width"),
        doc("thicken"));
  m.def("thicken", static_cast<Tools (*)(const Disc&, double)>(&thicken), py::arg("disc"), py::arg("width"));
  m.def("thicken", static_cast<Tools (*)(const BladePath&, double)>(&thicken), py::arg("path"), py::arg("width"));
  m.def("box_tool", &box_tool, py::arg("low"), py::arg("high"), doc("box_tool"));
  m.def("capsule_tool", &capsule_tool, py::arg("a"), py::arg("b"), py::arg("radius"), doc("capsule_tool"));
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

template <class Surface>
void bind_cut(py::module_& m, const char* text) {
  m.def(
      "cut",
      [](const EditHandle& h, const Cells& cells, const Surface& given, double width, const CarveOptions& options) {
        return change(
            h, [&, surface = given, own = options](ComplexEdit& e) { return cut(e, cells, surface, width, own); });
      },
      py::arg("edit"), py::arg("cells"), py::arg("surface"), py::arg("width"), py::arg("options") = CarveOptions{},
      text);
}

void bind_carving(py::module_& m) {
  bind_enum<Carving>(m, "Carving", {{"OPEN", Carving::open}, {"REMOVE", Carving::remove}});
  Record<CarveOptions>(m, "CarveOptions")
      .field("whole_cells", &CarveOptions::whole_cells)
      .field("snap", &CarveOptions::snap)
      .finish();
  Record<Carved>(m, "Carved")
      .field("opened", &Carved::opened)
      .field("removed", &Carved::removed)
      .field("whole", &Carved::whole)
      .finish();
  m.def(
      "carve",
      [](const EditHandle& h, const Cells& cells, const Tools& tools, Carving what, const CarveOptions& options) {
        expect_tools(tools);
        return change(h, [&, own = options](ComplexEdit& e) { return carve(e, cells, tools, what, own); });
      },
      py::arg("edit"), py::arg("cells"), py::arg("tools"), py::arg("what"), py::arg("options") = CarveOptions{},
      doc("carve"));
  bind_cut<Plane>(m, doc("cut"));
  bind_cut<Disc>(m, "");
  bind_cut<BladePath>(m, "");
  m.def(
      "open_faces",
      [](const EditHandle& h, const Cells& cells, const Plane& given, double within) {
        const Plane plane = given;
        expect_plane(plane);
        return change(h, [&](ComplexEdit& e) { return open_faces(e, cells, plane, within); });
      },
      py::arg("edit"), py::arg("cells"), py::arg("plane"), py::arg("within"), doc("open_faces"));
}

// `where`: the cell to start from, or a place.
Cells tie(const EditHandle& h, const Plane& given, const py::object& where) {
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
        (std::string(doc("ligature")) + "\n\nstart: a cell, or three numbers: the place.").c_str());
  Record<TyingOptions>(m, "TyingOptions")
      .field("share", &TyingOptions::share)
      .field("reach", &TyingOptions::reach)
      .finish();
  m.def(
      "draw_together",
      [](const ComplexHandle& h, const Cells& section, const Plane& plane, const TyingOptions& options,
         const py::object& positions) {
        expect_plane(plane);
        const auto given = vectors(positions, "positions");
        std::vector<Vec3> moved(given.begin(), given.end());
        read(h, [&](const CellComplex& complex) { draw_together(complex, section, plane, options, moved); });
        return moved;
      },
      py::arg("complex"), py::arg("section"), py::arg("plane"), py::arg("options"), py::arg("positions"),
      (std::string(doc("draw_together")) + "\n\nReturns the changed positions; the given ones stay as they are.")
          .c_str());
}

void bind_joining(py::module_& m) {
  Record<ReconnectOptions>(m, "ReconnectOptions")
      .field("tolerance", &ReconnectOptions::tolerance)
      .field("side", &ReconnectOptions::side)
      .finish();
  bind_enum<Reconnection>(
      m, "Reconnection",
      {{"SEWN", Reconnection::sewn}, {"PAIRED", Reconnection::paired}, {"BRIDGED", Reconnection::bridged}});
  Record<Reconnected>(m, "Reconnected")
      .field("how", &Reconnected::how)
      .field("cells", &Reconnected::cells)
      .field("shift", &Reconnected::shift)
      .finish();
  m.def(
      "reconnect",
      [](const EditHandle& h, const std::vector<CellFace>& a, const std::vector<CellFace>& b,
         const ReconnectOptions& options) {
        return change(h, [&, own = options](ComplexEdit& e) { return reconnect(e, a, b, own); });
      },
      py::arg("edit"), py::arg("a"), py::arg("b"), py::arg("options") = ReconnectOptions{}, doc("reconnect"));
}

}  // namespace

void bind(py::module_& m) {
  bind_planes(m);
  bind_tools(m);
  bind_carving(m);
  bind_tying(m);
  bind_joining(m);
}

}  // namespace dartcast::python::cutting
