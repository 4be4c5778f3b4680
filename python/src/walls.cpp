// Binds dartcast/walls.hpp.
#include "dartcast/walls.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::walls {
namespace {

std::vector<Vec3> points(const WallTriangles& walls, const Typed<"Points">& given) {
  const auto positions = vectors(given, "positions");
  if (!walls.vertices.empty() && walls.vertices.back().value >= positions.size())
    throw InvalidArgument("positions: expected those of the complex that the walls were taken from");
  return walls.points(positions);
}

}  // namespace

void bind(py::module_& m) {
  py::class_<WallTriangles>(m, "WallTriangles", doc("WallTriangles"))
      .def_property_readonly(
          "vertices",
          [](const WallTriangles& w) {
            std::vector<std::uint32_t> numbers;
            for (const Vertex v : w.vertices) numbers.push_back(v.value);
            return array_of(std::move(numbers));
          },
          "A copy: uint32 (n,).")
      .def_property_readonly(
          "triangles", [](const WallTriangles& w) { return array_of_rows(w.triangles); }, "A copy: uint32 (n, 3).")
      .def_property_readonly(
          "faces", [](const WallTriangles& w) { return w.faces; }, "A copy: the wall of each triangle.")
      .def("points", &points, py::arg("positions"), doc("WallTriangles::points"));
  m.def(
      "wall_triangles",
      [](const ComplexHandle& h) { return read_long(h, [](const CellComplex& c) { return wall_triangles(c); }); },
      py::arg("complex"), doc("wall_triangles"));
}

}  // namespace dartcast::python::walls
