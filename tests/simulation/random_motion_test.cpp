// Random motion: against closed forms in long double, exact series of diffusion, and counts within their sampling error.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/normal_deviates.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/eddies.hpp"
#include "simulation/force_kernel.hpp"
#include "simulation/simulation_state.hpp"
#include "support/expectations.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::random_motion_test {

using test::expect_near;

constexpr Fluid air = {1.2, 1.8e-5, 0.0, 300.0};

MeshData box_of(double edge, std::uint32_t cells = 2) {
  BoxOptions box;
  box.cells = {cells, cells, cells};
  box.size = {edge, edge, edge};
  return generate_box(box);
}

// The law of one axis, with z = c t: variances and the covariance in units of s, s t^2 and s t.
struct Law {
  long double velocity, way, joint;

  explicit Law(long double z) {
    const long double e = -std::expm1(-z);  // 1 - exp(-z)
    velocity = -std::expm1(-2.0L * z);
    joint = e * e / z;
    way = (2.0L * z - 2.0L * e - e * e) / (z * z);
    if (z > 0.1L) return;
    // 2 z - 3 + 4 exp(-z) - exp(-2 z), term by term.
    long double term = 1.0L;
    way = 0.0L;
    for (int k = 1; k <= 25; ++k) {
      term *= -z / k;
      if (k >= 3) way += term * (4.0L - std::pow(2.0L, static_cast<long double>(k)));
    }
    way /= z * z;
  }
};

// With its deviates known, a particle's motion has the coefficients of the law.
TEST(Brownian, VelocityAndWayHaveTheJointLawAtAnyRateAndTime) {
  const double d = 2e-6;
  const double density = 1100.0;
  const double energy = 4e-21;
  const RandomMoment moment = {5, RandomPurpose::brownian, 3};
  for (const double z : {1e-300, 1e-12, 1e-5, 0.01, 0.3, 0.34, 0.3401, 0.5, 1.0, 3.0, 30.0, 1e3, 1e9}) {
    const double duration = 0.25;
    const std::array<std::uint64_t, 1> ids = {17};
    const std::array<double, 1> diameters = {d}, densities = {density - 100.0}, rates = {z / duration};
    std::array<Vec3, 1> ends{}, ways{};
    detail::add_thermal_motion({moment, false, duration, energy, 100.0, ids, diameters, densities, rates, ends, ways});
    const std::array<double, 4> a = normal_deviates(moment.bits(17, 0));
    const std::array<double, 4> b = normal_deviates(moment.bits(17, 1));
    const Law law(z);
    const double s = energy / (density * std::numbers::pi / 6.0 * d * d * d);
    const auto speed = static_cast<double>(std::sqrt(s * law.velocity));
    const auto with_speed = static_cast<double>(duration * law.joint / law.velocity);
    // Long double cancels at great rates no more than double does.
    const auto alone = static_cast<double>(duration * std::sqrt(s * (law.way - law.joint * law.joint / law.velocity)));
    const double bound = z < 0.02 ? 1e-3 : 1e-12;
    EXPECT_NEAR(ends[0].x, speed * a[0], 1e-13 * std::abs(speed * a[0])) << z;
    EXPECT_NEAR(ends[0].y, speed * a[1], 1e-13 * std::abs(speed * a[1])) << z;
    EXPECT_NEAR(ends[0].z, speed * a[2], 1e-13 * std::abs(speed * a[2])) << z;
    const Vec3 rest = ways[0] - ends[0] * with_speed;
    EXPECT_NEAR(ways[0].x, with_speed * speed * a[0] + alone * a[3], bound * alone + 1e-13 * std::abs(ways[0].x)) << z;
    if (z < 0.02) continue;
    EXPECT_NEAR(rest.y, alone * b[0], 1e-12 * (alone + std::abs(ways[0].y))) << z;
    EXPECT_NEAR(rest.z, alone * b[1], 1e-12 * (alone + std::abs(ways[0].z))) << z;
  }
}

