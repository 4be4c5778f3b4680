// Walks in the plane against an oracle in integers: on lattices, where most of what is decided is degenerate.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "complex/simplex.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/generators.hpp"
#include "mesh/cell_types.hpp"
#include "support/tier.hpp"
#include "tracking/locate.hpp"
#include "tracking/walk.hpp"

namespace dartcast::plane_walk_test {

using Integer = std::int64_t;

// A point with coordinates x / w and y / w.
struct Point {
  Integer x, y, w = 1;
};

Point point_of(const Vec3& v) { return {static_cast<Integer>(v.x), static_cast<Integer>(v.y)}; }

// Sign of the turn a, b, c: a and b have w = 1.
int turn(const Point& a, const Point& b, const Point& c) {
  const Integer value = (b.x - a.x) * (c.y - a.y * c.w) - (b.y - a.y) * (c.x - a.x * c.w);
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

struct Time {
  Integer n, d;  // n / d, d > 0
  friend bool operator<(const Time& a, const Time& b) { return a.n * b.d < b.n * a.d; }
  friend bool operator==(const Time& a, const Time& b) { return a.n * b.d == b.n * a.d; }
};

// The features that a segment of the lattice touches, cell by cell and edge by edge of the mesh itself.
class Oracle {
 public:
  explicit Oracle(const MeshData& mesh) : mesh_(mesh) {
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      for_each_face(mesh, c, [&](std::span<const std::uint32_t> e) {
        auto& [free, all] = edges_[std::minmax(e[0], e[1])];
        ++all;
        free += is_free(c) ? 1 : 0;
      });
    }
  }

  enum class Where { free, wall, blocked };

  // free: strictly inside the union of the closed free cells; blocked: strictly outside of it.
  [[nodiscard]] Where where(const Point& x) const {
    bool in_free = false;
    bool in_blocked = false;
    bool at_border = false;
    for (const auto& [ends, sides] : edges_) {
      if (sides.second == 1 && on_edge(ends, x)) at_border = true;
    }
    for (std::size_t c = 0; c < mesh_.cell_count(); ++c) {
      if (!holds(c, x)) continue;
      (is_free(c) ? in_free : in_blocked) = true;
    }
    if (!in_free) return Where::blocked;
    return in_blocked || at_border ? Where::wall : Where::free;
  }

  // The times at which the segment meets any edge's line between its ends, 0 and 1.
  [[nodiscard]] std::vector<Time> times(const Point& p, const Point& q) const {
    std::vector<Time> all = {{0, 1}, {1, 1}};
    for (const auto& [ends, sides] : edges_) {
      for (const std::uint32_t v : {ends.first, ends.second}) add_vertex(point_of(mesh_.points[v]), p, q, all);
      if (const auto t = crossing(ends, p, q)) all.push_back(*t);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  static Point at(const Point& p, const Point& q, const Time& t) {
    return {p.x * t.d + (q.x - p.x) * t.n, p.y * t.d + (q.y - p.y) * t.n, t.d};
  }
  static Time between(const Time& a, const Time& b) {
    const Time t = {a.n * b.d + b.n * a.d, 2 * a.d * b.d};
    const Integer g = std::gcd(t.n, t.d);
    return {t.n / g, t.d / g};
  }

  // Whether x lies on the closed edge.
  [[nodiscard]] bool on_edge(std::pair<std::uint32_t, std::uint32_t> ends, const Point& x) const {
    const Point a = point_of(mesh_.points[ends.first]);
    const Point b = point_of(mesh_.points[ends.second]);
    if (turn(a, b, x) != 0) return false;
    const auto within = [&](Integer u, Integer v, Integer c) {
      return std::min(u, v) * x.w <= c && c <= std::max(u, v) * x.w;
    };
    return within(a.x, b.x, x.x) && within(a.y, b.y, x.y);
  }

  // Whether free cells meet in x that no edge at x joins: more than two walls do.
  [[nodiscard]] bool is_pinched(const Point& x) const {
    const auto is_at = [&](std::uint32_t v) {
      const Point p = point_of(mesh_.points[v]);
      return p.x == x.x && p.y == x.y;
    };
    return 2 < std::count_if(edges_.begin(), edges_.end(), [&](const auto& edge) {
             const auto& [ends, sides] = edge;
             return sides.first == 1 && (is_at(ends.first) || is_at(ends.second));
           });
  }

  // When the segment meets the closed edge first; nothing where it does not.
  [[nodiscard]] std::optional<Time> meets(std::pair<std::uint32_t, std::uint32_t> ends, const Point& p,
                                          const Point& q) const {
    for (const Time& t : times(p, q)) {
      if (on_edge(ends, at(p, q, t))) return t;
    }
    return {};
  }

 private:
  [[nodiscard]] bool is_free(std::size_t c) const { return mesh_.free.empty() || mesh_.free[c] != 0; }

  [[nodiscard]] bool holds(std::size_t c, const Point& x) const {
    bool inside = true;
    for_each_face(mesh_, c, [&](std::span<const std::uint32_t> e) {
      inside = inside && turn(point_of(mesh_.points[e[0]]), point_of(mesh_.points[e[1]]), x) >= 0;
    });
    return inside;
  }

  static void add_vertex(const Point& v, const Point& p, const Point& q, std::vector<Time>& all) {
    if (turn(p, q, v) != 0) return;
    const Integer dx = q.x - p.x;
    const Integer dy = q.y - p.y;
    const Time t = dx != 0 ? Time{(v.x - p.x) * (dx > 0 ? 1 : -1), std::abs(dx)}
                           : Time{(v.y - p.y) * (dy > 0 ? 1 : -1), std::abs(dy)};
    if (!(t < Time{0, 1}) && !(Time{1, 1} < t)) all.push_back(t);
  }

  [[nodiscard]] std::optional<Time> crossing(std::pair<std::uint32_t, std::uint32_t> ends, const Point& p,
                                             const Point& q) const {
    const Point a = point_of(mesh_.points[ends.first]);
    const Point b = point_of(mesh_.points[ends.second]);
    const Integer before = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    const Integer after = (b.x - a.x) * (q.y - a.y) - (b.y - a.y) * (q.x - a.x);
    if (before == after || (before > 0 && after > 0) || (before < 0 && after < 0)) return {};
    const Integer d = before - after;
    return d > 0 ? Time{before, d} : Time{-before, -d};
  }

  const MeshData& mesh_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges_;  // cells: free, all
};

MeshData lattice(int kind, std::uint64_t seed) {
  RectangleOptions o;
  o.cells = {5, 4};
  o.size = {20, 16};
  o.blocked_share = 0.25;
  o.seed = seed;
  if (kind == 0) o.type = CellType::triangle;
  if (kind == 1) o.type = CellType::quadrilateral;
  o.mixed = kind == 2;
  return generate_rectangle(o);
}

struct Counts {
  int walks = 0;
  int arrived = 0;
  int at_start = 0;
  int at_end = 0;
  int passed = 0;
};

// Compares one particle's walk with the oracle.
void judge(const Oracle& oracle, const CellComplex& complex, const Walk& w, const Vec3& from, const Vec3& to) {
  using Where = Oracle::Where;
  const Point p = point_of(from);
  const Point q = point_of(to);
  const auto times = oracle.times(p, q);
  Time end = {1, 1};
  if (w.end == WalkEnd::wall) {
    const CellView cell = complex.map().view(w.wall_simplex.cell);
    const Across across = cell.shape().simplices()[w.wall_simplex.simplex].across[w.wall_facet];
    ASSERT_TRUE(across.outer() && cell.is_wall(across.face()) && cell.is_free());
    const auto ends = cell.shape().corners(across.face());
    const std::pair wall = {cell.vertex(ends[0]).value, cell.vertex(ends[1]).value};
    if (w.at_end) {  // it may have run along the wall
      EXPECT_TRUE(oracle.on_edge(wall, q));
    } else {
      const auto met = oracle.meets(wall, p, q);
      ASSERT_TRUE(met) << "a wall that the segment does not meet";
      end = *met;
      EXPECT_EQ(w.at_start, end == (Time{0, 1})) << "a start on the wall, and so it says";
    }
    EXPECT_NE(oracle.where(Oracle::at(p, q, end)), Where::free);
    if (w.at_start) {  // along a wall is no contact at the start
      const Where first = oracle.where(Oracle::at(p, q, Oracle::between(times[0], times[1])));
      EXPECT_TRUE(first == Where::blocked || oracle.is_pinched(p));
    }
  } else {
    ASSERT_EQ(w.end, WalkEnd::arrived);
    EXPECT_EQ(oracle.where(q), Where::free) << "an end on a wall is a contact";
  }
  for (std::size_t i = 0; i + 1 < times.size() && times[i] < end; ++i) {
    ASSERT_NE(oracle.where(Oracle::at(p, q, Oracle::between(times[i], times[i + 1]))), Where::blocked)
        << "passed through a wall";
  }
}

class PlaneWalks : public testing::TestWithParam<int> {};

TEST_P(PlaneWalks, AreRightOnLattices) {
  Counts counts;
  const int seeds = std::max(1, test::scaled(10, 500));
  for (int seed = 1; seed <= seeds; ++seed) {
    const MeshData mesh = lattice(GetParam(), static_cast<std::uint64_t>(seed));
    const Oracle oracle(mesh);
    const CellComplex complex(mesh);
    ASSERT_TRUE(complex.invalid_cells().empty());
    const Locator locator(complex);
    const Space<Stored, 3> space = current_space<3>(complex);
    Random random(static_cast<std::uint64_t>(seed));
    const auto draw = [&] {
      return Vec3{static_cast<double>(random.below(21)), static_cast<double>(random.below(17)), 0.0};
    };
    Vec3 p;
    SimplexId at;
    for (int i = 0; i < 400; ++i) {
      if (i % 50 == 0) {
        Location location;
        while ((location = locator.locate(complex, p = draw())).place != Place::free) continue;
        at = location.simplex;
      }
      // Short steps and long ones; half of them along a line of the lattice.
      Vec3 q = draw();
      if (i % 3 == 0) q = p + Vec3{random.below(5) - 2.0, random.below(5) - 2.0, 0.0};
      if (i % 4 == 1) (random.below(2) == 0 ? q.x : q.y) = random.below(2) == 0 ? p.x : q.y;
      if (q == p) continue;
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", walk " << i << ": (" << p.x << ", " << p.y << ") to ("
                                      << q.x << ", " << q.y << ")");
      TestCounts tests;
      const Walk w = walk(space, at, p, q, tests);
      ASSERT_NO_FATAL_FAILURE(judge(oracle, complex, w, p, q));
      ASSERT_FALSE(HasFailure());
      ++counts.walks;
      counts.arrived += w.end == WalkEnd::arrived ? 1 : 0;
      counts.at_start += w.at_start ? 1 : 0;
      counts.at_end += w.at_end ? 1 : 0;
      if (w.end == WalkEnd::arrived || w.at_end) {
        at = w.simplex;
        p = q;
        const auto corners = space.corners(at);
        for (unsigned f = 0; f < 3; ++f) ASSERT_NE(orient_facet(corners, f, p), Sign::negative);
        ASSERT_TRUE(complex.map().is_free(at.cell));
      }
    }
  }
  EXPECT_GT(counts.arrived, counts.walks / 5);
  EXPECT_GT(counts.at_start, counts.walks / 50);
  EXPECT_GT(counts.at_end, counts.walks / 50);
}

INSTANTIATE_TEST_SUITE_P(Meshes, PlaneWalks, testing::Values(0, 1, 2));

}  // namespace dartcast::plane_walk_test
