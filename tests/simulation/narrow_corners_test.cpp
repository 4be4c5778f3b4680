// Particles under gravity in wedges and vertices that do not move, from 0.1 to 90 degrees: the sum of kinetic and
// potential energy stays below what it was, and what comes to rest stays at rest.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dartcast/simulation.hpp"
#include "support/tier.hpp"
#include "support/with_response.hpp"

namespace dartcast::test::narrow_corners_test {

// Seen along y: an edge below, two sides, a lid.
MeshData wedge(double degrees) {
  const double half = degrees * std::numbers::pi / 360.0;
  const double x = std::sin(half);
  const double z = std::cos(half);
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {x, 0, z}, {-x, 0, z}, {0, 1, 0}, {x, 1, z}, {-x, 1, z}};
  mesh.add_cell(CellType::prism, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  return mesh;
}

// A vertex below, whose three edges are so far off the vertical: by half of `degrees`.
MeshData cone(double degrees) {
  const double half = degrees * std::numbers::pi / 360.0;
  const double r = std::tan(half);
  MeshData mesh;
  mesh.points = {{0.1, 0.2, 0.3}};
  for (const double turn : {0.3, 2.5, 4.4})
    mesh.points.push_back(mesh.points[0] + Vec3{r * std::cos(turn), r * std::sin(turn), 1.0});
  mesh.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
  return mesh;
}

// Two sides of it are 1.6 degrees apart.
MeshData sliver() {
  MeshData mesh;
  mesh.points = {{0.376, 0.216, 0.251}, {0.420, 0.213, 0.246}, {0.662, 0.120, 0.243}, {0.803, 0.173, 0.243}};
  mesh.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 3, 2});
  return mesh;
}

// A sharp tetrahedron on its vertex.
MeshData top() {
  MeshData mesh;
  mesh.points = {{0, 0, -1}, {-0.2, -0.1, 0}, {0.2, -0.1, 0}, {0, 0.25, 0}};
  mesh.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
  return mesh;
}

struct Case {
  const char* name;
  MeshData mesh;
  SimulationOptions options;
  WallResponse response;
  Vec3 velocity;
};

// The energy of the leapfrog scheme: the rule of the simulation conserves it in free fall (docs/method.md, "Energy").
double energy(const Simulation& simulation, std::size_t i, const SimulationOptions& o, double shift) {
  const Vec3 v = simulation.velocities()[i] + o.gravity * (shift * o.dt);
  return 0.5 * dot(v, v) - dot(o.gravity, simulation.particles()[i].position);
}

void expect_bounded(Case c, std::size_t count, std::uint64_t steps) {
  Environment environment(c.mesh, Threads{1});
  Simulation simulation(environment, test::with_response(c.options, c.response));
  simulation.add_random(count, c.velocity);
  const double step_energy = dot(c.options.gravity, c.options.gravity) * c.options.dt * c.options.dt;
  std::vector<double> start;
  std::vector<double> leapfrog;
  std::vector<Vec3> first(simulation.velocities().begin(), simulation.velocities().end());
  for (std::size_t i = 0; i < count; ++i) {
    start.push_back(energy(simulation, i, c.options, 0.0));
    leapfrog.push_back(energy(simulation, i, c.options, 0.5));
  }
  for (std::uint64_t step = 0; step < steps; ++step) {
    simulation.step();
    for (std::size_t i = 0; i < count; ++i) {
      // Times of impact are right to 2^-40 of the step.
      const double rounding = 1e-12 * static_cast<double>(step + 1) * (1.0 + std::abs(leapfrog[i]));
      ASSERT_LE(energy(simulation, i, c.options, 0.5), leapfrog[i] + 0.125 * step_energy + rounding)
          << c.name << ", restitution " << c.response.restitution << ", particle " << i << ", step " << step;
      const double bound = 0.5 * c.options.dt * dot(c.options.gravity, first[i] - simulation.velocities()[i]);
      ASSERT_LE(energy(simulation, i, c.options, 0.0), start[i] + bound + 0.125 * step_energy + rounding)
          << c.name << ", restitution " << c.response.restitution << ", particle " << i << ", step " << step;
    }
  }
  EXPECT_EQ(simulation.particles().size(), count);
}

