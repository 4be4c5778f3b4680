// Numbers that particles carry for their user: through removals, edits and checkpoints.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"

namespace dartcast::user_data_test {

MeshData box() {
  BoxOptions o;
  o.cells = {4, 4, 4};
  o.size = {4.0, 4.0, 4.0};
  return generate_box(o);
}

SimulationOptions options() {
  SimulationOptions o;
  o.dt = 0.1;
  o.patch_responses = {{"xmax", Escape{}}};
  o.user_data = {"dose", "age"};
  return o;
}

// Each particle's numbers name the particle.
void number_all(Simulation& simulation) {
  for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
    simulation.user_data(i)[0] = static_cast<double>(simulation.ids()[i]);
    simulation.user_data(i)[1] = -0.5 * static_cast<double>(simulation.ids()[i]);
  }
}

void expect_numbered(const Simulation& simulation) {
  for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
    const auto id = static_cast<double>(simulation.ids()[i]);
    ASSERT_EQ(simulation.user_data(i).size(), 2U);
    EXPECT_EQ(simulation.user_data(i)[0], id);
    EXPECT_EQ(simulation.user_data(i)[1], -0.5 * id);
  }
}

TEST(UserData, StartsAsGivenOrAtZero) {
  Environment environment(box());
  Simulation simulation(environment, options());
  const std::vector<double> given = {1.5, 2.5};
  simulation.add(std::vector<Vec3>{{1, 1, 1}, {9, 9, 9}, {2, 1, 1}}, {}, 0.0, given);
  simulation.add_random(1, {});
  simulation.add_inlet(environment.map().patch("xmin"), 10.0, {0.1, 0, 0}, 0.0, given);
  simulation.step();
  ASSERT_EQ(simulation.particles().size(), 4U);
  for (const std::size_t i : {0U, 1U, 3U}) EXPECT_EQ(simulation.user_data(i)[1], 2.5) << i;
  EXPECT_EQ(simulation.user_data(2)[0], 0.0);
}

TEST(UserData, StaysWithItsParticleWhereOthersLeave) {
  Environment environment(box());
  Simulation simulation(environment, options());
  simulation.add_random(200, {3.0, 0.5, 0.25});
  number_all(simulation);
  for (int i = 0; i < 5; ++i) simulation.step();
  EXPECT_LT(simulation.particles().size(), 150U);
  EXPECT_GT(simulation.particles().size(), 20U);
  expect_numbered(simulation);
}

TEST(UserData, StaysWithItsParticleWhereAnEditAbsorbsOthers) {
  Environment environment(box());
  Simulation simulation(environment, options());
  simulation.add_random(200, {});
  number_all(simulation);
  const Cell cell = simulation.particles()[7].cell;
  const SimulationEdit done =
      simulation.edit([&](ComplexEdit& e) { e.topology().set_free(cell, false); }, OrphanPolicy::absorb);
  EXPECT_FALSE(done.particles.orphaned.empty());
  EXPECT_LT(simulation.particles().size(), 200U);
  expect_numbered(simulation);
}

TEST(UserData, IsPartOfACheckpoint) {
  Environment environment(box());
  Simulation simulation(environment, options());
  simulation.add_random(50, {1.0, 0, 0});
  number_all(simulation);
  simulation.step();
  const SimulationCheckpoint saved = simulation.checkpoint();
  for (int i = 0; i < 10; ++i) simulation.step();
  simulation.restore(saved);
  expect_numbered(simulation);
  EXPECT_EQ(saved.steps(), 1U);
  SimulationOptions o = options();
  o.user_data = {"dose"};
  Environment other(box());
  Simulation narrower(other, o);
  EXPECT_THROW(narrower.restore(saved), InvalidArgument);
}

TEST(UserData, RefusesWhatDoesNotFit) {
  Environment environment(box());
  for (const std::vector<std::string>& names :
       std::vector<std::vector<std::string>>{{""}, {"id"}, {"a", "b", "a"}, {"velocity"}}) {
    SimulationOptions o = options();
    o.user_data = names;
    EXPECT_THROW(Simulation(environment, o), InvalidArgument);
  }
  Simulation simulation(environment, options());
  const std::vector<double> three(3);
  EXPECT_THROW(simulation.add_random(1, {}, 0.0, three), InvalidArgument);
  EXPECT_EQ(simulation.particles().size(), 0U);
}

// A value that is linear in space, on a straight way: the integral is that of the linear value, whatever the step.
TEST(UserData, IntegratesSamples) {
  Scene scene;
  BoxOptions box;
  box.cells = {6, 2, 2};
  box.size = {6.0, 2.0, 2.0};
  MeshData mesh = generate_box(box);
  std::vector<double> flow;
  std::vector<double> values;
  for (const Vec3& x : mesh.points) {
    flow.insert(flow.end(), {0.5, 0.0, 0.0});
    values.insert(values.end(), {1.0, 2.0 * x.x});
  }
  mesh.point_data.push_back({"U", 3, flow});
  mesh.point_data.push_back({"s", 2, values});
  scene.environment.mesh = mesh;
  scene.motion.dt = 0.25;
  scene.motion.field.array = "U";
  scene.motion.sample = {"s"};
  scene.motion.integrate = {{"age", "s_0"}, {"dose", "s_1"}};
  scene.user_data = {"own"};
  scene.particles.push_back({RandomParticles{20}, {}, 0.0, {7.0}});
  InletParticles inlet;
  inlet.patch = "xmin";
  inlet.rate = 4.0;
  scene.particles.push_back({inlet, {}, 0.0, {7.0}});
  Simulation simulation(scene, Threads{1});
  EXPECT_EQ(simulation.options().user_data, (std::vector<std::string>{"own", "s_0", "s_1", "age", "dose"}));
  const std::vector<ParticleState> before(simulation.particles().states().begin(),
                                          simulation.particles().states().end());
  for (int step = 0; step < 6; ++step) simulation.step();
  Simulation resumed(scene, simulation.checkpoint(), Threads{1});
  for (Simulation* s : {&simulation, &resumed}) {
    s->step();
    s->step();
    ASSERT_GT(s->particles().size(), 25U);
    for (std::size_t i = 0; i < s->particles().size(); ++i) {
      const std::uint64_t id = s->ids()[i];
      const double age = id < 20 ? 2.0 : 2.0 - 0.25 * static_cast<double>(id - 20);  // one a step
      const double x = s->particles()[i].position.x;
      const double start = x - 0.5 * age;
      if (id < 20 && x > 5.9) continue;  // stopped at the wall
      EXPECT_NEAR(s->user_data(i)[3], age, 1e-12);
      EXPECT_NEAR(s->user_data(i)[4], (start + x) * age, 1e-12) << id;
    }
  }
  scene.motion.integrate = {{"dose", "shear"}};
  test::expect_parts(test::refusal([&] { Simulation bad(scene); }), {"dose", "shear", "s_0, s_1"});
}

}  // namespace dartcast::user_data_test