// The share that is not of the velocity: s t^2 z / 6 (1 - z^2 / 10 + 17 z^4 / 1680).
TEST(Brownian, TheSmallestStepsKeepTheirDigits) {
  const RandomMoment moment = {5, RandomPurpose::brownian, 3};
  for (const double z : {1e-12, 1e-6, 1e-3}) {
    const std::array<std::uint64_t, 1> ids = {17};
    const std::array<double, 1> one = {1.0}, rates = {z};
    std::array<Vec3, 1> ends{}, ways{};
    const double energy = std::numbers::pi / 6.0;
    detail::add_thermal_motion({moment, false, 1.0, energy, 0.0, ids, one, one, rates, ends, ways});
    const double alone = std::sqrt(z / 6.0 * (1.0 - z * z / 10.0));
    const double with_speed = std::tanh(0.5 * z) / z;
    const double a = normal_deviates(moment.bits(17, 0))[3];
    EXPECT_NEAR(ways[0].x - with_speed * ends[0].x, alone * a,
                1e-13 * std::abs(ways[0].x) + 1e-12 * std::abs(alone * a));
  }
}

TEST(Brownian, KernelsGiveTheSameBitsInEveryInstructionSetAndLane) {
  constexpr std::size_t n = 503;
  std::vector<std::uint64_t> ids(n);
  std::vector<double> diameters(n), densities(n), rates(n);
  for (std::size_t i = 0; i < n; ++i) {
    ids[i] = i << (i % 50);
    diameters[i] = 1e-6 * static_cast<double>(1 + i % 7);
    densities[i] = 500.0 + static_cast<double>(i);
    rates[i] = std::pow(10.0, static_cast<double>(i % 20) - 10.0);
  }
  for (const bool planar : {false, true}) {
    std::optional<std::array<std::vector<Vec3>, 3>> first;
    for (const auto set : {detail::InstructionSet::portable, detail::best_instruction_set()}) {
      for (const std::size_t shift : {0U, 1U, 3U}) {
        std::array<std::vector<Vec3>, 3> made;
        for (auto& list : made) list.assign(n, Vec3{});
        const RandomMoment moment = {9, RandomPurpose::brownian, 1ULL << 40U};
        const auto last = [&](auto& all) { return std::span(all).last(n - shift); };
        detail::add_thermal_motion({moment, planar, 0.1, 4e-21, 0.0, last(ids), last(diameters), last(densities),
                                    last(rates), last(made[0]), last(made[1])},
                                   set);
        detail::draw_ways({moment, 3.0, planar, last(ids), last(made[2])}, set);
        if (!first) first = made;
        for (std::size_t k = 0; k < 3; ++k) {
          ASSERT_EQ(std::memcmp(&made[k][shift], &(*first)[k][shift], (n - shift) * sizeof(Vec3)), 0);
          ASSERT_EQ(made[k][n - 1].z == 0.0, planar);
        }
      }
    }
  }
}

// Equipartition: each component has the variance k T / m after steps of any length. 20,000 particles: 1 in 122 is the
// standard error of the variance of all components.
TEST(Brownian, VelocitiesKeepTheTemperature) {
  constexpr double d = 5e-8;
  constexpr double density = 1000.0;
  constexpr std::size_t count = 20'000;
  const double tau = density * d * d / (18.0 * air.viscosity);
  const double s = boltzmann_constant * air.temperature / (density * std::numbers::pi / 6.0 * d * d * d);
  for (const double steps_per_tau : {0.05, 0.5, 5.0, 500.0}) {
    Environment environment(box_of(1.0, 1));
    SimulationOptions o;
    o.dt = steps_per_tau * tau;
    o.forces.terms = {Force::stokes, Force::brownian};
    o.forces.fluid = air;
    Simulation simulation(environment, o);
    simulation.add(std::vector<Vec3>(count, Vec3{0.5, 0.4, 0.3}), {}, 0.0, {}, {d, density, 0.0});
    const int steps = std::max(3, static_cast<int>(5.0 / steps_per_tau));
    for (int i = 0; i < steps; ++i) simulation.step();
    double square = 0.0;
    double way = 0.0;
    double joint = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 v = simulation.velocities()[i];
      const Vec3 x = simulation.particles()[i].position - Vec3{0.5, 0.4, 0.3};
      square += dot(v, v);
      way += dot(x, x);
      joint += dot(x, v);
    }
    // Steps do not count: the law of their sum is the law of one of their length.
    const double time = steps * o.dt;
    const Law law(time / tau);
    const double n = 3.0 * count;
    const double error = 4.0 * std::sqrt(2.0 / n);
    EXPECT_NEAR(square / n / (s * static_cast<double>(law.velocity)), 1.0, error) << steps_per_tau;
    EXPECT_NEAR(way / n / (s * time * time * static_cast<double>(law.way)), 1.0, error) << steps_per_tau;
    const double both = s * time * std::sqrt(static_cast<double>(law.velocity * law.way));
    EXPECT_NEAR(joint / n / both, s * time * static_cast<double>(law.joint) / both, error) << steps_per_tau;
  }
}

