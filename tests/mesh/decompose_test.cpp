// Decompositions against exact areas, exact turns and a ray test that share no code with the library; refusals against
// a look at all pairs of edges.
#include "dartcast/decompose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "support/drawings.hpp"
#include "support/dyadic.hpp"
#include "support/tier.hpp"

namespace dartcast::decompose_test {

using test::Dyadic;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge reversed(const Edge& e) { return {e.second, e.first}; }

Dyadic cross_of(const Vec3& a, const Vec3& b) { return Dyadic(a.x) * Dyadic(b.y) - Dyadic(a.y) * Dyadic(b.x); }

/// Twice the area, counterclockwise.
Dyadic shoelace(std::span<const Vec3> p) {
  Dyadic sum;
  for (std::size_t i = 0; i < p.size(); ++i) sum = sum + cross_of(p[i], p[(i + 1) % p.size()]);
  return sum;
}

int turn(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (cross_of(a, b) + cross_of(b, c) + cross_of(c, a)).sign();
}

/// Whether (x, y) / scale is on the inside of the rings, by a ray to the right that starts an infinitesimal step above.
bool even_odd(std::span<const Ring> rings, const Dyadic& x, const Dyadic& y, const Dyadic& scale) {
  bool inside = false;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.points.size(); ++i) {
      const Vec3& a = ring.points[i];
      const Vec3& b = ring.points[(i + 1) % ring.points.size()];
      const Dyadic below_a = y - scale * Dyadic(a.y);
      const Dyadic below_b = y - scale * Dyadic(b.y);
      const bool up = below_a.sign() >= 0;
      if (up == (below_b.sign() >= 0)) continue;
      const Dyadic left =
          (x - scale * Dyadic(a.x)) * (Dyadic(b.y) - Dyadic(a.y)) - below_a * (Dyadic(b.x) - Dyadic(a.x));
      if ((left.sign() < 0) == up) inside = !inside;
    }
  }
  return inside;
}

/// Twice the area inside, by even-odd: a ring within an odd number of others takes away.
Dyadic even_odd_area(std::span<const Ring> rings) {
  Dyadic sum;
  std::vector<Ring> others;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    others.assign(rings.begin(), rings.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(r));
    const Vec3& p = rings[r].points[0];
    const Dyadic area = shoelace(rings[r].points).abs();
    sum = even_odd(others, Dyadic(p.x), Dyadic(p.y), Dyadic(1.0)) ? sum - area : sum + area;
  }
  return sum;
}

std::vector<Vec3> corners_of(const MeshData& mesh, std::size_t c) {
  std::vector<Vec3> corners;
  for (const std::uint32_t v : mesh.cell(c)) corners.push_back(mesh.points.at(v));
  return corners;
}

std::map<Edge, std::size_t> edges_of(const MeshData& mesh) {
  std::map<Edge, std::size_t> edges;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto cell = mesh.cell(c);
    for (std::size_t k = 0; k < cell.size(); ++k) {
      EXPECT_TRUE(edges.try_emplace({cell[k], cell[(k + 1) % cell.size()]}, c).second) << "cells overlap at " << c;
    }
  }
  return edges;
}

void expect_cells_are_convex(const MeshData& mesh, std::uint32_t max_corners) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto p = corners_of(mesh, c);
    const std::size_t n = p.size();
    ASSERT_GE(n, 3U);
    ASSERT_LE(n, max_corners);
    EXPECT_EQ(mesh.types[c], n == 3 ? CellType::triangle : n == 4 ? CellType::quadrilateral : CellType::polygon);
    const auto cell = mesh.cell(c);
    EXPECT_EQ(*std::min_element(cell.begin(), cell.end()), cell[0]);
    for (std::size_t k = 0; k < n; ++k) EXPECT_GT(turn(p[k], p[(k + 1) % n], p[(k + 2) % n]), 0) << "cell " << c;
    for (std::size_t k = 1; k + 1 < n; ++k) EXPECT_GT(turn(p[0], p[k], p[k + 1]), 0) << "cell " << c;
  }
}

