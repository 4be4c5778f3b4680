// Binds dartcast/mesh_check.hpp.
#include "dartcast/mesh_check.hpp"

#include "bind.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_check {

void bind(py::module_& m) {
  m.def(
      "check_and_repair",
      [](MeshData& mesh) {
        const MeshUse use(mesh, true);
        const py::gil_scoped_release release;
        return check_and_repair(mesh);
      },
      about("check_and_repair"));
}

}  // namespace dartcast::python::mesh_check
