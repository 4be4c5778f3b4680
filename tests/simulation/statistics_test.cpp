// Crossings, residence times and pathlines, against flows whose answers are known and against rational arithmetic.
#include "dartcast/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/events.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "support/dyadic.hpp"
#include "support/tier.hpp"
#include "support/with_response.hpp"

namespace dartcast::statistics_test {

SectionPlane plane_at(double x, const std::string& name = "plane") { return {name, {x, 0.0, 0.0}, {1.0, 0.0, 0.0}}; }

std::vector<PlaneCrossing> crossings(const SectionPlane& plane, const Vec3& before, const Vec3& after) {
  return find_crossings(std::vector{plane}, std::vector{before}, std::vector{after});
}

TEST(Crossings, HaveADirectionAShareAndAPoint) {
  const auto forward = crossings(plane_at(1.0), {0.5, 2.0, 0.0}, {1.5, 4.0, 1.0});
  ASSERT_EQ(forward.size(), 1U);
  EXPECT_TRUE(forward[0].forward);
  EXPECT_EQ(forward[0].share, 0.5);
  EXPECT_EQ(forward[0].point, (Vec3{1.0, 3.0, 0.5}));
  const auto backward = crossings(plane_at(1.0), {1.75, 0.0, 0.0}, {0.75, 0.0, 0.0});
  ASSERT_EQ(backward.size(), 1U);
  EXPECT_FALSE(backward[0].forward);
  EXPECT_EQ(backward[0].share, 0.75);
  EXPECT_TRUE(crossings(plane_at(1.0), {1.5, 0.0, 0.0}, {2.5, 0.0, 0.0}).empty());
}

// On the plane is not behind it: each passage counts once, in two steps or in one, and a particle that turns on the
// plane has crossed it forward and backward.
TEST(Crossings, APositionOnThePlaneCountsOnce) {
  const Vec3 behind = {0.5, 0.0, 0.0};
  const Vec3 on = {1.0, 0.0, 0.0};
  const Vec3 beyond = {1.5, 0.0, 0.0};
  const auto count = [](const Vec3& a, const Vec3& b) {
    const auto found = crossings(plane_at(1.0), a, b);
    return found.empty() ? 0 : found[0].forward ? 1 : -1;
  };
  EXPECT_EQ(count(behind, on), 1);
  EXPECT_EQ(count(on, beyond), 0);
  EXPECT_EQ(count(on, behind), -1);
  EXPECT_EQ(count(beyond, on), 0);
  EXPECT_EQ(count(on, on), 0);
  const auto reached = crossings(plane_at(1.0), behind, on);
  ASSERT_EQ(reached.size(), 1U);
  EXPECT_EQ(reached[0].point, on);
}

TEST(Crossings, OfADiscAreThoseWithinItsRadius) {
  SectionPlane disc = plane_at(0.0);
  disc.radius = 2.0;
  EXPECT_EQ(crossings(disc, {-1.0, 1.0, 0.0}, {1.0, 2.0, 0.0}).size(), 1U);  // at y = 1.5
  EXPECT_EQ(crossings(disc, {-1.0, 1.0, 0.0}, {1.0, 3.0, 0.0}).size(), 1U);  // at its border
  EXPECT_EQ(crossings(disc, {-1.0, 1.0, 0.0}, {1.0, 3.5, 0.0}).size(), 0U);
}

// Positions within a few units in the last place of skew planes, where a rounded height has any sign.
TEST(Crossings, AreDecidedByExactSigns) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::size_t undecided = 0;
  std::size_t found = 0;
  for (int i = 0; i < 2000; ++i) {
    const SectionPlane plane{"p",
                             {number(random), number(random), number(random)},
                             {number(random), number(random), std::ldexp(number(random), i % 60)}};
    const Vec3 u = {number(random), number(random), 0.0};
    Vec3 x = plane.point + u;
    x.z = plane.point.z - (plane.normal.x * u.x + plane.normal.y * u.y) / plane.normal.z;
    Vec3 y = x;
    for (int k = i % 4; k > 0; --k) y.z = std::nextafter(y.z, i % 2 == 0 ? 9.0 : -9.0);
    const auto is_behind = [&](const Vec3& p) {
      return dot(test::exact(plane.normal), minus(test::exact(p), test::exact(plane.point))).sign() < 0;
    };
    if ((dot(plane.normal, x - plane.point) < 0.0) != is_behind(x)) ++undecided;
    const auto c = crossings(plane, x, y);
    ASSERT_EQ(!c.empty(), is_behind(x) != is_behind(y)) << i;
    if (c.empty()) continue;
    ++found;
    EXPECT_EQ(c[0].forward, is_behind(x));
    EXPECT_GE(c[0].share, 0.0);
    EXPECT_LE(c[0].share, 1.0);
  }
  EXPECT_GT(undecided, 10U);  // a rounded height would be wrong
  EXPECT_GT(found, 100U);
}

