// Binds dartcast/statistics.hpp and dartcast/statistics_files.hpp: hits, crossings, residence times and pathlines. Long lists are structured arrays.
#include "dartcast/statistics.hpp"

#include <filesystem>
#include <memory>
#include <string>

#include "bind.hpp"
#include "dartcast/statistics_files.hpp"
#include "support/environments.hpp"
#include "support/python.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::statistics {
namespace {

struct FaceHitsRow {
  std::uint32_t cell;
  std::uint16_t face;
  std::uint16_t patch;
  std::uint64_t hits;
};

struct CrossingRow {
  std::uint32_t plane;
  std::uint32_t particle;
  bool forward;
  double share;
  double point[3];
};

struct PassageRow {
  std::uint32_t plane;
  std::uint32_t particle;
  bool forward;
  double share;
  double point[3];
  std::uint64_t id;
  double time;
  double age;
};

struct PathPointRow {
  std::uint64_t id;
  double time;
  double position[3];
  double velocity[3];
  bool contact;
};

void copy_vector(const Vec3& from, double (&to)[3]) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

Vec3 vec(const double (&x)[3]) { return {x[0], x[1], x[2]}; }

template <class Row>
void set_crossing(const PlaneCrossing& c, Row& row) {
  row.plane = c.plane;
  row.particle = c.particle;
  row.forward = c.forward;
  row.share = c.share;
  copy_vector(c.point, row.point);
}

py::array hits_array(const std::vector<FaceHits>& faces) {
  std::vector<FaceHitsRow> rows;
  rows.reserve(faces.size());
  for (const FaceHits& f : faces) rows.push_back({f.face.cell.value, f.face.face, f.patch.value, f.hits});
  return array_of(std::move(rows));
}

py::array crossings_array(const std::vector<PlaneCrossing>& crossings) {
  std::vector<CrossingRow> rows(crossings.size());
  for (std::size_t i = 0; i < rows.size(); ++i) set_crossing(crossings[i], rows[i]);
  return array_of(std::move(rows));
}

py::array passages_array(const std::vector<PlanePassage>& passages) {
  std::vector<PassageRow> rows(passages.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    set_crossing(passages[i].crossing, rows[i]);
    rows[i].id = passages[i].id;
    rows[i].time = passages[i].time;
    rows[i].age = passages[i].age;
  }
  return array_of(std::move(rows));
}

py::array path_points_array(const std::vector<PathPoint>& points) {
  std::vector<PathPointRow> rows(points.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PathPoint& p = points[i];
    rows[i].id = p.id;
    rows[i].time = p.time;
    copy_vector(p.position, rows[i].position);
    copy_vector(p.velocity, rows[i].velocity);
    rows[i].contact = p.contact;
  }
  return array_of(std::move(rows));
}

/// The hits that faces() gave, from an array with its fields.
std::vector<FaceHits> hits_of(const py::object& faces) {
  const py::array_t<FaceHitsRow> array =
      structured(faces, py::dtype::of<FaceHitsRow>(), "faces", "the array of faces()", "hits.faces()");
  const auto rows = array.unchecked<1>();
  std::vector<FaceHits> found;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const FaceHitsRow& r = rows(i);
    found.push_back({CellFace{Cell{r.cell}, r.face}, Patch{r.patch}, r.hits});
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
      [](WallHits& hits, const EnvironmentHandle& h, const StepReport& report) {
        const Use use(*h.usage, "the environment");
        require_walls(h.environment->map(), report.contacts);
        hits.add(*h.environment, report.contacts);
      },
      py::arg("environment"), py::arg("report"), doc("WallHits::add"));
  c.def(
      "update_after_edit",
      [](WallHits& hits, const EnvironmentHandle& h) {
        const Use use(*h.usage, "the environment");
        hits.update_after_edit(*h.environment);
      },
      py::arg("environment"), doc("WallHits::update_after_edit"));
  c.def("of", &WallHits::of, py::arg("face"), "The hits of one face.");
  c.def(
      "faces", [](const WallHits& hits) { return hits_array(hits.faces()); },
      (std::string(doc("WallHits::faces")) + "\n\nA structured array (cell, face, patch, hits).").c_str());
  c.def(
      "ended_by_patch", [](const WallHits& hits) { return hits.ended_by_patch(); }, doc("WallHits::ended_by_patch"));
  c.def(
      "by_patch",
      [](const WallHits& hits, const EnvironmentHandle& h) {
        const Use use(*h.usage, "the environment");
        return hits.by_patch(*h.environment);
      },
      py::arg("environment"), doc("WallHits::by_patch"));
  c.def(
      "restore",
      [](WallHits& hits, const EnvironmentHandle& h, const py::object& faces, std::vector<std::uint64_t> ended) {
        const Use use(*h.usage, "the environment");
        hits.restore(*h.environment, hits_of(faces), std::move(ended));
      },
      py::arg("environment"), py::arg("faces"), py::arg("ended"), doc("WallHits::restore"));
}

