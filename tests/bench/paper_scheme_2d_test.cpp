// The paper's scheme of the plane does the same work as the library: the same walls, and the paper's tests.
#include "bench/paper_scheme_2d.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "bench/comparison.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/predicates.hpp"
#include "support/scheme_pair.hpp"
#include "support/tier.hpp"

namespace dartcast::paper_scheme_2d_test {

using bench::PaperEnd;
using bench::PaperResult;
using bench::PaperScheme2D;

constexpr double size = 12.0;

RectangleOptions rectangle(CellType type, double blocked, double jitter = 0.0) {
  RectangleOptions o;
  o.cells = {12, 12};
  o.size = {size, size};
  o.type = type;
  o.blocked_share = blocked;
  o.jitter = jitter;
  return o;
}

constexpr std::array plane_types = {CellType::quadrilateral, CellType::triangle, CellType::polygon};

std::vector<Vec3> places(std::size_t count, Random& random) {
  std::vector<Vec3> list(count);
  for (Vec3& x : list) x = {random.uniform(0.0, size), random.uniform(0.0, size), 0.0};
  return list;
}

struct PlanePair : test::SchemePair<PaperScheme2D> {
  explicit PlanePair(MeshData mesh)
      : SchemePair(std::move(mesh), [](Random& r) { return places(test::scaled(1000, 10000), r); }) {}
};

TEST(PaperScheme2D, FindsTheWallsThatTheLibraryFinds) {
  for (const CellType type : plane_types) {
    for (const double reach : {0.1, 3.0}) {
      PlanePair pair(generate_rectangle(rectangle(type, 0.2, 0.25)));
      for (int n = 0; n < 50; ++n) {
        pair.aim(reach);
        pair.step();
      }
      EXPECT_GT(pair.hits, pair.steps / 40);
      EXPECT_EQ(pair.differ, 0U);
      EXPECT_LT(pair.worst_time, 1e-9);
      EXPECT_EQ(pair.least, 3U) << "a forecast that holds";
    }
  }
}

TEST(PaperScheme2D, TakesThreeTestsAndOneForEachTurn) {
  RectangleOptions options;
  options.cells = {2, 1};
  options.size = {2.0, 1.0};
  const Environment environment(generate_rectangle(options));
  const Vec3 start = {0.5, 0.5, 0.0};
  struct Case {
    Vec3 target;
    std::uint32_t tests;
  };
  // The first forecast is the edge below. Clockwise the test that decides the way is the first of the turn, too.
  for (const Case& c : {Case{{0.5, 0.1, 0.0}, 3}, Case{{0.9, 0.5, 0.0}, 4}, Case{{0.5, 0.9, 0.0}, 4},
                        Case{{0.1, 0.5, 0.0}, 3}, Case{{1.5, 0.5, 0.0}, 8}}) {
    PaperScheme2D scheme(environment.complex());
    ParticleState state;
    state.put({Cell(1, 0), 0}, start);
    scheme.start(std::span<const ParticleState>(&state, 1));
    PaperResult result;
    scheme.advance(std::span<const Vec3>(&c.target, 1), std::span<PaperResult>(&result, 1));
    EXPECT_EQ(result.end, PaperEnd::arrived);
    EXPECT_EQ(scheme.position(0), c.target);
    EXPECT_EQ(result.tests, c.tests) << c.target.x << ' ' << c.target.y;
  }
}

TEST(PaperScheme2D, FollowsADeformation) {
  PlanePair pair(generate_rectangle(rectangle(CellType::quadrilateral, 0.2)));
  const std::vector<Vec3> rest(pair.environment.positions().begin(), pair.environment.positions().end());
  for (int n = 1; n <= 50; ++n) {
    const std::span<Vec3> next = pair.environment.next_positions();
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Vec3 x = rest[i];
      next[i] = x + 0.1 * Vec3{std::sin(x.y + 0.1 * n), std::sin(x.x + 0.1 * n), 0.0};
    }
    pair.environment.move();
    pair.scheme.moved();
    pair.aim(0.1);
    pair.step();
  }
  EXPECT_GT(pair.hits, pair.steps / 40);
  EXPECT_LE(pair.differ, pair.hits / 5);
  EXPECT_GT(pair.differ, 0U) << "a way that starts at the middle of the cell meets other walls";
}