SimulationOptions falling(const Vec3& gravity, double dt = 0.01, unsigned max_contacts = 16) {
  SimulationOptions o;
  o.dt = dt;
  o.gravity = gravity;
  o.step.max_contacts = max_contacts;
  return o;
}

std::uint64_t steps() { return scaled<std::uint64_t>(1000, 100000); }
std::size_t few() { return full_tier() ? 3 : 10; }
std::size_t at_rest() { return sanitized() ? 4 : 20; }

TEST(NarrowCorners, EnergyStaysBoundedInWedges) {
  for (const double degrees : {0.1, 1.6, 7.0, 30.0, 90.0}) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
      for (const Vec3& gravity : {Vec3{0, 0, -3}, Vec3{0.3, 1.0, -3}}) {
        expect_bounded(
            {"wedge", wedge(degrees), falling(gravity), {WallResponseKind::reflect, restitution, 0.0}, {0.3, 0.2, 0}},
            4, steps());
        if (HasFatalFailure()) FAIL() << degrees << " degrees";
      }
    }
  }
}

TEST(NarrowCorners, EnergyStaysBoundedInVertices) {
  for (const double degrees : {0.1, 1.6, 7.0, 30.0, 90.0}) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
      expect_bounded(
          {"vertex", cone(degrees), falling({0, 0, -3}), {WallResponseKind::reflect, restitution, 0.0}, {0.3, 0.2, 0}},
          4, steps());
      if (HasFatalFailure()) FAIL() << degrees << " degrees";
    }
  }
}

TEST(NarrowCorners, EnergyStaysBoundedWithFrictionDragAndFewContacts) {
  const Vec3 aslant = {1.0, -0.65, -3.25};
  const Vec3 velocity = {0.8, 0.5, 0.3};
  for (const double restitution : {0.0, 0.5, 1.0}) {
    const WallResponse smooth = {WallResponseKind::reflect, restitution, 0.0};
    for (const unsigned max_particles : {1U, 2U, 3U}) {
      expect_bounded({"few contacts", sliver(), falling(aslant, 0.01, max_particles), smooth, velocity}, few(),
                     steps());
      expect_bounded({"few contacts", top(), falling(aslant, 0.01, max_particles), smooth, velocity}, few(), steps());
    }
    expect_bounded({"friction", sliver(), falling(aslant), {WallResponseKind::reflect, restitution, 0.3}, velocity},
                   few(), steps());
    SimulationOptions drag = falling(aslant);
    drag.drag = 0.5;
    expect_bounded({"drag", sliver(), drag, smooth, velocity}, few(), steps());
    if (HasFatalFailure()) return;
  }
}

// The particles that once gained energy: between two sides at 1.6 degrees, and in a sharp vertex.
TEST(NarrowCorners, EnergyStaysBoundedInASliver) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    const WallResponse smooth = {WallResponseKind::reflect, restitution, 0.0};
    expect_bounded({"sliver", sliver(), falling({1.0, -0.65, -3.25}), smooth, {0.8, 0.5, 0.3}}, few(), steps());
    expect_bounded({"top", top(), falling({0, 0, -3}), smooth, {0.3, 0.2, 0}}, few(), steps());
    if (HasFatalFailure()) return;
  }
}

