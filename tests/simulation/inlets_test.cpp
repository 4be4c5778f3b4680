// Inlets: numbers against closed forms, places and directions against their distributions, and the same bits for any ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/remeshing.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "mesh/point_weights.hpp"
#include "simulation/rate_integral.hpp"
#include "simulation/seeding.hpp"
#include "support/expectations.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::inlets_test {

// Within 5 standard deviations of the mean of chi-squared: one set of draws in 10^5 or so falls outside. `expected`: of each
// bin, some 10 or more.
void expect_distribution(const std::vector<double>& found, const std::vector<double>& expected) {
  double chi_squared = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (expected[k] == 0.0) {
      EXPECT_EQ(found[k], 0.0) << "bin " << k;
      continue;
    }
    chi_squared += (found[k] - expected[k]) * (found[k] - expected[k]) / expected[k];
  }
  const auto freedom =
      static_cast<double>(std::count_if(expected.begin(), expected.end(), [](double e) { return e > 0.0; }) - 1);
  EXPECT_NEAR(chi_squared, freedom, 5.0 * std::sqrt(2.0 * freedom));
}

BoxOptions box_of(std::uint32_t n, CellType type = CellType::tetrahedron) {
  BoxOptions box;
  box.cells = {n, n, n};
  box.size = {1.0, 1.0, 1.0};
  box.type = type;
  return box;
}

template <class Field>
std::vector<Vec3> at_points(const MeshData& mesh, Field&& field) {
  std::vector<Vec3> values;
  for (const Vec3& x : mesh.points) values.push_back(field(x));
  return values;
}

ParticlesScene group_of(InletParticles inlet) {
  ParticlesScene group;
  group.source = std::move(inlet);
  return group;
}

TEST(RateIntegral, IsTheIntegralOfTheFactors) {
  // A breath: in for 1 s with a peak of 2, a pause, and again after 3 s.
  const RateIntegral breath({{0.0, 0.5, 1.0, 2.0}, {0.0, 2.0, 0.0, 0.0}, 3.0});
  EXPECT_DOUBLE_EQ(breath(0.25), 0.125);
  EXPECT_DOUBLE_EQ(breath(0.5), 0.5);
  EXPECT_DOUBLE_EQ(breath(1.0), 1.0);
  EXPECT_DOUBLE_EQ(breath(2.5), 1.0);
  EXPECT_DOUBLE_EQ(breath(3.25), 1.125);
  EXPECT_DOUBLE_EQ(breath(300.5), 100.5);
  EXPECT_EQ(breath.largest_factor(), 2.0);
  // Held before the first time and after the last.
  const RateIntegral ramp({{1.0, 3.0}, {2.0, 4.0}, 0.0});
  EXPECT_DOUBLE_EQ(ramp(0.5), 1.0);
  EXPECT_DOUBLE_EQ(ramp(1.0), 2.0);
  EXPECT_DOUBLE_EQ(ramp(3.0), 8.0);
  EXPECT_DOUBLE_EQ(ramp(4.0), 12.0);
  EXPECT_EQ(RateIntegral({})(0.7), 0.7);
  EXPECT_DOUBLE_EQ(RateIntegral({{5.0}, {3.0}, 0.0})(2.0), 6.0);
  // It never falls, also where pieces and periods meet. Its first time is not 0.
  const RateIntegral odd({{0.3, 0.7, 1.1}, {0.1, 0.0, 0.7}, 1.0 / 1.1});
  double last = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double now = odd(i * 1e-3);
    ASSERT_GE(now, last) << i;
    last = now;
  }
}

TEST(RateIntegral, RefusesWhatIsNoWaveform) {
  const auto expect = [](const Waveform& w, const char* word) {
    test::expect_parts(test::error_text([&] { static_cast<void>(RateIntegral(w)); }), {"waveform", word});
  };
  expect({{0.0, 1.0}, {1.0}, 0.0}, "1 factors");
  expect({{0.0, 0.0}, {1.0, 1.0}, 0.0}, "increase");
  expect({{0.0, 1.0}, {1.0, -1.0}, 0.0}, "not negative");
  expect({{0.0, 1.0}, {1.0, 1.0}, 0.5}, "period");
}

