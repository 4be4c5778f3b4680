// Places on a surface, one as a record and many as an array; and the search for them.
#include "surface_places.hpp"

#include <string>
#include <utility>

#include "dartcast/error.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

// A locator is good for one version of one surface.
struct LocatorHandle {
  std::shared_ptr<SurfaceHandle> surface;
  std::uint64_t version = 0;
  SurfaceLocator locator;

  explicit LocatorHandle(std::shared_ptr<SurfaceHandle> s)
      : surface(std::move(s)), version(surface->version), locator(surface->surface) {}
};

std::shared_ptr<LocatorHandle> make_locator(const std::shared_ptr<SurfaceHandle>& surface) {
  const Use use = surface->use();
  const py::gil_scoped_release release;
  return std::make_shared<LocatorHandle>(surface);
}

Typed<"SurfaceLocation or tuple[Records, Floats]"> nearest(const LocatorHandle& self,
                                                           const std::shared_ptr<SurfaceHandle>& surface,
                                                           const Typed<"Vector or Points">& x) {
  const Use use = surface->use();
  if (self.surface != surface || self.version != surface->version) {
    throw InvalidArgument(
        "nearest: the locator was made for another surface, or before a move or an edit of this one: make a new "
        "SurfaceLocator");
  }
  if (!py::isinstance<py::array>(x) || py::reinterpret_borrow<py::array>(x).ndim() == 1)
    return py::cast(self.locator.nearest(surface->surface, vector(x, "x")));
  const auto points = vectors(x, "x");
  std::vector<PlaceRow> places(points.size());
  std::vector<double> distances(points.size());
  {
    const py::gil_scoped_release release;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SurfaceLocation found = self.locator.nearest(surface->surface, points[i]);
      places[i] = row_of(found.place);
      distances[i] = found.distance;
    }
  }
  return py::make_tuple(array_of(std::move(places)), array_of(std::move(distances)));
}

bool is_aligned(const py::object& x) {
  return (py::detail::array_proxy(x.ptr())->flags & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
}

}  // namespace

SurfacePlace place_of(const PlaceRow& row) {
  return {{Cell{row.cell}, row.simplex}, {row.weights[0], row.weights[1], row.weights[2]}};
}

PlaceRow no_place() { return row_of(SurfacePlace{}); }

bool is_places(const py::object& x) { return py::isinstance<py::array>(x); }

std::span<const PlaceRow> place_rows(const py::object& x, const char* name) {
  const bool right = py::isinstance<py::array_t<PlaceRow, py::array::c_style>>(x) &&
                     py::reinterpret_borrow<py::array>(x).ndim() == 1 && is_aligned(x);
  if (!right) {
    refuse_array(x, name, "an array of places (dtype dartcast.SURFACE_PLACE), C-contiguous",
                 "x.astype(dartcast.SURFACE_PLACE); from a list of SurfacePlace: dartcast.surface_places(x)");
  }
  const auto a = py::reinterpret_borrow<py::array>(x);
  return {static_cast<const PlaceRow*>(a.data()), static_cast<std::size_t>(a.size())};
}

std::span<PlaceRow> writable_place_rows(const py::object& x, const char* name) {
  const auto rows = place_rows(x, name);
  auto a = py::reinterpret_borrow<py::array>(x);
  if (!a.writeable()) refuse_array(x, name, "a writable array", "x.copy()");
  return {static_cast<PlaceRow*>(a.mutable_data()), rows.size()};
}

std::vector<SurfacePlace> places_of(std::span<const PlaceRow> rows) {
  std::vector<SurfacePlace> places;
  places.reserve(rows.size());
  for (const PlaceRow& row : rows) places.push_back(place_of(row));
  return places;
}

void check_triangle(const Surface& surface, SimplexId t, const char* caller) {
  if (!surface.contains(SurfacePlace{t, {1.0, 0.0, 0.0}}))
    throw InvalidArgument(std::string(caller) + ": the surface has no such triangle");
}

void check_place(const Surface& surface, const SurfacePlace& place, const char* caller) {
  if (!surface.contains(place)) throw InvalidArgument(std::string(caller) + ": the place is none of this surface");
}

void check_places(const Surface& surface, std::span<const SurfacePlace> places, const char* caller) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!surface.contains(places[i]))
      throw InvalidArgument(std::string(caller) + ": place " + std::to_string(i) + " is none of this surface");
  }
}

namespace surface_places {

void bind(py::module_& m) {
  m.attr("SURFACE_PLACE") = py::dtype::of<PlaceRow>();
  m.def(
      "surface_places", [](const std::vector<SurfacePlace>& places) { return rows_of(places); }, py::arg("places"),
      "An array of places from a list of SurfacePlace: a structured array of the dtype SURFACE_PLACE, with the "
      "fields cell (uint32), simplex (uint16) and weights (3 float64).");
  m.def(
      "nearest_in_triangle",
      [](SurfaceHandle& surface, SimplexId triangle, const Vec3& x) {
        const Use use = surface.use();
        check_triangle(surface.surface, triangle, "nearest_in_triangle");
        return nearest_in_triangle(surface.surface, triangle, x);
      },
      about("nearest_in_triangle"));
  py::class_<LocatorHandle, std::shared_ptr<LocatorHandle>>(m, "SurfaceLocator", doc("SurfaceLocator"))
      .def(py::init(&make_locator), py::arg("surface").none(false), doc("SurfaceLocator::SurfaceLocator"))
      .def("nearest", &nearest, py::arg("surface").none(false), py::arg("x"),
           about("SurfaceLocator::nearest",
                 "x: three numbers, for which it returns a SurfaceLocation. Or float64 (n, 3), for which it returns an "
                 "array of places and the distances, float64 (n,)."));
}

}  // namespace surface_places
}  // namespace dartcast::python