bool in_polygon(const CellComplex& complex, Cell cell, const Vec3& x) {
  const CombinatorialMap& map = complex.map();
  const auto at = [&](Dart d) { return complex.positions()[map.origin(d).value]; };
  for (std::uint16_t n = 0; n < map.shape(cell).dart_count(); ++n) {
    if (orient2d(at({cell, n}), at(map.phi1({cell, n})), x) == Sign::negative) return false;
  }
  return true;
}

// In steps between points of a lattice of half cells: along edges, through vertices.
TEST(PaperScheme2D, FollowsEdgesAndVertices) {
  for (const CellType type : plane_types) {
    for (const double blocked : {0.0, 0.2}) {
      Environment environment(generate_rectangle(rectangle(type, blocked)), Threads{1});
      Particles particles;
      Random random(3);
      environment.add(particles, places(test::scaled(500, 5000), random));
      PaperScheme2D scheme(environment.complex());
      scheme.start(particles.states());
      std::vector<PaperResult> results(particles.size());
      std::vector<Vec3> targets(particles.size());
      std::array<std::uint64_t, 3> kinds{};
      const auto near = [&](double x) {
        return std::clamp(std::round(2.0 * x + random.uniform(-1.5, 1.5)) / 2.0, 0.5, size - 0.5);
      };
      for (int n = 0; n < 100; ++n) {
        for (std::size_t i = 0; i < targets.size(); ++i) {
          const Vec3 p = scheme.position(i);
          targets[i] = {near(p.x), near(p.y), 0.0};
        }
        scheme.advance(targets, results);
        for (std::size_t i = 0; i < targets.size(); ++i) {
          ASSERT_NE(results[i].end, PaperEnd::error);
          ASSERT_TRUE(environment.map().is_free(scheme.cell(i)));
          ++kinds[static_cast<std::size_t>(scheme.kind(i))];
          if (results[i].end == PaperEnd::arrived)
            ASSERT_TRUE(in_polygon(environment.complex(), scheme.cell(i), targets[i]));
          else
            ASSERT_TRUE(blocked > 0.0 && environment.map().view(results[i].wall.cell).is_wall(results[i].wall.face));
        }
      }
      EXPECT_GT(kinds[0], 1000U) << "vertices";
      EXPECT_GT(kinds[1], 1000U) << "edges";
    }
  }
}

TEST(PaperScheme2D, RacesInThePlane) {
  for (const bool deforms : {false, true}) {
    bench::WorkloadOptions options;
    options.name = "W6";
    options.scene = bench::Scene::squares;
    options.size = 16;
    options.deforms = deforms;
    options.particles = 200;
    options.steps = 200;
    const bench::Row row = compare(options, bench::competitor_kinds()).front();
    ASSERT_EQ(row.all_series.size(), 2U) << "no hierarchy over triangles";
    const bench::Series& paper = *row.series("paper");
    EXPECT_EQ(row.cells, 256U);
    EXPECT_EQ(row.counters.particle_steps, 40000U);
    EXPECT_GT(row.counters.contacts[1], 500U) << "edges";
    EXPECT_GE(paper.tests, 3 * row.counters.particle_steps);
    EXPECT_LE(paper.disagreements, deforms ? row.counters.particle_steps / 100 : 0);
    EXPECT_LE(paper.through + paper.stopped + paper.failed, paper.disagreements);
    EXPECT_EQ(paper.wrong_cells, 0U);
  }
}

}  // namespace dartcast::paper_scheme_2d_test