TEST(Crossings, OfPlanesThatAreNoneAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](std::vector<SectionPlane> planes) { EXPECT_THROW(check(planes), InvalidArgument); };
  refused({{"", {}, {1.0, 0.0, 0.0}}});
  refused({{"a,b", {}, {1.0, 0.0, 0.0}}});
  refused({{"a", {}, {}}});
  refused({{"a", {nan, 0.0, 0.0}, {1.0, 0.0, 0.0}}});
  refused({{"a", {}, {nan, 0.0, 0.0}}});
  refused({{"a", {}, {1.0, 0.0, 0.0}, -1.0}});
  refused({plane_at(0.0), plane_at(1.0)});
  EXPECT_NO_THROW(check(std::vector{plane_at(0.0, "a"), plane_at(1.0, "b")}));
  EXPECT_THROW((void)find_crossings(std::vector{plane_at(0.0)}, std::vector<Vec3>(2), std::vector<Vec3>(1)),
               InvalidArgument);
}

TEST(ResidenceTimesTest, BinsAreDoubledWhereTimesAreLonger) {
  std::vector<double> times;
  for (int i = 0; i < 1000; ++i) times.push_back(0.01 * ((i * 37) % 1000) + 0.005);
  ResidenceTimes up;
  ResidenceTimes down;
  for (const double t : times) up.add(t, 0.01);
  for (auto t = times.rbegin(); t != times.rend(); ++t) down.add(*t, 0.01);
  EXPECT_EQ(up.count, 1000U);
  EXPECT_NEAR(up.mean(), 5.0, 1e-9);
  EXPECT_EQ(up.least, 0.005);
  EXPECT_EQ(up.most, times[27]);
  EXPECT_EQ(up.bin, 0.16);  // 64 bins of 0.16 s hold 10 s
  EXPECT_EQ(up.bins, down.bins);
  std::array<std::uint64_t, 64> truth{};
  for (const double t : times) ++truth[static_cast<std::size_t>(std::floor(t / 0.01)) / 16];
  EXPECT_EQ(up.bins, truth);
}

MeshData channel(std::uint32_t length = 8) {
  BoxOptions options;
  options.cells = {length, 2, 2};
  options.size = {1.0 * length, 2.0, 2.0};
  return generate_box(options);
}

// A flow of 2 m/s along a channel of 8 m, in which an inlet puts 200 particles per second; they escape at its end.
std::unique_ptr<Simulation> plug_flow(Environment& environment, const StatisticsOptions& statistics,
                                      unsigned substeps = 1) {
  SimulationOptions options;
  options.dt = 0.01;
  options.substeps = substeps;
  options.patch_responses["xmax"] = Escape{};
  auto simulation = std::make_unique<Simulation>(environment, options);
  simulation->set_statistics(statistics);
  simulation->add_inlet(environment.map().patch("xmin"), 200.0, {2.0, 0.0, 0.0});
  return simulation;
}

