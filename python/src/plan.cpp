// Binds dartcast/plan.hpp.
#include "dartcast/plan.hpp"

#include "bind.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::plan {

void bind(py::module_& m) {
  m.def(
      "plan_run",
      [](const MeshData& mesh, const PlanOptions& options) {
        const PlanOptions own = options;
        check_arrays(mesh);
        const MeshUse use(mesh);
        const py::gil_scoped_release release;
        return plan_run(checked_mesh(mesh), own);
      },
      about("plan_run"));
}

}  // namespace dartcast::python::plan
