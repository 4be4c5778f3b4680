// The [[solid]] tables of a scene.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/scene_text.hpp"

namespace dartcast::scene_solids_test {

using test::box;
using test::expect_error;

TEST(SceneSolids, AreRead) {
  const Scene s = parse_scene(box + R"(
[[solid]]
surface = "jaw.stl"
scale = 0.5
rotate = [0.0, 0.5, 0.0]
at = [1.0, 2.0, 3.0]
[[solid]]
name = "needle"
points = [[0.0, 0.0, 0.0], [0, 0, 1]]
pivot = [0.0, 0.0, 0.5]
catch_up = true
meets = ["solid1"]
moves = [{ until = 1.0, velocity = [0.0, 0.0, 0.1], turn = [1.0, 0.0, 0.0] }]
)",
                              "folder/scene.toml");
  ASSERT_EQ(s.solids.size(), 2U);
  EXPECT_EQ(s.solids[0].name, "solid1");
  EXPECT_EQ(std::get<std::filesystem::path>(s.solids[0].shape), "folder/jaw.stl");
  EXPECT_EQ(s.solids[0].scale, 0.5);
  EXPECT_EQ(s.solids[0].rotate, (Vec3{0.0, 0.5, 0.0}));
  EXPECT_EQ(s.solids[0].pivot, (Vec3{1.0, 2.0, 3.0})) << "where it is put";
  EXPECT_FALSE(s.solids[0].catch_up);
  EXPECT_EQ(s.solids[1].name, "needle");
  EXPECT_EQ(std::get<std::vector<Vec3>>(s.solids[1].shape), (std::vector<Vec3>{{0, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(s.solids[1].pivot, (Vec3{0.0, 0.0, 0.5}));
  EXPECT_TRUE(s.solids[1].catch_up);
  EXPECT_FALSE(s.solids[0].meets);
  EXPECT_EQ(s.solids[1].meets, std::vector<std::string>{"solid1"});
  ASSERT_EQ(s.solids[1].moves.size(), 1U);
  EXPECT_EQ(s.solids[1].moves[0].velocity, (Vec3{0.0, 0.0, 0.1}));
  EXPECT_EQ(s.solids[1].moves[0].turn, (Vec3{1.0, 0.0, 0.0}));
}

TEST(SceneSolids, AreRefusedWithTheirLine) {
  const std::string solid = box + "[[solid]]\n";
  expect_error(solid, "3:", "give either surface");
  expect_error(solid + "surface = 'a.stl'\npoints = [[0, 0, 0]]\n", "4:", "give either surface");
  expect_error(solid + "points = []\n", "4:", "empty");
  expect_error(solid + "points = 3\n", "4:", "list of points");
  expect_error(solid + "points = [[0, 0, 0], [1, 2]]\n", "4:", "point 2 must be a list of 3 numbers");
  expect_error(solid + "points = [[0, 0, 'a']]\n", "4:", "number");
  expect_error(solid + "points = [[0, 0, 0]]\nmoves = [{ velocity = [0, 0, 1] }]\n", "5:", "until is missing");
}

}  // namespace dartcast::scene_solids_test