void bind_planes(py::module_& m) {
  Record<SectionPlane>(m, "SectionPlane")
      .field("name", &SectionPlane::name)
      .field("point", &SectionPlane::point)
      .field("normal", &SectionPlane::normal)
      .field("radius", &SectionPlane::radius)
      .finish();
  m.def(
      "find_crossings",
      [](const std::vector<SectionPlane>& planes, const py::object& before, const py::object& after, Threads threads) {
        const auto from = vectors(before, "before");
        const auto to = vectors(after, "after");
        const py::gil_scoped_release release;
        std::vector<PlaneCrossing> found = find_crossings(planes, from, to, threads);
        const py::gil_scoped_acquire acquire;
        return crossings_array(found);
      },
      py::arg("planes"), py::arg("before"), py::arg("after"), py::arg("threads") = 0,
      (std::string(doc("find_crossings")) +
       "\n\nbefore, after: float64 (n, 3). A structured array (plane, particle, forward, share, point).")
          .c_str());
}

void bind_totals(py::module_& m) {
  Record<ResidenceTimes>(m, "ResidenceTimes")
      .field("count", &ResidenceTimes::count)
      .field("sum", &ResidenceTimes::sum)
      .field("least", &ResidenceTimes::least)
      .field("most", &ResidenceTimes::most)
      .field("bin", &ResidenceTimes::bin)
      .field("bins", &ResidenceTimes::bins)
      .finish()
      .def("mean", &ResidenceTimes::mean, "The mean, s; 0 where there is none.")
      .attr("BIN_COUNT") = ResidenceTimes::bin_count;
  Record<StatisticsOptions>(m, "StatisticsOptions")
      .field("hits", &StatisticsOptions::hits)
      .field("residence", &StatisticsOptions::residence)
      .field("planes", &StatisticsOptions::planes)
      .field("pathlines_every", &StatisticsOptions::pathlines_every)
      .field("pathlines_of", &StatisticsOptions::pathlines_of)
      .finish()
      .def("pathlines", &StatisticsOptions::pathlines, "Whether there are pathlines.")
      .def("any", &StatisticsOptions::any, "Whether anything is kept.");
  Record<PlaneTotals>(m, "PlaneTotals")
      .field("forward", &PlaneTotals::forward)
      .field("backward", &PlaneTotals::backward)
      .finish();
  Record<LeaveTotals>(m, "LeaveTotals")
      .field("escaped", &LeaveTotals::escaped)
      .field("absorbed", &LeaveTotals::absorbed)
      .finish();
  py::class_<Statistics>(m, "Statistics", doc("Statistics"))
      .def_property_readonly(
          "hits", [](const Statistics& s) { return std::make_shared<WallHits>(s.hits); }, "A copy.")
      .def_readonly("planes", &Statistics::planes, doc("Statistics::planes"))
      .def_readonly("left", &Statistics::left, doc("Statistics::left"))
      .def_readonly("absorbed_by_edits", &Statistics::absorbed_by_edits, doc("Statistics::absorbed_by_edits"))
      .def_property_readonly(
          "passages", [](const Statistics& s) { return passages_array(s.passages); },
          "Of the last step: a structured array, the fields of find_crossings() and (id, time, age).")
      .def_property_readonly(
          "path_points", [](const Statistics& s) { return path_points_array(s.path_points); },
          "Of the last step, by particle, then by time: a structured array (id, time, position, velocity, contact).")
      .def_readonly("seconds", &Statistics::seconds, doc("Statistics::seconds"));
}

void bind_files(py::module_& m) {
  m.def(
      "write_wall_hits",
      [](const EnvironmentHandle& h, const WallHits& hits, const std::filesystem::path& file) {
        const Use use(*h.usage, "the environment");
        write_wall_hits(*h.environment, hits, file);
      },
      py::arg("environment"), py::arg("hits"), py::arg("file"), doc("write_wall_hits"));
  m.def(
      "write_pathlines",
      [](const py::object& points, const std::filesystem::path& file) {
        write_pathlines(path_points_of(points), file);
      },
      py::arg("points"), py::arg("file"),
      (std::string(doc("write_pathlines")) + "\n\npoints: the arrays Statistics.path_points, concatenated.").c_str());
}

}  // namespace

void bind(py::module_& m) {
  PYBIND11_NUMPY_DTYPE(FaceHitsRow, cell, face, patch, hits);
  PYBIND11_NUMPY_DTYPE(CrossingRow, plane, particle, forward, share, point);
  PYBIND11_NUMPY_DTYPE(PassageRow, plane, particle, forward, share, point, id, time, age);
  PYBIND11_NUMPY_DTYPE(PathPointRow, id, time, position, velocity, contact);
  bind_hits(m);
  bind_planes(m);
  bind_totals(m);
  bind_files(m);
}

}  // namespace dartcast::python::statistics