// Next to a corner of the wedge, where hardly a double lies between its sides: once the contact put a particle half way
// across the wedge.
TEST(NarrowCorners, AContactNextToACornerMovesNobody) {
  Environment environment(wedge(0.1), Threads{1});
  const SimulationOptions o = falling({0.3, 1.0, -3});
  Simulation simulation(environment, test::with_response(o, Reflect{1.0, 0.0}));
  simulation.add(std::vector<Vec3>{{1.9762194268653117e-06, 1, 0.019869600474872146}},
                 {-0.0033525515524524914, 0, -2.052864144302796});
  const double before = energy(simulation, 0, o, 0.5);
  simulation.step();
  EXPECT_GE(simulation.contact_counts()[0], 3U);
  EXPECT_NEAR(simulation.particles()[0].position.y, 1.0, 1e-12);
  EXPECT_NEAR(energy(simulation, 0, o, 0.5), before, 1e-9);
}

// An elastic rebound keeps its energy over many steps: no drift either way.
TEST(NarrowCorners, AnElasticParticleKeepsItsEnergy) {
  Environment environment(wedge(90.0), Threads{1});
  const SimulationOptions o = falling({0, 0, -3});
  Simulation simulation(environment, test::with_response(o, Reflect{1.0, 0.0}));
  simulation.add(std::vector<Vec3>{{0.01, 0.5, 0.6}}, {0, 0, 0});
  const double start = energy(simulation, 0, o, 0.5);
  const double rest = 0.0;  // at the edge
  const std::uint64_t count = std::max<std::uint64_t>(steps(), 1000);
  for (std::uint64_t step = 0; step < count; ++step) simulation.step();
  EXPECT_NEAR(energy(simulation, 0, o, 0.5), start, 0.02 * (start - rest));
  EXPECT_GT(simulation.contact_counts()[0], count / 100);
}

TEST(NarrowCorners, WhatHasComeToRestInAVertexStaysThereAtOneContactAStep) {
  for (const double restitution : {0.0, 0.5, 0.9}) {
    Environment environment(top(), Threads{1});
    Simulation simulation(environment, test::with_response(falling({0, 0, -3}), Reflect{restitution, 0.0}));
    simulation.add_random(at_rest(), {0.3, 0.2, 0});
    for (int step = 0; step < 3000; ++step) simulation.step();
    for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
      EXPECT_EQ(simulation.particles()[i].position, (Vec3{0, 0, -1})) << i;
      EXPECT_EQ(simulation.velocities()[i], Vec3{}) << i;
    }
    const SimulationStep& step = simulation.step();
    EXPECT_EQ(step.report.contacts.contacts.size(), at_rest());
    EXPECT_TRUE(step.report.stopped.empty());
  }
}

// On the level edge of a wedge, too, at one or two contacts a step.
TEST(NarrowCorners, WhatHasComeToRestOnAnEdgeStaysThere) {
  for (const double degrees : {1.6, 30.0, 90.0}) {
    Environment environment(wedge(degrees), Threads{1});
    Simulation simulation(environment, test::with_response(falling({0, 0, -3}), Reflect{0.5, 0.3}));
    simulation.add_random(at_rest(), {0.01, 0.2, 0});
    for (int step = 0; step < 3000; ++step) simulation.step();
    const std::vector<Vec3> velocities(simulation.velocities().begin(), simulation.velocities().end());
    std::vector<Vec3> positions;
    for (std::size_t i = 0; i < velocities.size(); ++i) positions.push_back(simulation.particles()[i].position);
    std::size_t contacts = 0;
    for (int step = 0; step < 100; ++step) contacts += simulation.step().report.contacts.contacts.size();
    EXPECT_LE(contacts, 100U * at_rest() * 3U) << degrees;
    for (std::size_t i = 0; i < velocities.size(); ++i) {
      EXPECT_LE(norm(simulation.velocities()[i]), 1e-9) << degrees << ' ' << i;
      EXPECT_LE(norm(simulation.particles()[i].position - positions[i]), 1e-9) << degrees << ' ' << i;
      EXPECT_LE(simulation.particles()[i].position.z, 1e-6) << degrees << ' ' << i;
    }
  }
}

}  // namespace dartcast::test::narrow_corners_test
