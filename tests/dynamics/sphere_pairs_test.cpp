#include "dynamics/sphere_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/random.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::sphere_pairs_test {

MeshData box_mesh(std::uint32_t n, double blocked_share) {
  BoxOptions o;
  o.cells = {n, n, n};
  o.size = {double(n), double(n), double(n)};
  o.blocked_share = blocked_share;
  o.jitter = 0.3;
  return generate_box(o);
}

struct Crowd {
  Environment environment;
  Particles particles;
  std::vector<SphereMotion> spheres;
  CellLists lists;

  Crowd(std::uint32_t cells, double blocked_share) : environment(box_mesh(cells, blocked_share), Threads{1}) {}

  // `sphere`: gives a motion for a place.
  template <class Sphere>
  void fill(std::size_t count, const Vec3& low, const Vec3& high, std::uint64_t seed, Sphere&& sphere) {
    Random random(seed);
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < count; ++i) {
      places.push_back({random.uniform(low.x, high.x), random.uniform(low.y, high.y), random.uniform(low.z, high.z)});
    }
    for (const AddResult& a : environment.add(particles, places)) {
      if (a.particle == 0xffffffffU) continue;
      spheres.push_back(sphere(random));
      spheres.back().centre = particles[a.particle].position;
    }
    lists.update(environment.map(), particles.states());
  }

  std::vector<SpherePair> find(PairSearch search, unsigned threads = 1) {
    PairFinder finder;
    const auto pairs = finder.find(environment.complex(), lists, particles.states(), spheres, Threads{threads}, search);
    EXPECT_EQ(finder.by_lists(), search == PairSearch::lists);
    return {pairs.begin(), pairs.end()};
  }

  // Those without a wall in between.
  std::vector<SpherePair> facing(std::vector<SpherePair> pairs) {
    std::erase_if(
        pairs, [&](const SpherePair& p) { return separated(environment.complex(), particles[p.a], particles[p.b]); });
    return pairs;
  }
};

// Some radius over three orders of magnitude, most of them small, and a motion of about as much.
SphereMotion any_sphere(Random& random) {
  const double radius = std::pow(10.0, -random.uniform(0.5, 3.0));
  const auto part = [&] { return random.uniform(-radius, radius); };
  return {{}, {part(), part(), part()}, radius};
}

std::vector<SpherePair> all_that_meet(std::span<const SphereMotion> spheres) {
  std::vector<SpherePair> pairs;
  for (std::uint32_t a = 0; a < spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size(); ++b) {
      if (spheres[a].radius > 0.0 && spheres[b].radius > 0.0 && approach(spheres[a], spheres[b]).distance <= 0.0)
        pairs.push_back({a, b});
    }
  }
  return pairs;
}

bool boxes_meet(const SphereMotion& a, const SphereMotion& b) {
  const auto within = [&](double x, double dx, double y, double dy) {
    const double reach = a.radius + b.radius;
    return std::max(x, x + dx) + reach >= std::min(y, y + dy) - 1e-12 &&
           std::min(x, x + dx) - reach <= std::max(y, y + dy) + 1e-12;
  };
  return within(a.centre.x, a.displacement.x, b.centre.x, b.displacement.x) &&
         within(a.centre.y, a.displacement.y, b.centre.y, b.displacement.y) &&
         within(a.centre.z, a.displacement.z, b.centre.z, b.displacement.z);
}

// Sorted, each once, none whose boxes are apart, all that meet.
void expect_complete(std::span<const SpherePair> found, std::span<const SpherePair> meeting,
                     std::span<const SphereMotion> spheres) {
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  for (const SpherePair& p : found) {
    EXPECT_LT(p.a, p.b);
    EXPECT_TRUE(boxes_meet(spheres[p.a], spheres[p.b]));
  }
  EXPECT_TRUE(std::includes(found.begin(), found.end(), meeting.begin(), meeting.end()));
}

TEST(SpherePairs, AllThatMeetAreFound) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Crowd crowd(5, 0.0);
    crowd.fill(std::max<std::size_t>(100, test::scaled<std::size_t>(1500, 5000)), {0, 0, 0}, {5, 5, 5}, seed,
               any_sphere);
    const auto meeting = all_that_meet(crowd.spheres);
    EXPECT_GT(meeting.size(), test::sanitized() ? 0U : crowd.spheres.size() / 20);
    const auto by_grid = crowd.find(PairSearch::grid);
    expect_complete(by_grid, meeting, crowd.spheres);
    EXPECT_EQ(crowd.find(PairSearch::lists), by_grid);
  }
}

