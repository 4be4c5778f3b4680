// The faces that a box reaches, and the boxes of walls that move: against a look at each of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/random.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/predicates.hpp"
#include "dartcast/remeshing.hpp"
#include "dynamics/moving_walls.hpp"
#include "dynamics/reached_faces.hpp"
#include "predicates/moving_pair.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::reach_test {

using test::cubes;
using test::random_vector;

// Whether all of some points, before and after, lie beyond one side of the box.
bool misses(std::span<const std::uint16_t> points, const CellView& cell, std::span<const Vec3> before,
            std::span<const Vec3> after, const detail::MovingBox& box) {
  const auto all = [&](auto&& beyond) {
    return std::all_of(points.begin(), points.end(), [&](std::uint16_t p) {
      const std::size_t v = cell.vertex(p).value;
      return beyond(before[v]) && beyond(after[v] - box.shift);
    });
  };
  return all([&](const Vec3& x) { return x.x < box.low.x; }) || all([&](const Vec3& x) { return x.x > box.high.x; }) ||
         all([&](const Vec3& x) { return x.y < box.low.y; }) || all([&](const Vec3& x) { return x.y > box.high.y; }) ||
         all([&](const Vec3& x) { return x.z < box.low.z; }) || all([&](const Vec3& x) { return x.z > box.high.z; });
}

TEST(Reach, FacesOfEachTypeWithEachInstructionSet) {
  Random random(3);
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron, CellType::pyramid, CellType::prism}) {
    const CellComplex complex(cubes(2, type, 0.05, 0.0, 1), Threads{1});
    const std::span<const Vec3> before = complex.positions();
    std::vector<Vec3> after;
    for (const Vec3& x : before) after.push_back(x + random_vector(random, 0.3));
    for (int k = 0; k < 40; ++k) {
      detail::MovingBox box;
      box.low = Vec3{1, 1, 1} + random_vector(random, 1.2);
      box.high = box.low + Vec3{random.uniform(0, 0.5), random.uniform(0, 0.5), random.uniform(0, 0.5)};
      box.shift = random_vector(random, 0.3);
      for (const Cell c : complex.map().cells()) {
        const CellView cell = complex.map().view(c);
        std::uint64_t expected = 0;
        for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
          const bool missed = misses(cell.shape().corners(f), cell, before, after, box);
          expected |= std::uint64_t{!missed} << f;
        }
        for (const auto set : {detail::InstructionSet::portable, detail::best_instruction_set()}) {
          ASSERT_EQ(detail::reached_faces(cell.shape(), cell.vertices().data(), before.data(), after.data(), box, set),
                    expected);
        }
      }
    }
  }
}

// After moves and an edit, too.
TEST(Reach, WallsWhoseBoxesMeetAWay) {
  Random random(5);
  Environment environment(cubes(6, CellType::hexahedron, 0.05, 0.3, 2), Threads{1});
  MovingWalls walls;
  for (std::uint64_t move = 0; move < 6; ++move) {
    if (move == 3) environment.edit([&](ComplexEdit& e) { subdivide(e, *environment.map().cells().begin()); });
    std::vector<Vec3> next;
    for (const Vec3& x : environment.positions()) next.push_back(x + random_vector(random, 0.1));
    environment.move(next);
    const CellComplex& complex = environment.complex();
    walls.list(complex, {1, environment.edit_count()});
    walls.update(complex, Threads{1});
    for (int k = 0; k < 50; ++k) {
      const Vec3 from = Vec3{3, 3, 3} + random_vector(random, 3.0);
      const Vec3 to = from + random_vector(random, 0.5);
      const Box way = join({from, from}, {to, to});
      std::vector<WayAndWall> pairs;
      walls.find_near(from, to, 7, pairs);
      std::set<WallCorners> found;
      for (const WayAndWall& p : pairs) {
        ASSERT_EQ(p.way, 7U);
        found.insert(p.corners);
      }
      ASSERT_EQ(found.size(), pairs.size());
      for (const Cell c : complex.map().cells()) {
        const CellView cell = complex.map().view(c);
        for (std::uint16_t f = 0; cell.is_free() && f < cell.shape().face_count(); ++f) {
          if (!cell.is_wall(f)) continue;
          Box box{complex.positions()[cell.vertex(cell.shape().corners(f)[0]).value], {}};
          box.high = box.low;
          for (const std::uint16_t p : cell.shape().corners(f)) {
            for (const auto& x : {complex.positions(), complex.previous_positions()})
              box = join(box, {x[cell.vertex(p).value], x[cell.vertex(p).value]});
          }
          for (std::uint16_t t = 0; t < cell.shape().triangle_count(f); ++t) {
            const auto local = cell.shape().triangle(f, t);
            const WallCorners corners = {cell.vertex(local[0]).value, cell.vertex(local[1]).value,
                                         cell.vertex(local[2]).value};
            ASSERT_EQ(found.contains(corners), overlap(box, way));
          }
        }
      }
    }
  }
}

