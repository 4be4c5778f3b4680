// Binds dartcast/remeshing.hpp.
#include "dartcast/remeshing.hpp"

#include "bind.hpp"
#include "support/edits.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::remeshing {
namespace {

/// A subdivision, and the map that it is of. Only subdivide() makes one, so that its vertices are what they say.
struct SubdivisionHandle {
  Subdivision subdivision;
  const CombinatorialMap* map = nullptr;  // to compare only

  void expect_of(const CombinatorialMap& other) const {
    if (map != &other) throw InvalidArgument("subdivision: it is of another complex");
  }
};

struct SubdividedHandle {
  SubdivisionHandle subdivision;
  std::vector<Cell> cells;
};

void bind_subdivision(py::module_& m) {
  const auto list = [](std::vector<Vertex> Subdivision::*member) {
    return [member](const SubdivisionHandle& h) { return without_writing(py::cast(h.subdivision.*member)); };
  };
  py::class_<SubdivisionHandle>(m, "Subdivision", doc("Subdivision"))
      .def_property_readonly(
          "middle", [](const SubdivisionHandle& h) { return h.subdivision.middle; }, doc("Subdivision::middle"))
      .def_property_readonly(
          "part", [](const SubdivisionHandle& h) { return h.subdivision.part; }, doc("Subdivision::part"))
      .def_property_readonly("corners", list(&Subdivision::corners), doc("Subdivision::corners"))
      .def_property_readonly("edge_middles", list(&Subdivision::edge_middles), doc("Subdivision::edge_middles"))
      .def_property_readonly("face_middles", list(&Subdivision::face_middles), doc("Subdivision::face_middles"));
  py::class_<SubdividedHandle>(m, "Subdivided", "The result of subdivide().")
      .def_property_readonly(
          "subdivision", [](const SubdividedHandle& h) { return h.subdivision; }, "The Subdivision.")
      .def_property_readonly(
          "cells", [](const SubdividedHandle& h) { return h.cells; }, doc("Subdivided::cells"));
  m.def(
      "subdivide",
      [](const EditHandle& h, Cell c) {
        return change(h, [&](ComplexEdit& e) {
          Subdivided made = subdivide(e, c);
          return SubdividedHandle{{std::move(made.subdivision), &e.map()}, std::move(made.cells)};
        });
      },
      py::arg("edit"), py::arg("c"), doc("subdivide"));
  m.def(
      "coarsen",
      [](const EditHandle& h, const SubdivisionHandle& given) {
        return change(h, [&, s = given](ComplexEdit& e) {
          s.expect_of(e.map());
          return coarsen(e, s.subdivision);
        });
      },
      py::arg("edit"), py::arg("subdivision"), doc("coarsen"));
  m.def(
      "update_after_edit",
      [](const MapHandle& h, const std::vector<Cell>& added, SubdivisionHandle& s) {
        read(h, [&](const CombinatorialMap& map) {
          s.expect_of(map);
          update_after_edit(map, added, s.subdivision);
        });
      },
      py::arg("map"), py::arg("added"), py::arg("subdivision"),
      "Updates a subdivision. Call it after later edits next to the cell, and after the commit, which replaces its "
      "parts. "
      "`added`: cells that the edit made (EditReport.added).");
}

void bind_repair(py::module_& m) {
  m.def(
      "divide_into_simplices",
      [](const EditHandle& h, const std::vector<Cell>& cells) {
        return change(h, [&](ComplexEdit& e) { return divide_into_simplices(e, cells); });
      },
      py::arg("edit"), py::arg("cells"), doc("divide_into_simplices"));
  Record<RepairOptions>(m, "RepairOptions").field("max_cells", &RepairOptions::max_cells).finish();
  bind_enum<Mending>(m, "Mending", {{"POINT", Mending::point}, {"MOVED", Mending::moved}, {"CUT", Mending::cut}});
  Record<MendedRegion>(m, "MendedRegion")
      .field("how", &MendedRegion::how)
      .field("sources", &MendedRegion::sources)
      .field("cells", &MendedRegion::cells)
      .finish();
  Record<LeftCell>(m, "LeftCell")
      .field("cell", &LeftCell::cell)
      .field("source", &LeftCell::source)
      .field("reason", &LeftCell::reason)
      .finish();
  Record<RepairReport>(m, "RepairReport")
      .field("mended", &RepairReport::mended)
      .field("left", &RepairReport::left)
      .finish();
  m.def(
      "repair",
      [](const EditHandle& h, const std::vector<Cell>& cells, const RepairOptions& options) {
        return change(h, [&, own = options](ComplexEdit& e) { return repair(e, cells, own); });
      },
      py::arg("edit"), py::arg("cells"), py::arg("options") = RepairOptions{}, doc("repair"));
}

}  // namespace

void bind(py::module_& m) {
  bind_subdivision(m);
  bind_repair(m);
}

}  // namespace dartcast::python::remeshing
