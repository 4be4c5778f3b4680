// Binds dartcast/statistics.hpp and dartcast/statistics_files.hpp: hits, crossings, residence times and pathlines. Long lists are structured arrays.
#include "dartcast/statistics.hpp"

#include <filesystem>
#include <memory>

#include "bind.hpp"
#include "dartcast/statistics_files.hpp"
#include "support/environments.hpp"
#include "support/members.hpp"
#include "support/python.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::statistics {
namespace {

Vec3 vec(const Row3& x) { return {x[0], x[1], x[2]}; }

/// The hits that faces() gave, from an array with its fields.
std::vector<FaceHits> hits_of(const py::object& faces) {
  const py::array_t<FaceHitsRow> array =
      structured(faces, py::dtype::of<FaceHitsRow>(), "faces", "the array of faces()", "hits.faces()");
  const auto rows = array.unchecked<1>();
  std::vector<FaceHits> found;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const FaceHitsRow& r = rows(i);
    found.push_back({CellFace{Cell{r.cell}, r.face}, Patch{r.patch}, r.hits, r.mass, r.energy, r.angles});
  }
  return found;
}

/// The points of pathlines, from an array with their fields.
std::vector<PathPoint> path_points_of(const py::object& points) {
  const py::array_t<PathPointRow> array =
      structured(points, py::dtype::of<PathPointRow>(), "points", "the array of Statistics.path_points",
                 "numpy.concatenate(list of these arrays)");
  const auto rows = array.unchecked<1>();
  std::vector<PathPoint> found;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const PathPointRow& r = rows(i);
    found.push_back({r.id, r.time, vec(r.position), vec(r.velocity), r.contact});
  }
  return found;
}

/// Throws InvalidArgument where a contact is at a wall that the map does not have: of another environment, or from
/// before an edit.
void require_walls(const CombinatorialMap& map, const ContactList& contacts) {
  for (const WallHit& wall : contacts.walls) {
    if (!map.contains(wall.face.cell) || wall.face.face >= map.shape(wall.face.cell).face_count()) {
      throw InvalidArgument(
          "add: the report is of another environment, or from before an edit: add it right after its step");
    }
  }
}

using HitsClass = py::class_<WallHits, std::shared_ptr<WallHits>>;

void bind_hits(py::module_& m) {
  HitsClass c(m, "WallHits", doc("WallHits"));
  c.def(py::init<>());
  c.def(
      "add",
      [](WallHits& hits, const EnvironmentHandle& h, const StepReport& report, const std::vector<Impact>& impacts) {
        const Use use(*h.usage, "the environment");
        require_walls(h.environment->map(), report.contacts);
        hits.add(*h.environment, report.contacts, impacts);
      },
      py::arg("environment"), py::arg("report"), py::arg("impacts") = std::vector<Impact>(), doc("WallHits::add"));
  members_of_WallHits(c);
  c.def("of", &WallHits::of, py::arg("face"), "The hits of one face.");
  c.def(
      "faces", [](const WallHits& hits) { return rows_of(hits.faces()); },
      about("WallHits::faces", "A structured array (cell, face, patch, hits, mass, energy, angles)."));
  c.def(
      "ended_by_patch", [](const WallHits& hits) { return hits.ended_by_patch(); }, doc("WallHits::ended_by_patch"));
  c.def(
      "restore",
      [](WallHits& hits, const EnvironmentHandle& h, const Typed<"Records">& faces, std::vector<std::uint64_t> ended) {
        const Use use(*h.usage, "the environment");
        hits.restore(*h.environment, hits_of(faces), std::move(ended));
      },
      about("WallHits::restore"));
}

void bind_planes(py::module_& m) {
  m.def(
      "find_crossings",
      [](const std::vector<SectionPlane>& planes, const Typed<"Points">& before, const Typed<"Points">& after,
         Threads threads) {
        const auto from = vectors(before, "before");
        const auto to = vectors(after, "after");
        const py::gil_scoped_release release;
        std::vector<PlaneCrossing> found = find_crossings(planes, from, to, threads);
        const py::gil_scoped_acquire acquire;
        return rows_of(found);
      },
      about("find_crossings",
            "before, after: float64 (n, 3). A structured array (plane, particle, forward, share, point)."));
}

}  // namespace

void bind(py::module_& m) {
  m.def("cell_quantities", &cell_quantities, about("cell_quantities"));
  m.def(
      "check_cell_quantities", [](const std::vector<std::string>& names) { check_cell_quantities(names); },
      about("check_cell_quantities"));
  bind_hits(m);
  bind_planes(m);
  m.def(
      "write_pathlines",
      [](const Typed<"Records">& points, const std::filesystem::path& file) {
        write_pathlines(path_points_of(points), file);
      },
      about("write_pathlines", "points: the arrays Statistics.path_points, concatenated."));
}

}  // namespace dartcast::python::statistics
