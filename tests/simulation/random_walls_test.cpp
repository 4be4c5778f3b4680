// Random motion beside walls: survival between absorbing plates against its series, and eddies that a wall damps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <string>
#include <vector>

#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::random_walls_test {

// A box of edge 1 whose sides x = 0 and x = 1 take particles that diffuse from its middle.
Scene plates(bool bridge) {
  Scene scene;
  BoxOptions box;
  box.cells = {4, 2, 2};
  box.size = {1.0, 1.0, 1.0};
  scene.environment.mesh = generate_box(box);
  scene.motion.dt = 0.1;
  scene.motion.diffusion = 0.05;
  scene.motion.brownian_bridge = bridge;
  scene.contact.general = Reflect{1.0};
  scene.contact.by_patch = {{"xmin", Absorb{}}, {"xmax", Stick{}}};
  return scene;
}

// The share that is left of particles that start in the middle between plates, after D t / width^2.
double surviving(double time) {
  double sum = 0.0;
  for (int n = 0; n < 50; ++n) {
    const double k = (2 * n + 1) * std::numbers::pi;
    sum += (n % 2 == 0 ? 4.0 : -4.0) / k * std::exp(-k * k * time);
  }
  return sum;
}

constexpr std::size_t count = 5000;

double share_left(const Scene& scene, double radius = 0.0) {
  Simulation simulation(scene);
  simulation.add(std::vector<Vec3>(count, Vec3{0.5, 0.4, 0.3}), {}, radius);
  for (int i = 0; i < 16; ++i) simulation.step();
  const std::span<const ParticleStatus> all = simulation.statuses();
  return static_cast<double>(std::count(all.begin(), all.end(), ParticleStatus::alive)) / count;
}

// A step is a tenth of the passage: the sampling error alone is left, also for spheres, and for walls that turn and carry
// particles along.
TEST(Bridge, CoarseStepsLoseAsManyAsTheSeriesSays) {
  const double truth = surviving(0.05 * 1.6);
  const double error = std::sqrt(truth * (1.0 - truth) / count);
  EXPECT_NEAR(share_left(plates(true)), truth, 4.0 * error);
  EXPECT_GT(share_left(plates(false)), truth + 8.0 * error);
  EXPECT_NEAR(share_left(plates(true), 0.05), surviving(0.05 * 1.6 / 0.81), 4.0 * error);
  Scene turning = plates(true);
  DeformationScene turn;
  turn.step.kind = DeformationKind::rotate;
  turn.step.axis = {0.0, 0.6, 0.8};
  turn.step.centre = {0.2, 0.1, 0.0};
  turn.step.period = 5.0;
  turning.deformation = {turn};
  auto& mesh = std::get<MeshData>(turning.environment.mesh);
  mesh.point_data.push_back({"u", 3, std::vector<double>(3 * mesh.points.size())});
  turning.motion.field.array = "u";
  turning.motion.field.frame = FieldFrame::mesh;
  EXPECT_NEAR(share_left(turning), truth, 4.0 * error);
}

// A field of D that is 0.05 everywhere draws the same.
TEST(Bridge, BitsAreThoseOfAnyThreadsRanksAndOfAFieldOfD) {
  Scene scene = plates(true);
  scene.particles.push_back({RandomParticles{500}, {}, 0.0, {}});
  Scene by_field = scene;
  auto& mesh = std::get<MeshData>(by_field.environment.mesh);
  mesh.point_data.push_back({"D", 1, std::vector<double>(mesh.points.size(), 0.05)});
  by_field.motion.diffusion = 0.0;
  by_field.motion.diffusivity = "D";
  by_field.motion.sample = {"D"};
  const auto positions = [](const Scene& of, Threads threads) {
    Simulation simulation(of, threads);
    for (int i = 0; i < 5; ++i) simulation.step();
    std::vector<Vec3> all;
    for (const ParticleState& s : simulation.particles().states()) all.push_back(s.position);
    return all;
  };
  const std::vector<Vec3> truth = positions(scene, Threads{1});
  EXPECT_LT(truth.size(), 480U);
  EXPECT_EQ(positions(scene, Threads{3}), truth);
  const std::vector<Vec3> other = positions(by_field, Threads{1});
  ASSERT_EQ(other.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) test::expect_near(other[i], truth[i], 1e-12);
  std::size_t in_ranks = 0;
  std::mutex mutex;
  test::on_ranks(3, [&](Ranks& ranks) {
    Simulation shared(scene, Threads{1}, &ranks);
    for (int i = 0; i < 5; ++i) shared.step();
    const std::lock_guard lock(mutex);
    in_ranks += shared.particles().size();
    for (const ParticleState& s : shared.particles().states())
      EXPECT_EQ(std::count(truth.begin(), truth.end(), s.position), 1);
  });
  EXPECT_EQ(in_ranks, truth.size());
}

