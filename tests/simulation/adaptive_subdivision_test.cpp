#include "dartcast/adaptive_subdivision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "support/tier.hpp"

namespace dartcast::crowding_test {

MeshData crowding_box() {
  BoxOptions o;
  o.cells = {4, 4, 4};
  o.size = {4.0, 4.0, 4.0};
  return generate_box(o);
}

std::size_t fullest_cell(const Flow& flow) {
  std::map<Cell, std::size_t> counts;
  for (const State& s : flow.particles().states()) ++counts[s.cell];
  std::size_t most = 0;
  for (const auto& [cell, count] : counts) most = std::max(most, count);
  return most;
}

std::vector<Vec3> cluster(std::size_t count, const Vec3& low, const Vec3& high) {
  Random random(5);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back({random.uniform(low.x, high.x), random.uniform(low.y, high.y), random.uniform(low.z, high.z)});
  return places;
}

// A crowd gathers, and the cells get small; it leaves, and they are as many as before.
TEST(Crowding, SubdividesAndMergesAgain) {
  Environment environment(crowding_box(), Threads{1});
  FlowOptions o;
  o.dt = 0.1;
  Flow flow(environment, o);
  const std::size_t cells = environment.map().cell_count();
  flow.add(cluster(300, {1.1, 1.1, 1.1}, {1.9, 1.9, 1.9}), {0.1, 0.05, 0.02});
  CrowdingOptions options;
  options.most = 20;
  options.least = 10;
  Crowding crowding(options);
  CrowdingReport first;
  for (int i = 0; i < 5; ++i) {
    const CrowdingReport report = flow.relieve(crowding);
    first.subdivided += report.subdivided;
    EXPECT_TRUE(report.refused.empty()) << report.refused.front().reason;
    EXPECT_EQ(report.waiting, 0U);
    EXPECT_LE(fullest_cell(flow), options.most);
    EXPECT_TRUE(environment.validity().valid());
    EXPECT_EQ(audit(environment.complex(), flow.particles()).failed, 0U);
    flow.step();
  }
  EXPECT_GT(first.subdivided, 8U);
  EXPECT_GT(crowding.subdivisions().size(), 8U);
  EXPECT_EQ(flow.particles().size(), 300U);
  // With everyone still there nothing is merged; with nobody all is.
  EXPECT_EQ(flow.relieve(crowding).merged, 0U);
  Flow empty(environment, o);
  std::uint64_t merged = 0;
  for (int i = 0; i < 10 && !crowding.subdivisions().empty(); ++i) {
    const CrowdingReport report = empty.relieve(crowding);
    merged += report.merged;
    EXPECT_TRUE(report.refused.empty()) << report.refused.front().reason;
  }
  EXPECT_TRUE(crowding.subdivisions().empty());
  EXPECT_EQ(environment.map().cell_count(), cells);
  EXPECT_GT(merged, 8U);
}

// A report names what was not done: cells too small, and more of them than one call edits.
TEST(Crowding, TellsWhatItLeaves) {
  Environment environment(crowding_box(), Threads{1});
  Flow flow(environment, FlowOptions{});
  flow.add(cluster(400, {1.1, 1.1, 1.1}, {2.9, 1.9, 1.9}), {});
  CrowdingOptions options;
  options.most = 20;
  options.smallest = 0.4;
  Crowding small(options);
  const CrowdingReport report = flow.relieve(small);
  EXPECT_EQ(report.subdivided, 2U);
  ASSERT_GT(report.refused.size(), 4U);
  EXPECT_GT(report.refused.front().particles, options.most);
  EXPECT_NE(report.refused.front().reason.find("across"), std::string::npos);
  options.smallest = 0.0;
  options.edits = 1;
  Crowding slow(options);
  const CrowdingReport some = flow.relieve(slow);
  EXPECT_EQ(some.subdivided, 1U);
  EXPECT_GT(some.waiting, 0U);
}

TEST(Crowding, RefusesOptionsOutOfRange) {
  CrowdingOptions options;
  options.least = options.most;
  EXPECT_THROW(Crowding{options}, InvalidArgument);
  options = {};
  options.smallest = -1.0;
  EXPECT_THROW(Crowding{options}, InvalidArgument);
}

// Spheres that rest on each other go on resting while the cells around them change.
TEST(Crowding, SpheresDoNotNotice) {
  const auto run = [](bool relieve) {
    Environment environment(crowding_box(), Threads{1});
    FlowOptions o;
    o.dt = 5e-3;
    o.gravity = {0.0, 0.0, -9.81};
    o.collisions = CollisionOptions{};
    o.collisions->friction = 0.3;
    Flow flow(environment, o, Responses(Response{ResponseKind::reflect, 0.0, 0.3}));
    for (int i = 0; i < 90; ++i) {
      const Vec3 place = {0.3 + 0.21 * (i % 5), 0.3 + 0.21 * (i / 5 % 6), 0.15 + 0.25 * (i / 30)};
      flow.add(std::span(&place, 1), {}, 0.1);
    }
    CrowdingOptions options;
    options.most = 10;
    options.least = 5;
    Crowding crowding(options);
    std::uint64_t edits = 0;
    for (int i = 0; i < 200; ++i) {
      if (relieve && i % 20 == 10) edits += flow.relieve(crowding).subdivided;
      flow.step();
    }
    EXPECT_EQ(edits > 0, relieve);
    EXPECT_EQ(flow.particles().size(), 90U);
    std::vector<Vec3> places;
    for (const State& s : flow.particles().states()) places.push_back(s.position);
    return places;
  };
  const auto without = run(false);
  const auto with = run(true);
  for (std::size_t i = 0; i < without.size(); ++i) EXPECT_LT(norm(without[i] - with[i]), 1e-3);
}

}  // namespace dartcast::crowding_test
