// Plans against real parts, and the exchanges that a plan counts against those of a run.
#include "dartcast/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/collectives.hpp"
#include "simulation/simulation_view.hpp"
#include "support/thread_ranks.hpp"
#include "support/tier.hpp"

namespace dartcast::plan_test {

BoxOptions cubes(std::uint32_t n) {
  BoxOptions box;
  box.cells = {n, n, n};
  box.size = {1.0, 1.0, 1.0};
  return box;
}

TEST(Plan, CountsThePartsOfARun) {
  const MeshData mesh = generate_vessel({.core = 3, .rings = 2});
  PlanOptions options;
  options.ranks = 12;
  options.particles = 200;
  const RunPlan plan = plan_run(mesh, options);
  const std::vector<std::uint32_t> owners = partition(mesh, 12);
  double own = 0.0;
  double ghosts = 0.0;
  double most_ghosts = 0.0;
  double most_neighbours = 0.0;
  for (std::uint32_t p = 0; p < 12; ++p) {
    const MeshPart part = mesh_part(mesh, owners, 12, p);
    const auto count = static_cast<double>(std::count(part.owners.begin(), part.owners.end(), p));
    own += count / 12.0;
    ghosts += (static_cast<double>(part.cells.size()) - count) / 12.0;
    most_ghosts = std::max(most_ghosts, static_cast<double>(part.cells.size()) - count);
    std::vector<std::uint32_t> others = part.owners;
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    most_neighbours = std::max(most_neighbours, static_cast<double>(others.size()) - 1.0);
  }
  EXPECT_DOUBLE_EQ(plan.cells.mean, own);
  EXPECT_NEAR(plan.ghosts.mean, ghosts, 1e-9);
  EXPECT_EQ(plan.ghosts.largest, most_ghosts);
  EXPECT_EQ(plan.neighbours.largest, most_neighbours);
  EXPECT_GT(plan.seconds_walk, 0.0);
  EXPECT_GT(plan.sent.largest, 0.0);
  EXPECT_GT(plan.bytes.largest, 60.0 * own);
}

// As if a step of one rank alone took 0.2 ms: what a plan measures differs from one measurement to the next.
double efficiency_at_one_speed(RunPlan plan) {
  const double speed = 2e-4 / plan.seconds_alone;
  plan.seconds_walk *= speed;
  plan.seconds_alone *= speed;
  return plan.efficiency();
}

// The ghosts of larger parts follow from their surface: 64 parts of a mesh against 64 of one with eight times the cells.
TEST(Plan, LargerPartsFollowFromTheirSurface) {
  const std::uint32_t n = test::full_tier() ? 93 : 36;  // full: 800,000 and 6,400,000 cells
  PlanOptions options;
  options.ranks = 64;
  options.particles = 1000;
  options.samples = 1;
  const RunPlan real = plan_run(generate_box(cubes(2 * n)), options);
  options.cells = real.cells.mean;
  const RunPlan planned = plan_run(generate_box(cubes(n)), options);
  EXPECT_NEAR(planned.cells.largest, real.cells.largest, 0.05 * real.cells.largest);
  EXPECT_NEAR(planned.ghosts.mean, real.ghosts.mean, 0.15 * real.ghosts.mean);
  EXPECT_NEAR(planned.neighbours.largest, real.neighbours.largest, 4.0);  // parts touch at corners in one of them alone
  EXPECT_NEAR(planned.bytes.largest, real.bytes.largest, 0.1 * real.bytes.largest);
  EXPECT_NEAR(efficiency_at_one_speed(planned), efficiency_at_one_speed(real), 0.02);
  std::printf("ghosts %.1f planned, %.1f real; efficiency %.3f and %.3f\n", planned.ghosts.mean, real.ghosts.mean,
              efficiency_at_one_speed(planned), efficiency_at_one_speed(real));
}

// In the full tier 10^8 cubes, which no array holds together: each part is made, built, and dropped.
TEST(Plan, LargeBoxesAreBuiltInParts) {
  const std::uint32_t n = test::full_tier() ? 465 : 40;
  constexpr std::uint32_t parts = 64;
  std::uint64_t own = 0;
  std::uint64_t most_cells = 0;
  std::size_t most_bytes = 0;
  for (std::uint32_t p = 0; p < parts; ++p) {
    MeshPart part = box_part(cubes(n), parts, p);
    own += static_cast<std::uint64_t>(std::count(part.owners.begin(), part.owners.end(), p));
    const std::uint64_t cells = part.cells.size();
    const Environment environment(std::move(part.mesh));
    most_cells = std::max(most_cells, cells);
    most_bytes = std::max(most_bytes, environment.complex().bytes());
  }
  EXPECT_EQ(own, std::uint64_t{n} * n * n);
  EXPECT_LE(static_cast<double>(most_bytes), 160.0 * static_cast<double>(most_cells));
  std::printf("%llu cells; the largest of %u parts has %llu with its ghosts, and takes %.3f GB\n",
              static_cast<unsigned long long>(own), parts, static_cast<unsigned long long>(most_cells),
              1e-9 * static_cast<double>(most_bytes));
}

TEST(Plan, OfOneRankIsAStepAlone) {
  PlanOptions options;
  options.particles = 1000;
  const RunPlan plan = plan_run(generate_box(cubes(8)), options);
  EXPECT_EQ(plan.ghosts.largest, 0.0);
  EXPECT_EQ(plan.sent.largest, 0.0);
  EXPECT_DOUBLE_EQ(plan.efficiency(), 1.0);
}

TEST(Plan, RefusesWhatCannotBe) {
  const MeshData mesh = generate_box(cubes(2));
  PlanOptions options;
  options.ranks = 9;
  EXPECT_THROW(plan_run(mesh, options), InvalidArgument);
  options.ranks = 2;
  options.step = std::nan("");
  EXPECT_THROW(plan_run(mesh, options), InvalidArgument);
  options.step = 0.1;
  options.bandwidth = 0.0;
  EXPECT_THROW(plan_run(mesh, options), InvalidArgument);
  EXPECT_THROW(plan_run(generate_rectangle({}), {}), InvalidArgument);
}

// Counts the calls of another set of ranks.
class CountedRanks final : public Ranks {
 public:
  explicit CountedRanks(Ranks& ranks) : ranks_(ranks) {}
  [[nodiscard]] unsigned rank() const override { return ranks_.rank(); }
  [[nodiscard]] unsigned size() const override { return ranks_.size(); }
  std::vector<std::string> gather(std::string bytes) override {
    ++gathers;
    return ranks_.gather(std::move(bytes));
  }
  std::string broadcast(std::string bytes) override {
    ++broadcasts;
    return ranks_.broadcast(std::move(bytes));
  }
  std::vector<std::string> exchange(std::vector<std::string> bytes) override {
    ++exchanges;
    return ranks_.exchange(std::move(bytes));
  }
  void sum(std::span<std::uint64_t> values) override {
    ++sums;
    summed += static_cast<double>(values.size_bytes());
    ranks_.sum(values);
  }
  bool fail(const std::string& why) noexcept override { return ranks_.fail(why); }