/// Each edge has a cell on either side, but for those of the outline; edges of rings are there, in one direction at
/// least, between an inside and an outside; no other edge could have been left out.
void expect_conforming(std::span<const Ring> rings, const MeshData& mesh, const DecomposeOptions& options) {
  const auto edges = edges_of(mesh);
  std::set<Edge> drawn;
  std::uint32_t first = 0;
  for (const Ring& ring : rings) {
    const auto n = static_cast<std::uint32_t>(ring.points.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      drawn.insert({first + i, first + (i + 1) % n});
      drawn.insert({first + (i + 1) % n, first + i});
    }
    first += n;
  }
  std::size_t found = 0;
  std::size_t outline = 0;
  const auto side_of = [&](std::size_t c, std::uint32_t v, std::size_t step) {
    const auto cell = mesh.cell(c);
    const auto at = static_cast<std::size_t>(std::find(cell.begin(), cell.end(), v) - cell.begin());
    return mesh.points[cell[(at + step) % cell.size()]];
  };
  for (const auto& [edge, cell] : edges) {
    const auto other = edges.find(reversed(edge));
    const bool is_drawn = drawn.contains(edge);
    if (is_drawn && (other == edges.end() || edge.first < edge.second)) ++found;
    if (other == edges.end()) {
      ++outline;
      EXPECT_EQ(options.with_outside, !is_drawn);
      EXPECT_EQ(options.with_outside, edge.first >= first && edge.second >= first);
      continue;
    }
    EXPECT_EQ(mesh.free[cell] != mesh.free[other->second], is_drawn);
    const std::size_t corners = mesh.cell(cell).size() + mesh.cell(other->second).size() - 2;
    if (is_drawn || corners > options.max_corners) continue;
    const auto before = [&](std::size_t c, std::uint32_t v) { return side_of(c, v, mesh.cell(c).size() - 1); };
    const auto after = [&](std::size_t c, std::uint32_t v) { return side_of(c, v, 1); };
    const auto& [u, v] = edge;
    EXPECT_TRUE(turn(before(cell, u), mesh.points[u], after(other->second, u)) <= 0 ||
                turn(before(other->second, v), mesh.points[v], after(cell, v)) <= 0)
        << "the edge from " << u << " to " << v << " could have been left out";
  }
  EXPECT_EQ(found, drawn.size() / 2);
  EXPECT_EQ(outline, options.with_outside ? 4 : drawn.size() / 2);
}

void expect_areas(std::span<const Ring> rings, const MeshData& mesh, const DecomposeOptions& options) {
  Dyadic free;
  Dyadic blocked;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    Dyadic& sum = mesh.free[c] != 0 ? free : blocked;
    sum = sum + shoelace(corners_of(mesh, c));
  }
  EXPECT_TRUE(free == even_odd_area(rings));
  if (!options.with_outside) {
    EXPECT_EQ(blocked.sign(), 0);
    return;
  }
  EXPECT_TRUE(free + blocked == shoelace(std::span(mesh.points).last(4)));
}

void expect_marks(std::span<const Ring> rings, const MeshData& mesh, const DecomposeOptions& options) {
  ASSERT_EQ(mesh.free.size(), mesh.cell_count());
  ASSERT_EQ(mesh.regions.size(), mesh.cell_count());
  std::map<std::int32_t, std::string> names = {{1, "inside"}};
  if (options.with_outside) names[2] = "outside";
  EXPECT_EQ(mesh.region_names, names);
  EXPECT_TRUE(std::is_sorted(mesh.free.rbegin(), mesh.free.rend()));
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) EXPECT_EQ(mesh.regions[c], mesh.free[c] != 0 ? 1 : 2);
  const std::size_t step = 1 + mesh.cell_count() / 20;
  for (std::size_t c = 0; c < mesh.cell_count(); c += step) {
    const auto p = corners_of(mesh, c);
    const Dyadic x = Dyadic(p[0].x) + Dyadic(p[1].x) + Dyadic(p[2].x);
    const Dyadic y = Dyadic(p[0].y) + Dyadic(p[1].y) + Dyadic(p[2].y);
    EXPECT_EQ(even_odd(rings, x, y, Dyadic(3.0)), mesh.free[c] != 0) << "cell " << c;
  }
}

void expect_patches(std::span<const Ring> rings, const MeshData& mesh) {
  std::map<std::string, std::vector<std::uint32_t>> wanted;
  std::uint32_t first = 0;
  for (const Ring& ring : rings) {
    const auto n = static_cast<std::uint32_t>(ring.points.size());
    for (std::uint32_t i = 0; i < n && !ring.name.empty(); ++i) {
      wanted[ring.name].insert(wanted[ring.name].end(), {first + i, first + (i + 1) % n});
    }
    first += n;
  }
  std::map<std::string, std::vector<std::uint32_t>> found;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    ASSERT_EQ(mesh.patch_offsets[f + 1], 2 * f + 2);
    auto& list = found[mesh.patch_names.at(mesh.patch_tags[f])];
    list.insert(list.end(), {mesh.patch_faces[2 * f], mesh.patch_faces[2 * f + 1]});
  }
  EXPECT_EQ(found, wanted);
}

