// Checks of cells, darts, faces and vertices that come from Python.
#include "support/map_checks.hpp"

#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

std::string name_of(Cell c) { return c.valid() ? "cell " + std::to_string(c.value) : "cell None"; }

}  // namespace

void expect_cell(const CombinatorialMap& map, Cell c) {
  if (!map.contains(c))
    throw InvalidArgument("there is no " + name_of(c) + ": an edit may have replaced it; look it up anew");
}

void expect_dart(const CombinatorialMap& map, Dart d) {
  expect_cell(map, d.cell);
  expect_number(d.number, map.shape(d.cell).dart_count(), "dart");
}

void expect_face(const CombinatorialMap& map, CellFace f) {
  expect_cell(map, f.cell);
  expect_number(f.face, map.shape(f.cell).face_count(), "face");
}

void expect_simplex(const CombinatorialMap& map, SimplexId s) {
  expect_cell(map, s.cell);
  expect_number(s.simplex, map.shape(s.cell).simplices().size(), "simplex");
}

void expect_vertex(const CombinatorialMap& map, Vertex v) {
  if (!map.is_vertex(v))
    throw InvalidArgument("there is no vertex " + (v.valid() ? std::to_string(v.value) : "None") +
                          ": an edit may have given it up");
}

void expect_pool(std::uint32_t pool) { expect_number(pool, CombinatorialMap::general_pool + std::size_t{1}, "pool"); }

void expect_positions(const CombinatorialMap& map, std::size_t count, const char* name) {
  if (count == map.vertex_count()) return;
  throw InvalidArgument(std::string(name) + ": expected " + std::to_string(map.vertex_count()) +
                        " positions, one for each vertex, Steiner points included; got " + std::to_string(count));
}

void expect_number(std::size_t number, std::size_t end, const char* what) {
  if (number >= end)
    throw py::index_error("there is no " + std::string(what) + " " + std::to_string(number) + ": there are " +
                          std::to_string(end));
}

void expect_plane(const Plane& plane) {
  if (!is_finite(plane.normal) || !std::isfinite(plane.offset) || plane.normal == Vec3{})
    throw InvalidArgument("the plane must be finite, and its normal not zero: make it by plane_through()");
}

MapHandle map_of(const ComplexHandle& complex) {
  return {complex.owner, &complex.complex->map(), nullptr, complex.usage};
}

}  // namespace dartcast::python
