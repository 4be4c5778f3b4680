// Edges among walls. For each scene: edges at free places, steps of them through cells, and the same by a tree.
#include "bench/solids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/random.hpp"
#include "bench/timing.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/solids.hpp"
#include "predicates/moving_pair.hpp"
#include "solids/element_touches.hpp"

namespace dartcast::bench {

namespace {

using Clock = std::chrono::steady_clock;
using detail::MovingPair;
using detail::PairKind;

constexpr std::size_t edge_count = 1000;
constexpr int timed_steps = 15;

double microseconds_since(Clock::time_point start) { return 1e6 * seconds_since(start); }

Vec3 random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

// The walls of all free cells, and which corner's edge a wall tests for all that share it.
struct SweptWalls {
  std::vector<std::array<std::uint32_t, 3>> vertices;
  std::vector<std::uint8_t> own_edges;
  std::vector<MovingTriangle> now;

  explicit SweptWalls(const CellComplex& complex) {
    std::vector<std::array<std::uint32_t, 4>> edges;  // vertices, wall, corner
    for (const Cell c : complex.map().cells()) {
      const CellView cell = complex.map().view(c);
      for (std::uint16_t f = 0; cell.is_free() && f < cell.shape().face_count(); ++f) {
        for (std::uint16_t t = 0; cell.is_wall(f) && t < cell.shape().triangle_count(f); ++t) {
          const auto local = cell.shape().triangle(f, t);
          const auto w = static_cast<std::uint32_t>(vertices.size());
          vertices.push_back({cell.vertex(local[0]).value, cell.vertex(local[1]).value, cell.vertex(local[2]).value});
          for (std::uint32_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(vertices[w][k], vertices[w][(k + 1) % 3]);
            edges.push_back({a, b, w, k});
          }
        }
      }
    }
    std::sort(edges.begin(), edges.end());
    own_edges.resize(vertices.size());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const bool first = i == 0 || edges[i][0] != edges[i - 1][0] || edges[i][1] != edges[i - 1][1];
      if (first) own_edges[edges[i][2]] = static_cast<std::uint8_t>(own_edges[edges[i][2]] | (1U << edges[i][3]));
    }
    now.resize(vertices.size());
  }
  void move(std::span<const Vec3> before, std::span<const Vec3> after) {
    for (std::size_t w = 0; w < now.size(); ++w) {
      for (std::size_t i = 0; i < 3; ++i) {
        now[w].from[i] = before[vertices[w][i]];
        now[w].to[i] = after[vertices[w][i]];
      }
    }
  }
};

// The first touch of an edge and one wall, each edge of walls once.
void touch(const std::array<Vec3, 2>& from, const std::array<Vec3, 2>& to, const MovingTriangle& w, unsigned own_edges,
           std::optional<double>& first) {
  const auto ask = [&](const MovingPair& pair, PairKind kind) {
    const auto time = detail::first_touch(pair, kind);
    if (time && (!first || *time < *first)) first = time;
  };
  for (unsigned i = 0; i < 2; ++i)
    ask({{from[i], w.from[0], w.from[1], w.from[2]}, {to[i], w.to[0], w.to[1], w.to[2]}}, PairKind::vertex_face);
  for (unsigned k = 0; k < 3; ++k) {
    const unsigned l = (k + 1) % 3;
    if (((own_edges >> k) & 1U) != 0)
      ask({{from[0], from[1], w.from[k], w.from[l]}, {to[0], to[1], w.to[k], w.to[l]}}, PairKind::edge_edge);
  }
}

using FirstTouches = std::vector<std::optional<double>>;  // of each edge

class EdgeBench {
 public:
  EdgeBench(std::size_t across, bool moving)
      : environment_(box(across), Threads{1}),
        solids_(environment_),
        walls_(environment_.complex()),
        random_(3),
        moving_(moving) {
    const auto size = static_cast<double>(across);
    while (solids_.size() < edge_count) {
      const Vec3 a = {random_.uniform(0, size), random_.uniform(0, size), random_.uniform(0, size)};
      const Vec3 way = random_vector(random_, 1.0);
      if (norm(way) > 0.0) solids_.add(solid_of_polyline(std::vector<Vec3>{a, a + way * (1.0 / norm(way))}));
    }
    before_.assign(environment_.complex().positions().begin(), environment_.complex().positions().end());
  }

