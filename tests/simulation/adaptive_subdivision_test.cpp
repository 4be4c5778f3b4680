#include "simulation/adaptive_subdivision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/events.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/validity.hpp"
#include "support/meshes.hpp"
#include "support/tier.hpp"
#include "support/with_response.hpp"

namespace dartcast::adaptive_subdivision_test {

std::size_t fullest_cell(const Simulation& simulation) {
  std::map<Cell, std::size_t> counts;
  for (const ParticleState& s : simulation.particles().states()) ++counts[s.cell];
  std::size_t max_particles = 0;
  for (const auto& [cell, count] : counts) max_particles = std::max(max_particles, count);
  return max_particles;
}

std::vector<Vec3> cluster(std::size_t count, const Vec3& low, const Vec3& high) {
  Random random(5);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back({random.uniform(low.x, high.x), random.uniform(low.y, high.y), random.uniform(low.z, high.z)});
  return places;
}

AdaptiveSubdivisionReport adapt(Simulation& simulation, AdaptiveSubdivision& subdivision) {
  return subdivision.adapt(simulation.environment().complex(), simulation.particles(),
                           [&](const std::function<void(ComplexEdit&)>& make) { return simulation.edit(make).edit; });
}

// Cells are replaced at the end of the steps in which particles met their walls.
TEST(AdaptiveSubdivision, ContactsKeepTheSourceOfTheirCell) {
  Environment environment(test::cubes(3));
  SimulationOptions o;
  o.dt = 0.05;
  Simulation simulation(environment, o);
  AdaptiveSubdivisionScene subdivision;
  subdivision.every = 1;
  subdivision.options.max_particles = 15;
  subdivision.options.min_particles = 6;
  simulation.set_adaptive_subdivision(subdivision);
  simulation.add_random(300, {1.5, 0.75, 0.5});
  std::size_t replaced = 0;
  for (int i = 0; i < 30; ++i) {
    const SimulationStep& step = simulation.step();
    ASSERT_EQ(step.contact_sources.size(), step.contacts().size());
    for (std::size_t k = 0; k < step.contacts().size(); ++k) {
      const Contact& c = step.contacts()[k];
      const auto place = [](double x) { return std::clamp(std::floor(x), 0.0, 2.0); };
      const double cube = place(c.point.x) + 3.0 * place(c.point.y) + 9.0 * place(c.point.z);
      EXPECT_EQ(step.contact_sources[k], cube) << "step " << i;
      const Cell cell = step.report.contacts.walls_of(c).front().face.cell;
      if (!environment.map().contains(cell) || environment.map().source(cell) != cube) ++replaced;
    }
  }
  EXPECT_GT(replaced, 0U);
}

// A crowd gathers, and the cells get small; it leaves, and they are as many as before.
TEST(AdaptiveSubdivision, SubdividesAndMergesAgain) {
  Environment environment(test::cubes(4), Threads{1});
  SimulationOptions o;
  o.dt = 0.1;
  Simulation simulation(environment, o);
  const std::size_t cells = environment.map().cell_count();
  simulation.add(cluster(300, {1.1, 1.1, 1.1}, {1.9, 1.9, 1.9}), {0.1, 0.05, 0.02});
  AdaptiveSubdivisionOptions options;
  options.max_particles = 20;
  options.min_particles = 10;
  AdaptiveSubdivision adaptive_subdivision(options);
  AdaptiveSubdivisionReport first;
  for (int i = 0; i < 5; ++i) {
    const AdaptiveSubdivisionReport report = adapt(simulation, adaptive_subdivision);
    first.subdivided += report.subdivided;
    EXPECT_TRUE(report.refused.empty()) << report.refused.front().reason;
    EXPECT_EQ(report.waiting, 0U);
    EXPECT_LE(fullest_cell(simulation), options.max_particles);
    EXPECT_TRUE(environment.validity().valid());
    EXPECT_EQ(audit(environment.complex(), simulation.particles()).failed, 0U);
    simulation.step();
  }
  EXPECT_GT(first.subdivided, 8U);
  EXPECT_GT(adaptive_subdivision.subdivisions().size(), 8U);
  EXPECT_EQ(simulation.particles().size(), 300U);
  // With everyone still there nothing is merged; with nobody all is.
  EXPECT_EQ(adapt(simulation, adaptive_subdivision).merged, 0U);
  Simulation empty(environment, o);
  std::uint64_t merged = 0;
  for (int i = 0; i < 10 && !adaptive_subdivision.subdivisions().empty(); ++i) {
    const AdaptiveSubdivisionReport report = adapt(empty, adaptive_subdivision);
    merged += report.merged;
    EXPECT_TRUE(report.refused.empty()) << report.refused.front().reason;
  }
  EXPECT_TRUE(adaptive_subdivision.subdivisions().empty());
  EXPECT_EQ(environment.map().cell_count(), cells);
  EXPECT_GT(merged, 8U);
}

// A report names what was not done: cells too small, and more of them than one call edits.
TEST(AdaptiveSubdivision, ReportsWhatItLeaves) {
  Environment environment(test::cubes(4), Threads{1});
  Simulation simulation(environment, SimulationOptions{});
  simulation.add(cluster(400, {1.1, 1.1, 1.1}, {2.9, 1.9, 1.9}), {});
  AdaptiveSubdivisionOptions options;
  options.max_particles = 20;
  options.smallest = 0.4;
  AdaptiveSubdivision small(options);
  const AdaptiveSubdivisionReport report = adapt(simulation, small);
  EXPECT_EQ(report.subdivided, 2U);
  ASSERT_GT(report.refused.size(), 4U);
  EXPECT_GT(report.refused.front().particles, options.max_particles);
  EXPECT_NE(report.refused.front().reason.find("across"), std::string::npos);
  options.smallest = 0.0;
  options.edits = 1;
  AdaptiveSubdivision slow(options);
  const AdaptiveSubdivisionReport some = adapt(simulation, slow);
  EXPECT_EQ(some.subdivided, 1U);
  EXPECT_GT(some.waiting, 0U);
}

TEST(AdaptiveSubdivision, RefusesOptionsOutOfRange) {
  AdaptiveSubdivisionOptions options;
  options.min_particles = options.max_particles;
  EXPECT_THROW(AdaptiveSubdivision{options}, InvalidArgument);
  options = {};
  options.smallest = -1.0;
  EXPECT_THROW(AdaptiveSubdivision{options}, InvalidArgument);
}

// Spheres that rest on each other go on resting while the cells around them change.
TEST(AdaptiveSubdivision, SpheresDoNotNotice) {
  const auto run = [](bool adapts) {
    Environment environment(test::cubes(4), Threads{1});
    SimulationOptions o;
    o.dt = 5e-3;
    o.gravity = {0.0, 0.0, -9.81};
    o.collisions = CollisionOptions{};
    o.collisions->friction = 0.3;
    Simulation simulation(environment, test::with_response(o, Reflect{0.0, 0.3}));
    for (int i = 0; i < 90; ++i) {
      const Vec3 place = {0.3 + 0.21 * (i % 5), 0.3 + 0.21 * (i / 5 % 6), 0.15 + 0.25 * (i / 30)};
      simulation.add(std::span(&place, 1), {}, 0.1);
    }
    AdaptiveSubdivisionOptions options;
    options.max_particles = 10;
    options.min_particles = 5;
    AdaptiveSubdivision adaptive_subdivision(options);
    std::uint64_t edits = 0;
    for (int i = 0; i < 200; ++i) {
      if (adapts && i % 20 == 10) edits += adapt(simulation, adaptive_subdivision).subdivided;
      simulation.step();
    }
    EXPECT_EQ(edits > 0, adapts);
    EXPECT_EQ(simulation.particles().size(), 90U);
    std::vector<Vec3> places;
    for (const ParticleState& s : simulation.particles().states()) places.push_back(s.position);
    return places;
  };
  const auto without = run(false);
  const auto with = run(true);
  for (std::size_t i = 0; i < without.size(); ++i) EXPECT_LT(norm(without[i] - with[i]), 1e-3);
}

}  // namespace dartcast::adaptive_subdivision_test
