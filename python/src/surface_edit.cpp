// Edits of a surface as a `with` block, and the places that follow them.
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "support/edits.hpp"
#include "surface_places.hpp"

namespace py = pybind11;

namespace dartcast::python::surface_edit {
namespace {

// An edit is open from its making to its commit, or to the end of its block. Calls on the surface are refused until
// then; its map can be read.
class SurfaceEditHandle {
 public:
  explicit SurfaceEditHandle(std::shared_ptr<SurfaceHandle> surface) : surface_(std::move(surface)) {
    const Use use = surface_->use();
    edit_ = std::make_unique<SurfaceEdit>(surface_->surface);
    surface_->edited = true;
  }
  SurfaceEditHandle(const SurfaceEditHandle&) = delete;
  SurfaceEditHandle& operator=(const SurfaceEditHandle&) = delete;
  // Another thread may still read the map.
  ~SurfaceEditHandle() {
    if (edit_ == nullptr) return;
    const py::gil_scoped_release release;
    while (!surface_->usage->begin()) std::this_thread::yield();
    end();
    surface_->usage->end();
  }

  [[nodiscard]] Use use() const { return Use(*surface_->usage, "the Surface"); }
  [[nodiscard]] SurfaceEdit& open() const {
    if (edit_ == nullptr) throw InvalidArgument("this edit has ended: make a new SurfaceEdit");
    return *edit_;
  }
  [[nodiscard]] const std::shared_ptr<SurfaceHandle>& surface() const { return surface_; }

  SurfaceEditReport commit() {
    const Use held = use();
    SurfaceEdit& edit = open();
    const py::gil_scoped_release release;
    try {
      SurfaceEditReport report = edit.commit();
      end();
      return report;
    } catch (...) {
      end();
      throw;
    }
  }
  // Undoes all that was not committed.
  void give_up() {
    const Use held = use();
    if (edit_ != nullptr) end();
  }

 private:
  void end() {
    edit_.reset();
    surface_->edited = false;
    ++surface_->version;
  }

  std::shared_ptr<SurfaceHandle> surface_;
  std::unique_ptr<SurfaceEdit> edit_;
};

using Handle = SurfaceEditHandle;

std::shared_ptr<MapHandle> edited_map(const std::shared_ptr<Handle>& self) {
  auto handle = std::make_shared<MapHandle>();
  handle->of_edit = [self]() -> const CombinatorialMap& { return self->open().map(); };
  handle->usage = self->surface()->usage;
  return handle;
}

std::shared_ptr<TransactionHandle> topology(const std::shared_ptr<Handle>& self) {
  static_cast<void>(self->open());
  auto handle = std::make_shared<TransactionHandle>();
  handle->of_surface = [self]() -> Transaction& { return self->open().topology(); };
  handle->usage = self->surface()->usage;
  return handle;
}

// A report of another surface, or of an edit before the last one, may name cells that are not there.
void check_report(const Surface& surface, const SurfaceEditReport& report) {
  for (const Cell c : report.map.added) {
    if (!surface.map().contains(c))
      throw InvalidArgument(
          "followed: the report is not of this surface's last edit: every place must follow each edit before the next "
          "one");
  }
}

Typed<"SurfacePlace | None or Records"> follow(SurfaceHandle& surface, const SurfaceEditReport& report,
                                               const Typed<"SurfacePlace or Records">& place) {
  const Use use = surface.use();
  check_report(surface.surface, report);
  if (!is_places(place)) return py::cast(followed(surface.surface, report, place.cast<const SurfacePlace&>()));
  std::vector<PlaceRow> rows;
  for (const SurfacePlace& p : places_of(place_rows(place, "place"))) {
    const std::optional<SurfacePlace> now = followed(surface.surface, report, p);
    rows.push_back(now ? row_of(*now) : no_place());
  }
  return array_of(std::move(rows));
}

}  // namespace

void bind(py::module_& m) {
  py::class_<Handle, std::shared_ptr<Handle>>(
      m, "SurfaceEdit",
      about("SurfaceEdit",
            "It is a context manager: leaving its block without commit() undoes it. While it is open, the surface can "
            "be read through `edit.map` and `edit.position()` only."))
      .def(py::init<std::shared_ptr<SurfaceHandle>>(), py::arg("surface").none(false))
      .def("__enter__", [](const std::shared_ptr<Handle>& self) { return self; })
      .def("__exit__", [](Handle& self, const py::args& /*raised*/) { self.give_up(); })
      .def_property_readonly("topology", &topology, "The transaction for the functions of map_edits.hpp.")
      .def_property_readonly("map", &edited_map, "The surface's map, with the edits made so far.")
      .def(
          "position",
          [](const Handle& self, Vertex v) {
            const Use held = self.use();
            return self.open().position(v);
          },
          about("SurfaceEdit::position"))
      .def(
          "place",
          [](const Handle& self, Vertex v, const Vec3& x) {
            const Use held = self.use();
            self.open().place(v, x);
          },
          about("SurfaceEdit::place"))
      .def("commit", &Handle::commit, doc("SurfaceEdit::commit"));
  m.def("followed", &follow, py::arg("surface"), py::arg("report"), py::arg("place"),
        about("followed",
              "place: a SurfacePlace; the answer is None where no face took the place. Or an array of places, for "
              "which it returns an array; its cell is NONE where no face took the place."));
}

}  // namespace dartcast::python::surface_edit