  // Through cells. Keeps the first touches of all steps.
  void time_cells(SolidRow& row) {
    std::vector<double> search, step;
    for (int s = 0; s < timed_steps; ++s) {
      set_step(s);
      search.push_back(search_edges());
      firsts.push_back(first_);
      const auto start = Clock::now();
      if (!moving_) solids_.advance(to_);
      step.push_back(microseconds_since(start) / edge_count);
    }
    row.cells = environment_.map().cell_count();
    row.search_us = median(search);
    row.step_us = moving_ ? 0.0 : median(step);
    row.walls = walls_reached_ / static_cast<double>(timed_steps * edge_count);
    row.pairs = static_cast<double>(finder_.pairs()) / static_cast<double>(timed_steps * edge_count);
  }

  // The same steps by a tree. `expected`: the first touches of all of them.
  void time_tree(SweptTree& tree, const std::vector<FirstTouches>& expected, SolidRow& row) {
    std::vector<double> whole, refit;
    for (int s = 0; s < timed_steps; ++s) {
      set_step(s);
      walls_.move(before_, after_);
      const auto start = Clock::now();
      if (moving_ || s == 0) tree.fit(walls_.now);
      refit.push_back(microseconds_since(start) / edge_count);
      whole.push_back(refit.back() + search_tree(tree));
      for (std::size_t i = 0; i < edge_count; ++i)
        row.unlike += first_[i] != expected[static_cast<std::size_t>(s)][i] ? 1 : 0;
      if (!moving_) solids_.advance(to_);
    }
    row.tree_us = median(whole);
    row.refit_us = median(refit);
  }

  std::vector<FirstTouches> firsts;

 private:
  static MeshData box(std::size_t across) {
    BoxOptions o;
    const auto n = static_cast<std::uint32_t>(across);
    o.cells = {n, n, n};
    o.size = {double(n), double(n), double(n)};
    o.blocked_share = 0.1;
    o.jitter = 0.1;
    return generate_box(o);
  }
  // Edges move by a tenth of a cell; walls by a wave.
  void set_step(int s) {
    to_.assign(solids_.positions().begin(), solids_.positions().end());
    for (std::size_t i = 0; i < edge_count; ++i) {
      const Vec3 way = random_vector(random_, 0.06);
      for (std::size_t k = 2 * i; k < 2 * i + 2; ++k) to_[k] += way + random_vector(random_, 0.02);
    }
    after_ = before_;
    if (!moving_) return;
    for (Vec3& p : after_)
      p += Vec3{0.05 * std::sin(0.7 * p.y + s), 0.05 * std::sin(0.7 * p.z + s), 0.05 * std::sin(0.7 * p.x)};
    environment_.complex().steiner_weights().compute(after_);
  }
  [[nodiscard]] VertexMotion wall_motion() const {
    return moving_ ? VertexMotion{before_, after_} : VertexMotion{before_, before_};
  }
  double search_edges() {
    first_.assign(edge_count, std::nullopt);
    const SolidMotion motion = {solids_.positions(), to_};
    std::vector<ElementTouch> touches;
    const auto start = Clock::now();
    const auto cell_of = [&](std::size_t i) { return solids_.particles()[2 * i].cell; };
    for (std::uint32_t i = 0; i < edge_count; ++i) {
      if (i + 2 < edge_count) prefetch_record(environment_.complex(), cell_of(i + 2));  // as SolidSet does
      if (i + 1 < edge_count) prefetch_cell(environment_.complex(), cell_of(i + 1), wall_motion());
      touches.clear();
      const SolidElement edge = {{2 * i, 2 * i + 1, 2 * i + 1}, 2, 3, 1};
      finder_.find_touches(environment_.complex(), cell_of(i), edge, motion, wall_motion(), touches);
      walls_reached_ += static_cast<double>(finder_.walls().size());
      for (const ElementTouch& t : touches) first_[i] = std::min(first_[i].value_or(2.0), t.time);
    }
    return microseconds_since(start) / edge_count;
  }
  double search_tree(SweptTree& tree) {
    first_.assign(edge_count, std::nullopt);
    const auto x = solids_.positions();
    const auto start = Clock::now();
    for (std::size_t i = 0; i < edge_count; ++i) {
      const std::array<Vec3, 2> from = {x[2 * i], x[2 * i + 1]};
      const std::array<Vec3, 2> to = {to_[2 * i], to_[2 * i + 1]};
      const auto least = [&](double Vec3::*k) { return std::min({from[0].*k, from[1].*k, to[0].*k, to[1].*k}); };
      const auto most = [&](double Vec3::*k) { return std::max({from[0].*k, from[1].*k, to[0].*k, to[1].*k}); };
      std::optional<double> first;
      for (const std::size_t w : tree.query({least(&Vec3::x), least(&Vec3::y), least(&Vec3::z)},
                                            {most(&Vec3::x), most(&Vec3::y), most(&Vec3::z)}))
        touch(from, to, walls_.now[w], walls_.own_edges[w], first);
      first_[i] = first;
    }
    return microseconds_since(start) / edge_count;
  }