SimulationOptions diffusing(double diffusion, double dt) {
  SimulationOptions o;
  o.dt = dt;
  o.diffusion = diffusion;
  return o;
}

// 6 D t: 20,000 particles, whose mean square has a standard error of 1 in 173.
TEST(Diffusion, SpreadsAsSixDT) {
  for (const unsigned substeps : {1U, 3U}) {
    Environment environment(box_of(1000.0));
    SimulationOptions o = diffusing(0.3, 0.1);
    o.substeps = substeps;
    Simulation simulation(environment, o);
    const Vec3 start = {480.0, 510.0, 530.0};
    constexpr std::size_t count = 20'000;
    simulation.add(std::vector<Vec3>(count, start), {});
    for (int i = 0; i < 20; ++i) simulation.step();
    Vec3 mean;
    double square = 0.0;
    double fourth = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 x = simulation.particles()[i].position - start;
      mean += x * (1.0 / count);
      square += dot(x, x) / count;
      fourth += dot(x, x) * dot(x, x) / count;
      ASSERT_EQ(simulation.velocities()[i], Vec3{});
    }
    const double truth = 6.0 * 0.3 * 2.0;
    EXPECT_NEAR(square, truth, 4.0 * truth / 173.0);
    EXPECT_NEAR(fourth, truth * truth * 5.0 / 3.0, 4.0 * truth * truth * 5.0 / 3.0 / 74.0);
    EXPECT_LT(norm(mean), 4.0 * std::sqrt(truth / count));
  }
}

// A box of 4^3 parts whose walls pulse along with the field: each part keeps its share. 63 degrees of freedom.
TEST(Diffusion, UniformStaysUniformInABoxThatPulses) {
  for (const WallMotion walls : {WallMotion::carried, WallMotion::simultaneous}) {
    const MeshData mesh = box_of(1.0, 4);
    Environment environment(mesh);
    SimulationOptions o = diffusing(0.05, 0.02);
    o.response = Reflect{1.0};
    o.wall_motion = walls;
    Simulation simulation(environment, o);
    DeformationStep pulse;
    pulse.kind = DeformationKind::stretch;
    pulse.axis = {0.0, 0.0, 1.0};
    pulse.amplitude = 0.3;
    pulse.period = 0.5;
    simulation.set_deformation({{pulse}, mesh.points});
    simulation.set_field(VelocityField(environment.complex(), std::vector<Vec3>(mesh.points.size()), FieldFrame::mesh));
    constexpr std::size_t count = 10'000;
    simulation.add_random(count, {});
    for (int i = 0; i < 40; ++i) simulation.step();
    ASSERT_EQ(simulation.particles().size(), count);
    std::vector<Vec3> corners = {environment.positions().front(), environment.positions().front()};
    for (const Vec3& p : environment.positions()) {
      corners[0] = {std::min(corners[0].x, p.x), std::min(corners[0].y, p.y), std::min(corners[0].z, p.z)};
      corners[1] = {std::max(corners[1].x, p.x), std::max(corners[1].y, p.y), std::max(corners[1].z, p.z)};
    }
    std::array<double, 64> counts{};
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 x = simulation.particles()[i].position - corners[0];
      const Vec3 size = corners[1] - corners[0];
      const auto part = [](double share) { return std::min<std::size_t>(3, static_cast<std::size_t>(4.0 * share)); };
      ++counts[16 * part(x.x / size.x) + 4 * part(x.y / size.y) + part(x.z / size.z)];
    }
    double chi = 0.0;
    for (const double c : counts) chi += (c - count / 64.0) * (c - count / 64.0) / (count / 64.0);
    EXPECT_LT(chi, 63.0 + 4.0 * std::sqrt(126.0));
    EXPECT_GT(chi, 63.0 - 4.0 * std::sqrt(126.0));
  }
}