// Every particle that has entered is in the scene or has left.
TEST(Inlets, NumbersBalance) {
  Environment environment(generate_box(box_of(3)));
  SimulationOptions options;
  options.dt = 0.013;
  options.response = Reflect{};
  options.patch_responses["xmax"] = Escape{};
  Simulation simulation(environment, options);
  InletParticles inlet;
  inlet.patch = "xmin";
  inlet.rate = 997.0;
  inlet.waveform = {{0.0, 0.1, 0.4}, {0.0, 1.0, 0.0}, 0.5};
  inlet.burst_times = {0.0, 0.2, 0.2, 0.999};
  inlet.burst_count = 7;
  ParticlesScene group = group_of(inlet);
  group.velocity = {3.0, 0.1, 0.0};
  simulation.add(group);
  const RateIntegral integral(inlet.waveform);
  std::uint64_t injected = 0;
  for (int step = 1; step <= 90; ++step) {
    injected += simulation.step().injected;
    const double time = simulation.time();
    const auto bursts = static_cast<std::uint64_t>(
        std::count_if(inlet.burst_times.begin(), inlet.burst_times.end(), [&](double t) { return t < time; }));
    EXPECT_EQ(injected, static_cast<std::uint64_t>(std::floor(997.0 * integral(time))) + 7 * bursts);
    EXPECT_EQ(simulation.totals().injected, injected);
    EXPECT_EQ(simulation.particles().size() + simulation.totals().escaped, injected);
  }
  EXPECT_GT(simulation.totals().escaped, 0U);
}

// A flux that enters above y = 1/2 alone. Cells are bins: their shares follow from the values at their corners.
TEST(Inlets, FluxDecidesThePlaces) {
  constexpr std::size_t n = 8;
  constexpr std::uint64_t count = 40000;
  const MeshData mesh = generate_box(box_of(n));
  const CellComplex complex(mesh);
  PatchSampler sampler(complex, complex.map().patch("xmin"));
  const auto flow = [](const Vec3& x) { return Vec3{(x.y - 0.5) * (1.0 + x.z), 0.3, 0.0}; };
  ASSERT_TRUE(sampler.update(complex, [&](SimplexId s, unsigned corner) { return flow(complex.corners(s)[corner]); }));
  std::vector<double> found(n * n);
  std::vector<double> in_one(4);  // quarters of a cell's y, to see the density in it
  for (std::uint64_t i = 0; i < count; ++i) {
    KeyedRandom random(1, RandomPurpose::place, i);
    const Vec3 x = sampler.sample(complex, random)->position;
    ASSERT_LE(x.x, 1.0 / 8 / 64 + 1e-15);
    found[static_cast<std::size_t>(x.y * n) * n + static_cast<std::size_t>(x.z * n)] += 1.0;
    if (x.y >= 0.5 && x.y < 0.625) in_one[static_cast<std::size_t>((x.y - 0.5) * 32.0)] += 1.0;
  }
  // The flux of each cell's face by that of its two triangles: linear between the corners' values.
  std::vector<double> expected(n * n);
  double sum = 0.0;
  for (std::size_t j = n / 2; j < n; ++j) {
    for (std::size_t k = 0; k < n; ++k) {
      const auto at = [&](std::size_t a, std::size_t b) {
        return flow({0.0, static_cast<double>(a) / n, static_cast<double>(b) / n}).x;
      };
      // Either diagonal: the mean of the means of its two triangles; the diagonal's corners count twice.
      const double one = (2.0 * at(j, k) + 2.0 * at(j + 1, k + 1) + at(j + 1, k) + at(j, k + 1)) / 6.0;
      const double other = (at(j, k) + at(j + 1, k + 1) + 2.0 * at(j + 1, k) + 2.0 * at(j, k + 1)) / 6.0;
      ASSERT_NEAR(one, other, 0.003);
      sum += expected[j * n + k] = 0.5 * (one + other);
    }
  }
  for (double& e : expected) e *= static_cast<double>(count) / sum;
  expect_distribution(found, expected);
  // In the first row of cells the density grows from 0 in y: quarters have the shares 1, 3, 5 and 7 of 16.
  const double row = in_one[0] + in_one[1] + in_one[2] + in_one[3];
  expect_distribution(in_one, {row / 16.0, row * 3.0 / 16.0, row * 5.0 / 16.0, row * 7.0 / 16.0});
  // Where nothing comes in there is no place.
  EXPECT_FALSE(sampler.update(complex, [](SimplexId, unsigned) { return Vec3{-1.0, 0.0, 0.0}; }));
}

