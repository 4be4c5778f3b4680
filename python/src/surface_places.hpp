// Places on a surface: many of them are a structured array of the dtype dartcast.SURFACE_PLACE.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/surface.hpp"
#include "support/in_use.hpp"
#include "support/python.hpp"
#include "support/rows.hpp"

namespace dartcast::python {

/// A surface as Python holds it. Its map shares the mark of use.
struct SurfaceHandle {
  Surface surface;
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
  std::uint64_t version = 0;  ///< how often it was moved or edited
  bool edited = false;        ///< an edit is open

  explicit SurfaceHandle(MeshData mesh) : surface(std::move(mesh)) {}

  /// Throws InvalidArgument while an edit is open.
  [[nodiscard]] Use use() const {
    if (edited) throw InvalidArgument("an edit of this surface is open: end its `with` block first");
    return Use(*usage, "the Surface");
  }
  [[nodiscard]] const Surface& object() const { return surface; }
  [[nodiscard]] Surface& target() { return surface; }
};

using PlaceRow = SurfacePlaceRow;
SurfacePlace place_of(const PlaceRow& row);
/// The row of no place: cell NONE.
PlaceRow no_place();

bool is_places(const pybind11::object& x);
/// The rows of an array of places. Throws TypeError if it is none, or a writable one is asked for and it is not.
std::span<const PlaceRow> place_rows(const pybind11::object& x, const char* name);
std::span<PlaceRow> writable_place_rows(const pybind11::object& x, const char* name);
std::vector<SurfacePlace> places_of(std::span<const PlaceRow> rows);

/// Throw InvalidArgument if the surface has no such triangle, or the place is none of it.
void check_triangle(const Surface& surface, SimplexId t, const char* caller);
void check_place(const Surface& surface, const SurfacePlace& place, const char* caller);
/// The same for all; the message names the place.
void check_places(const Surface& surface, std::span<const SurfacePlace> places, const char* caller);

// The parts of surface::bind().
namespace surface_places {
void bind(pybind11::module_& m);
}
namespace surface_steps {
void bind(pybind11::module_& m);
}
namespace surface_edit {
void bind(pybind11::module_& m);
}

}  // namespace dartcast::python