// The share that survives from a uniform start in a box of edge 1, if its absorbing walls stand so far behind it: that of one
// axis, cubed.
double surviving(double behind, double dt_d) {
  const double edge = 1.0 + 2.0 * behind;
  double one = 0.0;
  for (int n = 1; n < 200; n += 2) {
    const double k = n * std::numbers::pi / edge;
    one += 8.0 / (edge * k * k) * std::cos(k * behind) * std::exp(-k * k * dt_d);
  }
  return one * one * one;
}

// D grows fivefold along the box. Without the drift five times as many would be where D is low.
TEST(Diffusion, InAFieldKeepsUniformCloudsUniform) {
  const auto scene_of = [](MeshData mesh) {
    std::vector<double> d;
    for (const Vec3& x : mesh.points) d.push_back(0.05 * (1.0 + x.x));
    mesh.point_data.push_back({"D", 1, d});
    Scene scene;
    scene.environment.mesh = std::move(mesh);
    scene.contact.general = Reflect{1.0};
    scene.motion.dt = 0.05;
    scene.motion.sample = {"D"};
    scene.motion.diffusivity = "D";
    scene.particles.push_back({RandomParticles{4000}, {}, 0.0, {}});
    return scene;
  };
  BoxOptions box;
  box.cells = {8, 2, 2};
  box.size = {4.0, 1.0, 1.0};
  RectangleOptions plane;
  plane.cells = {8, 2};
  plane.size = std::array{4.0, 1.0};
  Scene space = scene_of(generate_box(box));
  std::vector<std::string> states;
  for (const auto& [scene, threads] :
       {std::pair{space, 1U}, std::pair{space, 3U}, std::pair{scene_of(generate_rectangle(plane)), 1U}}) {
    Simulation simulation(scene, Threads{threads});
    for (int step = 0; step < 160; ++step) simulation.step();
    states.push_back(simulation.state_hash().hex());
    std::array<double, 8> count{};
    for (const ParticleState& s : simulation.particles().states())
      count[std::min<std::size_t>(7, static_cast<std::size_t>(2.0 * s.position.x))] += 1.0;
    double chi_squared = 0.0;
    for (const double n : count) chi_squared += (n - 500.0) * (n - 500.0) / 500.0;
    EXPECT_LT(chi_squared, 24.3);  // 0.1% of such clouds are beyond it, with 7 degrees of freedom
  }
  EXPECT_EQ(states[0], states[1]);
  space.motion.diffusivity = "E";
  Simulation unknown(space);
  test::expect_parts(test::refusal([&] { unknown.step(); }), {"diffusivity", "\"E\""});
}

// A walk in steps sees a wall later than the exact motion, as if it stood 0.5826 sqrt(2 D dt) behind (S. Asmussen,
// P. Glynn, J. Pitman, 1995).
TEST(Diffusion, SurvivalBetweenAbsorbingWallsIsThatOfTheSeries) {
  constexpr std::size_t count = 20'000;
  constexpr double d = 0.01;
  Environment environment(box_of(1.0, 4));
  SimulationOptions o = diffusing(d, 0.002);
  o.response = Absorb{};
  Simulation simulation(environment, o);
  simulation.add_random(count, {});
  for (int i = 0; i < 400; ++i) simulation.step();
  const double share = surviving(0.5826 * std::sqrt(2.0 * d * o.dt), d * simulation.time());
  const double left = static_cast<double>(simulation.particles().size()) / count;
  EXPECT_NEAR(left, share, 4.0 * std::sqrt(share * (1.0 - share) / count));
}

