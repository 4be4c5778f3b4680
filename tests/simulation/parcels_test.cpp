// Parcels, impacts and drops at walls, against sums and numbers by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/with_response.hpp"

namespace dartcast::test::parcels_test {

constexpr double pi = 3.14159265358979323846;
constexpr Material ball = {0.1, 1200.0, 0.0};

double mass() { return pi / 6.0 * ball.density * ball.diameter * ball.diameter * ball.diameter; }

MeshData box() { return cube_of(4, 4.0); }

StatisticsOptions everything() {
  StatisticsOptions o;
  o.hits = true;
  o.impacts = true;
  o.residence = true;
  o.planes = {{"middle", {2.0, 2.0, 2.0}, {1.0, 0.5, 0.25}, 0.0}};
  o.cells = {"track_length", "residence", "visits", "deposition", "concentration"};
  return o;
}

// Elastic walls at rest keep all speeds, and in a box each component of a velocity but for its sign.
TEST(Impacts, HaveTheMassEnergyAndAngleOfEachContact) {
  for (const unsigned substeps : {1U, 3U}) {
    Environment environment(box(), Threads{1});
    Simulation simulation(
        environment,
        with_response(SimulationOptions{.dt = 0.5, .substeps = substeps, .user_data = {"number"}}, Reflect{1.0}));
    simulation.set_statistics(everything());
    Random random(3);
    std::vector<Vec3> places;
    std::vector<Vec3> velocities;
    std::vector<double> numbers;
    for (int i = 0; i < 300; ++i) {
      places.push_back({random.uniform(0.1, 3.9), random.uniform(0.1, 3.9), random.uniform(0.1, 3.9)});
      velocities.push_back(random_vector(random) * 6.0);
      numbers.push_back(i % 3 == 0 ? 0.0 : 1.0 + i % 5);  // 0 counts as 1
    }
    for (std::size_t i = 0; i < places.size(); ++i)
      simulation.add({&places[i], 1}, velocities[i], 0.0, {&numbers[i], 1}, ball);
    std::uint64_t hits = 0;
    double energy = 0.0;
    std::array<std::uint64_t, 9> angles{};
    for (int step = 0; step < 10; ++step) {
      const SimulationStep& made = simulation.step();
      for (std::size_t k = 0; k < made.contacts().size(); ++k) {
        const Vec3& v = velocities[made.contact_ids[k]];
        const auto number = static_cast<std::uint64_t>(std::max(1.0, numbers[made.contact_ids[k]]));
        const Vec3& n = made.report.contacts.walls_of(made.contacts()[k]).front().normal;
        const double towards = std::abs(n.x) > 0.5 ? v.x : std::abs(n.y) > 0.5 ? v.y : v.z;
        hits += number;
        energy += 0.5 * mass() * static_cast<double>(number) * dot(v, v);
        angles[static_cast<std::size_t>(std::asin(std::abs(towards) / norm(v)) * 18.0 / pi)] += number;
      }
    }
    ASSERT_GT(hits, 1000U);
    FaceHits sum;
    for (const FaceHits& f : simulation.statistics().hits.faces()) {
      sum.hits += f.hits;
      sum.mass += f.mass;
      sum.energy += f.energy;
      for (std::size_t i = 0; i < sum.angles.size(); ++i) sum.angles[i] += f.angles[i];
    }
    EXPECT_EQ(sum.hits, hits);
    EXPECT_EQ(sum.angles, angles);
    EXPECT_NEAR(sum.mass, static_cast<double>(hits) * mass(), 1e-12 * sum.mass);
    EXPECT_NEAR(sum.energy, energy, 1e-12 * energy);
  }
}

// A wall that comes to a particle at rest: the energy is that of the wall's motion in the step.
TEST(Impacts, AreRelativeToTheWall) {
  Environment environment(box(), Threads{1});
  Simulation simulation(environment, with_response(SimulationOptions{.dt = 0.25}, Absorb{}));
  simulation.set_statistics(everything());
  simulation.add({{0.25, 1.3, 1.6}}, {}, 0.0);
  const Vec3 at{0.4, 2.3, 2.6};
  simulation.add({&at, 1}, {}, 0.0, {}, ball);
  simulation.pull(std::vector<Vec3>(environment.positions().size(), Vec3{1.0, 0.0, 0.0}), 2.0);
  double expected = 0.0;
  for (int step = 0; step < 8; ++step) {
    const double before = environment.positions()[0].x;
    for (const Contact& c : simulation.step().contacts()) {
      const double speed = (environment.positions()[0].x - before) / 0.25;
      if (c.point.y > 2.0) expected = 0.5 * mass() * speed * speed;
    }
  }
  ASSERT_EQ(simulation.totals().absorbed, 2U);
  double energy = 0.0;
  std::uint64_t straight = 0;
  for (const FaceHits& f : simulation.statistics().hits.faces()) {
    energy += f.energy;
    straight += f.angles[8];
  }
  EXPECT_NEAR(energy, expected, 1e-12 * expected);
  EXPECT_EQ(straight, 2U);
}

// Each sum is that of a run without parcels, times their number.
TEST(Parcels, CountAsManyParticles) {
  constexpr std::uint64_t number = 1000;
  const auto run = [](bool parcels) {
    auto environment = std::make_unique<Environment>(box(), Threads{1});
    SimulationOptions options = with_response(SimulationOptions{.dt = 0.3, .gravity = {0.0, 0.0, -1.0}}, Absorb{});
    if (parcels) options.user_data = {"other", "number"};
    Simulation simulation(*environment, options);
    simulation.set_statistics(everything());
    const std::vector<double> numbers = {7.0, static_cast<double>(number)};
    simulation.add_random(200, {1.0, 2.0, 3.0}, 0.0, parcels ? numbers : std::vector<double>{}, ball);
    simulation.add_random(50, {1.0, 2.0, 3.0}, 0.125, parcels ? numbers : std::vector<double>{}, ball);
    for (int step = 0; step < 8; ++step) simulation.step();
    EXPECT_TRUE(simulation.cell_tally()->adds_up());
    return std::pair{simulation.statistics(), simulation.cell_tally()->words()};
  };
  const auto [one, one_words] = run(false);
  const auto [many, many_words] = run(true);
  ASSERT_EQ(one.hits.faces().size(), many.hits.faces().size());
  for (const FaceHits& f : one.hits.faces()) {
    const FaceHits sums = many.hits.at(f.face);
    EXPECT_EQ(sums.hits, number * f.hits);
    EXPECT_NEAR(sums.energy, number * f.energy, 1e-12 * sums.energy);
  }
  EXPECT_GT(one.planes[0].forward.count, 0U);
  EXPECT_EQ(many.planes[0].forward.count, number * one.planes[0].forward.count);
  EXPECT_NEAR(many.planes[0].forward.mean(), one.planes[0].forward.mean(), 1e-12);
  std::uint64_t absorbed = 0;
  for (std::size_t i = 0; i < one.left.size(); ++i) {
    EXPECT_EQ(many.left[i].absorbed.count, number * one.left[i].absorbed.count);
    absorbed += one.left[i].absorbed.count;
  }
  EXPECT_GT(absorbed, 100U);
  Environment environment(box(), Threads{1});
  CellTally sum(environment.complex());
  std::vector<std::uint64_t> words = one_words;
  for (std::uint64_t& w : words) w *= number;
  sum.set_words(words);
  CellTally found(environment.complex());
  found.set_words(many_words);
  // The time that is taken back from a particle that leaves is rounded once, not for each.
  EXPECT_NEAR(found.age(), sum.age(), 1e-9);
  EXPECT_EQ(found.path_length(), sum.path_length());
  for (const Cell c : environment.map().cells()) {
    EXPECT_EQ(found.track_length(c), sum.track_length(c));
    EXPECT_NEAR(found.residence(c), sum.residence(c), 1e-10);
    EXPECT_EQ(found.visits(c), sum.visits(c));
    EXPECT_EQ(found.deposited(c), sum.deposited(c));
  }
}

TEST(Parcels, AreNumbersOfGroupsInScenes) {
  const std::string text = R"(
[environment]
generator = "box"
cells = [4, 4, 4]
size = [4.0, 4.0, 4.0]
[motion]
dt = 0.1
steps = 20
[[particles]]
count = 10
number = 5
[[particles]]
cone = { at = [2.1, 2.1, 2.1], axis = [0, 0, 1], inner = 0.0, outer = 20.0, speed = 1.0 }
mass_rate = 100.0
number = 50
diameter = 0.1
density = 1200
)";
  Scene scene = parse_scene(text, ".");
  load_scene_files(scene);
  Simulation simulation(scene);
  EXPECT_EQ(simulation.options().user_data, std::vector<std::string>{"number"});
  while (simulation.time() < 1.95) simulation.step();
  EXPECT_NEAR(static_cast<double>(simulation.totals().injected), 2.0 * 100.0 / (50.0 * mass()), 1.0);
  EXPECT_EQ(simulation.user_data(0)[0], 5.0);
  EXPECT_EQ(simulation.user_data(10)[0], 50.0);
  Environment environment(box(), Threads{1});
  Simulation other(environment, {});
  expect_parts(refusal([&] { other.add(scene.particles[0]); }), {"number", "user data"});
  StatisticsOptions lonely;
  lonely.impacts = true;
  expect_parts(refusal([&] { other.set_statistics(lonely); }), {"impacts", "hits"});
}