// Points, vertices and pairs of them: anywhere, on a lattice, or points on the first triangle, but for rounding.
struct Pairs {
  std::vector<Vec3> before, after, targets;
  std::vector<ParticleState> states;
  std::vector<WayAndWall> pairs;

  Pairs(Random& random, int k) {
    const double unit = std::array{1.0, 0x1p-20, 0x1p200, 0x1p-290, 0x1p-302}[static_cast<std::size_t>(k) % 5];
    const auto place = [&] {
      const Vec3 x = random_vector(random, 2.0);
      return (k % 3 == 0 ? Vec3{std::floor(x.x), std::floor(x.y), std::floor(x.z)} : x) * unit;
    };
    for (std::uint32_t i = 0; i < 9; ++i) {
      before.push_back(place());
      after.push_back(before.back() + place() * 0.25);
      states.emplace_back().position = flushed(place());
      targets.push_back(flushed(states.back().position + place() * 0.25));
    }
    if (k % 50 == 1) after[3].x = std::numeric_limits<double>::infinity();
    if (k % 50 == 2) after[4].y = std::nan("");
    const auto on_wall = [&](const std::vector<Vec3>& x) {
      return flushed(x[0] * 0.3125 + x[1] * 0.25 + x[2] * 0.4375 + random_vector(random, 0x1p-52 * unit));
    };
    for (std::uint32_t i = 0; k % 4 == 1 && i < 3; ++i) {
      states[i].position = on_wall(before);
      targets[i] = on_wall(after);
      pairs.push_back({i, {0, 1, 2}});
    }
    const auto any = [&] { return static_cast<std::uint32_t>(random.uniform(0.0, 9.0)); };
    for (int i = 0; i < k % 14; ++i) pairs.push_back({any(), {any(), any(), any()}});
  }
  [[nodiscard]] std::vector<WayAndWall> undecided(detail::InstructionSet set) const {
    std::vector<WayAndWall> rest = pairs;
    rest.resize(detail::keep_undecided(rest, states.data(), targets.data(), before.data(), after.data(), set));
    return rest;
  }
  [[nodiscard]] bool touch(const WayAndWall& p) const {
    detail::MovingPair pair{{states[p.way].position}, {targets[p.way]}};
    for (std::size_t i = 0; i < 3; ++i) {
      pair.from[i + 1] = flushed(before[p.corners[i]]);
      pair.to[i + 1] = flushed(after[p.corners[i]]);
    }
    return detail::exact_touch(pair, detail::PairKind::vertex_face).has_value();
  }
};

// The filter in vectors proves nothing that is not so, keeps the order, and is the same with each instruction set.
TEST(Reach, PairsThatAreProvedApart) {
  Random random(9);
  std::size_t kept = 0;
  std::size_t all = 0;
  for (int k = 0; k < test::scaled(3000, 60000); ++k) {
    const Pairs some(random, k);
    const std::vector<WayAndWall> rest = some.undecided(detail::best_instruction_set());
    const std::vector<WayAndWall> portable = some.undecided(detail::InstructionSet::portable);
    const auto same = [](const WayAndWall& a, const WayAndWall& b) { return a.way == b.way && a.corners == b.corners; };
    ASSERT_TRUE(std::equal(rest.begin(), rest.end(), portable.begin(), portable.end(), same)) << k;
    std::size_t next = 0;
    for (const WayAndWall& p : some.pairs) {
      if (next < rest.size() && same(p, rest[next]))
        ++next;
      else
        ASSERT_FALSE(some.touch(p)) << k;
    }
    ASSERT_EQ(next, rest.size()) << k;
    kept += rest.size();
    all += some.pairs.size();
  }
  EXPECT_LT(kept, all - all / 5);
  EXPECT_GT(kept, all / 10);
}

}  // namespace dartcast::reach_test