// A scene with both random motions, in which particles rebound, leave and enter.
Scene shaken() {
  Scene scene;
  BoxOptions box;
  box.cells = {8, 4, 4};
  box.size = {2.0, 1.0, 1.0};
  MeshData mesh = generate_box(box);
  DataArray u{"u", 3, {}};
  for (const Vec3& p : mesh.points) {
    for (const double x : {1.0 + p.y, 0.3 * p.z - 0.1, 0.5 * p.x - 0.3}) u.values.push_back(x);
  }
  mesh.point_data.push_back(u);
  scene.environment.mesh = mesh;
  scene.motion.field.array = "u";
  scene.motion.dt = 0.02;
  scene.motion.diffusion = 1e-3;
  scene.motion.forces.terms = {Force::stokes, Force::brownian};
  scene.motion.forces.fluid = {1.2, 1.8e-5, 0.0, 1e18};
  scene.contact.general = Reflect{0.7};
  scene.contact.by_patch["xmax"] = Escape{};
  for (const double d : {1e-5, 1e-4, 1e-3}) {
    ParticlesScene some;
    some.source = RandomParticles{100};
    some.material = {d, 1000.0, 0.0};
    scene.particles.push_back(some);
  }
  ParticlesScene entering;
  entering.source = InletParticles{"xmin", 400.0};
  entering.velocity = {1.0, 0.0, 0.0};
  entering.material = {2e-4, 500.0, 0.0};
  entering.sizes = SizeDistribution{SizeLaw::lognormal, 2e-4, 1.5, 1e-5, 1e-3};
  scene.particles.push_back(entering);
  return scene;
}

void expect_same(const SimulationCheckpoint& one, const SimulationCheckpoint& other) {
  const SavedParticles& a = one.state().particles.table;
  const SavedParticles& b = other.state().particles.table;
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_GT(a.rows(), 100U);
  for (std::size_t i = 0; i < a.rows(); ++i) {
    ASSERT_EQ(a[a.id][i], b[b.id][i]);
    ASSERT_EQ(a[a.diameter][i], b[b.diameter][i]);
    ASSERT_EQ(std::memcmp(&a[a.velocity][i], &b[b.velocity][i], sizeof(Vec3)), 0) << i;
    ASSERT_EQ(std::memcmp(&a[a.state][i].position, &b[b.state][i].position, sizeof(Vec3)), 0) << i;
  }
}

void expect_same_on_all(const Scene& scene, int steps) {
  Simulation alone(scene, Threads{1});
  std::optional<SimulationCheckpoint> half;
  for (int i = 0; i < steps; ++i) {
    if (i == steps / 2) half = alone.checkpoint();
    alone.step();
  }
  EXPECT_GT(alone.totals().escaped, 50U);
  const SimulationCheckpoint truth = alone.checkpoint();
  for (const unsigned threads : {2U, 4U}) {
    Simulation threaded(scene, Threads{threads});
    for (int i = 0; i < steps; ++i) threaded.step();
    expect_same(threaded.checkpoint(), truth);
  }
  Simulation resumed(scene, *half);
  for (int i = steps / 2; i < steps; ++i) resumed.step();
  expect_same(resumed.checkpoint(), truth);
  for (const Partition partition : {Partition::particles, Partition::cells}) {
    std::mutex mutex;
    std::vector<SimulationCheckpoint> parts;
    test::on_ranks(3, [&](Ranks& ranks) {
      Simulation shared(scene, Threads{1}, &ranks, partition);
      for (int i = 0; i < steps; ++i) shared.step();
      const std::lock_guard lock(mutex);
      parts.push_back(shared.checkpoint());
    });
    expect_same(joined(parts), truth);
  }
}

TEST(RandomMotion, BitsAreThoseOfAnyThreadsRanksAndResume) { expect_same_on_all(shaken(), 40); }

