#include "dartcast/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "simulation/simulation_state.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/with_response.hpp"

namespace dartcast::simulation_test {

using test::expect_near;

SimulationOptions options(double dt) {
  SimulationOptions o;
  o.dt = dt;
  return o;
}

std::vector<Vec3> values(const MeshData& mesh, const std::function<Vec3(const Vec3&)>& f) {
  std::vector<Vec3> result;
  for (const Vec3& p : mesh.points) result.push_back(f(p));
  return result;
}

TEST(Simulation, FallsAsEulersMethodSays) {
  Environment environment(test::cube_of(4, 10.0));
  SimulationOptions o = options(0.01);
  o.gravity = {0, 0, -2.0};
  Simulation flow(environment, o);
  flow.add(std::vector<Vec3>{{5, 5, 9}}, {1, 0, 0});
  for (int i = 0; i < 100; ++i) flow.step();
  expect_near(flow.particles()[0].position, {6, 5, 9 - 2.0 * 1e-4 * 100 * 101 / 2}, 1e-12);
  expect_near(flow.velocities()[0], {1, 0, -2}, 1e-12);
  EXPECT_DOUBLE_EQ(flow.time(), 1.0);
  EXPECT_EQ(flow.totals().counters.particle_steps, 100U);
}

// A checkpoint that does not fit is refused as a whole.
TEST(Simulation, RestoresOnlyStatesThatHold) {
  Environment environment(test::cube_of(3, 10.0));
  Simulation flow(environment, options(0.01));
  flow.add_random(20, {1, 2, 3});
  flow.step();
  const SimulationCheckpoint good = flow.checkpoint();
  const std::string hash = flow.state_hash().hex();
  const auto expect_refused = [&](auto&& spoil) {
    SimulationState bad = good.state();
    spoil(bad.particles.table[bad.particles.table.state][7]);
    EXPECT_THROW(flow.restore(SimulationCheckpoint(bad)), InvalidArgument);
    EXPECT_EQ(flow.state_hash().hex(), hash);
  };
  expect_refused([](ParticleState& s) { s.cell = Cell(); });
  expect_refused([](ParticleState& s) { s.cell = Cell{s.cell.value + 1}; });
  expect_refused([](ParticleState& s) { s.simplex = 6; });
  expect_refused([](ParticleState& s) { s.simplex = s.simplex == 0 ? 1 : 0; });
  expect_refused([](ParticleState& s) { s.position.x += 4.0; });
  expect_refused([](ParticleState& s) { s.position.x = std::numeric_limits<double>::quiet_NaN(); });
  expect_refused([](ParticleState& s) { s.touching_count = 4; });
  expect_refused([](ParticleState& s) { s.touching_count = 1; });
  flow.restore(good);
  EXPECT_EQ(flow.state_hash().hex(), hash);
}

// Vertices that had moved stayed where they were.
TEST(Simulation, GoesBackToItsStart) {
  Environment environment(test::cube_of(3, 10.0));
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  Simulation flow(environment, options(0.01));
  flow.add_random(20, {100, 200, 300});
  const SimulationCheckpoint start = flow.checkpoint();
  flow.pull(std::vector<Vec3>(rest.size(), Vec3{1, 2, 3}), 0.02);
  std::vector<std::string> hashes;
  for (int i = 0; i < 2; ++i) {
    flow.restore(start);
    EXPECT_TRUE(std::equal(rest.begin(), rest.end(), environment.positions().begin()));
    for (int step = 0; step < 3; ++step) flow.step();
    hashes.push_back(flow.state_hash().hex());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// Found by random calls (seed 1): the vertices had gone to the time of the checkpoint, the particles had not followed.
TEST(Simulation, GoesOnAfterARefusedCheckpointOfAnotherMotion) {
  Environment environment(test::cube_of(3, 10.0));
  Simulation flow(environment, options(0.1));
  flow.add_random(50, {1, 2, 3});
  flow.add_body(std::vector<Vec3>{{5, 5, 5}, {6, 5, 5}, {5, 6, 5}, {5, 5, 6}}, {});
  for (int i = 0; i < 4; ++i) flow.step();
  const SimulationCheckpoint early = flow.checkpoint();
  for (int i = 0; i < 2; ++i) flow.step();
  DeformationStep twist;
  twist.kind = DeformationKind::twist;
  twist.amplitude = 0.02;
  twist.period = 0.7;
  flow.set_deformation(Deformation({twist}, environment.positions()));
  const std::string hash = flow.state_hash().hex();
  const std::vector<Vec3> places(environment.positions().begin(), environment.positions().end());
  EXPECT_THROW(flow.restore(early), InvalidArgument);
  EXPECT_EQ(flow.state_hash().hex(), hash);
  EXPECT_EQ(flow.steps(), 6U);
  EXPECT_TRUE(std::ranges::equal(environment.positions(), places));
  for (int i = 0; i < 3; ++i) flow.step();
  EXPECT_EQ(flow.audit().failed, 0U);
}

TEST(Simulation, DragTakesSpeedExponentiallyWhateverTheStep) {
  for (const double dt : {0.001, 0.5}) {
    Environment environment(test::cube_of(2, 10.0));
    SimulationOptions o = options(dt);
    o.drag = 3.0;
    Simulation flow(environment, o);
    flow.add(std::vector<Vec3>{{1, 5, 5}}, {2, 0, 0});
    while (flow.time() < 1.0 - 1e-9) flow.step();
    expect_near(flow.velocities()[0], {2 * std::exp(-3.0), 0, 0}, 1e-12);
  }
}

TEST(Simulation, DragAndGravityEndAtTheTerminalVelocity) {
  Environment environment(test::cube_of(2, 10.0));
  SimulationOptions o = options(0.1);
  o.drag = 50.0;
  o.gravity = {0, 0, -10};
  Simulation flow(environment, o);
  flow.add(std::vector<Vec3>{{5, 5, 8}}, {});
  for (int i = 0; i < 20; ++i) flow.step();
  expect_near(flow.velocities()[0], {0, 0, -0.2}, 1e-12);
}

// Steiner points need a mesh whose pulling triangulation is not enough: strongly displaced corners.
TEST(Simulation, ALinearFieldIsReproducedInEverySimplex) {
  BoxOptions box;
  box.cells = {6, 6, 6};
  box.size = {6, 6, 6};
  box.jitter = 0.7;
  const MeshData mesh = generate_box(box);
  Environment environment(mesh);
  ASSERT_GT(environment.complex().steiner_point_count(), 0U);
  const auto field = [](const Vec3& p) { return Vec3{p.y + 0.5, 2 * p.z - p.x, 1 - p.y}; };
  Simulation flow(environment, options(1e-9));
  flow.set_field(VelocityField(environment.complex(), values(mesh, field)));
  flow.add_random(2000, {});
  const std::vector<ParticleState> before(flow.particles().states().begin(), flow.particles().states().end());
  flow.step();
  for (std::size_t i = 0; i < before.size(); ++i) expect_near(flow.velocities()[i], field(before[i].position), 1e-10);
}

double off_circle(unsigned substeps) {
  const MeshData mesh = test::cube_of(5, 10.0);
  Environment environment(mesh);
  SimulationOptions o = options(0.05);
  o.substeps = substeps;
  Simulation flow(environment, o);
  flow.set_field(VelocityField(environment.complex(), values(mesh, [](const Vec3& p) {
                                 return Vec3{5 - p.y, p.x - 5, 0};
                               })));
  flow.add(std::vector<Vec3>{{7, 5, 5}}, {});
  for (int i = 0; i < 40; ++i) flow.step();
  const Vec3 r = flow.particles()[0].position - Vec3{5, 5, 5};
  return std::abs(norm(r) - 2.0);
}

// Euler's error on a circle is of first order in a segment's length.
TEST(Simulation, SubstepsFollowACurvedFieldMoreClosely) {
  const double one = off_circle(1);
  EXPECT_NEAR(one / off_circle(4), 4.0, 0.3);
  EXPECT_NEAR(one / off_circle(16), 16.0, 1.2);
}

Deformation turning(const MeshData& mesh) {
  DeformationStep step;
  step.kind = DeformationKind::rotate;
  step.period = 1.0;
  step.centre = {5, 5, 5};
  return Deformation({step}, mesh.points);
}

TEST(Simulation, AFieldInTheMeshsFrameCarriesAlong) {
  const MeshData mesh = test::cube_of(5, 10.0);
  Environment environment(mesh);
  Simulation flow(environment, options(0.01));
  flow.set_field(VelocityField(environment.complex(),
                               values(mesh,
                                      [](const Vec3&) {
                                        return Vec3{1, 0, 0};
                                      }),
                               FieldFrame::mesh));
  flow.set_deformation(turning(mesh));
  flow.add(std::vector<Vec3>{{2, 2, 5}}, {});
  for (int i = 0; i < 25; ++i) flow.step();  // a quarter of a turn; meanwhile from (2, 2) to (2.25, 2) in the mesh
  expect_near(flow.particles()[0].position, {5 - (2 - 5), 5 + (2.25 - 5), 5}, 1e-9);
  EXPECT_EQ(flow.totals().counters.contacts[2], 0U);
}

TEST(Simulation, AFieldInSpaceDoesNotCarryAlong) {
  const MeshData mesh = test::cube_of(5, 10.0);
  Environment environment(mesh);
  Simulation flow(environment, options(0.01));
  flow.set_field(VelocityField(environment.complex(), values(mesh, [](const Vec3&) { return Vec3{1, 0, 0}; })));
  flow.set_deformation(turning(mesh));
  flow.add(std::vector<Vec3>{{4, 4, 5}}, {});
  for (int i = 0; i < 25; ++i) flow.step();
  expect_near(flow.particles()[0].position, {4.25, 4, 5}, 1e-9);
}

TEST(Simulation, StuckParticlesMoveWithTheWallWithoutNewContacts) {
  const MeshData mesh = test::cube_of(3, 10.0);
  Environment environment(mesh);
  Simulation flow(environment, test::with_response(options(0.01), Stick{}));
  flow.set_deformation(turning(mesh));
  flow.add(std::vector<Vec3>{{9.95, 5, 5}}, {20, 0, 0});
  flow.step();
  ASSERT_EQ(flow.statuses()[0], ParticleStatus::stuck);
  const Vec3 r = flow.particles()[0].position - Vec3{5, 5, 5};
  for (int i = 0; i < 50; ++i) flow.step();
  expect_near(flow.particles()[0].position - Vec3{5, 5, 5}, -r, 1e-9);
  EXPECT_EQ(flow.contact_counts()[0], 1U);
  EXPECT_NEAR(norm(flow.velocities()[0]), 2 * std::numbers::pi * norm(r), 0.01 * norm(r));
}

TEST(Simulation, ParticlesLeaveWhereTheyAreAbsorbedOrEscape) {
  Environment environment(test::cube_of(3, 10.0));
  SimulationOptions o = options(1.0);
  o.patch_responses = {{"xmax", Escape{}}, {"xmin", Absorb{}}};
  Simulation flow(environment, o);
  flow.add(std::vector<Vec3>{{9, 1, 1}, {5, 5, 5}}, {1.5, 0, 0});
  flow.add(std::vector<Vec3>{{1, 5, 5}}, {-1.5, 0, 0});
  const SimulationStep& step = flow.step();
  EXPECT_EQ(step.escaped, 1U);
  EXPECT_EQ(step.absorbed, 1U);
  EXPECT_EQ(step.contact_ids, (std::vector<std::uint64_t>{0, 2}));
  ASSERT_EQ(flow.particles().size(), 1U);
  EXPECT_EQ(flow.ids()[0], 1U);
  expect_near(flow.particles()[0].position, {6.5, 5, 5}, 1e-12);
  const SimulationTotals& t = flow.totals();
  EXPECT_EQ(t.start, 3U);
  EXPECT_EQ(t.escaped, 1U);
  EXPECT_EQ(t.absorbed, 1U);
  EXPECT_EQ(t.contacts_by_patch[environment.map().patch("xmax").value], 1U);
  EXPECT_EQ(t.contacts_by_patch[environment.map().patch("xmin").value], 1U);
  EXPECT_EQ(t.escaped_by_patch[environment.map().patch("xmax").value], 1U);
  EXPECT_EQ(t.deposited_by_patch[environment.map().patch("xmin").value], 1U);
}

// A particle counts at the wall where it ends: not where it rebounds before, and once where it sticks to a moving wall.
TEST(Simulation, ParticlesAreCountedWhereTheyEnd) {
  Environment environment(test::cube_of(3, 10.0));
  SimulationOptions o = options(0.1);
  o.patch_responses = {{"xmax", Escape{}}, {"ymin", Absorb{}}, {"zmin", Stick{}}};
  Simulation flow(environment, o);
  DeformationStep bump;
  bump.kind = DeformationKind::bump;
  bump.amplitude = 1.0;
  bump.centre = {5.0, 5.0, 0.0};
  bump.length = 4.0;
  flow.set_deformation(Deformation({bump}, environment.positions()));
  flow.add_random(300, {3.0, -2.0, -4.0});
  std::uint64_t stuck = 0;
  for (int i = 0; i < 60; ++i) flow.step();
  for (const ParticleStatus s : flow.statuses()) stuck += s == ParticleStatus::stuck ? 1 : 0;
  const SimulationTotals& t = flow.totals();
  const auto patch = [&](const char* name) { return environment.map().patch(name).value; };
  EXPECT_GT(stuck, 20U);
  EXPECT_GT(t.absorbed, 20U);
  EXPECT_EQ(t.deposited_by_patch[patch("zmin")], stuck);
  EXPECT_EQ(t.deposited_by_patch[patch("ymin")], t.absorbed);
  EXPECT_EQ(t.escaped_by_patch[patch("xmax")], t.escaped);
  const auto sum = [](const std::vector<std::uint64_t>& n) {
    return std::accumulate(n.begin(), n.end(), std::uint64_t{0});
  };
  EXPECT_EQ(sum(t.deposited_by_patch), stuck + t.absorbed);
  EXPECT_EQ(sum(t.escaped_by_patch), t.escaped);
}

TEST(Simulation, AReflectionKeepsTheUnusedWay) {
  Environment environment(test::cube_of(3, 10.0));
  Simulation flow(environment, options(1.0));
  flow.add(std::vector<Vec3>{{9, 5, 4.5}}, {3, 0, 0});
  flow.step();
  expect_near(flow.particles()[0].position, {8, 5, 4.5}, 1e-12);
  expect_near(flow.velocities()[0], {-3, 0, 0}, 1e-12);
}

TEST(Simulation, InletsInjectAtTheirRateAndPlace) {
  Environment environment(test::cube_of(4, 10.0));
  Simulation flow(environment, options(0.1));
  flow.add_inlet(environment.map().patch("zmin"), 25.0, {0, 0, 1.0});
  std::uint64_t expected_id = 0;
  for (int i = 1; i <= 20; ++i) {
    const std::uint64_t injected = flow.step().injected;
    EXPECT_TRUE(injected == 2 || injected == 3);
    EXPECT_EQ(flow.totals().injected, static_cast<std::uint64_t>(2.5 * i));
    for (; expected_id < flow.totals().injected; ++expected_id) {
      const ParticleState& s = flow.particles()[expected_id];
      EXPECT_EQ(flow.ids()[expected_id], expected_id);
      EXPECT_GT(s.position.z, 0.1);  // moved by 0.1 from just inside
      EXPECT_LT(s.position.z, 0.1 + 2.5 / 64 + 1e-12);
    }
  }
  EXPECT_EQ(flow.totals().start, 0U);
}

TEST(Simulation, RandomParticlesFillTheFreeCellsEvenly) {
  BoxOptions box;
  box.cells = {4, 4, 4};
  box.size = {4, 4, 4};
  box.blocked_share = 0.25;
  Environment environment(generate_box(box));
  Simulation flow(environment, options(1.0));
  flow.add_random(48000, {});
  std::vector<int> counts(64);
  Vec3 in_cell;
  for (const ParticleState& s : flow.particles().states()) {
    ++counts[environment.map().source(s.cell)];
    in_cell += {s.position.x - std::floor(s.position.x), s.position.y - std::floor(s.position.y),
                s.position.z - std::floor(s.position.z)};
  }
  for (const int count : counts) {
    if (count != 0) EXPECT_NEAR(count, 1000, 6 * std::sqrt(1000.0));  // 6 standard deviations
  }
  EXPECT_EQ(std::count(counts.begin(), counts.end(), 0), 16);
  const double sigma = 48000 / std::sqrt(12.0 * 48000);
  expect_near(in_cell, {24000, 24000, 24000}, 6 * sigma);
}

// A scene with everything in it.
std::string run_vessel(unsigned threads, std::uint64_t seed, Audit* result = nullptr) {
  VesselOptions small;
  small.core = 2;
  small.rings = 2;
  small.tissue_layers = 1;
  small.step_length = 1.5e-3;
  const MeshData mesh = generate_vessel(small);
  Environment environment(mesh, Threads{threads});
  SimulationOptions o = options(1e-3);
  o.seed = seed;
  o.gravity = {0, -9.81, 0};
  o.drag = 500;
  o.response = Reflect{0.5, 0.1};
  o.patch_responses = {{"outlet_left", Escape{}}, {"outlet_right", Absorb{}}};
  Simulation flow(environment, o);
  DeformationStep bend;
  bend.kind = DeformationKind::bend;
  bend.amplitude = 0.8;
  bend.period = 0.05;
  bend.length = 0.06;
  flow.set_deformation(Deformation({bend}, mesh.points));
  const auto& velocity =
      *std::find_if(mesh.point_data.begin(), mesh.point_data.end(), [](auto& a) { return a.name == "velocity"; });
  std::vector<Vec3> field;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    field.push_back({velocity.values[3 * i], velocity.values[3 * i + 1], velocity.values[3 * i + 2]});
  }
  flow.set_field(VelocityField(environment.complex(), field, FieldFrame::mesh));
  flow.add_random(1500, {});
  flow.add_inlet(environment.map().patch("inlet"), 2000.0, {0, 0, 0.1});
  for (int i = 0; i < 40; ++i) {
    flow.step();
    if (result != nullptr) *result += audit(environment.complex(), flow.particles(), Threads{2});
  }
  const SimulationTotals& t = flow.totals();
  EXPECT_EQ(t.start, 1500U);
  EXPECT_EQ(t.injected, 80U);
  EXPECT_GT(t.escaped + t.absorbed, 0U);
  EXPECT_GT(t.counters.contacts[2], 0U);
  EXPECT_EQ(t.start + t.injected - t.escaped - t.absorbed, flow.particles().size());
  return flow.state_hash().hex();
}

TEST(Simulation, OneHashForAnyNumberOfThreadsAndAnotherForAnotherSeed) {
  Audit result;
  const std::string expected = run_vessel(1, 1, &result);
  EXPECT_EQ(result.failed, 0U) << result.first;
  EXPECT_GT(result.checked, 50000U);
  EXPECT_EQ(run_vessel(2, 1), expected);
  EXPECT_EQ(run_vessel(7, 1), expected);
  EXPECT_NE(run_vessel(2, 2), expected);
}

TEST(Simulation, ThoseWhoLeftStayInTheHash) {
  Environment environment(test::cube_of(1, 10.0));
  const auto hash = [&](double y) {
    Simulation flow(environment, test::with_response(options(1.0), Escape{}));
    flow.add(std::vector<Vec3>{{9, y, 5}}, {3, 0, 0});
    flow.step();
    EXPECT_EQ(flow.particles().size(), 0U);
    return flow.state_hash().hex();
  };
  EXPECT_EQ(hash(5.0), hash(5.0));
  EXPECT_NE(hash(5.0), hash(5.5));
}

TEST(Simulation, RefusesWhatHasNoMeaning) {
  Environment environment(test::cube_of(1, 10.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Simulation(environment, options(0.0)), InvalidArgument);
  EXPECT_THROW(Simulation(environment, options(nan)), InvalidArgument);
  SimulationOptions o = options(1.0);
  o.drag = -1;
  EXPECT_THROW(Simulation(environment, o), InvalidArgument);
  o = options(1.0);
  o.substeps = 0;
  EXPECT_THROW(Simulation(environment, o), InvalidArgument);
  o = options(1.0);
  o.gravity.y = nan;
  EXPECT_THROW(Simulation(environment, o), InvalidArgument);
  Simulation flow(environment, options(1.0));
  EXPECT_THROW(flow.add(std::vector<Vec3>{{1, 1, nan}}, {}), InvalidArgument);
  EXPECT_THROW(flow.add(std::vector<Vec3>{{1, 1, 1}}, {nan, 0, 0}), InvalidArgument);
  EXPECT_THROW(flow.add_random(1, {nan, 0, 0}), InvalidArgument);
  EXPECT_EQ(flow.particles().size(), 0U);
  EXPECT_THROW(flow.add_inlet(environment.map().patch("xmin"), nan, {}), InvalidArgument);
  EXPECT_THROW(flow.add_inlet(environment.map().patch("xmin"), -1, {}), InvalidArgument);
  EXPECT_THROW(flow.add_inlet(Patch{0}, 1, {}), InvalidArgument);  // every wall of the box has a name
  EXPECT_THROW(VelocityField(environment.complex(), std::vector<Vec3>(3)), InvalidArgument);
  EXPECT_THROW(VelocityField(environment.complex(), std::vector<Vec3>(8, {nan, 0, 0})), InvalidArgument);
  EXPECT_THROW(flow.set_deformation(Deformation({}, std::vector<Vec3>(3))), InvalidArgument);
}

// Sums of many terms: the same bits for any number of threads.
TEST(Simulation, EnergyDoesNotDependOnThreads) {
  Environment environment(test::cube_of(4, 10.0));
  SimulationOptions o = options(0.1);
  o.gravity = {0.3, -0.7, -9.81};
  Simulation flow(environment, o);
  flow.add_random(20000, {1.0, 2.0, -0.3});
  flow.step();
  environment.set_threads(Threads{1});
  const SimulationEnergy one = flow.energy();
  EXPECT_GT(one.kinetic, 0.0);
  for (const unsigned threads : {2U, 3U, 7U}) {
    environment.set_threads(Threads{threads});
    EXPECT_EQ(flow.energy().kinetic, one.kinetic);
    EXPECT_EQ(flow.energy().potential, one.potential);
  }
}

TEST(Simulation, ParticlesAreAddedWithVelocitiesAndRadiiOfTheirOwn) {
  Environment environment(test::cube_of(4, 10.0));
  Simulation flow(environment, options(1.0));
  const std::vector<Vec3> points = {{1, 1, 1}, {19, 9, 9}, {2, 2, 2}};
  const std::vector<Vec3> velocities = {{0.5, 0, 0}, {7, 7, 7}, {0, 0.25, 0}};
  const std::vector<double> radii = {0.1, 0.2, 0.0};
  const auto added = flow.add(points, velocities, radii);
  ASSERT_EQ(flow.particles().size(), 2U);
  EXPECT_EQ(added[1].location.place, Place::outside);
  EXPECT_EQ(flow.velocities()[1], velocities[2]);
  EXPECT_EQ(flow.radii()[0], 0.1);
  EXPECT_EQ(flow.radii()[1], 0.0);
  EXPECT_EQ(flow.totals().start, 2U);
  EXPECT_THROW(flow.add(points, std::span<const Vec3>(velocities).first(2), radii), InvalidArgument);
  EXPECT_THROW(flow.add(points, velocities, std::vector<double>{0.1, -1.0, 0.0}), InvalidArgument);
  EXPECT_EQ(flow.particles().size(), 2U);
  flow.step();
  EXPECT_EQ(flow.particles()[0].position, (Vec3{1.5, 1, 1}));
  EXPECT_EQ(flow.particles()[1].position, (Vec3{2, 2.25, 2}));
}

TEST(Simulation, RefusesWhatLeavesThePlane) {
  RectangleOptions o;
  o.cells = {2, 2};
  o.size = {2.0, 2.0};
  const MeshData mesh = generate_rectangle(o);
  Environment environment(mesh);
  SimulationOptions up = options(1.0);
  up.gravity = {0, 0, -9.81};
  EXPECT_THROW(Simulation(environment, up), InvalidArgument);
  Simulation flow(environment, options(1.0));
  EXPECT_THROW(flow.add(std::vector<Vec3>{{1, 1, 0}}, {0, 0, 1}), InvalidArgument);
  EXPECT_THROW(flow.add_random(1, {0, 0, 1}), InvalidArgument);
  EXPECT_THROW(flow.add_inlet(environment.map().patch("xmin"), 1.0, {0, 0, 1}), InvalidArgument);
  std::vector<Vec3> field(mesh.points.size());
  field[2].z = 1.0;
  EXPECT_THROW(VelocityField(environment.complex(), field), InvalidArgument);
  EXPECT_THROW(flow.pull(field, 1.0), InvalidArgument);
  DeformationStep step;
  step.kind = DeformationKind::twist;
  step.amplitude = 1.0;
  step.axis = {1, 0, 0};
  EXPECT_THROW(flow.set_deformation(Deformation({step}, mesh.points)), InvalidArgument);
  Deformation pulled({}, mesh.points);
  pulled.add_pull(field, 0.0, 1.0);
  EXPECT_THROW(flow.set_deformation(pulled), InvalidArgument);
  EXPECT_EQ(flow.particles().size(), 0U);
  EXPECT_FALSE(flow.deforms());
  flow.add(std::vector<Vec3>{{1, 1, 0}}, {0.5, 0.25, 0});
  flow.step();
  EXPECT_EQ(flow.particles()[0].position, (Vec3{1.5, 1.25, 0}));
}

// In the segments that follow, the flow must not carry it into the wall again.
TEST(Simulation, AnAbsorbedParticleMeetsNoFurtherWallInItsStep) {
  BoxOptions box;
  box.cells = {2, 2, 2};
  box.size = {1.0, 1.0, 1.0};
  const MeshData mesh = generate_box(box);
  for (const bool flows : {false, true}) {
    Environment environment(mesh);
    SimulationOptions o = options(1.0);
    o.substeps = 4;
    o.response = Absorb{};
    Simulation simulation(environment, o);
    if (flows)
      simulation.set_field(VelocityField(environment.complex(), std::vector<Vec3>(mesh.points.size(), Vec3{4, 0, 0})));
    simulation.add(std::vector<Vec3>(8, Vec3{0.75, 0.25, 0.25}), {4, 0, 0});
    EXPECT_EQ(simulation.step().report.contacts.contacts.size(), 8U);
    EXPECT_EQ(simulation.totals().absorbed, 8U);
  }
}

TEST(Simulation, ItsContactsCanBeIterated) {
  Environment environment(generate_bar());
  Simulation simulation(environment, {.dt = 0.1, .response = Reflect{0.5}});
  simulation.add({{2.5, 2.5, 14.0}}, {30.0, 0.0, 1.0});
  std::vector<Vec3> points;
  for (const Contact& c : simulation.step().contacts()) {
    EXPECT_GT(c.time_of_impact, 0.0);
    points.push_back(c.point);
  }
  ASSERT_EQ(points.size(), 1U);  // 1.5 of its 3 metres lead to the wall, and half of the rest back
  EXPECT_EQ(points[0].x, 4.0);
  EXPECT_NEAR(simulation.particles()[0].position.x, 4.0 - 0.75, 1e-9);
}

}  // namespace dartcast::simulation_test