  Environment environment_;
  SolidSet solids_;
  SweptWalls walls_;
  Random random_;
  TouchFinder finder_;
  bool moving_;
  double walls_reached_ = 0.0;
  AlignedVector<Vec3> before_, after_;  // in large pages, as those of the complex
  std::vector<Vec3> to_;
  FirstTouches first_;
};

}  // namespace

#ifndef DARTCAST_BENCH_BULLET
std::unique_ptr<SweptTree> make_swept_tree() { return nullptr; }
#endif

PairTimes time_pairs() {
  Random random(1);
  std::vector<std::pair<MovingPair, PairKind>> pairs;
  for (int i = 0; i < 20000; ++i) {
    MovingPair pair;
    for (unsigned k = 0; k < 4; ++k) {
      pair.from[k] = random_vector(random, 1.0);
      pair.to[k] = pair.from[k] + random_vector(random, 0.3);
    }
    pairs.emplace_back(pair, i % 2 == 0 ? PairKind::vertex_face : PairKind::edge_edge);
  }
  PairTimes times;
  std::size_t open = 0;
  const auto start = Clock::now();
  for (const auto& [pair, kind] : pairs)
    open += detail::filtered_touch(pair, kind).answer == detail::FilterAnswer::undecided ? 1 : 0;
  times.filter_ns = 1e3 * microseconds_since(start) / static_cast<double>(pairs.size());
  times.undecided = static_cast<double>(open) / static_cast<double>(pairs.size());
  constexpr std::size_t exact_count = 2000;
  std::size_t touching = 0;
  const auto start_exact = Clock::now();
  for (std::size_t i = 0; i < exact_count; ++i)
    touching += detail::exact_touch(pairs[i].first, pairs[i].second) ? 1 : 0;
  times.exact_ns = touching > 0 ? 1e3 * microseconds_since(start_exact) / exact_count : 0.0;
  return times;
}

// One after the other, so that neither finds its data thrown out of the caches by the other.
SolidRow time_edges(std::size_t across, bool moving) {
  SolidRow row;
  row.moving = moving;
  row.edges = edge_count;
  EdgeBench ours(across, moving);
  ours.time_cells(row);
  if (const auto tree = make_swept_tree()) EdgeBench(across, moving).time_tree(*tree, ours.firsts, row);
  return row;
}

std::string solids_text(const PairTimes& pairs, std::span<const SolidRow> rows) {
  std::string out = fmt::format("random pairs: the filter takes {:.0f} ns and leaves {:.2g}, integers take {:.0f} ns\n",
                                pairs.filter_ns, pairs.undecided, pairs.exact_ns);
  for (const SolidRow& r : rows) {
    out += fmt::format("{} cells{}: {} edges, us for each: search {:.2f} ({:.1f} walls, {:.0f} pairs)", r.cells,
                       r.moving ? ", moving" : "", r.edges, r.search_us, r.walls, r.pairs);
    if (r.step_us > 0.0) out += fmt::format(", a whole step {:.2f}", r.step_us);
    if (r.tree_us > 0.0)
      out += fmt::format("; by a tree {:.2f} ({:.2f} of them the refit), {:.1f} times ours, {} unlike", r.tree_us,
                         r.refit_us, r.tree_us / r.search_us, r.unlike);
    out += "\n";
  }
  return out;
}

std::string solids_json(const PairTimes& pairs, std::span<const SolidRow> rows) {
  nlohmann::ordered_json json = {
      {"version", DARTCAST_VERSION},
      {"pairs", {{"filter_ns", pairs.filter_ns}, {"exact_ns", pairs.exact_ns}, {"undecided", pairs.undecided}}},
      {"solids", nlohmann::ordered_json::array()}};
  for (const SolidRow& r : rows) {
    json["solids"].push_back({{"cells", r.cells},
                              {"moving", r.moving},
                              {"edges", r.edges},
                              {"search_us", r.search_us},
                              {"step_us", r.step_us},
                              {"walls_per_edge", r.walls},
                              {"pairs_per_edge", r.pairs},
                              {"tree_us", r.tree_us},
                              {"refit_us", r.refit_us},
                              {"unlike", r.unlike}});
  }
  return json.dump(1);
}

}  // namespace dartcast::bench
