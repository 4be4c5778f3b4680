// Binds dartcast/mesh_check.hpp.
#include "dartcast/mesh_check.hpp"

#include "bind.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_check {

void bind(py::module_& m) {
  bind_enum<Verdict>(
      m, "Verdict",
      {{"ACCEPT", Verdict::accept}, {"REPAIR", Verdict::repair}, {"WARN", Verdict::warn}, {"REFUSE", Verdict::refuse}});
  m.def(
      "verdict_name", [](Verdict v) { return std::string(verdict_name(v)); }, py::arg("v"), doc("verdict_name"));
  Record<Finding>(m, "Finding")
      .field("kind", &Finding::kind)
      .field("count", &Finding::count)
      .field("first", &Finding::first)
      .field("message", &Finding::message)
      .finish()
      .def("add", &Finding::add, py::arg("place"), doc("Finding::add"));
  Record<MeshReport>(m, "MeshReport")
      .field("file", &MeshReport::file)
      .field("format", &MeshReport::format)
      .field("dimension", &MeshReport::dimension)
      .field("surface", &MeshReport::surface)
      .field("points", &MeshReport::points)
      .field("cells", &MeshReport::cells)
      .field("regions", &MeshReport::regions)
      .field("parts", &MeshReport::parts)
      .field("repairs", &MeshReport::repairs)
      .field("warnings", &MeshReport::warnings)
      .field("defects", &MeshReport::defects)
      .def_property_readonly("valid", &MeshReport::valid, "Whether there are no defects.")
      .def_property_readonly("verdict", &MeshReport::verdict, "The Verdict on the mesh.")
      .finish();
  m.def(
      "check_and_repair",
      [](MeshData& mesh) {
        const MeshUse use(mesh, true);
        const py::gil_scoped_release release;
        return check_and_repair(mesh);
      },
      py::arg("mesh"), doc("check_and_repair"));
}

}  // namespace dartcast::python::mesh_check