// A finder that is used step after step gives the pairs of a new one, whether spheres creep, fly, jump or change.
TEST(SpherePairs, EarlierStepsDoNotMatter) {
  Crowd crowd(5, 0.0);
  crowd.fill(std::max<std::size_t>(400, test::scaled<std::size_t>(400, 2000)), {1, 1, 1}, {4, 4, 4}, 5, any_sphere);
  PairFinder kept;
  Random random(6);
  std::size_t pairs = 0;
  for (int step = 0; step < 120; ++step) {
    const double speed = step < 40 ? 0.001 : step < 80 ? 0.1 : 1.0;
    for (SphereMotion& s : crowd.spheres) s.centre += s.displacement * speed;
    if (step % 10 == 9) std::swap(crowd.spheres[random.below(100)].centre, crowd.spheres[random.below(100)].centre);
    if (step % 25 == 24) crowd.spheres[random.below(100)].radius *= step % 2 == 0 ? 0.0 : 1.5;
    if (step == 60) crowd.spheres.pop_back();
    const auto found = kept.find(crowd.spheres);
    PairFinder fresh;
    const auto expected = fresh.find(crowd.spheres);
    ASSERT_TRUE(std::equal(found.begin(), found.end(), expected.begin(), expected.end())) << step;
    pairs += found.size();
  }
  EXPECT_GT(pairs, 1000U);
}

// Some cells are blocked: pairs that see each other are found by either search, and these are the same.
TEST(SpherePairs, WallsSeparate) {
  Crowd crowd(6, 0.3);
  crowd.fill(std::max<std::size_t>(600, test::scaled<std::size_t>(1500, 4000)), {0, 0, 0}, {6, 6, 6}, 4, any_sphere);
  const auto meeting = all_that_meet(crowd.spheres);
  const auto facing = crowd.facing(meeting);
  EXPECT_LT(facing.size(), meeting.size() + (test::sanitized() ? 1U : 0U));
  const auto by_lists = crowd.find(PairSearch::lists);
  expect_complete(by_lists, facing, crowd.spheres);
  const auto by_grid = crowd.find(PairSearch::grid);
  expect_complete(by_grid, meeting, crowd.spheres);
  EXPECT_EQ(crowd.facing(by_lists), crowd.facing(by_grid));
}

// Two sides of a layer of blocked cells.
TEST(SpherePairs, BothSidesOfAWall) {
  Environment environment(box_mesh(3, 0.0), Threads{1});
  environment.edit([](ComplexEdit& e) {
    for (const Cell c : e.topology().map().cells()) {
      if (e.topology().map().source(c) % 9 / 3 == 1) e.topology().set_free(c, false);
    }
  });
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{1.5, 0.8, 1.5}, {1.5, 2.2, 1.5}, {1.6, 0.8, 1.5}});
  ASSERT_EQ(particles.size(), 3U);
  EXPECT_TRUE(separated(environment.complex(), particles[0], particles[1]));
  EXPECT_TRUE(separated(environment.complex(), particles[1], particles[0]));
  EXPECT_FALSE(separated(environment.complex(), particles[0], particles[2]));
}

// A wall far from one of them, and particles that are held.
TEST(SpherePairs, SeparatedByAWallFarAway) {
  Environment environment(box_mesh(6, 0.0), Threads{1});
  environment.edit([](ComplexEdit& e) {
    for (const Cell c : e.topology().map().cells()) {
      if (e.topology().map().source(c) % 36 / 6 == 4) e.topology().set_free(c, false);
    }
  });
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{3.5, 0.3, 3.5}, {3.5, 5.7, 3.5}, {3.5, 3.5, 3.5}});
  ASSERT_EQ(particles.size(), 3U);
  EXPECT_TRUE(separated(environment.complex(), particles[0], particles[1]));
  EXPECT_TRUE(separated(environment.complex(), particles[1], particles[0]));
  EXPECT_FALSE(separated(environment.complex(), particles[0], particles[2]));
  ParticleState held = particles[0];
  held.held = true;
  EXPECT_FALSE(separated(environment.complex(), held, particles[1]));
  EXPECT_FALSE(separated(environment.complex(), particles[1], held));
}

// None reaches further than the other; and as far as they can, over several cells.
TEST(SpherePairs, EqualSpheresByLists) {
  Crowd crowd(4, 0.0);
  crowd.fill(std::max<std::size_t>(60, test::scaled<std::size_t>(300, 1000)), {0, 0, 0}, {4, 4, 4}, 9, [](Random&) {
    return SphereMotion{{}, {}, 0.15};
  });
  const auto meeting = all_that_meet(crowd.spheres);
  EXPECT_FALSE(meeting.empty());
  expect_complete(crowd.find(PairSearch::lists), meeting, crowd.spheres);
  Crowd two(8, 0.0);
  const auto add = [&](double x) {
    two.fill(1, {x, 4.4, 4.4}, {x, 4.4, 4.4}, 1, [](Random&) { return SphereMotion{{}, {}, 3.0}; });
  };
  add(0.5);
  add(6.45);
  ASSERT_EQ(two.spheres.size(), 2U);
  EXPECT_EQ(two.find(PairSearch::lists).size(), 1U);
}

