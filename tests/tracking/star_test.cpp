// Walls around vertices and edges, found from cell to cell, against a search simplex by simplex.
#include "tracking/star.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <span>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "oracle/scenes.hpp"
#include "support/seeds.hpp"
#include "support/tier.hpp"

namespace dartcast::test::star_test {

using Walls = std::set<std::pair<SimplexId, unsigned>>;

// All walls that hold the feature, reached through facets that hold it.
Walls simplex_by_simplex(const CombinatorialMap& map, SimplexId start, const Feature& feature) {
  Walls walls;
  std::vector<SimplexId> open = {start};
  std::set<SimplexId> seen = {start};
  while (!open.empty()) {
    const SimplexId id = open.back();
    open.pop_back();
    const CellView cell = map.view(id.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[id.simplex];
    for (unsigned facet = 0; facet < 4; ++facet) {
      unsigned held = 0;
      const std::span<const Vertex> around(feature.vertex.data(), feature.count);
      for (unsigned i = 0; i < 4; ++i)
        held += i != facet && std::find(around.begin(), around.end(), cell.vertex(s.vertex[i])) != around.end() ? 1 : 0;
      if (held != feature.count) continue;
      const Across across = s.across[facet];
      if (across.outer() && cell.is_wall(across.face())) {
        walls.emplace(id, facet);
      } else if (const SimplexId next = pass(map, id, cell, across).simplex; seen.insert(next).second) {
        open.push_back(next);
      }
    }
  }
  return walls;
}

Walls cell_by_cell(const CombinatorialMap& map, SimplexId start, const Feature& feature) {
  Walls walls;
  search_walls(map, start, feature, [&](SimplexId id, const CellView&, const ImplicitSimplex&, unsigned facet) {
    EXPECT_TRUE(walls.emplace(id, facet).second) << "found twice";
    return true;
  });
  return walls;
}

// The first face that has the points, and in it the dart of the point or the edge.
Shape::Feature feature_face_by_face(const Shape& shape, const std::vector<std::uint16_t>& points) {
  for (std::uint16_t f = 0; f < shape.face_count(); ++f) {
    const auto corners = shape.corners(f);
    const auto on_face = [&](std::uint16_t p) {
      return p < shape.corner_count() ? std::count(corners.begin(), corners.end(), p) == 1
                                      : shape.face_of_point(p) == f;
    };
    if (!std::all_of(points.begin(), points.end(), on_face)) continue;
    for (std::uint16_t d = shape.first_dart(f); d < shape.first_dart(f) + shape.degree(f); ++d) {
      const std::uint16_t a = shape.origin(d);
      const std::uint16_t b = shape.origin(shape.phi1(d));
      if (points.size() == 1 && points[0] == a) return {Kind::vertex, d};
      if (points.size() == 2 && std::minmax(points[0], points[1]) == std::minmax(a, b)) return {Kind::edge, d};
    }
    return {Kind::face, shape.first_dart(f)};
  }
  return {Kind::volume, 0};
}

// Every corner and edge of every simplex of free cells; what is wrong.
std::string compare(const CombinatorialMap& map, std::size_t& with_walls, std::size_t& without) {
  for (const Cell c : map.cells()) {
    if (!map.is_free(c)) continue;
    const CellView cell = map.view(c);
    for (std::uint16_t n = 0; n < cell.shape().simplices().size(); ++n) {
      const ImplicitSimplex& s = cell.shape().simplices()[n];
      for (unsigned corners = 1; corners < 15; ++corners) {
        if (std::popcount(corners) > 2) continue;
        Feature feature;
        std::vector<std::uint16_t> points;
        for (unsigned i = 0; i < 4; ++i) {
          if (((corners >> i) & 1U) == 0) continue;
          feature.add(cell.vertex(s.vertex[i]));
          points.push_back(s.vertex[i]);
        }
        const Shape::Feature found_feature = cell.shape().feature(points);
        const Shape::Feature expected_feature = feature_face_by_face(cell.shape(), points);
        if (found_feature.kind != expected_feature.kind || found_feature.dart != expected_feature.dart)
          return fmt::format("the feature of cell {}, simplex {}, corners {}", c.value, n, corners);
        const Walls expected = simplex_by_simplex(map, {c, n}, feature);
        if (cell_by_cell(map, {c, n}, feature) != expected)
          return fmt::format("cell {}, simplex {}, corners {}", c.value, n, corners);
        const auto found = find_wall(map, {c, n}, 15U & ~corners, feature);
        if (found.has_value() == expected.empty() || (found && !expected.contains({found->simplex, found->facet})))
          return fmt::format("the wall at cell {}, simplex {}, corners {}", c.value, n, corners);
        ++(expected.empty() ? without : with_walls);
      }
    }
  }
  return {};
}

class StarSearch : public ::testing::TestWithParam<int> {};

TEST_P(StarSearch, FindsTheWallsThatTheSimplicesReach) {
  const auto kind = static_cast<oracle::SceneKind>(GetParam());
  std::size_t with_walls = 0;
  std::size_t without = 0;
  for (std::uint64_t seed = 0; seed < std::max<std::uint64_t>(2, scaled(4, 200)); ++seed) {
    CellComplex complex(seed % 2 == 0 ? oracle::lattice_scene(kind, seed) : oracle::random_scene(kind, seed, 0.5));
    if (!complex.invalid_cells().empty()) continue;
    ASSERT_EQ(compare(complex.map(), with_walls, without), "") << "seed " << seed;
    // Marks that change: a vertex may be thought to touch a wall that it no longer does, never the other way round.
    Random random(seed, 3);
    const std::vector<Cell> cells = complex.map().cells();
    for (int i = 0; i < 10; ++i) {
      complex.map().set_free(cells[random.below(static_cast<std::uint32_t>(cells.size()))], random.below(2) == 0);
    }
    ASSERT_EQ(compare(complex.map(), with_walls, without), "") << "seed " << seed << ", marks changed";
  }
  EXPECT_GT(with_walls, 100U);
  EXPECT_GT(without, 0U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, StarSearch, ::testing::Range(0, oracle::scene_kinds), [](const auto& scene) {
  return oracle::name_of(static_cast<oracle::SceneKind>(scene.param));
});

TEST(StarSearch, GoesOnWhereAVertexHasMoreCellsThanFitOnTheStack) {
  // Prisms around one edge.
  const std::uint32_t n = sanitized() ? 80 : 200;
  MeshData mesh;
  mesh.points.resize(2 * (n + 1));
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 1 + i;
    const std::uint32_t b = 1 + (i + 1) % n;
    mesh.add_cell(CellType::prism, {{0, a, b, n + 1, n + 1 + a, n + 1 + b}});
  }
  const CombinatorialMap map(mesh);
  std::size_t with_walls = 0;
  std::size_t without = 0;
  EXPECT_EQ(compare(map, with_walls, without), "");
}

TEST(Stars, SayWhereAPointIsHeldTwice) {
  const auto facet = [](std::uint16_t simplex, std::uint16_t place) { return Across{simplex, place}; };
  const auto face = [](std::uint16_t f) { return Across{static_cast<std::uint16_t>(Across::outer_bit | f), 0}; };
  // A chain of three; the first and the last both have point 0, and no facet between them.
  const std::vector<ImplicitSimplex> chain = {{{0, 1, 2, 3}, {facet(1, 3), face(0), face(1), face(2)}},
                                              {{1, 2, 3, 4}, {facet(2, 3), face(3), face(4), facet(0, 0)}},
                                              {{2, 3, 4, 0}, {face(5), face(6), face(7), facet(1, 0)}}};
  const Stars::Fans fans = {{{0, 2, 3}, {0, 1, 3}, {0, 1, 2}, {1, 3, 4}, {1, 2, 4}, {3, 4, 0}, {2, 4, 0}, {2, 3, 0}},
                            {0, 1, 2, 3, 4, 5, 6, 7, 8}};
  const Stars pinched(chain, fans);
  EXPECT_FALSE(pinched.one_each());
  EXPECT_NE(pinched.star(0, 1), pinched.star(2, 8));
  EXPECT_EQ(pinched.star(0, 2), pinched.star(1, 1));
  EXPECT_EQ(pinched.outer_facets(pinched.star(0, 1)).size(), 3U);
  EXPECT_TRUE(Stars(std::span(chain).first(0), {}).empty());
}

}  // namespace dartcast::test::star_test
