// A trajectory as a page.
//
// Phases: the points that are shown; a recording of them in memory, a frame for each, as that of a run; the viewer's data
// from it; the table of all points.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/trajectory.hpp"
#include "output/cells_passed.hpp"
#include "output/wall_faces.hpp"
#include "report/chart.hpp"
#include "report/recorded.hpp"
#include "report/selection.hpp"
#include "report/viewer_page.hpp"

namespace dartcast {

namespace {

constexpr std::size_t most_points = 2000;
constexpr std::size_t most_faces = 200'000;
constexpr std::string_view passed_patch = "cells passed";

struct TrajectoryBox {
  Vec3 low;
  Vec3 high;

  explicit TrajectoryBox(const Vec3& p) : low(p), high(p) {}
  void include(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  [[nodiscard]] bool overlaps(const TrajectoryBox& b) const {
    return low.x <= b.high.x && b.low.x <= high.x && low.y <= b.high.y && b.low.y <= high.y && low.z <= b.high.z &&
           b.low.z <= high.z;
  }
};

// Collects faces and numbers their vertices.
class FaceCollector {
 public:
  FaceCollector(const CellComplex& complex, const RecordedHeader& header) : complex_(complex), header_(header) {
    walls_.offsets = {0};
  }

  void add(CellFace face, std::uint16_t patch) {
    const CellView view = complex_.map().view(face.cell);
    for (const std::uint16_t k : view.shape().corners(face.face)) {
      const Vertex v = view.vertex(k);
      const auto [place, is_new] = number_.try_emplace(v.value, static_cast<std::uint32_t>(walls_.points.size()));
      if (is_new) walls_.points.push_back(recorded(complex_.positions()[v.value], header_));
      walls_.corners.push_back(place->second);
    }
    walls_.offsets.push_back(walls_.corners.size());
    walls_.patches.push_back(patch);
  }
  RecordedWalls& walls() { return walls_; }