TEST(SpherePairs, ThousandsInOneCellAndOneHugeSphere) {
  Crowd crowd(3, 0.0);
  const auto count = std::max<std::size_t>(200, test::scaled<std::size_t>(3000, 10000));
  crowd.fill(count, {1.2, 1.2, 1.2}, {1.8, 1.8, 1.8}, 5, any_sphere);
  crowd.spheres[7].radius = 2.0;
  crowd.spheres[11].displacement = {2.0, 1.0, 0.0};
  const auto meeting = all_that_meet(crowd.spheres);
  const auto by_grid = crowd.find(PairSearch::grid);
  expect_complete(by_grid, meeting, crowd.spheres);
  EXPECT_EQ(crowd.find(PairSearch::lists), by_grid);
  PairFinder finder;
  finder.find(crowd.environment.complex(), crowd.lists, crowd.particles.states(), crowd.spheres);
  EXPECT_FALSE(finder.by_lists());
}

TEST(SpherePairs, ThreadsAndPointsAndCoincidence) {
  Crowd crowd(4, 0.1);
  crowd.fill(std::max<std::size_t>(600, test::scaled<std::size_t>(4000, 20000)), {0, 0, 0}, {4, 4, 4}, 6, any_sphere);
  for (std::size_t i = 0; i < crowd.spheres.size(); i += 3) crowd.spheres[i].radius = 0.0;
  crowd.spheres[1].centre = crowd.spheres[2].centre = {0.0, 0.0, 0.0};  // and on a corner of the grid's cells
  for (const PairSearch search : {PairSearch::lists, PairSearch::grid}) {
    if (search == PairSearch::lists) {
      crowd.spheres[1].centre = crowd.particles[1].position;
      crowd.spheres[2].centre = crowd.particles[2].position;
    }
    const auto one = crowd.find(search, 1);
    for (const SpherePair& p : one) EXPECT_TRUE(p.a % 3 != 0 && p.b % 3 != 0);
    EXPECT_EQ(crowd.find(search, 2), one);
    EXPECT_EQ(crowd.find(search, 5), one);
  }
}

// Boxes that touch in one plane, on the planes of the grid.
TEST(SpherePairs, LatticeOfTouchingSpheres) {
  std::vector<SphereMotion> spheres;
  for (int x = -4; x < 4; ++x) {
    for (int y = -4; y < 4; ++y) spheres.push_back({{double(x), double(y), 0.0}, {}, 0.5});
  }
  spheres.push_back({{1e9, 0.0, 0.0}, {}, 0.5});  // far away: the grid's cells get no finer than it allows
  PairFinder finder;
  const auto pairs = finder.find(spheres);
  EXPECT_EQ(pairs.size(), 7U * 8U * 2U + 7U * 7U * 2U);
}

TEST(CellLists, FollowMotionEditsAndRemovals) {
  Crowd crowd(4, 0.2);
  crowd.fill(std::max<std::size_t>(200, test::scaled<std::size_t>(2000, 10000)), {0, 0, 0}, {4, 4, 4}, 7, any_sphere);
  Random random(8);
  const auto expect_right = [&] {
    crowd.lists.update(crowd.environment.map(), crowd.particles.states());
    std::size_t listed = 0;
    std::size_t crowded = 0;
    for (const Cell c : crowd.environment.map().cells()) {
      std::set<std::uint32_t> in_cell;
      crowd.lists.for_each(c, [&](std::uint32_t i) {
        EXPECT_EQ(crowd.particles[i].cell, c);
        EXPECT_TRUE(in_cell.insert(i).second);
      });
      EXPECT_EQ(in_cell.size(), crowd.lists.count(c));
      listed += in_cell.size();
      crowded += in_cell.size() > CellLists::short_list ? 1 : 0;
    }
    EXPECT_EQ(listed, crowd.particles.size());
    EXPECT_EQ(crowd.lists.crowded(), crowded);
  };
  expect_right();
  EXPECT_EQ(crowd.lists.crossed(), 0U);
  for (int step = 0; step < 5; ++step) {
    std::vector<Vec3> targets;
    for (const ParticleState& s : crowd.particles.states())
      targets.push_back(s.position + Vec3{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.1});
    crowd.environment.advance(crowd.particles, targets);
    expect_right();
    EXPECT_GT(crowd.lists.crossed(), 0U);
    EXPECT_LT(crowd.lists.crossed(), crowd.particles.size());
  }
  std::vector<std::uint8_t> marks(crowd.particles.size(), 0);
  for (std::size_t i = 0; i < marks.size(); i += 1 + random.below(3)) marks[i] = 1;
  crowd.particles.remove(marks);
  expect_right();
  crowd.environment.edit([&](ComplexEdit& e) {
    const CombinatorialMap& map = e.topology().map();
    split_edge(e.topology(), {crowd.particles[0].cell, 0});
    EXPECT_TRUE(map.cell_count() > 0);
  });
  crowd.environment.update_after_edit(crowd.particles);
  expect_right();
  Particles none;
  crowd.lists.update(crowd.environment.map(), none.states());
  EXPECT_EQ(crowd.lists.size(), 0U);
  EXPECT_EQ(crowd.lists.crowded(), 0U);
}

}  // namespace dartcast::sphere_pairs_test