TEST(Drops, StickBelowTheirWeberNumber) {
  WallResponse wall = Reflect{0.5};
  wall.stick_below_weber = 5.0;
  SimulationOptions options = with_response(SimulationOptions{.dt = 1.0}, wall);
  options.forces.fluid.surface_tension = 0.07;
  Environment environment(box(), Threads{1});
  Simulation simulation(environment, options);
  const Vec3 at{3.5, 1.3, 1.6};
  std::vector<bool> sticks;
  for (const double diameter : {1e-4, 3e-4, 1e-3}) {
    for (const double speed : {0.6, 1.0, 1.9}) {
      simulation.add({&at, 1}, {speed, 0.1, 0.0}, 0.0, {}, Material{diameter, 1000.0, 0.0});
      sticks.push_back(1000.0 * diameter * speed * speed < 5.0 * 0.07);
    }
  }
  simulation.step();
  ASSERT_EQ(std::count(sticks.begin(), sticks.end(), true), 4);
  for (std::size_t i = 0; i < sticks.size(); ++i)
    EXPECT_EQ(simulation.statuses()[i], sticks[i] ? ParticleStatus::stuck : ParticleStatus::alive) << i;
  expect_parts(refusal([&] { simulation.add({&at, 1}, {}, 0.0); }), {"diameter is 0", "stick_below_weber"});
  options.forces.fluid.surface_tension = 0.0;
  expect_parts(refusal([&] { Simulation bad(environment, options); }), {"stick_below_weber", "surface tension"});
}

}  // namespace dartcast::test::parcels_test
