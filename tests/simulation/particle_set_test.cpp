// A column that nothing but this test knows goes along with its particles, whatever happens to them.
#include "simulation/particle_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/simulation_view.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::particle_set_test {

// A flow through a channel of cubes. All start in one half, so that ranks with a half of the cells move some.
Scene channel(std::size_t count) {
  BoxOptions cubes;
  cubes.cells = {8, 4, 4};
  cubes.size = {8.0, 4.0, 4.0};
  Scene scene;
  scene.environment.mesh = generate_box(cubes);
  ParticlesScene particles;
  ParticleSeeds seeds;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(count);
    seeds.points.push_back({0.1 + 3.0 * x, 0.2 + 3.6 * x * x, 2.0});
    seeds.velocities.push_back({0.5 + 3.0 * x, 0.3, -0.2});
  }
  particles.source = PlacedParticles{seeds};
  scene.particles = {particles};
  scene.contact.by_patch["xmax"] = Escape{};
  scene.motion.dt = 0.05;
  return scene;
}

// A simulation with one column more.
class Marked {
 public:
  explicit Marked(const Scene& scene, Ranks* ranks = nullptr, Partition partition = Partition::particles)
      : simulation(scene, Threads{1}, ranks, partition), mark_(table().add_column<double>(2)) {
    mark(0);
  }

  // Those from this index on.
  void mark(std::size_t first) {
    for (std::size_t i = first; i < table().rows(); ++i) marks()[2 * i] = 0.5 * number(i);
  }
  void expect_marks() {
    ASSERT_EQ(marks().size(), 2 * simulation.particles().size());
    for (std::size_t i = 0; i < table().rows(); ++i) {
      EXPECT_EQ(marks()[2 * i], 0.5 * number(i));
      EXPECT_EQ(marks()[2 * i + 1], 0.0);
    }
  }

  Simulation simulation;

 private:
  // The library changes tables through its own functions alone.
  ParticleTable& table() { return const_cast<ParticleTable&>(view_of(simulation).particles.set().table); }
  std::span<double> marks() { return table()[mark_]; }
  double number(std::size_t i) { return static_cast<double>(simulation.ids()[i] + 1); }

  Column<double> mark_;
};

TEST(ParticleSet, TakesANewColumnThroughStepsEditsAndCheckpoints) {
  Marked marked(channel(200));
  Simulation& s = marked.simulation;
  for (int i = 0; i < 50; ++i) s.step();
  EXPECT_LT(s.particles().size(), 190U);
  marked.expect_marks();
  const std::size_t before = s.particles().size();
  s.add_random(20, {});
  EXPECT_THROW(s.add(std::vector<Vec3>{{1, 1, 1}, {NAN, 1, 1}}, {}), InvalidArgument);  // it undoes what was added
  marked.mark(before);
  marked.expect_marks();
  const SimulationCheckpoint saved = s.checkpoint();
  const Cell cell = s.particles()[7].cell;
  s.edit([&](ComplexEdit& e) { e.topology().set_free(cell, false); }, OrphanPolicy::absorb);
  EXPECT_LT(s.particles().size(), before + 20);
  marked.expect_marks();
  for (int i = 0; i < 20; ++i) s.step();
  s.edit([&](ComplexEdit& e) { e.topology().set_free(cell, true); });
  s.restore(saved);
  EXPECT_EQ(s.particles().size(), before + 20);
  marked.expect_marks();
}

TEST(ParticleSet, TakesANewColumnFromRankToRank) {
  test::on_ranks(2, [&](Ranks& ranks) {
    Marked marked(channel(200), &ranks, Partition::cells);
    for (int i = 0; i < 50; ++i) {
      marked.simulation.step();
      marked.expect_marks();
    }
    EXPECT_GE(view_of(marked.simulation).balanced, 1U);
    std::uint64_t sent = view_of(marked.simulation).part->traffic().sent;
    ranks.sum({&sent, 1});
    EXPECT_GT(sent, 20U);
  });
}

TEST(ParticleSet, JoinsANewColumnOfAllRanks) {
  std::mutex mutex;
  std::vector<SimulationCheckpoint> parts;
  test::on_ranks(3, [&](Ranks& ranks) {
    Marked marked(channel(400), &ranks);
    for (int i = 0; i < 40; ++i) marked.simulation.step();
    const std::lock_guard lock(mutex);
    parts.push_back(marked.simulation.checkpoint());
  });
  Marked alone(channel(400));
  for (int i = 0; i < 40; ++i) alone.simulation.step();
  const std::vector<std::uint64_t> ids(alone.simulation.ids().begin(), alone.simulation.ids().end());
  alone.simulation.restore(joined(parts));
  EXPECT_TRUE(std::equal(ids.begin(), ids.end(), alone.simulation.ids().begin(), alone.simulation.ids().end()));
  alone.expect_marks();
}

// A file of no particles does not say how many numbers they would have.
TEST(ParticleSet, JoinsUserDataBehindARankWithoutParticles) {
  SimulationState with;
  ParticleTable table(2);
  table.append_zeros(2);
  table[table.id][0] = 7;
  table[table.id][1] = 5;
  table[table.user_data][1] = 0.5;
  with.particles.table = SavedParticles(table);
  const std::vector<SimulationCheckpoint> parts = {SimulationCheckpoint(SimulationState()), SimulationCheckpoint(with)};
  const SimulationCheckpoint all = joined(parts);
  const SavedParticles& saved = all.state().particles.table;
  EXPECT_EQ(saved[saved.id][0], 5U);
  ASSERT_EQ(saved[saved.user_data].size(), 4U);
  EXPECT_EQ(saved[saved.user_data][3], 0.5);
}

}  // namespace dartcast::particle_set_test
