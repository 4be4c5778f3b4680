// Binds dartcast/trajectory.hpp.
#include "dartcast/trajectory.hpp"

#include <string>
#include <vector>

#include "bind.hpp"
#include "support/handles.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {

void bind_trajectory(py::module_& m) {
  bind_enum<TrajectoryMark>(m, "TrajectoryMark",
                            {{"START", TrajectoryMark::start},
                             {"CROSSING", TrajectoryMark::crossing},
                             {"CONTACT", TrajectoryMark::contact},
                             {"TARGET", TrajectoryMark::target},
                             {"END", TrajectoryMark::end}});
  Record<TrajectoryPoint>(m, "TrajectoryPoint")
      .field("mark", &TrajectoryPoint::mark)
      .field("step", &TrajectoryPoint::step)
      .field("time", &TrajectoryPoint::time)
      .field("point", &TrajectoryPoint::point)
      .field("kind", &TrajectoryPoint::kind)
      .field("cell", &TrajectoryPoint::cell)
      .field("next", &TrajectoryPoint::next)
      .finish();
  m.def(
      "trajectory_points", [](const std::vector<Trace>& traces) { return trajectory_points(traces); },
      py::arg("traces"), doc("trajectory_points"));
  m.def(
      "trajectory_csv",
      [](const MapHandle& map, const std::vector<Trace>& traces) {
        const Use use(*map.usage, "the map");
        return trajectory_csv(map.read(), traces);
      },
      py::arg("map"), py::arg("traces"), doc("trajectory_csv"));
  m.def(
      "trajectory_svg",
      [](const ComplexHandle& complex, const std::vector<Trace>& traces) {
        const Use use(*complex.usage, "the complex");
        return trajectory_svg(*complex.complex, traces);
      },
      py::arg("complex"), py::arg("traces"), doc("trajectory_svg"));
}

}  // namespace dartcast::python