TEST(Flux, APlugFlowHasTheInletsRateAndAgesByWayOverSpeed) {
  Environment environment(channel());
  StatisticsOptions statistics;
  statistics.residence = true;
  statistics.planes = {plane_at(2.0, "two"), plane_at(6.0, "six"), {"back", {4.0, 0.0, 0.0}, {-3.0, 0.0, 0.0}}};
  const auto simulation = plug_flow(environment, statistics);
  const int steps = 1000;  // 10 s
  std::uint64_t passages = 0;
  for (int i = 0; i < steps; ++i) {
    simulation->step();
    for (const PlanePassage& p : simulation->statistics().passages) {
      EXPECT_NEAR(p.crossing.point.x, statistics.planes[p.crossing.plane].point.x, 1e-12);
      EXPECT_GT(p.time, simulation->time() - 0.01 - 1e-12);
      EXPECT_LE(p.time, simulation->time() + 1e-12);
      ++passages;
    }
  }
  const Statistics& s = simulation->statistics();
  EXPECT_EQ(s.planes[0].backward.count, 0U);
  EXPECT_EQ(s.planes[2].forward.count, 0U);
  EXPECT_EQ(passages, s.planes[0].forward.count + s.planes[1].forward.count + s.planes[2].backward.count);
  // An inlet puts particles 2^-6 of a simplex's height beyond its face: at most 1/64 m.
  const double near = 1.0 / 64 / 2.0 + 1e-9;
  EXPECT_NEAR(static_cast<double>(s.planes[0].forward.count), 200.0 * (10.0 - 1.0), 200.0 * near + 2.0);
  EXPECT_NEAR(static_cast<double>(s.planes[1].forward.count), 200.0 * (10.0 - 3.0), 200.0 * near + 2.0);
  EXPECT_NEAR(s.planes[0].forward.mean(), 1.0, near);
  EXPECT_NEAR(s.planes[1].forward.mean(), 3.0, near);
  EXPECT_NEAR(s.planes[2].backward.least, 2.0, near);
  EXPECT_NEAR(s.planes[2].backward.most, 2.0, near);
  const std::size_t out = environment.map().patch("xmax").value;
  EXPECT_EQ(s.left[out].escaped.count, simulation->totals().escaped);
  EXPECT_GT(s.left[out].escaped.count, 1000U);
  EXPECT_NEAR(s.left[out].escaped.mean(), 4.0, near);
  for (std::size_t i = 0; i < s.left.size(); ++i) {
    EXPECT_EQ(s.left[i].absorbed.count, 0U);
    if (i != out) EXPECT_EQ(s.left[i].escaped.count, 0U);
  }
}

// Statistics of a scene with all that particles do, by brute force from what the simulation shows before and after.
TEST(Flux, CountsAreThoseOfPositionsBeforeAndAfterEachStep) {
  for (const unsigned threads : test::all_or_first({3U, 1U})) {
    Environment environment(channel(), Threads{threads});
    SimulationOptions options;
    options.dt = 0.05;
    options.gravity = {-0.6, 0.0, -1.0};
    options.patch_responses["ymax"] = Absorb{};
    options.patch_responses["xmax"] = Escape{};
    Simulation simulation(environment, options);
    StatisticsOptions statistics;
    statistics.residence = true;
    statistics.planes = {{"a", {4.0, 0.0, 0.0}, {1.0, 0.25, 0.0}}, {"b", {4.0, 1.0, 1.0}, {0.0, 0.5, 1.0}, 1.5}};
    simulation.set_statistics(statistics);
    simulation.add_random(5000, {1.0, 0.3, 0.5});
    std::array<std::array<std::uint64_t, 2>, 2> truth{};
    std::map<std::uint64_t, Vec3> at;
    std::map<std::size_t, std::uint64_t> left;
    for (int i = 0; i < 60; ++i) {
      at.clear();
      for (std::size_t k = 0; k < simulation.ids().size(); ++k)
        at[simulation.ids()[k]] = simulation.particles()[k].position;
      const SimulationStep& step = simulation.step();
      std::map<std::uint64_t, Vec3> then;
      for (std::size_t k = 0; k < simulation.ids().size(); ++k)
        then[simulation.ids()[k]] = simulation.particles()[k].position;
      for (const LeftParticle& p : step.left) {
        then[p.id] = p.position;
        const Contact& c = step.contacts()[p.contact];
        EXPECT_EQ(step.contact_ids[p.contact], p.id);
        ++left[step.report.contacts.walls_of(c).front().patch.value];
      }
      ASSERT_EQ(then.size(), at.size());
      for (const auto& [id, x] : at) {
        for (std::size_t p = 0; p < 2; ++p) {
          const auto c = crossings(statistics.planes[p], x, then[id]);
          if (!c.empty()) ++truth[p][c[0].forward ? 0 : 1];
        }
      }
    }
    const Statistics& s = simulation.statistics();
    for (std::size_t p = 0; p < 2; ++p) {
      EXPECT_GT(truth[p][0], 0U);
      EXPECT_GT(truth[p][1], 0U);
      EXPECT_EQ(s.planes[p].forward.count, truth[p][0]);
      EXPECT_EQ(s.planes[p].backward.count, truth[p][1]);
    }
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < s.left.size(); ++i) {
      EXPECT_EQ(s.left[i].escaped.count + s.left[i].absorbed.count, left[i]);
      all += left[i];
    }
    EXPECT_EQ(all, simulation.totals().absorbed + simulation.totals().escaped);
    EXPECT_GT(simulation.totals().absorbed, 0U);
  }
}

