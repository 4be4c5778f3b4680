// Binds dartcast/surface.hpp: the surface itself. Places, steps and edits have files of their own.
#include "dartcast/surface.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "bind.hpp"
#include "support/handles.hpp"
#include "surface_places.hpp"

namespace py = pybind11;

namespace dartcast::python::surface {
namespace {

using Handle = SurfaceHandle;

std::shared_ptr<Handle> make_surface(const MeshData& mesh) {
  MeshData copy = mesh;
  const py::gil_scoped_release release;
  return std::make_shared<Handle>(std::move(copy));
}

std::shared_ptr<MapHandle> map_of(const std::shared_ptr<Handle>& self) {
  auto handle = std::make_shared<MapHandle>();
  handle->owner = self;
  handle->map = &self->surface.map();
  handle->usage = self->usage;
  return handle;
}

void move(Handle& self, const py::object& positions, Threads threads) {
  const SurfaceUse use(self);
  const auto x = vectors(positions, "positions");
  const py::gil_scoped_release release;
  self.surface.move(x, threads);
  ++self.version;
}

// One row a triangle: the cell and the number of the simplex.
struct TriangleRow {
  std::uint32_t cell;
  std::uint16_t simplex;
};

py::array_t<TriangleRow> triangles(Handle& self) {
  const SurfaceUse use(self);
  std::vector<TriangleRow> rows;
  for (const SimplexId t : self.surface.triangles()) rows.push_back({t.cell.value, t.simplex});
  return array_of(std::move(rows));
}

// Calls a function of the surface for a triangle that exists.
template <class F>
auto of_triangle(Handle& self, SimplexId t, const char* caller, F&& f) {
  const SurfaceUse use(self);
  check_triangle(self.surface, t, caller);
  return f(self.surface);
}

py::array_t<double> corners(Handle& self, SimplexId t) {
  const auto found = of_triangle(self, t, "corners", [&](const Surface& s) { return s.corners(t); });
  return array_of(std::span<const Vec3>(found));
}

AcrossEdge across(Handle& self, SimplexId t, unsigned edge) {
  if (edge > 2) throw InvalidArgument("across: edge " + std::to_string(edge) + ": a triangle has edges 0, 1 and 2");
  return of_triangle(self, t, "across", [&](const Surface& s) { return s.across(t, edge); });
}

py::object contains(Handle& self, const py::object& place) {
  const SurfaceUse use(self);
  if (!is_places(place)) return py::bool_(self.surface.contains(place.cast<const SurfacePlace&>()));
  const auto rows = place_rows(place, "place");
  py::array_t<bool> found(static_cast<py::ssize_t>(rows.size()));
  bool* out = found.mutable_data();
  for (std::size_t i = 0; i < rows.size(); ++i) out[i] = self.surface.contains(place_of(rows[i]));
  return found;
}

py::array_t<double> point(Handle& self, const py::object& place) {
  const SurfaceUse use(self);
  if (!is_places(place)) {
    const auto& one = place.cast<const SurfacePlace&>();
    check_place(self.surface, one, "point");
    return array_of(self.surface.point(one));
  }
  const std::vector<SurfacePlace> places = places_of(place_rows(place, "place"));
  std::vector<Vec3> points(places.size());
  {
    const py::gil_scoped_release release;
    check_places(self.surface, places, "point");
    std::transform(places.begin(), places.end(), points.begin(),
                   [&](const SurfacePlace& p) { return self.surface.point(p); });
  }
  return array_of(std::span<const Vec3>(points));
}

SurfacePlace place(Handle& self, SimplexId triangle, const std::array<double, 3>& weights) {
  const SurfaceUse use(self);
  return self.surface.place(triangle, weights);
}

void set_free(Handle& self, Cell face, bool free) {
  const SurfaceUse use(self);
  self.surface.set_free(face, free);
}

std::string with(const char* name, const char* more) { return std::string(doc(name)) + "\n\n" + more; }

void bind_class(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(TriangleRow, cell, simplex);
  py::class_<Handle, std::shared_ptr<Handle>> surface(m, "Surface", doc("Surface"));
  surface.def(py::init(&make_surface), py::arg("mesh"), doc("Surface::Surface"))
      .def_property_readonly("map", &map_of, doc("Surface::map"))
      .def_property_readonly(
          "positions",
          [](Handle& self) {
            const SurfaceUse use(self);
            return read_only(array_of(self.surface.positions()));
          },
          with("Surface::positions", "A copy, float64 (n, 3).").c_str())
      .def("move", &move, py::arg("positions"), py::arg("threads") = Threads{}, doc("Surface::move"))
      .def("set_free", &set_free, py::arg("face"), py::arg("free"), doc("Surface::set_free"))
      .def(
          "triangles", &triangles,
          with("Surface::triangles", "A structured array with the fields cell (uint32) and simplex (uint16).").c_str());
  surface
      .def(
          "vertices",
          [](Handle& self, SimplexId t) {
            return of_triangle(self, t, "vertices", [&](const Surface& s) { return s.vertices(t); });
          },
          py::arg("t"), doc("Surface::vertices"))
      .def("corners", &corners, py::arg("t"), with("Surface::corners", "The positions of vertices(), (3, 3).").c_str())
      .def("across", &across, py::arg("t"), py::arg("edge"), doc("Surface::across"))
      .def(
          "normal",
          [](Handle& self, SimplexId t) {
            return of_triangle(self, t, "normal", [&](const Surface& s) { return s.normal(t); });
          },
          py::arg("t"), doc("Surface::normal"));
  surface
      .def("contains", &contains, py::arg("place"),
           with("Surface::contains", "place: a SurfacePlace, or an array of places; then bool (n,).").c_str())
      .def("point", &point, py::arg("place"),
           with("Surface::point", "place: a SurfacePlace, or an array of places; then float64 (n, 3).").c_str())
      .def("place", &place, py::arg("triangle"), py::arg("weights"), doc("Surface::place"));
}

}  // namespace

void bind(py::module_& m) {
  surface_places::bind(m);
  Record<AcrossEdge>(m, "AcrossEdge")
      .field("face", &AcrossEdge::face)
      .field("triangle", &AcrossEdge::triangle)
      .field("edge", &AcrossEdge::edge)
      .field("wall", &AcrossEdge::wall)
      .finish();
  bind_class(m);
  surface_steps::bind(m);
  surface_edit::bind(m);
}

}  // namespace dartcast::python::surface
