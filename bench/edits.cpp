#include "bench/edits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/random.hpp"
#include "bench/timing.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/validity.hpp"
#include "simulation/seeding.hpp"

namespace dartcast::bench {

namespace {

Environment box(std::uint32_t edge) {
  BoxOptions o;
  o.cells = {edge, edge, edge};
  o.size = {double(edge), double(edge), double(edge)};
  o.blocked_share = 0.1;
  return Environment(generate_box(o), Threads{1});
}

// Edits in pairs, of which the second undoes the first.
class Editor {
 public:
  Editor(Environment& environment, Particles& particles, EditRow& row, std::uint64_t seed)
      : environment_(environment), particles_(particles), row_(row), random_(seed) {}

  void edit_pair(unsigned kind) {
    const Cell c = random_cell();
    const Shape& s = map().shape(c);
    const Dart d{c, static_cast<std::uint16_t>(random_.below(s.dart_count()))};
    if (kind == 0) on_edge(d);
    if (kind == 1) on_face(d);
    if (kind == 2) on_cells(map().face(d));
    if (kind == 3) mark(c);
  }

 private:
  [[nodiscard]] const CombinatorialMap& map() const { return environment_.map(); }

  // One that no edit has left a polyhedron.
  Cell random_cell() {
    while (true) {
      const Cell c(static_cast<std::uint32_t>(CellType::hexahedron),
                   random_.below(static_cast<std::uint32_t>(map().slot_count(1))));
      if (map().contains(c)) return c;
    }
  }

  void edit(const std::function<void(Transaction&)>& make) {
    commit(make);
    follow();
  }

  void commit(const std::function<void(Transaction&)>& make) {
    environment_.edit([&](ComplexEdit& e) { make(e.topology()); });
  }

  void follow() {
    const EditReport& done = environment_.last_edit().map;
    row_.particles_touched += static_cast<double>(environment_.update_after_edit(particles_).touched);
    row_.cells_touched += static_cast<double>(done.removed.size() + done.added.size() + done.marked.size());
    ++row_.edits;
  }

  void on_edge(Dart d) {
    const Vertex from = map().origin(d);
    Vertex middle;
    const auto start = Clock::now();
    commit([&](Transaction& t) { middle = split_edge(t, d).vertex; });
    row_.split_seconds += seconds_since(start);
    ++row_.splits;
    follow();
    find(middle, from, [&](Dart found) { edit([&](Transaction& t) { merge_edges(t, found); }); });
  }

  void on_face(Dart d) {
    const Dart other = map().phi1(map().phi1(d));
    const Vertex a = map().origin(d);
    const Vertex b = map().origin(other);
    edit([&](Transaction& t) { split_face(t, d, other); });
    find(a, b, [&](Dart found) { edit([&](Transaction& t) { merge_faces(t, found); }); });
  }

  // The cube is made again by cutting along the face's edges.
  void on_cells(CellFace f) {
    const CellFace g = map().opposite(f);
    if (!g.valid() || map().is_free(f.cell) != map().is_free(g.cell)) return;
    std::vector<Vertex> rim;
    for (const std::uint16_t k : map().shape(f.cell).corners(f.face)) rim.push_back(map().view(f.cell).vertex(k));
    edit([&](Transaction& t) { merge_cells(t, f); });
    const Cell now = last_added();
    edit([&](Transaction& t) {
      std::vector<Dart> path;
      for (std::size_t i = 0; i < rim.size(); ++i)
        path.push_back(find_dart(t.map(), now, rim[i], rim[(i + 1) % rim.size()]));
      split_cell(t, path);
    });
  }

  void mark(Cell c) {
    const bool free = map().is_free(c);
    edit([&](Transaction& t) { t.set_free(c, !free); });
    edit([&](Transaction& t) { t.set_free(c, free); });
  }

  [[nodiscard]] Cell last_added() const { return environment_.last_edit().map.added.back(); }

  // Calls use(dart) with a dart from one vertex to another, of a cell that the last edit added.
  void find(Vertex from, Vertex to, const std::function<void(Dart)>& use) const {
    for (const Cell c : environment_.last_edit().map.added) {
      const Dart d = find_dart(map(), c, from, to);
      if (d.valid()) return use(d);
    }
  }

  Environment& environment_;
  Particles& particles_;
  EditRow& row_;
  Random random_;
};

// Edits until a tenth of the cells may have been touched. A face that was split and merged keeps a Steiner point.
double edit_some(std::uint32_t edge, std::size_t count, EditRow& row) {
  Environment environment = box(edge);
  KeyedRandom random(2, RandomPurpose::place, 0);
  const VolumeSampler sampler(environment.complex());
  Particles set;
  while (set.size() < row.particles) {
    const Sample s = *sampler.sample(environment.complex(), random);
    environment.add(set, s.simplex, s.position);
  }
  row.cells = environment.map().cell_count();
  EditRow warm;
  Editor(environment, set, warm, 0).edit_pair(0);
  const std::size_t end = row.edits + std::min(count, row.cells / 40);
  Editor editor(environment, set, row, row.edits + 1);
  const auto start = Clock::now();
  for (unsigned kind = 0; row.edits < end; kind = (kind + 1) % 4) editor.edit_pair(kind);
  const double seconds = seconds_since(start);
  for (int i = 0; i < 3; ++i) {
    const auto begin = Clock::now();
    if (!environment.validity().valid()) throw InternalError("bench: an edit left a cell that is not valid");
    row.validity_ns_per_cell =
        std::min(row.validity_ns_per_cell, seconds_since(begin) * 1e9 / static_cast<double>(row.cells));
  }
  return seconds;
}

}  // namespace

EditRow edit_box(std::uint32_t edge, std::size_t particles, std::size_t edits) {
  EditRow row;
  row.particles = particles;
  row.validity_ns_per_cell = std::numeric_limits<double>::max();
  double seconds = 0.0;
  while (row.edits < edits) seconds += edit_some(edge, edits - row.edits, row);
  row.edits_per_second = static_cast<double>(row.edits) / seconds;
  row.splits_per_second = static_cast<double>(row.splits) / row.split_seconds;
  row.cells_touched /= static_cast<double>(row.edits);
  row.particles_touched /= static_cast<double>(row.edits);
  return row;
}

std::string edits_text(std::span<const EditRow> rows) {
  std::string out;
  for (const EditRow& r : rows) {
    out += fmt::format(
        "{} cells, {} particles: {:.0f} edits a second, each touching {:.1f} cells and {:.1f} particles; "
        "{:.0f} splits of an edge a second without particles; "
        "validity of the scene: {:.1f} ns a cell\n",
        r.cells, r.particles, r.edits_per_second, r.cells_touched, r.particles_touched, r.splits_per_second,
        r.validity_ns_per_cell);
  }
  return out;
}

std::string edits_json(std::span<const EditRow> rows) {
  nlohmann::ordered_json json = {{"version", DARTCAST_VERSION}, {"edits", nlohmann::ordered_json::array()}};
  for (const EditRow& r : rows) {
    json["edits"].push_back({{"cells", r.cells},
                             {"particles", r.particles},
                             {"edits", r.edits},
                             {"edits_per_second", r.edits_per_second},
                             {"splits_per_second", r.splits_per_second},
                             {"cells_touched", r.cells_touched},
                             {"particles_touched", r.particles_touched},
                             {"validity_ns_per_cell", r.validity_ns_per_cell}});
  }
  return json.dump(1);
}

}  // namespace dartcast::bench
