// Binds dartcast/surface.hpp: the surface itself. Places, steps and edits have files of their own.
#include "dartcast/surface.hpp"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "bind.hpp"
#include "support/handles.hpp"
#include "support/members.hpp"
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

void move(Handle& self, const Typed<"Points">& positions, Threads threads) {
  const Use use = self.use();
  const auto x = vectors(positions, "positions");
  const py::gil_scoped_release release;
  self.surface.move(x, threads);
  ++self.version;
}

// A triangle that exists.
template <class F>
auto of_triangle(const char* caller, F f) {
  return [caller, f](const Handle& self, SimplexId t) {
    return read(self, [&](const Surface& surface) {
      check_triangle(surface, t, caller);
      return std::invoke(f, surface, t);
    });
  };
}

AcrossEdge across(const Handle& self, SimplexId t, unsigned edge) {
  if (edge > 2) throw InvalidArgument("across: edge " + std::to_string(edge) + ": a triangle has edges 0, 1 and 2");
  return read(self, [&](const Surface& surface) {
    check_triangle(surface, t, "across");
    return surface.across(t, edge);
  });
}

Typed<"bool or NDArray[bool]"> contains(Handle& self, const Typed<"SurfacePlace or Records">& place) {
  const Use use = self.use();
  if (!is_places(place)) return py::bool_(self.surface.contains(place.cast<const SurfacePlace&>()));
  const auto rows = place_rows(place, "place");
  py::array_t<bool> found(static_cast<py::ssize_t>(rows.size()));
  bool* out = found.mutable_data();
  for (std::size_t i = 0; i < rows.size(); ++i) out[i] = self.surface.contains(place_of(rows[i]));
  return found;
}

py::array_t<double> point(Handle& self, const Typed<"SurfacePlace | Records">& place) {
  const Use use = self.use();
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

void bind_class(py::module_& m) {
  py::class_<Handle, std::shared_ptr<Handle>> c(m, "Surface", doc("Surface"));
  c.def(py::init(&make_surface), about("Surface::Surface"))
      .def_property_readonly("map", &map_of, doc("Surface::map"))
      .def("move", &move, about("Surface::move"))
      .def(
          "triangles",
          [](const Handle& self) { return rows_of(read(self, [](const Surface& s) { return s.triangles(); })); },
          about("Surface::triangles", "A structured array with the fields cell (uint32) and simplex (uint16)."))
      .def("vertices", of_triangle("vertices", &Surface::vertices), about("Surface::vertices"))
      .def("corners", of_triangle("corners", [](const Surface& s, SimplexId t) { return kept(s.corners(t)); }),
           about("Surface::corners", "The positions of vertices(), (3, 3)."))
      .def("across", &across, about("Surface::across"))
      .def("normal", of_triangle("normal", &Surface::normal), about("Surface::normal"))
      .def("contains", &contains,
           about("Surface::contains", "place: a SurfacePlace, or an array of places; then bool (n,)."))
      .def("point", &point,
           about("Surface::point", "place: a SurfacePlace, or an array of places; then float64 (n, 3)."));
  members_of_Surface(c);
}

}  // namespace

void bind(py::module_& m) {
  bind_class(m);
  surface_places::bind(m);
  surface_steps::bind(m);
  surface_edit::bind(m);
}

}  // namespace dartcast::python::surface