  double gathers = 0.0;
  double broadcasts = 0.0;
  double exchanges = 0.0;
  double sums = 0.0;
  double summed = 0.0;  // bytes

 private:
  Ranks& ranks_;
};

TEST(Plan, CountsTheExchangesOfARun) {
  Scene scene;
  scene.environment.mesh = cubes(12);
  ParticlesScene particles;
  particles.source = RandomParticles{2000};
  particles.velocity = {1.0, 0.5, 0.25};
  scene.particles = {particles};
  scene.motion.dt = 0.1 / 12.0;
  test::on_ranks(4, [&](Ranks& own) {
    CountedRanks ranks(own);
    Simulation simulation(scene, Threads{1}, &ranks, Partition::cells);
    simulation.step();  // cells may move before the first one
    constexpr int steps = 9;
    const TrafficCounts before = view_of(simulation).part->traffic();
    ranks.gathers = ranks.broadcasts = ranks.exchanges = ranks.sums = 0.0;
    ranks.summed = 0.0;
    for (int s = 0; s < steps; ++s) {
      simulation.step();
      static_cast<void>(simulation.alive());
      static_cast<void>(simulation.energy());
      std::uint64_t stops = 0;  // of the loop around
      ranks.sum({&stops, 1});
    }
    const TrafficCounts& traffic = view_of(simulation).part->traffic();
    const auto rounds = static_cast<double>(traffic.rounds - before.rounds);
    EXPECT_EQ(ranks.exchanges, rounds);
    EXPECT_GE(rounds, steps);
    EXPECT_LE(rounds, collectives::rounds * steps);
    EXPECT_EQ(ranks.gathers, 0.0);
    EXPECT_EQ(ranks.broadcasts, 0.0);
    EXPECT_EQ(ranks.sums, collectives::sums * steps + rounds);
    EXPECT_EQ(ranks.summed, collectives::summed_bytes * steps + 8.0 * rounds);
    EXPECT_LE(static_cast<double>(traffic.bytes), collectives::sent_bytes * static_cast<double>(traffic.sent));
  });
}

}  // namespace dartcast::plan_test
