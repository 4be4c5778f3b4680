// Binds dartcast/trajectory.hpp.
#include "dartcast/trajectory.hpp"

#include "bind.hpp"
#include "support/members.hpp"
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
  m.def(
      "trajectory_csv",
      [](const MapHandle& h, const std::vector<Trace>& traces) {
        return read_long(h, [&](const CombinatorialMap& map) {
          expect_cells_of(map, traces);
          return trajectory_csv(map, traces);
        });
      },
      about("trajectory_csv"));
  m.def(
      "trajectory_svg",
      [](const ComplexHandle& h, const std::vector<Trace>& traces) {
        return read_long(h, [&](const CellComplex& complex) {
          expect_cells_of(complex.map(), traces);
          return trajectory_svg(complex, traces);
        });
      },
      about("trajectory_svg"));
}

}  // namespace dartcast::python::trajectory
