// Binds dartcast/remeshing.hpp.
#include "dartcast/remeshing.hpp"

#include "bind.hpp"
#include "support/members.hpp"
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
    return [member](const SubdivisionHandle& h) { return reading(h.subdivision.*member); };
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
      about("subdivide"));
  m.def(
      "coarsen",
      [](const EditHandle& h, const SubdivisionHandle& given) {
        return change(h, [&, s = given](ComplexEdit& e) {
          s.expect_of(e.map());
          return coarsen(e, s.subdivision);
        });
      },
      about("coarsen"));
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
      "parts. `added`: cells that the edit made (EditReport.added).");
}

}  // namespace

void bind(py::module_& m) { bind_subdivision(m); }

}  // namespace dartcast::python::remeshing
