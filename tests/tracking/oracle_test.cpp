// The oracle itself, on cases that one can see.
#include "oracle/oracle.hpp"

#include <gtest/gtest.h>

#include "oracle/scenes.hpp"

namespace dartcast::oracle::oracle_test {

constexpr std::uint32_t two_cubes[2][8] = {{0, 1, 4, 3, 6, 7, 10, 9}, {1, 2, 5, 4, 7, 8, 11, 10}};

// Cubes side by side along x: [0, 2] x [0, 2] x [0, 2] and [2, 4] x [0, 2] x [0, 2].
MeshData cubes(bool second_is_free) {
  MeshData mesh;
  for (const double z : {0.0, 2.0}) {
    for (const double y : {0.0, 2.0}) {
      for (const double x : {0.0, 2.0, 4.0}) mesh.points.push_back({x, y, z});
    }
  }
  for (const auto& corners : two_cubes) mesh.add_cell(CellType::hexahedron, corners);
  mesh.free = {1, static_cast<std::uint8_t>(second_is_free ? 1 : 0)};
  return mesh;
}

TEST(Oracle, CutsAHexahedronIntoSixSimplicesAndAWallIntoTwoTriangles) {
  const Oracle oracle(cubes(false));
  EXPECT_EQ(oracle.triangulation().simplices().size(), 12U);
  EXPECT_EQ(oracle.triangulation().walls().size(), 12U);
  EXPECT_TRUE(oracle.all_positive());
  EXPECT_EQ(Oracle(cubes(true)).triangulation().walls().size(), 20U);
}

TEST(Oracle, FindsEverySimplexThatContainsAPoint) {
  const Oracle oracle(cubes(false));
  EXPECT_EQ(oracle.all_containing({0.0, 0.0, 0.0}).size(), 6U);  // the corner that the cell is coned from
  EXPECT_EQ(oracle.all_containing({3.0, 1.0, 1.0}).size(), 0U);
  EXPECT_EQ(oracle.all_containing({3.125, 0.75, 0.25}, false).size(), 1U);
  EXPECT_TRUE(oracle.all_containing({-0x1p-1000, 1.0, 1.0}).empty());
  const auto at = [&](const Vec3& q) { return oracle.dimension_at(oracle.all_containing(q)[0], q); };
  EXPECT_EQ(at({2.0, 2.0, 0.0}), 0);
  EXPECT_EQ(at({1.0, 2.0, 0.0}), 1);
  EXPECT_EQ(at({1.0, 1.0, 0.0}), 2);  // on a diagonal
  EXPECT_EQ(at({1.0, 1.5, 0.0}), 2);
  EXPECT_EQ(at({1.0, 1.0, 1.0}), 3);
}

TEST(Oracle, SeesTheWallThatIsPassed) {
  const Oracle oracle(cubes(false));
  const Trace t = oracle.trace({1.0, 1.5, 0.5}, {5.0, 1.5, 0.5});
  ASSERT_TRUE(t.leaves);
  EXPECT_EQ(t.exit_time, 0.25);
  ASSERT_EQ(t.touches.size(), 1U);  // the boundary behind belongs to a blocked cell
  EXPECT_TRUE(t.touches[0].passes_out());
  EXPECT_EQ(t.touches[0].dimension, 2);
  const Trace open = Oracle(cubes(true)).trace({1.0, 1.5, 0.5}, {5.0, 1.5, 0.5});
  EXPECT_EQ(open.exit_time, 0.75);
}

TEST(Oracle, DistinguishesEdgesAndCornersFromFaces) {
  const Oracle oracle(cubes(false));
  const auto dimension = [&](const Vec3& q) { return oracle.trace({1.0, 1.0, 1.0}, q).touches.at(0).dimension; };
  EXPECT_EQ(dimension({3.0, 3.0, 3.0}), 0);
  EXPECT_EQ(dimension({3.0, 3.0, 1.0}), 1);
  EXPECT_EQ(dimension({3.0, 1.0, 1.0}), 2);
  EXPECT_EQ(oracle.trace({1.0, 1.0, 1.0}, {3.0, 3.0, 3.0}).touches.size(), oracle.walls_at({2.0, 2.0, 2.0}).size());
}

TEST(Oracle, DistinguishesAGrazeAndASlideFromAPassage) {
  const Oracle oracle(cubes(false));
  const Trace slide = oracle.trace({0.5, 0.25, 0.0}, {1.5, 1.75, 0.0});
  EXPECT_FALSE(slide.leaves);
  ASSERT_EQ(slide.touches.size(), 2U);
  EXPECT_EQ(slide.touches[0].time, 0.0);
  EXPECT_EQ(slide.touches[1].time, 0.5);  // the second triangle, from the diagonal (0.75, 0.75) on
  for (const Touch& t : slide.touches) EXPECT_TRUE(t.lies_in_plane());
  const Trace over_the_end = oracle.trace({1.0, 1.0, 0.0}, {3.0, 1.0, 0.0});
  EXPECT_TRUE(over_the_end.leaves);
  EXPECT_EQ(over_the_end.exit_time, 0.5);
  const Trace ends = oracle.trace({1.0, 0.5, 0.5}, {2.0, 0.5, 0.5});
  EXPECT_FALSE(ends.leaves);
  EXPECT_TRUE(ends.touches.at(0).ends_on());
  EXPECT_TRUE(oracle.trace({1.0, 0.5, 0.5}, {1.0, 0.5, 0.5}).touches.empty());
}

// Four cubes around the edge x = y = 2, two of them, diagonally opposite, free: a path through the edge stays in the
// closed free cells, a path beside it does not.
TEST(Oracle, FollowsAPathThroughAnEdgeBetweenFreeCells) {
  MeshData mesh;
  for (const double z : {0.0, 2.0}) {
    for (const double y : {0.0, 2.0, 4.0}) {
      for (const double x : {0.0, 2.0, 4.0}) mesh.points.push_back({x, y, z});
    }
  }
  for (const std::uint32_t v : {0U, 1U, 3U, 4U}) {
    const std::uint32_t corners[] = {v, v + 1, v + 4, v + 3, v + 9, v + 10, v + 13, v + 12};
    mesh.add_cell(CellType::hexahedron, corners);
  }
  mesh.free = {1, 0, 0, 1};
  const Oracle oracle(mesh);
  const Trace through = oracle.trace({1.0, 1.0, 1.0}, {3.0, 3.0, 1.0});
  EXPECT_FALSE(through.leaves);
  EXPECT_EQ(through.touches.at(0).dimension, 1);
  const Trace beside = oracle.trace({1.0, 1.0, 1.0}, {3.0, 3.0 + 0x1p-50, 1.0});
  EXPECT_TRUE(beside.leaves);
  const auto start = oracle.all_containing({2.0, 2.0, 1.0});
  const auto of_first = std::find_if(start.begin(), start.end(),
                                     [&](std::uint32_t s) { return oracle.triangulation().simplices()[s].cell == 0; });
  EXPECT_FALSE(oracle.can_start(*of_first, {2.0, 2.0, 1.0}, {3.0, 3.0, 1.0}));
  EXPECT_TRUE(oracle.can_start(*of_first, {2.0, 2.0, 1.0}, {1.0, 1.0, 1.0}));
}

TEST(Oracle, MakesScenesOfEveryKindThatAreValidWithoutAWarp) {
  for (int k = 0; k < scene_kinds; ++k) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto kind = static_cast<SceneKind>(k);
      if (kind == SceneKind::flat_corners) continue;  // they need Steiner points
      EXPECT_TRUE(Oracle(random_scene(kind, seed, 0.0)).all_positive()) << name_of(kind) << " " << seed;
      EXPECT_TRUE(Oracle(lattice_scene(kind, seed)).all_positive()) << name_of(kind) << " " << seed;
    }
  }
}

}  // namespace dartcast::oracle::oracle_test
