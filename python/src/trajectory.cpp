// Binds dartcast/trajectory.hpp.
#include "dartcast/trajectory.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::trajectory {
namespace {

// Traces may be of another map, or older than an edit.
void expect_cells_of(const CombinatorialMap& map, const std::vector<Trace>& traces) {
  const auto expect = [&](Cell c) {
    if (!map.contains(c))
      throw InvalidArgument("traces: they were made in another map, or before an edit: make them anew");
  };
  for (const Trace& t : traces) {
    expect(t.before.cell);
    expect(t.after.cell);
    for (const Crossing& c : t.crossings) {
      expect(c.from);
      expect(c.to);
      if (c.dart.valid()) expect_dart(map, c.dart);
    }
    for (const Contact& c : t.contacts.contacts) expect_dart(map, c.dart);
  }
}

}  // namespace

void bind(py::module_& m) {
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
      [](const MapHandle& h, const std::vector<Trace>& traces) {
        return read_long(h, [&](const CombinatorialMap& map) {
          expect_cells_of(map, traces);
          return trajectory_csv(map, traces);
        });
      },
      py::arg("map"), py::arg("traces"), doc("trajectory_csv"));
  m.def(
      "trajectory_svg",
      [](const ComplexHandle& h, const std::vector<Trace>& traces) {
        return read_long(h, [&](const CellComplex& complex) {
          expect_cells_of(complex.map(), traces);
          return trajectory_svg(complex, traces);
        });
      },
      py::arg("complex"), py::arg("traces"), doc("trajectory_svg"));
}

}  // namespace dartcast::python::trajectory