MeshData expect_decomposed(std::span<const Ring> rings, const DecomposeOptions& options = {}) {
  MeshData mesh = decompose(rings, options);
  std::vector<Vec3> points;
  for (const Ring& ring : rings) points.insert(points.end(), ring.points.begin(), ring.points.end());
  EXPECT_EQ(mesh.points.size(), points.size() + (options.with_outside ? 4 : 0));
  EXPECT_TRUE(std::equal(points.begin(), points.end(), mesh.points.begin()));
  expect_cells_are_convex(mesh, options.max_corners);
  expect_conforming(rings, mesh, options);
  expect_areas(rings, mesh, options);
  expect_marks(rings, mesh, options);
  expect_patches(rings, mesh);
  return mesh;
}

std::size_t triangle_count(std::span<const Ring> rings) {
  DecomposeOptions options;
  options.max_corners = 3;
  return decompose(rings, options).cell_count();
}

TEST(Decompose, ASquareIsOneCellInAFrame) {
  const std::vector<Ring> square = {{{{0, 0, 0}, {0, 2, 0}, {2, 2, 0}, {2, 0, 0}}, "wall"}};
  const MeshData mesh = expect_decomposed(square);
  EXPECT_EQ(std::count(mesh.free.begin(), mesh.free.end(), 1), 1);
  EXPECT_EQ(mesh.types[0], CellType::quadrilateral);
  EXPECT_EQ(mesh.points[4], (Vec3{-0.2, -0.2, 0}));
  EXPECT_EQ(mesh.points[6], (Vec3{2.2, 2.2, 0}));
  EXPECT_EQ(mesh.patch_tags.size(), 4U);
  const MeshData alone = expect_decomposed(square, {.with_outside = false});
  EXPECT_EQ(alone.cell_count(), 1U);
}

TEST(Decompose, ARegularPolygonIsOneCellUpToItsCorners) {
  Ring ring;
  for (int i = 0; i < 100; ++i) {
    ring.points.push_back({std::cos(std::numbers::pi * i / 50), std::sin(std::numbers::pi * i / 50), 0});
  }
  const std::vector<Ring> rings = {ring};
  EXPECT_EQ(expect_decomposed(rings, {.with_outside = false}).cell_count(), 1U);
  EXPECT_EQ(expect_decomposed(rings, {.with_outside = false, .max_corners = 3}).cell_count(), 98U);
  EXPECT_GE(expect_decomposed(rings, {.with_outside = false, .max_corners = 10}).cell_count(), 13U);
}

TEST(Decompose, StarsWithHolesAndIslands) {
  Random random(1);
  for (int i = 0; i < test::scaled(20, 200); ++i) {
    const auto rings = test::star_with_holes(random, 9 + static_cast<int>(random.below(60)));
    const MeshData mesh = expect_decomposed(rings);
    EXPECT_LT(4 * mesh.cell_count(), 3 * triangle_count(rings));
    expect_decomposed(rings, {.with_outside = false});
    expect_decomposed(rings, {.margin = 10, .max_corners = 3 + random.below(4)});
    if (testing::Test::HasFailure()) FAIL() << "drawing " << i;
  }
}

TEST(Decompose, CombsOfLatticePoints) {
  Random random(2);
  for (int i = 0; i < test::scaled(20, 200); ++i) {
    for (const bool all : {false, true}) {
      const std::vector<Ring> rings = {test::comb(random, 2 + i % 9, 1 + i % 13, all)};
      const MeshData mesh = expect_decomposed(rings);
      EXPECT_LT(5 * mesh.cell_count(), 4 * triangle_count(rings));
      expect_decomposed(rings, {.with_outside = false});
      expect_decomposed(test::flattened(rings));
    }
    if (testing::Test::HasFailure()) FAIL() << "drawing " << i;
  }
}

TEST(Decompose, SpiralsAndThinPolygons) {
  Random random(3);
  for (int i = 1; i <= test::scaled(20, 60); ++i) {
    const std::vector<Ring> band = {test::spiral(1 + i % 4, 40 * i)};
    EXPECT_LT(4 * expect_decomposed(band).cell_count(), 3 * triangle_count(band));
    expect_decomposed(std::vector<Ring>{test::monotone(random, 5 + 10 * i)});
    if (testing::Test::HasFailure()) FAIL() << "drawing " << i;
  }
}

