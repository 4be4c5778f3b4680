// Points and walls that move at the same time, in a simulation.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "dartcast/audit.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/error.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "support/meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::wall_motion_test {

SimulationOptions options() {
  SimulationOptions o;
  o.dt = 0.05;
  o.gravity = {0.0, 0.0, -9.81};
  o.response = Reflect{0.5, 0.1};
  o.wall_motion = WallMotion::simultaneous;
  return o;
}

Deformation turning(const Environment& environment) {
  DeformationStep turn;
  turn.kind = DeformationKind::rotate;
  turn.period = 2.0;
  turn.axis = {0.0, 1.0, 0.0};
  turn.centre = {3.0, 3.0, 3.0};
  DeformationStep bump;
  bump.kind = DeformationKind::bump;
  bump.amplitude = 0.4;
  bump.period = 0.7;
  bump.centre = {3.0, 3.0, 0.0};
  bump.length = 4.0;
  return {{turn, bump}, environment.positions()};
}

std::unique_ptr<Simulation> made(Environment& environment) {
  auto simulation = std::make_unique<Simulation>(environment, options());
  simulation->set_deformation(turning(environment));
  return simulation;
}

std::string hash_after(unsigned threads, int steps, int restart) {
  const MeshData mesh = test::cubes(6, CellType::tetrahedron, 0.1, 0.2, 5);
  Environment environment(mesh, {threads});
  auto simulation = made(environment);
  simulation->add_random(test::sanitized() ? 100 : 500, {});
  for (int i = 0; i < (restart > 0 ? restart : steps); ++i) simulation->step();
  EXPECT_GT(simulation->totals().counters.contacts[2], 0U);
  if (restart == 0) {
    EXPECT_EQ(audit(environment.complex(), simulation->particles(), Threads{1}).failed, 0U);
    return simulation->state_hash().hex();
  }
  Environment again(mesh, {threads});
  auto resumed = made(again);
  resumed->restore(simulation->checkpoint());
  for (int i = restart; i < steps; ++i) resumed->step();
  return resumed->state_hash().hex();
}

TEST(WallMotion, TheSameBitsForAnyThreadsAndAfterARestart) {
  const std::string one = hash_after(1, 40, 0);
  EXPECT_EQ(hash_after(0, 40, 0), one);
  EXPECT_EQ(hash_after(3, 40, 0), one);
  EXPECT_EQ(hash_after(2, 40, 17), one);
}

// A floor that rises under points at rest takes them along: in its frame they fall onto it and rebound.
TEST(WallMotion, ResponsesKnowTheVelocityOfTheWall) {
  Environment environment(test::cubes(4), Threads{1});
  SimulationOptions o = options();
  o.dt = 1.0;
  o.gravity = {};
  o.response = Reflect{};
  Simulation simulation(environment, o);
  DeformationStep rise;
  rise.kind = DeformationKind::frames;
  rise.times = {0.0, 1.0};
  for (const double by : rise.times) {
    auto& frame = rise.frames.emplace_back();
    for (const Vec3& x : environment.positions()) frame.push_back({x.x, x.y, by + (1.0 - 0.25 * by) * x.z});
  }
  simulation.set_deformation(Deformation({rise}, environment.positions()));
  simulation.add({{2.25, 2.125, 0.25}}, Vec3{});
  const SimulationStep& step = simulation.step();
  ASSERT_EQ(step.contact_ids.size(), 1U);
  EXPECT_NEAR(step.report.contacts.contacts[0].time_of_impact, 0.25, 0x1p-20);
  EXPECT_NEAR(simulation.velocities()[0].z, 2.0, 1e-12);
  EXPECT_NEAR(simulation.particles()[0].position.z, 0.25 + 2.0 * 0.75, 1e-5);
}

TEST(WallMotion, SpheresAreRefusedHoweverTheyAreAdded) {
  Environment environment(test::cubes(2), Threads{1});
  Simulation simulation(environment, options());
  const std::vector<Vec3> positions = {{0.5, 0.5, 0.5}, {1.5, 1.5, 1.5}};
  EXPECT_THROW(simulation.add(positions, Vec3{}, 0.1), InvalidArgument);
  EXPECT_THROW(simulation.add(positions, std::vector<Vec3>(2), std::vector<double>{0.0, 0.1}), InvalidArgument);
  EXPECT_EQ(simulation.particles().size(), 0U);
}

TEST(WallMotion, ScenesChooseIt) {
  Scene scene;
  scene.environment.mesh = test::cubes(2);
  EXPECT_EQ(Simulation(scene, Threads{1}).options().wall_motion, WallMotion::carried);
  scene.motion.wall_motion = WallMotion::simultaneous;
  EXPECT_EQ(Simulation(scene, Threads{1}).options().wall_motion, WallMotion::simultaneous);
}

TEST(WallMotion, RefusesWhatItIsNotFor) {
  Environment environment(test::cubes(2), Threads{1});
  SimulationOptions o = options();
  o.substeps = 2;
  EXPECT_THROW(Simulation(environment, o), InvalidArgument);
  o = options();
  o.collisions = CollisionOptions{};
  EXPECT_THROW(Simulation(environment, o), InvalidArgument);
  Simulation simulation(environment, options());
  EXPECT_THROW(simulation.add({{0.5, 0.5, 0.5}}, Vec3{}, 0.1), InvalidArgument);
  EXPECT_EQ(simulation.particles().size(), 0U);
}

}  // namespace dartcast::wall_motion_test