TEST(Inlets, FluxOnAnEdgeOfThePlane) {
  RectangleOptions rectangle;
  rectangle.cells = {4, 4};
  rectangle.size = {1.0, 1.0};
  const CellComplex complex(generate_rectangle(rectangle));
  PatchSampler sampler(complex, complex.map().patch("xmin"));
  ASSERT_TRUE(sampler.update(complex, [&](SimplexId s, unsigned corner) {
    return Vec3{complex.corners(s)[corner].y, 9.0, 0.0};
  }));
  constexpr std::uint64_t count = 20000;
  std::vector<double> found(16);
  std::vector<double> expected(16);
  for (std::uint64_t i = 0; i < count; ++i) {
    KeyedRandom random(1, RandomPurpose::place, i);
    found[static_cast<std::size_t>(sampler.sample(complex, random)->position.y * 16.0)] += 1.0;
  }
  // The way inwards shifts places by up to a 64th of a cell, a 16th of a bin: bins of a half are compared.
  std::vector<double> halves(4);
  for (std::size_t k = 0; k < 16; ++k) halves[k / 4] += found[k];
  for (std::size_t k = 0; k < 4; ++k) expected[k] = count * (2.0 * static_cast<double>(k) + 1.0) / 16.0;
  expected.resize(4);
  expect_distribution(halves, expected);
}

// Cosines of the angle to the axis are uniform between those of the two cones, and so is the angle around it.
TEST(Inlets, AConeIsEvenBySolidAngle) {
  Environment environment(generate_box(box_of(2)));
  SimulationOptions options;
  options.dt = 1e-6;
  Simulation simulation(environment, options);
  InletCone cone;
  cone.at = {0.5, 0.5, 0.5};
  cone.axis = {1.0, 2.0, -2.0};
  cone.inner = 20.0;
  cone.outer = 75.0;
  cone.speed = 4.0;
  InletParticles inlet;
  inlet.cone = cone;
  inlet.burst_times = {0.0};
  inlet.burst_count = 20000;
  simulation.add(group_of(inlet));
  simulation.step();
  ASSERT_EQ(simulation.particles().size(), 20000U);
  const double inner = std::cos(20.0 * std::numbers::pi / 180.0);
  const double outer = std::cos(75.0 * std::numbers::pi / 180.0);
  std::vector<double> cosines(20);
  std::vector<double> turns(20);
  for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
    const Vec3 v = simulation.velocities()[i];
    EXPECT_NEAR(norm(v), 4.0, 1e-14);
    test::expect_near(simulation.particles()[i].position, cone.at + v * 1e-6, 1e-15);
    const double cosine = dot(v, cone.axis) / (4.0 * 3.0);
    const double share = (cosine - inner) / (outer - inner);
    ASSERT_TRUE(share > -1e-12 && share < 1.0 + 1e-12);
    ++cosines[static_cast<std::size_t>(std::clamp(share * 20.0, 0.0, 19.0))];
    const Vec3 a = Vec3{0.0, 1.0, 1.0} * std::sqrt(0.5);
    const Vec3 b = cross(cone.axis, a) * (1.0 / 3.0);
    const double around = std::atan2(dot(v, b), dot(v, a)) / (2.0 * std::numbers::pi);
    ++turns[static_cast<std::size_t>(std::clamp((around + 0.5) * 20.0, 0.0, 19.0))];
  }
  expect_distribution(cosines, std::vector<double>(20, 1000.0));
  expect_distribution(turns, std::vector<double>(20, 1000.0));
}

TEST(Inlets, AConeInThePlaneStaysThere) {
  Environment environment(generate_rectangle({}));
  SimulationOptions options;
  options.dt = 1e-6;
  Simulation simulation(environment, options);
  InletParticles inlet;
  inlet.cone = InletCone{{0.5, 0.25, 0.0}, {0.0, 1.0, 0.0}, 10.0, 40.0, 1.0};
  inlet.rate = 1e9;
  simulation.add(group_of(inlet));
  simulation.step();
  ASSERT_EQ(simulation.particles().size(), 1000U);
  std::array<int, 2> sides{};
  for (const Vec3& v : simulation.velocities()) {
    EXPECT_EQ(v.z, 0.0);
    EXPECT_GT(v.y, std::cos(40.0 * std::numbers::pi / 180.0) - 1e-12);
    EXPECT_LT(v.y, std::cos(10.0 * std::numbers::pi / 180.0) + 1e-12);
    ++sides[v.x > 0.0 ? 1 : 0];
  }
  EXPECT_GT(std::min(sides[0], sides[1]), 400);
}