TEST(Decompose, NestedSquaresAlternate) {
  const auto rings = test::nested(7, 5);
  const MeshData mesh = expect_decomposed(rings);
  EXPECT_LT(4 * mesh.cell_count(), 3 * triangle_count(rings));
  expect_decomposed(rings, {.with_outside = false});
  expect_decomposed(test::nested(2, 1));
  expect_decomposed(test::flattened(rings));
}

TEST(Decompose, EdgesThroughManySpecks) {
  Random random(4);
  for (int i = 0; i < test::scaled(20, 60); ++i) {
    expect_decomposed(test::needle(random, 3 + i % 9));
    expect_decomposed(test::needle_between_squares(1 + i % 25));
    expect_decomposed(test::flattened(test::needle_between_squares(1 + i % 25)));
    if (testing::Test::HasFailure()) FAIL() << "drawing " << i;
  }
}

TEST(Decompose, LongEdgesAmongShort) {
  Random random(8);
  for (int i = 0; i < test::scaled(40, 1000); ++i) {
    const std::vector<Ring> rings = {test::untangled(random, 5 + random.below(40))};
    expect_decomposed(rings);
    if (testing::Test::HasFailure()) FAIL() << "drawing " << i;
  }
}

// Before its first edge is put in, point 1 of the second ring has one neighbour above that edge: the gap along it has
// an edge in it, with both sides in the gap.
TEST(Decompose, AnEdgeHangsInAGap) {
  std::vector<Ring> rings = {{{{-100, 0, 0}, {100, 0, 0}, {0, 1000, 0}}, ""},
                             {{{0, 5, 0}, {0, 0.125, 0}, {-50, 30, 0}}, ""},
                             {{{-1, -1, 0}, {0, -3, 0}, {1, -1, 0}}, ""}};
  expect_decomposed(rings);
  std::swap(rings[0], rings[1]);
  expect_decomposed(rings);
}

TEST(Decompose, ScaledByAPowerOfTwoTheCellsAreTheSame) {
  Random random(5);
  std::vector<std::vector<Ring>> drawings = {
      test::star_with_holes(random, 40), {test::comb(random, 8, 9, true)}, test::needle(random, 8)};
  for (const auto& rings : drawings) {
    const MeshData mesh = decompose(rings);
    for (const int power : {-230, -1, 3, 290}) {
      auto scaled = rings;
      for (Ring& ring : scaled) {
        for (Vec3& p : ring.points) p = {std::ldexp(p.x, power), std::ldexp(p.y, power), 0};
      }
      const MeshData other = decompose(scaled);
      EXPECT_EQ(other.connectivity, mesh.connectivity) << power;
      EXPECT_EQ(other.free, mesh.free);
    }
  }
}

/// Whether rings of lattice points neither touch nor cross anything, by looking at all pairs of edges.
bool is_valid(std::span<const Ring> rings) {
  struct Segment {
    Vec3 a, b;
  };
  std::vector<Segment> segments;
  for (const Ring& ring : rings) {
    if (ring.points.size() < 3) return false;
    for (std::size_t i = 0; i < ring.points.size(); ++i) {
      segments.push_back({ring.points[i], ring.points[(i + 1) % ring.points.size()]});
    }
  }
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    const double d = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);  // small integers
    return (d > 0) - (d < 0);
  };
  const auto on = [&](const Segment& s, const Vec3& p) {
    return side(s.a, s.b, p) == 0 && std::min(s.a.x, s.b.x) <= p.x && p.x <= std::max(s.a.x, s.b.x) &&
           std::min(s.a.y, s.b.y) <= p.y && p.y <= std::max(s.a.y, s.b.y);
  };
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = 0; j < segments.size(); ++j) {
      if (i == j) continue;
      const Segment& s = segments[i];
      const Segment& t = segments[j];
      if (s.a == t.a || (on(t, s.a) && s.a != t.b)) return false;
      if (side(s.a, s.b, t.a) * side(s.a, s.b, t.b) < 0 && side(t.a, t.b, s.a) * side(t.a, t.b, s.b) < 0) return false;
    }
  }
  return true;
}

TEST(Decompose, RefusesExactlyWhatTouchesOrCrosses) {
  Random random(6);
  int accepted = 0;
  const int cases = test::scaled(10000, 300000);
  for (int i = 0; i < cases; ++i) {
    std::vector<Ring> rings(1 + random.below(2));
    const std::uint32_t size = 4 + random.below(5);
    for (Ring& ring : rings) {
      for (std::uint32_t n = 3 + random.below(4); n > 0; --n) {
        ring.points.push_back({1.0 * random.below(size), 1.0 * random.below(size), 0});
      }
    }
    const bool valid = is_valid(rings);
    if (random.below(2) == 0) rings = test::flattened(rings);
    if (!valid) {
      EXPECT_THROW(decompose(rings), InvalidMesh);
    } else if (++accepted % 10 == 0) {
      expect_decomposed(rings);
    } else {
      EXPECT_NO_THROW(decompose(rings));
    }
    if (testing::Test::HasFailure()) FAIL() << "drawing " << i;
  }
  EXPECT_GT(accepted, cases / 20);
}