 private:
  const CellComplex& complex_;
  const RecordedHeader& header_;
  std::unordered_map<std::uint32_t, std::uint32_t> number_;
  RecordedWalls walls_;
};

TrajectoryBox box_of(const CellComplex& complex, Cell cell) {
  const CellView view = complex.map().view(cell);
  TrajectoryBox box(complex.positions()[view.vertex(0).value]);
  for (std::uint16_t k = 1; k < view.shape().point_count(); ++k) box.include(complex.positions()[view.vertex(k).value]);
  return box;
}

// The walls, and the faces around the cells passed, each of these once: that of the smaller cell.
RecordedWalls faces_of(const CellComplex& complex, std::span<const Cell> passed, const RecordedHeader& header) {
  FaceCollector faces(complex, header);
  const std::vector<CellFace> walls = wall_face_list(complex.map()).faces;
  TrajectoryBox near = box_of(complex, passed.front());
  for (const Cell c : passed) {
    const TrajectoryBox box = box_of(complex, c);
    near.include(box.low);
    near.include(box.high);
  }
  for (const CellFace f : walls) {
    if (walls.size() <= most_faces || near.overlaps(box_of(complex, f.cell)))
      faces.add(f, complex.map().patch(f).value);
  }
  RecordedWalls& out = faces.walls();
  out.patch_names = complex.map().patch_names();
  const auto patch = static_cast<std::uint16_t>(out.patch_names.size());
  out.patch_names.emplace_back(passed_patch);
  for (const Cell c : passed) {
    const CellView view = complex.map().view(c);
    for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
      const Cell other = view.neighbour(f);
      if (!other.valid() || c < other || !std::binary_search(passed.begin(), passed.end(), other))
        faces.add({c, f}, patch);
    }
  }
  return std::move(out);
}

std::string_view article_of(Kind kind) { return kind == Kind::edge ? "an" : "a"; }

std::string text_of(const CombinatorialMap& map, const TrajectoryPoint& p) {
  const std::string cell = fmt::format("cell {}", map.source(p.cell));
  const std::string when = fmt::format("step {}, t = {:.4g}: ", p.step + 1, p.time);
  const std::string place = fmt::format("{} {}", article_of(p.kind), name_of(p.kind));
  switch (p.mark) {
    case TrajectoryMark::start: return fmt::format("start in {}, {}", place, cell);
    case TrajectoryMark::crossing:
      return fmt::format("{}through {}, from {} to cell {}", when, place, cell, map.source(p.next));
    case TrajectoryMark::contact: return fmt::format("{}contact with {}, {}", when, place, cell);
    case TrajectoryMark::target: return fmt::format("{}target, in {}, {}", when, place, cell);
    case TrajectoryMark::end: return fmt::format("{}end in {}, {}", when, place, cell);
  }
  return {};
}

double time_of(const TrajectoryPoint& p) { return static_cast<double>(p.step) + p.time; }

float length_of_step(const Trace& trace) {
  return static_cast<float>(
      std::min<double>(norm(trace.after.position - trace.before.position), std::numeric_limits<float>::max()));
}

std::string recording_of(const CellComplex& complex, std::span<const Trace> traces,
                         std::span<const TrajectoryPoint> points, const RecordedWalls& walls,
                         const RecordedHeader& header) {
  std::string bytes = std::string(recorded_line) + "\n" + chunk_of(header) + chunk_of(walls);
  RecordedContacts contacts;
  for (const Trace& t : traces) {
    const auto step = static_cast<double>(&t - traces.data());
    for (const Contact& c : t.contacts.contacts)
      contacts.contacts.push_back({0, step + c.time_of_impact, recorded(c.point, header),
                                   t.contacts.walls_of(c).front().patch.value, static_cast<std::uint8_t>(c.kind), 0});
  }
  bytes += chunk_of(contacts);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TrajectoryPoint& p = points[i];
    bytes += chunk_of(RecordedEvent{i, time_of(p), text_of(complex.map(), p)});
    RecordedFrame frame;
    frame.step = i;
    frame.time = time_of(p);
    frame.all = 1;
    frame.ids = {0};
    frame.positions = {recorded(p.point, header)};
    frame.speeds = {length_of_step(traces[p.step])};
    frame.kinds = {static_cast<std::uint8_t>(p.kind)};
    bytes += chunk_of(frame);
  }
  return bytes;
}

std::string row_of(std::string_view cell, std::string_view line) {
  std::string row = "<tr>";
  while (true) {
    const std::size_t comma = line.find(',');
    row += fmt::format("<{0}>{1}</{0}>", cell, html(line.substr(0, comma)));
    if (comma == std::string_view::npos) return row + "</tr>\n";
    line.remove_prefix(comma + 1);
  }
}

std::string table_of(std::string_view csv) {
  std::string table = "<section class=\"wide\"><table class=\"trajectory\">\n";
  for (std::size_t rows = 0; !csv.empty() && rows <= most_points; ++rows) {
    const std::size_t end = csv.find('\n');
    table += row_of(rows == 0 ? "th" : "td", csv.substr(0, end));
    csv.remove_prefix(end + 1);
  }
  return table + "</table></section>\n";
}

std::string counted(std::size_t n, std::string_view what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

std::string summary_of(std::span<const Trace> traces) {
  std::size_t crossings = 0;
  std::size_t contacts = 0;
  for (const Trace& t : traces) {
    crossings += t.crossings.size();
    contacts += t.contacts.contacts.size();
  }
  return fmt::format("{}, {}, {}; {}", counted(traces.size(), "step"), counted(crossings, "crossing"),
                     counted(contacts, "contact"), traces.back().result.stopped ? "it stops at a wall" : "it arrives");
}

}  // namespace

std::string trajectory_html(const CellComplex& complex, std::span<const Trace> traces) {
  if (traces.empty()) throw InvalidArgument("there is no trajectory to show: give it one target or more");
  const std::vector<TrajectoryPoint> all = trajectory_points(traces);
  std::vector<TrajectoryPoint> points;
  for (const std::size_t i : evenly(all.size(), most_points)) points.push_back(all[i]);
  RecordedHeader header;
  header.dimension = complex.map().dimension();
  header.every = 1;
  header.origin = points.front().point;
  const RecordedWalls walls = faces_of(complex, cells_passed(all), header);
  const TrajectorySubject subject{walls.patch_names.size() - 1};
  const RecordedFile file("the trajectory", recording_of(complex, traces, points, walls, header));
  ViewerData data = viewer_data(file, {.particles = 1, .frames = most_points}, subject);
  if (points.size() < all.size())
    data.taken.notes.push_back(
        fmt::format("{} of {} points of the way are in the scene, evenly chosen, and the first {} "
                    "in the table; a table in a .csv has all",
                    points.size(), all.size(), most_points));
  return viewer_page({"A trajectory", summary_of(traces), table_of(trajectory_csv(complex.map(), traces))}, data);
}

}  // namespace dartcast