TEST(Residence, ParticlesThatAnEditAbsorbsCountByThemselves) {
  Environment environment(channel());
  SimulationOptions options;
  options.dt = 0.1;
  Simulation simulation(environment, options);
  StatisticsOptions statistics;
  statistics.residence = true;
  statistics.planes = {plane_at(4.0)};
  simulation.set_statistics(statistics);
  simulation.add({{1.5, 0.5, 0.5}, {1.5, 1.5, 0.5}, {6.5, 0.5, 0.5}}, {});
  for (int i = 0; i < 5; ++i) simulation.step();
  const ConvexTool tool = box_tool({1.0, 0.0, 0.0}, {2.0, 2.0, 2.0});
  apply(simulation, {0.0, Carve{tool, Carving::remove, true}, OrphanPolicy::absorb});
  simulation.step();
  EXPECT_EQ(simulation.statistics().absorbed_by_edits.count, 2U);
  EXPECT_NEAR(simulation.statistics().absorbed_by_edits.mean(), 0.5, 1e-12);
  EXPECT_TRUE(simulation.statistics().passages.empty());
}

StatisticsOptions everything() {
  StatisticsOptions statistics;
  statistics.hits = true;
  statistics.residence = true;
  statistics.planes = {plane_at(2.0, "two"), plane_at(6.0, "six")};
  statistics.pathlines_every = 50;
  statistics.pathlines_of = {7, 3};
  return statistics;
}

TEST(StatisticsTest, GoOnFromACheckpoint) {
  const auto run = [](Simulation& simulation, int steps, std::vector<PathPoint>& points) {
    for (int i = 0; i < steps; ++i) {
      simulation.step();
      const auto& now = simulation.statistics().path_points;
      points.insert(points.end(), now.begin(), now.end());
    }
  };
  Environment one(channel());
  const auto whole = plug_flow(one, everything());
  std::vector<PathPoint> points;
  run(*whole, 310, points);
  const SimulationCheckpoint saved = whole->checkpoint();
  std::vector<PathPoint> expected;
  run(*whole, 200, expected);
  Environment two(channel(), Threads{3});
  const auto resumed = plug_flow(two, everything());
  resumed->restore(saved);
  std::vector<PathPoint> found;
  run(*resumed, 200, found);
  EXPECT_EQ(resumed->statistics().planes, whole->statistics().planes);
  EXPECT_EQ(resumed->statistics().left, whole->statistics().left);
  EXPECT_EQ(resumed->statistics().hits.faces(), whole->statistics().hits.faces());
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.size(), 100U);
  EXPECT_EQ(resumed->state_hash(), whole->state_hash());
  Environment three(channel());
  const auto other = plug_flow(three, {});
  EXPECT_THROW(other->restore(saved), InvalidArgument);
}