template <class Refusal>
void expect_refused(const std::vector<Ring>& rings, const std::vector<std::string>& texts,
                    const DecomposeOptions& options = {}) {
  try {
    decompose(rings, options);
    ADD_FAILURE() << "accepted: " << texts[0];
  } catch (const Refusal& e) {
    for (const std::string& text : texts) EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

TEST(Decompose, RefusalsNameRingAndPoint) {
  const Ring square = {{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, "outer"};
  const auto with = [&](const Ring& ring) { return std::vector<Ring>{square, ring}; };
  const auto changed = [&](std::size_t i, const Vec3& p) {
    auto rings = with({{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, "hole"});
    rings[1].points[i] = p;
    return rings;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused<InvalidMesh>(with({{{1, 1, 0}, {2, 1, 0}}, ""}), {"ring 1 has 2 points"});
  expect_refused<InvalidMesh>(changed(1, {nan, 1, 0}), {"point 1", "ring 1 (\"hole\")", "not finite"});
  expect_refused<InvalidMesh>(changed(1, {2, 1, 0.5}), {"point 1 (2, 1) of ring 1", "z = 0.5"});
  expect_refused<InvalidMesh>(changed(1, {2, 1, nan}), {"point 1", "not finite"});
  expect_refused<InvalidMesh>(changed(2, {0x1p-301, 2, 0}), {"point 2 (0, 2) of ring 1", "of ring 0"});  // counts as 0
  expect_refused<InvalidMesh>(changed(2, {1, 0x1p301, 0}), {"point 2", "ring 1", "2^300"});
  expect_refused<InvalidMesh>(changed(2, {4, 4, 0}), {"point 2 (4, 4) of ring 1", "repeats point 2 (4, 4) of ring 0"});
  expect_refused<InvalidMesh>(changed(2, {1, 1, 0}),
                              {"point 2", "repeats point 0 (1, 1) of ring 1", "closes by itself"});
  expect_refused<InvalidMesh>(changed(2, {3, 1, 0}), {"point 1 (2, 1)", "lies on the edge from point 2 (3, 1)"});
  expect_refused<InvalidMesh>(changed(2, {1, 4, 0}), {"point 2 (1, 4) of ring 1", "of ring 0 (\"outer\")"});
  expect_refused<InvalidMesh>(changed(2, {1, 5, 0}),
                              {"crosses", "the edge from point 2 (4, 4) to point 3 (0, 4) of ring 0"});
  expect_refused<InvalidMesh>(with({{{1, 1, 0}, {3, 3, 0}, {3, 1, 0}, {1, 3, 0}}, ""}),
                              {"from point 2 (3, 1) to point 3 (1, 3) of ring 1", "crosses",
                               "from point 0 (1, 1) to point 1 (3, 3) of ring 1"});
  expect_refused<InvalidMesh>(with({{{1, 1, 0}, {3, 1, 0}, {2, 1, 0}, {2, 2, 0}}, ""}), {"lies on", "run back"});
  expect_refused<InvalidArgument>({}, {"no rings"});
  expect_refused<InvalidArgument>({square}, {"margin is 0"}, {.margin = 0});
  expect_refused<InvalidArgument>({square}, {"margin is nan"}, {.margin = nan});
  expect_refused<InvalidArgument>({square}, {"is lost in the rounding"}, {.margin = 1e-18});
  expect_refused<InvalidArgument>({square}, {"2^300"}, {.margin = 1e100});
  expect_refused<InvalidArgument>({square}, {"max_corners is 2"}, {.max_corners = 2});
  expect_refused<InvalidArgument>({square}, {"max_corners is 1001"}, {.max_corners = 1001});
}

TEST(Decompose, ManyPoints) {
  Random random(7);
  const int n = test::scaled(8000, 100000);
  const std::vector<std::vector<Ring>> drawings = {{test::spiral(50, n / 2)},
                                                   {test::comb(random, n / 50, 50, true)},
                                                   {test::comb(random, n / 4, 1000, false)},
                                                   test::nested(n / 400, 100),
                                                   {test::star(random, {0, 0, 0}, n, 1, 2)}};
  for (const auto& rings : drawings) expect_decomposed(rings);
}

}  // namespace dartcast::decompose_test
