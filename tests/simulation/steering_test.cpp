// Catheters and tools moved by hand. The truth is the same simulation whose scene has these moves.
#include <gtest/gtest.h>

#include <limits>

#include "dartcast/deformation.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "support/meshes.hpp"

namespace dartcast::steering_test {

constexpr double for_ever = std::numeric_limits<double>::infinity();

Scene scene_with_tools() {
  Scene scene;
  scene.environment.mesh = test::cubes(4);
  scene.motion.dt = 0.01;
  CatheterScene catheter;
  catheter.options.entry = {2.3, 2.2, 0.4};
  catheter.options.direction = {0.1, 0.0, 1.0};
  catheter.options.length = 3.0;
  catheter.options.spacing = 0.25;
  catheter.options.tip_length = 0.75;
  catheter.options.tip_curvature = 0.5;
  scene.catheters = {catheter};
  SolidScene line;
  line.shape = std::vector<Vec3>{{0.5, 0.5, 2.0}, {0.9, 0.6, 2.5}};
  line.pivot = {0.5, 0.5, 2.0};
  scene.solids = {line};
  return scene;
}

TEST(Steering, IsTheMotionOfTheScene) {
  const CatheterScene::Move push = {for_ever, 7.0, 3.0};
  const SolidScene::Move turn = {for_ever, {0.7, 0.3, -0.2}, {0.0, 2.0, 1.0}};
  Scene scene = scene_with_tools();
  Simulation by_hand(scene);
  scene.catheters[0].moves = {push};
  scene.solids[0].moves = {turn};
  Simulation planned(scene);
  by_hand.steer(0, {push.push * 0.01, push.turn * 0.01, {}});
  by_hand.steer_solid(0, turn.velocity, turn.turn);
  for (int step = 0; step < 20; ++step) {
    by_hand.step();
    planned.step();
    ASSERT_EQ(by_hand.state_hash(), planned.state_hash()) << step;
  }
  EXPECT_GT(by_hand.catheter(0).inserted(), 1.0);

  by_hand.steer(0, {});
  by_hand.steer_solid(0, {});
  const StateHash rest = by_hand.state_hash();
  const double inserted = by_hand.catheter(0).inserted();
  by_hand.step();
  EXPECT_EQ(by_hand.catheter(0).inserted(), inserted);
  EXPECT_EQ(by_hand.solids_step().made, (std::vector<double>{1.0}));
  planned.step();
  EXPECT_NE(planned.state_hash(), rest);
  EXPECT_EQ(by_hand.audit().failed, 0U);
}

// A tool that is pushed into a wall by hand stops before it, and turns there.
TEST(Steering, StopsAtWalls) {
  Simulation simulation(scene_with_tools());
  simulation.steer_solid(0, {-3.0, 0.0, 0.0});
  for (int step = 0; step < 30; ++step) simulation.step();
  EXPECT_LT(simulation.solids_step().made[0], 1.0);
  const Vec3 before = simulation.solids()->positions()[1];
  simulation.steer_solid(0, {}, {0.0, 0.0, 1.0});
  simulation.step();
  EXPECT_NE(simulation.solids()->positions()[1], before);
  EXPECT_EQ(simulation.audit().failed, 0U);
}

TEST(Steering, RefusesWithoutAChange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Simulation refusing(scene_with_tools());
  Simulation plain(scene_with_tools());
  for (Simulation* s : {&refusing, &plain}) {
    s->steer(0, {0.05, 0.1, {}});
    s->steer_solid(0, {0.1, 0.0, 0.0}, {0.0, 0.0, 1.0});
  }
  EXPECT_THROW(refusing.steer(1, {}), InvalidArgument);
  EXPECT_THROW(refusing.steer(0, {nan, 0.0, {}}), InvalidArgument);
  EXPECT_THROW(refusing.steer(0, {0.0, 7.0, {}}), InvalidArgument);
  EXPECT_THROW(refusing.steer_solid(1, {}), InvalidArgument);
  EXPECT_THROW(refusing.steer_solid(0, {0.0, nan, 0.0}), InvalidArgument);
  EXPECT_THROW(refusing.steer_solid(0, {}, {0.0, 0.0, nan}), InvalidArgument);
  EXPECT_THROW(refusing.steer_solid(0, {}, {0.0, 0.0, 1e9}), InvalidArgument);
  for (int step = 0; step < 5; ++step) {
    refusing.step();
    plain.step();
  }
  EXPECT_EQ(refusing.state_hash(), plain.state_hash());
}

TEST(PullAround, FadesOutAtItsReach) {
  const std::vector<Vec3> positions = {{1.0, 0.0, 0.0}, {1.5, 0.0, 0.0}, {1.0, 1.0, 0.0}, {5.0, 0.0, 0.0}};
  const std::vector<Vec3> pull = pull_around(positions, {1.0, 0.0, 0.0}, {0.0, 0.0, 2.0}, 1.0);
  EXPECT_EQ(pull, (std::vector<Vec3>{{0.0, 0.0, 2.0}, {0.0, 0.0, 1.125}, {}, {}}));  // 2 (1 - 1/4)^2
  EXPECT_THROW(pull_around(positions, {}, {}, 0.0), InvalidArgument);
  EXPECT_THROW(pull_around(positions, {}, {}, for_ever), InvalidArgument);
}

}  // namespace dartcast::steering_test