// As shaken(), with turbulence of k that falls along the box.
Scene turbulent(bool by_forces) {
  Scene scene = shaken();
  auto& mesh = std::get<MeshData>(scene.environment.mesh);
  DataArray k{"k", 1, {}};
  for (const Vec3& p : mesh.points) k.values.push_back(0.3 - 0.1 * p.x);
  mesh.point_data.push_back(k);
  mesh.point_data.push_back({"omega", 1, std::vector<double>(mesh.points.size(), 40.0)});
  scene.motion.sample = {"k", "omega"};
  scene.motion.turbulence = {.k = "k", .epsilon = {}, .omega = "omega", .lagrangian = 0.15};
  if (!by_forces) scene.motion.forces = {};
  return scene;
}

TEST(Turbulence, BitsAreThoseOfAnyThreadsRanksAndResume) {
  expect_same_on_all(turbulent(true), 40);
  expect_same_on_all(turbulent(false), 40);
}

// Numbers of a particle: k, epsilon, and its eddy.
struct OneParticle {
  std::array<double, 6> numbers = {0.6, 0.3, 1.0, 0.0, 0.0, 0.0};
  SimulationOptions options;
  explicit OneParticle(double k = 0.6) {
    numbers[0] = k;
    options.user_data = {"k", "epsilon", "eddy_x", "eddy_y", "eddy_z", "eddy_left"};
    options.turbulence = {.k = "k", .epsilon = "epsilon", .omega = {}, .lagrangian = 0.2};
  }
  Vec3 step(double duration, const Eddies::Crossing& crossing, std::uint64_t at = 5) {
    const Eddies eddies(options, false);
    return eddies.velocity(numbers, eddies.moment(at), 7, duration, crossing);
  }
};

// The life is 2 C_L k / epsilon; the size is C_mu^(3/4) k^(3/2) / epsilon.
TEST(Turbulence, AnEddyEndsWithItsLifeOrWhenItIsCrossed) {
  const double life = 2.0 * 0.2 * 0.6 / 0.3;
  const double size = std::pow(0.09, 0.75) * std::pow(0.6, 1.5) / 0.3;
  struct Case {
    Eddies::Crossing crossing;
    double time;
  };
  for (const auto& [crossing, time] :
       {Case{{}, life}, Case{{0.1, 0.5 * size / 0.1}, life},  // it never comes out of the eddy
        Case{{10.0, 0.5}, -0.5 * std::log(1.0 - size / 5.0)}, Case{{1e-3, 1e9}, life},
        Case{{5.0, 1e6}, -1e6 * std::log1p(-size / 5e6)}}) {
    OneParticle p;
    const Vec3 v = p.step(0.01, crossing);
    EXPECT_NEAR(p.numbers[5], time - 0.01, 1e-9 * time);
    const double steps = time / 0.01;
    const double fraction = steps - std::floor(steps);
    const double share = 1.0 - fraction * (1.0 - fraction) / (steps * steps + fraction * (1.0 - fraction));
    const auto deviates = normal_deviates(RandomMoment{1, RandomPurpose::eddy, 5}.bits(7));
    expect_near(v, Vec3{deviates[0], deviates[1], deviates[2]} * std::sqrt(0.4 * share), 1e-9);
    EXPECT_EQ(p.step(0.01, crossing, 6), v);
  }
  OneParticle still(0.0);
  EXPECT_EQ(still.step(0.01, {}), Vec3{});
  EXPECT_EQ(still.numbers[2], 0.0);
}