// A field at cells that is brought to points, a group and three inlets that take it, or directions of their own.
Scene scene_with_inlets() {
  Scene scene;
  MeshData mesh = generate_box(box_of(6));
  DataArray array{"U", 3, {}};
  for (const Vec3& x : cell_centres(mesh)) {
    const Vec3 u = {1.0 + std::sin(3.0 * x.y), 0.3 * x.z, -0.2 * x.x};
    array.values.insert(array.values.end(), {u.x, u.y, u.z});
  }
  mesh.cell_data.push_back(array);
  scene.environment.mesh = mesh;
  scene.motion.dt = 0.01;
  scene.motion.drag = 2.0;
  scene.motion.field.array = "U";
  scene.motion.field.at = FieldPlace::points;
  scene.contact.general = Reflect{};
  scene.contact.by_patch["xmax"] = Escape{};
  ParticlesScene group;
  group.source = RandomParticles{50};
  group.with_field = true;
  scene.particles.push_back(group);
  InletParticles inlet;
  inlet.patch = "xmin";
  inlet.rate = 1500.0;
  inlet.waveform = {{0.0, 0.05, 0.1}, {0.2, 1.0, 0.2}, 0.1};
  inlet.profile = InletProfile::flux;
  scene.particles.push_back(group_of(inlet));
  InletParticles spray;
  spray.cone = InletCone{{0.52, 0.47, 0.55}, {1.0, 1.0, 0.0}, 5.0, 60.0, 2.0};
  spray.rate = 400.0;
  spray.burst_times = {0.033};
  spray.burst_count = 20;
  scene.particles.push_back(group_of(spray));
  InletParticles side;
  side.patch = "ymin";
  side.rate = 300.0;
  scene.particles.push_back(group_of(side));
  scene.particles.back().with_field = true;
  return scene;
}

using States = std::map<std::uint64_t, std::pair<Vec3, Vec3>>;

void take(const Simulation& simulation, States& to) {
  for (std::size_t i = 0; i < simulation.particles().size(); ++i)
    to[simulation.ids()[i]] = {simulation.particles()[i].position, simulation.velocities()[i]};
}

States states_after(const Scene& scene, int steps, Threads threads = {}) {
  Simulation simulation(scene, threads);
  for (int i = 0; i < steps; ++i) simulation.step();
  States states;
  take(simulation, states);
  return states;
}

TEST(Inlets, ThreadsRanksAndResumesGiveTheSameBits) {
  const Scene scene = scene_with_inlets();
  const States expected = states_after(scene, 25);
  EXPECT_GT(expected.size(), 300U);
  EXPECT_EQ(states_after(scene, 25, Threads{3}), expected);
  for (const Partition partition : {Partition::particles, Partition::cells}) {
    States states;
    std::mutex mutex;
    test::on_ranks(3, [&](Ranks& ranks) {
      Simulation simulation(scene, {}, &ranks, partition);
      for (int i = 0; i < 25; ++i) simulation.step();
      const std::lock_guard lock(mutex);
      take(simulation, states);
    });
    EXPECT_EQ(states, expected) << (partition == Partition::cells ? "by cells" : "by particles");
  }
  Simulation first(scene);
  for (int i = 0; i < 11; ++i) first.step();
  Simulation second(scene, first.checkpoint());
  for (int i = 0; i < 14; ++i) second.step();
  States states;
  take(second, states);
  EXPECT_EQ(states, expected);
}

