// A walk's visitor sees every simplex that the segment leaves, once and in order.
#include <gtest/gtest.h>

#include <set>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "support/meshes.hpp"
#include "tracking/locate.hpp"
#include "tracking/walk.hpp"

namespace dartcast::visitor_test {

struct Left {
  SimplexId simplex;
  unsigned facet;
};

MeshData jittered_box(int kind) {
  BoxOptions o;
  o.cells = {5, 5, 5};
  o.size = {5, 5, 5};
  o.jitter = 0.4;
  o.blocked_share = 0.1;
  test::set_kind(o, kind);
  return generate_box(o);
}

TEST(Visitor, SeesAChainOfNeighbours) {
  for (int which = 0; which < 5; ++which) {
    const CellComplex complex(jittered_box(which));
    const Locator locator(complex);
    const auto space = current_space(complex);
    Random random(static_cast<std::uint64_t>(which));
    const auto point = [&] { return Vec3{random.uniform(0, 5), random.uniform(0, 5), random.uniform(0, 5)}; };
    std::size_t passed = 0, walls = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = point();
      const Vec3 q = point();
      const Location from = locator.locate(complex, p);
      if (from.place != Place::free) continue;
      std::vector<Left> seen;
      TestCounts counts;
      const Walk w = walk(space, from.simplex, p, q, counts, [&](SimplexId s, unsigned facet) {
        seen.push_back({s, facet});
      });
      const Walk plain = [&] {
        TestCounts again;
        const Walk result = walk(space, from.simplex, p, q, again);
        EXPECT_EQ(again.tests, counts.tests);
        return result;
      }();
      EXPECT_EQ(plain.simplex, w.simplex);
      EXPECT_EQ(plain.end, w.end);
      std::set<SimplexId> distinct;
      SimplexId at = from.simplex;
      for (const Left& left : seen) {
        ASSERT_EQ(left.simplex, at);
        EXPECT_TRUE(distinct.insert(at).second) << "met twice";
        const CellView cell = complex.map().view(at.cell);
        ASSERT_TRUE(cell.is_free());
        const Across across = cell.shape().simplices()[at.simplex].across[left.facet];
        if (across.outer() && cell.is_wall(across.face())) {
          EXPECT_EQ(w.end, WalkEnd::wall);
          EXPECT_EQ(w.wall_simplex, at);
          EXPECT_EQ(w.wall_facet, left.facet);
          EXPECT_EQ(left.simplex, seen.back().simplex);
          ++walls;
          break;
        }
        at = pass(complex.map(), at, cell, across).simplex;
        ++passed;
      }
      EXPECT_EQ(at, w.simplex);
      if (w.end == WalkEnd::arrived) {
        const Location to = locator.locate(complex, q);
        EXPECT_EQ(to.simplex, w.simplex);
      }
    }
    EXPECT_GT(passed, 1000U);
    EXPECT_GT(walls, 100U);
  }
}

TEST(Visitor, SeesNothingWhereTheSimplexIsNotLeft) {
  const CellComplex complex(generate_box({}));
  const Corners v = complex.corners({complex.map().cells()[0], 0});
  const Vec3 middle = (v[0] + v[1] + v[2] + v[3]) * 0.25;
  std::size_t seen = 0;
  TestCounts counts;
  const Walk w = walk(current_space(complex), {complex.map().cells()[0], 0}, middle, middle + (v[0] - middle) * 0.5,
                      counts, [&](SimplexId, unsigned) { ++seen; });
  EXPECT_EQ(w.end, WalkEnd::arrived);
  EXPECT_EQ(seen, 0U);
  EXPECT_EQ(counts.tests, 4U);
}

}  // namespace dartcast::visitor_test
