// Solids that meet each other never cross. The truth is brute force: all parts of all solids, exactly, in every step.
#include "solids/solid_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "solids/audit_solids.hpp"
#include "solids/elements.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::solid_pairs_test {

using test::ball;
using test::moved;
using test::rod;

struct Heap {
  Environment environment;
  test::TossedSolids tossed;
  std::vector<SolidElement> elements;  // of all solids
  std::vector<std::uint32_t> solid_of;

  Heap(std::uint64_t seed, unsigned threads)
      : environment(test::cubes(4, CellType::hexahedron, 0.05, 0.2, seed), Threads{threads}),
        tossed(environment, seed) {
    for (const SolidMesh& mesh : {ball(0.4), rod(4, 0.3), ball(0.55), SolidMesh{{{}}, {}, {}}}) {
      const std::size_t first = tossed.solids.size();
      tossed.fill(mesh, first + 4, 4.0, true);
      for (std::size_t s = first; s < tossed.solids.size(); ++s) {
        for (SolidElement e : elements_of(mesh)) {
          for (std::uint32_t& v : e.vertex) v += tossed.solids.first_vertices()[s];
          elements.push_back(e);
          solid_of.push_back(static_cast<std::uint32_t>(s));
        }
      }
    }
  }

  [[nodiscard]] std::array<Vec3, 3> corners(std::size_t e, std::span<const Vec3> x) const {
    const auto& v = elements[e].vertex;
    return {x[v[0]], x[v[1]], x[v[2]]};
  }

  // Whether two parts cross at the end, or touch on their straight ways.
  [[nodiscard]] std::size_t pierced() const {
    const auto x = tossed.solids.positions();
    std::size_t found = 0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const MovingElement way = {corners(i, tossed.before()), corners(i, x), elements[i].count};
      for (std::size_t k = 0; k < elements.size(); ++k) {
        if (solid_of[i] == solid_of[k]) continue;
        const MovingTriangle other = {corners(k, tossed.before()), corners(k, x)};
        if (!test::boxes_meet(way, other)) continue;
        const std::vector<MovingTriangle> one = {other};
        if (audit_meet(corners(i, x), corners(k, x)) || test::first_touch_of(way, one)) ++found;
      }
    }
    return found;
  }
};

TEST(SolidPairs, NothingIsPiercedInAHeap) {
  std::size_t meetings = 0;
  double made = 0.0;
  double steps = 0.0;
  for (std::uint64_t seed = 1; seed <= (test::sanitized() ? 1 : 3); ++seed) {
    Heap heap(seed, 1);
    Heap same(seed, 3);
    ASSERT_GE(heap.tossed.solids.size(), 12U);
    const std::vector<Vec3> rest(heap.environment.positions().begin(), heap.environment.positions().end());
    for (int s = 0; s < std::max(20, test::scaled(60, 600)); ++s) {
      const SolidStepOptions options = {.rounds = s % 3 == 0 ? 0U : 12U};
      const auto go = [&](Heap& h) -> const SolidStep& {
        const std::vector<Vec3> targets = h.tossed.targets(20.0);
        if (s % 2 == 0) return h.tossed.solids.advance(targets, options);
        return h.tossed.solids.move_with(targets, test::waved(rest, 0.1 * std::sin(0.7 * s)), options);
      };
      const SolidStep& step = go(heap);
      go(same);
      heap.tossed.follow();
      same.tossed.follow();
      ASSERT_EQ(heap.pierced(), 0U) << seed << " " << s;
      ASSERT_EQ(heap.tossed.solids.audit().failed, 0U) << heap.tossed.solids.audit().first;
      ASSERT_TRUE(std::ranges::equal(heap.tossed.solids.positions(), same.tossed.solids.positions()));
      for (const SolidMeeting& m : step.meetings) {
        EXPECT_LT(m.other, m.solid);
        EXPECT_NEAR(norm(m.normal), 1.0, 1e-12);
        EXPECT_NEAR(std::accumulate(m.weights.begin(), m.weights.end(), 0.0), 1.0, 1e-12);
        EXPECT_NEAR(std::accumulate(m.other_weights.begin(), m.other_weights.end(), 0.0), 1.0, 1e-12);
      }
      meetings += step.meetings.size();
      made += std::accumulate(step.made.begin(), step.made.end(), 0.0);
      steps += static_cast<double>(step.made.size());
    }
  }
  EXPECT_GT(meetings, test::sanitized() ? 0U : 100U);
  EXPECT_GT(made, 0.5 * steps) << "they jam";
}