TEST(Bridge, BelongsToDiffusionOfWholeMeshes) {
  Scene scene = plates(true);
  test::on_ranks(2, [&](Ranks& ranks) {
    test::expect_refused([&] { Simulation(scene, Threads{1}, &ranks, Partition::cells); }, "a Brownian bridge");
  });
  scene.motion.diffusion = 0.0;
  test::expect_refused([&] { Simulation simulation(scene); }, "brownian_bridge belongs to diffusion");
}

// Eddies over the wall z = 0, in air: with k = 0.5 y+ is 1 at a height of 1.5e-5 / (0.09^(1/4) sqrt(0.5)) m.
TEST(Damping, TakesTheShareOfWangAndJamesAcrossTheWallAlone) {
  constexpr std::size_t particles = 4000;
  const double unit = 1.5e-5 / (std::sqrt(std::sqrt(0.09)) * std::sqrt(0.5));
  Scene scene;
  BoxOptions box;
  box.cells = {2, 2, 8};
  box.size = {1.0, 1.0, 1000.0 * unit};
  MeshData mesh = generate_box(box);
  mesh.point_data.push_back({"u", 3, std::vector<double>(3 * mesh.points.size())});
  mesh.point_data.push_back({"k", 1, std::vector<double>(mesh.points.size(), 0.5)});
  mesh.point_data.push_back({"omega", 1, std::vector<double>(mesh.points.size(), 1.0)});
  DataArray y{"y", 1, {}};
  for (const Vec3& x : mesh.points) y.values.push_back(x.z);
  mesh.point_data.push_back(y);
  scene.environment.mesh = mesh;
  scene.motion.field.array = "u";
  scene.motion.dt = 1e-9;
  scene.motion.forces.fluid = {1.2, 1.8e-5, 0.0, 300.0};
  scene.motion.sample = {"k", "omega", "y"};
  scene.motion.turbulence = {.k = "k", .epsilon = {}, .omega = "omega", .lagrangian = 0.15, .wall_distance = "y"};
  for (const bool by_forces : {false, true}) {
    if (by_forces) scene.motion.forces.terms = {Force::stokes};
    for (const double plus : {5.0, 50.0, 500.0}) {
      Simulation simulation(scene, Threads{2});
      simulation.add(std::vector<Vec3>(particles, Vec3{0.4, 0.3, plus * unit}), {}, 0.0, {}, {1e-9, 1000.0, 0.0});
      simulation.step();
      Vec3 square;
      for (const ParticleState& s : simulation.particles().states()) {
        const Vec3 v = (s.position - Vec3{0.4, 0.3, plus * unit}) * (1.0 / (1e-9 * particles));
        square += Vec3{v.x * v.x, v.y * v.y, v.z * v.z} * particles;
      }
      const double share = 1.0 - std::exp(-0.02 * plus);
      const double bound = 4.0 * std::sqrt(2.0 / particles) / 3.0;
      EXPECT_NEAR(square.x, 1.0 / 3.0, bound) << plus;
      EXPECT_NEAR(square.y, 1.0 / 3.0, bound) << plus;
      EXPECT_NEAR(square.z, share * share / 3.0, share * share * bound) << plus;
    }
  }
  Scene without = scene;
  without.motion.forces.fluid.density = 0.0;
  without.motion.forces.terms = {};
  test::expect_refused([&] { Simulation simulation(without); }, "the fluid's density and viscosity");
  without = scene;
  without.motion.turbulence.wall_distance = "z";
  Simulation unknown(without);
  test::expect_refused([&] { unknown.step(); }, "wall distance \"z\"");
}

}  // namespace dartcast::random_walls_test