TEST(StatisticsTest, ChangeNoStateAndWithoutThemThereAreNone) {
  std::vector<StateHash> hashes;
  for (const StatisticsOptions& statistics : {StatisticsOptions{}, everything()}) {
    Environment environment(channel());
    const auto simulation = plug_flow(environment, statistics);
    for (int i = 0; i < 100; ++i) simulation->step();
    hashes.push_back(simulation->state_hash());
    if (!statistics.any()) {
      EXPECT_TRUE(simulation->statistics().planes.empty());
      EXPECT_TRUE(simulation->statistics().path_points.empty());
      EXPECT_TRUE(simulation->statistics().hits.faces().empty());
    }
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// A particle that flies to and fro between two walls: its line is known.
TEST(Pathlines, HaveTheStartTheContactsAndTheEndsOfSteps) {
  Environment environment(channel(2));
  SimulationOptions options;
  options.dt = 1.0;
  options.response = Reflect{0.5};
  Simulation simulation(environment, options);
  StatisticsOptions statistics;
  statistics.pathlines_of = {1};
  simulation.set_statistics(statistics);
  simulation.add({{1.0, 0.5, 0.5}, {1.5, 0.5, 0.5}}, {1.0, 0.0, 0.0});
  const auto expect = [&](std::size_t i, double time, double x, double v, bool contact) {
    const PathPoint& p = simulation.statistics().path_points.at(i);
    EXPECT_EQ(p.id, 1U);
    EXPECT_NEAR(p.time, time, 1e-12);
    EXPECT_NEAR(p.position.x, x, 1e-12);
    EXPECT_NEAR(p.velocity.x, v, 1e-12);
    EXPECT_EQ(p.position.y, 0.5);
    EXPECT_EQ(p.contact, contact);
  };
  simulation.step();
  ASSERT_EQ(simulation.statistics().path_points.size(), 3U);
  expect(0, 0.0, 1.5, 1.0, false);
  expect(1, 0.5, 2.0, 1.0, true);
  expect(2, 1.0, 1.75, -0.5, false);
  simulation.step();
  ASSERT_EQ(simulation.statistics().path_points.size(), 1U);
  expect(0, 2.0, 1.25, -0.5, false);
}

TEST(Pathlines, AreThoseOfTheChosenParticlesAndEndWhereTheyLeave) {
  Environment environment(channel());
  StatisticsOptions statistics;
  statistics.pathlines_every = 50;
  statistics.pathlines_of = {7, 3};
  const auto simulation = plug_flow(environment, statistics, 2);
  std::map<std::uint64_t, std::vector<PathPoint>> lines;
  for (int i = 0; i < 600; ++i) {
    simulation->step();
    for (const PathPoint& p : simulation->statistics().path_points) lines[p.id].push_back(p);
  }
  ASSERT_EQ(lines.size(), 2U + (simulation->totals().injected + 49) / 50);
  EXPECT_TRUE(lines.contains(3) && lines.contains(7) && lines.contains(0) && lines.contains(1150));
  for (const auto& [id, line] : lines) {
    const Vec3 start = line.front().position;
    EXPECT_LE(start.x, 1.0 / 64);
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (i > 0) EXPECT_GT(line[i].time, line[i - 1].time);
      EXPECT_NEAR(line[i].position.x, start.x + 2.0 * (line[i].time - line.front().time), 1e-9);
      EXPECT_EQ(line[i].position.y, start.y);
      EXPECT_NEAR(line[i].velocity.x, 2.0, 1e-6);
      EXPECT_EQ(line[i].contact, i + 1 == line.size() && line[i].position.x > 8.0 - 1e-9);
    }
    if (id == 0) EXPECT_TRUE(line.back().contact);
  }
}

}  // namespace dartcast::statistics_test