// The bar in front goes its whole way; the quicker one behind stays behind.
TEST(SolidPairs, OneThatIsFollowedIsNotStopped) {
  Environment environment(test::unit_box({20, 2, 2}), Threads{1});
  SolidSet solids(environment);
  const SolidMesh mesh = ball(0.3);
  ASSERT_EQ(solids.add(moved(mesh, {1.0, 1.0, 1.0})).refusal, SolidRefusal::none);
  ASSERT_EQ(solids.add(moved(mesh, {2.0, 1.0, 1.0}), std::array{0U}).refusal, SolidRefusal::none);
  for (int s = 0; s < 60; ++s) {
    std::vector<Vec3> targets(solids.positions().begin(), solids.positions().end());
    for (std::size_t v = 0; v < targets.size(); ++v) targets[v].x += v < mesh.points.size() ? 0.5 : 0.25;
    const SolidStep& step = solids.advance(targets);
    EXPECT_EQ(step.made[1], 1.0) << s;
    EXPECT_EQ(step.made[0] < 1.0, step.meetings.size() == 1) << s;
  }
  EXPECT_NEAR(solids.positions()[mesh.points.size()].x - (mesh.points[0].x + 2.0), 15.0, 1e-9);
  const double behind = solids.positions()[mesh.points.size()].x - solids.positions()[0].x;
  EXPECT_GT(behind, 0.5) << "twice the distance of a face from the middle of the ball is 0.48";
  EXPECT_LT(behind, 1.2);
}

TEST(SolidPairs, OverlapsAreRefused) {
  Environment environment(test::unit_box({4, 4, 4}), Threads{1});
  SolidSet solids(environment);
  const Vec3 middle = {2.0, 2.0, 2.0};
  ASSERT_EQ(solids.add(moved(ball(1.0), middle)).refusal, SolidRefusal::none);
  for (const SolidMesh& mesh : {moved(ball(0.2), middle), moved(ball(1.5), middle), moved(rod(3, 0.9), {0.5, 2.0, 2.0}),
                                moved(ball(0.5), {3.2, 2.0, 2.0}), SolidMesh{{middle}, {}, {}}}) {
    const SolidPlacement placed = solids.add(mesh, std::array{0U});
    EXPECT_EQ(placed.refusal, SolidRefusal::meets_solid);
    EXPECT_EQ(placed.other, 0U);
    EXPECT_GE(placed.count, 1U);
    EXPECT_EQ(solids.size(), 1U);
  }
  EXPECT_THROW(solids.add(ball(0.1), std::array{1U}), InvalidArgument);
  EXPECT_EQ(solids.add(moved(ball(0.2), middle)).refusal, SolidRefusal::none) << "it does not meet the other";
}

// Numbers move up with those after one that is taken out.
TEST(SolidPairs, RemainAfterARemoval) {
  Environment environment(test::unit_box({6, 2, 2}), Threads{1});
  SolidSet solids(environment);
  for (std::uint32_t s = 0; s < 3; ++s) {
    std::vector<std::uint32_t> met(s);
    std::iota(met.begin(), met.end(), 0U);
    ASSERT_EQ(solids.add(moved(ball(0.3), {1.0 + 1.5 * s, 1.0, 1.0}), met).refusal, SolidRefusal::none);
  }
  solids.remove(0);
  std::vector<Vec3> targets(solids.positions().begin(), solids.positions().end());
  for (std::size_t v = 0; v < 12; ++v) targets[v].x += 1.5;
  const SolidStep& step = solids.advance(targets);
  ASSERT_EQ(step.meetings.size(), 1U);
  EXPECT_EQ(step.meetings[0].solid, 1U);
  EXPECT_EQ(step.meetings[0].other, 0U);
  EXPECT_LT(step.made[0], 0.8);
  EXPECT_EQ(solids.audit().failed, 0U);
}

}  // namespace dartcast::solid_pairs_test