// At the start and at inlets particles have the field's velocity at their places; in the mesh's frame the mesh's, too.
TEST(Inlets, ParticlesStartWithTheField) {
  const auto flow = [](const Vec3& x) { return Vec3{1.0 + x.y, -0.5 * x.z, 0.25 * x.x}; };
  const MeshData mesh = generate_box(box_of(3));
  Environment environment(mesh);
  SimulationOptions options;
  options.dt = 0.5;
  options.drag = 1e-9;  // what they start with they keep
  Simulation simulation(environment, options);
  ParticlesScene group;
  group.source = RandomParticles{100};
  group.with_field = true;
  EXPECT_THROW(simulation.add(group), InvalidArgument);
  EXPECT_EQ(simulation.particles().size(), 0U);
  simulation.set_field({environment.complex(), at_points(mesh, flow)});
  simulation.add({{0.3, 0.3, 0.3}}, {7.0, 0.0, 0.0});
  simulation.add(group);
  EXPECT_EQ(simulation.velocities()[0], (Vec3{7.0, 0.0, 0.0}));
  ASSERT_EQ(simulation.particles().size(), 101U);
  for (std::size_t i = 1; i < 101; ++i)
    test::expect_near(simulation.velocities()[i], flow(simulation.particles()[i].position), 1e-14);
}

// Through a patch that moves as fast as the fluid nothing comes in. A slower patch lets particles in, also once a
// cell behind it is subdivided.
TEST(Inlets, FluxIsRelativeToAMovingPatch) {
  const MeshData mesh = generate_box(box_of(2, CellType::hexahedron));
  DeformationStep frames;
  frames.kind = DeformationKind::frames;
  frames.times = {0.0, 64.0};
  frames.frames = {mesh.points, mesh.points};
  for (Vec3& x : frames.frames[1]) x.x += 64.0;
  for (const double speed : {1.0, 3.0}) {
    Environment environment(mesh);
    SimulationOptions options;
    options.dt = 0.25;
    options.response = Escape{};
    Simulation simulation(environment, options);
    simulation.set_field({environment.complex(), std::vector<Vec3>(mesh.points.size(), Vec3{speed, 0.0, 0.0})});
    simulation.set_deformation(Deformation({frames}, mesh.points));
    InletParticles inlet;
    inlet.patch = "xmin";
    inlet.rate = 40.0;
    inlet.profile = InletProfile::flux;
    simulation.add(group_of(inlet));
    EXPECT_EQ(simulation.step().injected, 10U);  // it stands before the first move
    for (int i = 0; i < 3; ++i) EXPECT_EQ(simulation.step().injected, speed > 1.0 ? 10U : 0U);
    const Cell behind = environment.locate({simulation.time() + 0.1, 0.25, 0.25}).simplex.cell;
    simulation.edit([&](ComplexEdit& e) { subdivide(e, behind); });
    EXPECT_EQ(simulation.step().injected, 10U);  // nor does it move between the edit and the next move
    EXPECT_EQ(simulation.step().injected, speed > 1.0 ? 10U : 0U);
    EXPECT_EQ(simulation.audit().failed, 0U);
  }
}

TEST(Inlets, WhatIsRefused) {
  Environment environment(generate_box(box_of(2)));
  Simulation simulation(environment, {});
  const auto expect = [&](const InletParticles& inlet, std::initializer_list<const char*> words) {
    test::expect_parts(test::error_text([&] { simulation.add(group_of(inlet)); }), words);
  };
  InletParticles cone;
  cone.cone = InletCone{{0.5, 0.5, 0.5}, {0, 0, 1}, 10.0, 20.0, 1.0};
  const auto with = [&](auto change) {
    InletParticles other = cone;
    change(other);
    return other;
  };
  expect(with([](auto& i) { i.cone->outer = 5.0; }), {"angles", "outer"});
  expect(with([](auto& i) { i.cone->axis = {}; }), {"axis"});
  expect(with([](auto& i) { i.cone->speed = -1.0; }), {"speed"});
  expect(with([](auto& i) { i.cone->at = {5, 5, 5}; }), {"(5, 5, 5)", "no free cell"});
  expect(with([](auto& i) { i.patch = "xmin"; }), {"either a patch or a cone"});
  expect(with([](auto& i) { i.burst_times = {-1.0}; }), {"burst", "-1"});
  expect(with([](auto& i) { i.rate = 1e300; }), {"rate"});
  InletParticles flux;
  flux.patch = "xmin";
  flux.profile = InletProfile::flux;
  expect(flux, {"field", "set_field"});
  const std::vector<Vec3> flow(environment.complex().point_count(), Vec3{1.0, 0.0, 0.0});
  simulation.set_field({environment.complex(), flow});
  expect(with([](auto& i) { i.profile = InletProfile::flux; }), {"flux", "patch"});
  EXPECT_EQ(simulation.step().injected, 0U);
}

}  // namespace dartcast::inlets_test
