// Binds dartcast/plan.hpp.
#include "dartcast/plan.hpp"

#include "bind.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::plan {

void bind(py::module_& m) {
  Record<PlanOptions>(m, "PlanOptions")
      .field("ranks", &PlanOptions::ranks)
      .field("particles", &PlanOptions::particles)
      .field("cells", &PlanOptions::cells)
      .field("step", &PlanOptions::step)
      .field("deforms", &PlanOptions::deforms)
      .field("latency", &PlanOptions::latency)
      .field("bandwidth", &PlanOptions::bandwidth)
      .field("samples", &PlanOptions::samples)
      .finish();
  Record<RankSpread>(m, "RankSpread").field("mean", &RankSpread::mean).field("largest", &RankSpread::largest).finish();
  Record<RunPlan>(m, "RunPlan")
      .field("options", &RunPlan::options)
      .field("cells", &RunPlan::cells)
      .field("ghosts", &RunPlan::ghosts)
      .field("neighbours", &RunPlan::neighbours)
      .field("bytes", &RunPlan::bytes)
      .field("sent", &RunPlan::sent)
      .field("sent_bytes", &RunPlan::sent_bytes)
      .field("rounds", &RunPlan::rounds)
      .field("seconds_walk", &RunPlan::seconds_walk)
      .field("seconds_pack", &RunPlan::seconds_pack)
      .field("seconds_messages", &RunPlan::seconds_messages)
      .field("seconds_all", &RunPlan::seconds_all)
      .field("seconds_alone", &RunPlan::seconds_alone)
      .def("seconds", &RunPlan::seconds, "The time of a step, in s.")
      .def("efficiency", &RunPlan::efficiency, doc("RunPlan::efficiency"))
      .finish();
  m.def(
      "plan_run",
      [](const MeshData& mesh, const PlanOptions& options) {
        const PlanOptions own = options;
        check_arrays(mesh);
        const MeshUse use(mesh);
        const py::gil_scoped_release release;
        return plan_run(checked_mesh(mesh), own);
      },
      py::arg("mesh"), py::arg("options"), doc("plan_run"));
}

}  // namespace dartcast::python::plan
