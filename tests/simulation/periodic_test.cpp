// Simulations with periodic pairs: images are counted, vectors turn, and a run goes on from a checkpoint.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/scene.hpp"
#include "support/expectations.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::periodic_test {

// A channel with floor and ceiling whose other sides are pairs. Free particles reflect between floor and ceiling.
Scene channel() {
  Scene scene;
  scene.environment.mesh = BoxOptions{.cells = {4, 2, 2}};
  scene.environment.periodic = {{"xmax", "xmin", {-4.0, 0.0, 0.0}}, {"ymin", "ymax", {0.0, 2.0, 0.0}}};
  scene.motion.dt = 0.5;
  ParticlesScene& group = scene.particles.emplace_back();
  group.source = RandomParticles{50};
  group.velocity = {3.25, -1.5, 0.75};
  return scene;
}

TEST(PeriodicSimulation, UnwrappedPlacesAreThoseOfFreeFlight) {
  Simulation simulation(channel());
  EXPECT_EQ(simulation.options().user_data, (std::vector<std::string>{"image_xmax", "image_ymin"}));
  const std::vector<Vec3> starts = simulation.unwrapped();
  for (int step = 0; step < 40; ++step) simulation.step();
  const std::vector<Vec3> ends = simulation.unwrapped();
  ASSERT_EQ(ends.size(), 50U);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    EXPECT_NEAR(ends[i].x - starts[i].x, 20 * 3.25, 1e-11);
    EXPECT_NEAR(ends[i].y - starts[i].y, 20 * -1.5, 1e-11);
    EXPECT_EQ(std::abs(simulation.velocities()[i].z), 0.75);
  }
  EXPECT_GT(simulation.totals().counters.contacts[2], 50U * 5);
}

TEST(PeriodicSimulation, ACheckpointKeepsImages) {
  Simulation whole(channel());
  for (int step = 0; step < 5; ++step) whole.step();
  const SimulationCheckpoint saved = whole.checkpoint();
  for (int step = 0; step < 5; ++step) whole.step();
  Simulation rest(channel(), saved);
  for (int step = 0; step < 5; ++step) rest.step();
  EXPECT_EQ(rest.state_hash(), whole.state_hash());
  EXPECT_EQ(rest.unwrapped(), whole.unwrapped());
}

TEST(PeriodicSimulation, RanksHaveTheBitsOfOneProcess) {
  Simulation whole(channel());
  for (int step = 0; step < 10; ++step) whole.step();
  const std::vector<Vec3> all = whole.unwrapped();
  const StateHash hash = whole.state_hash();
  test::on_ranks(3, [&](Ranks& ranks) {
    Simulation simulation(channel(), {}, &ranks);
    for (int step = 0; step < 10; ++step) simulation.step();
    EXPECT_EQ(simulation.state_hash(), hash);
    const std::vector<Vec3> mine = simulation.unwrapped();
    for (std::size_t i = 0; i < mine.size(); ++i) EXPECT_EQ(mine[i], all[simulation.ids()[i]]);
  });
}

// A particle on a circle of the whole square goes through the quarter again and again. Its velocity turns, and so does a
// vector of its user.
TEST(PeriodicSimulation, VectorsTurn) {
  Scene scene;
  scene.environment.mesh = BoxOptions{.cells = {2, 2, 1}};
  scene.environment.periodic = {{"ymin", "xmin", {}, {0.0, 0.0, 1.0}, {}, 90.0}};
  scene.user_data = {"axis_x", "axis_y", "axis_z"};
  scene.motion.dt = 0.25;
  ParticleSeeds seeds;
  seeds.points = {{1.0, 0.5, 0.5}};
  ParticlesScene& group = scene.particles.emplace_back();
  group.source = PlacedParticles{seeds};
  group.velocity = {0.0, -1.0, 0.0};
  group.user_data = {1.0, 2.0, 3.0};
  Simulation simulation(scene);
  for (int step = 0; step < 4; ++step) simulation.step();
  EXPECT_EQ(simulation.velocities()[0], (Vec3{1.0, 0.0, 0.0}));
  EXPECT_EQ(simulation.particles()[0].position, (Vec3{0.5, 1.0, 0.5}));
  EXPECT_EQ(simulation.unwrapped()[0], (Vec3{1.0, -0.5, 0.5}));
  const std::span<const double> data = simulation.user_data(0);
  EXPECT_EQ(std::vector<double>(data.begin(), data.end()), (std::vector<double>{-2.0, 1.0, 3.0, 1.0}));
}

// Stages of rk4 pass periodic faces: a tracer in a quarter has the way of one in the whole square.
TEST(PeriodicSimulation, TracersTurnInAFlowThatTurns) {
  const auto circling = [](MeshData mesh) {
    auto environment = std::make_unique<Environment>(mesh);
    SimulationOptions options{.dt = 0.4, .integrator = Integrator::rk4};
    if (!mesh.periodic.empty()) options.user_data = {"image_ymin"};
    auto simulation = std::make_unique<Simulation>(*environment, options);
    FieldSamples samples;
    std::vector<Vec3> values;
    for (const Vec3& x : mesh.points) values.push_back({-x.y, x.x, 0.0});
    samples.read = [values](std::size_t) { return values; };
    simulation->set_field(VelocityField(environment->complex(), std::move(samples)));
    simulation->add({{1.0, 0.5, 0.5}, {0.25, 0.25, 0.25}}, {});
    for (int step = 0; step < 30; ++step) simulation->step();
    return simulation->unwrapped();
  };
  MeshData quarter = generate_box({.cells = {2, 2, 1}});
  quarter.periodic = {{"ymin", "xmin", {}, {0.0, 0.0, 1.0}, {}, 90.0}};
  const std::vector<Vec3> part = circling(quarter);
  const std::vector<Vec3> all = circling(generate_box({.cells = {4, 4, 1}, .origin = {-2.0, -2.0, 0.0}}));
  for (std::size_t i = 0; i < all.size(); ++i) test::expect_near(part[i], all[i], 1e-12);
}

TEST(PeriodicSimulation, WhatDoesNotKnowPairsIsRefused) {
  const auto refused = [](const auto& change, const std::string& words) {
    Scene scene = channel();
    change(scene);
    test::expect_parts(test::error_text([&] {
                         Simulation simulation(scene);
                         simulation.step();
                       }),
                       {words.c_str()});
  };
  refused([](Scene& s) { s.collisions.emplace(); },
          "spheres that collide: they cannot be in a scene with periodic pairs");
  refused([](Scene& s) { s.particles[0].radius = 0.1; }, "radius is 0.1: in a scene with periodic pairs");
  refused([](Scene& s) { s.motion.wall_motion = WallMotion::simultaneous; },
          "move at the same time as the walls: they cannot be");
  refused([](Scene& s) { s.environment.periodic[1].translate = {}; }, "no corner of \"ymax\" is its partner");
  refused([](Scene& s) { s.environment.periodic[1].a = "top"; }, "top");
  refused(
      [](Scene& s) {
        DeformationStep& twist = s.deformation.emplace_back().step;
        twist.kind = DeformationKind::twist;
        twist.amplitude = 1.0;
        twist.period = 4.0;
      },
      "move: periodic pair \"xmax\", \"xmin\": vertex");
}

}  // namespace dartcast::periodic_test