// Steps longer than an eddy keep the dispersion of a long time; drops of little inertia follow.
TEST(Turbulence, DispersesAlikeForAnyStep) {
  constexpr std::size_t count = 3000;
  const double life = 2.0 * 0.15 * 0.015 / 0.0225;
  MeshData mesh = box_of(8.0, 1);
  mesh.point_data.push_back({"u", 3, std::vector<double>(24)});
  mesh.point_data.push_back({"k", 1, std::vector<double>(8, 0.015)});
  mesh.point_data.push_back({"epsilon", 1, std::vector<double>(8, 0.0225)});
  for (const bool by_forces : {false, true}) {
    for (const double steps_per_life : {4.0, 1.3, 0.4}) {
      Scene scene;
      scene.environment.mesh = mesh;
      scene.motion.field.array = "u";
      scene.motion.sample = {"k", "epsilon"};
      scene.motion.turbulence.k = "k";
      scene.motion.turbulence.epsilon = "epsilon";
      scene.motion.dt = life / steps_per_life;
      if (by_forces) {
        scene.motion.forces.terms = {Force::stokes};
        scene.motion.forces.fluid = air;
      }
      ParticlesScene group;
      InletParticles cone;
      cone.cone = InletCone{.at = {4.1, 4.2, 4.3}};
      cone.burst_times = {0.0};
      cone.burst_count = count;
      group.source = cone;
      group.material = {1e-6, 1000.0, 0.0};
      scene.particles = {group};
      Simulation simulation(scene);
      while (simulation.time() < 20.0 * life) simulation.step();
      ASSERT_EQ(simulation.particles().size(), count);
      double way = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3 x = simulation.particles()[i].position - Vec3{4.1, 4.2, 4.3};
        way += dot(x, x) / (3.0 * count);
      }
      const double truth = 0.01 * (life * simulation.time() - (steps_per_life > 1.0 ? life * life / 3.0 : 0.0));
      EXPECT_NEAR(way, truth, (4.0 * std::sqrt(2.0 / (3.0 * count)) + 0.01) * truth)
          << by_forces << " " << steps_per_life;
    }
  }
}

TEST(Turbulence, RefusesOptionsThatCannotBeMet) {
  Environment environment(box_of(1.0));
  const auto expect = [&](const SimulationOptions& o, const char* part) {
    test::expect_refused([&] { Simulation simulation(environment, o); }, part);
  };
  SimulationOptions o = OneParticle().options;
  o.turbulence.omega = "omega";
  expect(o, "one of epsilon and omega");
  o = OneParticle().options;
  o.turbulence.k = "";
  expect(o, "needs k");
  o.turbulence.k = "tke";
  expect(o, "\"tke\" of each particle");
  o = OneParticle().options;
  std::swap(o.user_data[2], o.user_data[5]);
  expect(o, "in a row");
  o = OneParticle().options;
  o.turbulence.lagrangian = 0.0;
  expect(o, "Lagrangian constant");
  o = OneParticle().options;
  o.collisions.emplace();
  expect(o, "leave collisions or turbulence out");
  Simulation without_field(environment, OneParticle().options);
  test::expect_refused([&] { without_field.step(); }, "turbulence needs a velocity field");
}

TEST(RandomMotion, StaysInThePlane) {
  RectangleOptions rectangle;
  rectangle.cells = {4, 4};
  Environment environment(generate_rectangle(rectangle));
  SimulationOptions o = diffusing(1e-3, 0.1);
  o.forces.terms = {Force::stokes, Force::brownian};
  o.forces.fluid = {1.2, 1.8e-5, 0.0, 1e18};
  Simulation simulation(environment, o);
  simulation.add_random(50, {}, 0.0, {}, {1e-4, 1000.0, 0.0});
  for (int i = 0; i < 10; ++i) simulation.step();
  for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
    EXPECT_NE(simulation.velocities()[i].x, 0.0);
    EXPECT_EQ(simulation.velocities()[i].z, 0.0);
    EXPECT_EQ(simulation.particles()[i].position.z, 0.0);
  }
}

TEST(RandomMotion, RefusesOptionsThatCannotBeMet) {
  Environment environment(box_of(1.0));
  const auto expect = [&](const SimulationOptions& o, const char* part) {
    test::expect_refused([&] { Simulation simulation(environment, o); }, part);
  };
  expect(diffusing(-1.0, 0.1), "diffusion must be finite");
  expect(diffusing(NAN, 0.1), "diffusion must be finite");
  SimulationOptions o = diffusing(1.0, 0.1);
  o.collisions.emplace();
  expect(o, "leave collisions or diffusion out");
  o = {};
  o.forces.fluid = air;
  o.forces.terms = {Force::brownian};
  expect(o, "belongs to drag");
  o.forces.terms = {Force::stokes, Force::brownian};
  o.forces.fluid.temperature = 0.0;
  expect(o, "temperature: give it");
  o.forces.fluid.temperature = -3.0;
  expect(o, "temperature is -3");
}

}  // namespace dartcast::random_motion_test
