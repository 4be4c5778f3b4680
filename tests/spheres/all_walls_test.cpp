// Spheres against walls: every step against all walls of the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "dartcast/deformation.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/spheres.hpp"
#include "support/meshes.hpp"
#include "support/sphere_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::all_walls_test {

using test::all_walls;
using test::bouncing;
using test::clearance;
using test::cubes;
using test::first_of_all;
using test::scaled;
using test::slack_of;
using test::sliding;
using test::Swarm;

struct Checked {
  int contacts = 0;
  int unfinished = 0;
  double worst_overlap = 0.0;  // in slacks
};

// One step of all spheres; the first contact of each is the first of all walls, and after it none overlaps a wall.
Checked checked_step(Swarm& swarm, const WallResponses& responses, bool moved = false, bool expect_room = true) {
  const auto walls = all_walls(swarm.environment.complex(), moved);
  std::vector<Vec3> before;
  std::vector<Vec3> velocities = swarm.velocities;
  for (std::size_t i = 0; i < swarm.radii.size(); ++i) before.push_back(swarm.particles[i].position);
  const SphereReport report = swarm.step(responses);
  Checked checked;
  std::size_t c = 0;
  const auto& contacts = report.step.contacts.contacts;
  for (std::uint32_t i = 0; i < swarm.radii.size(); ++i) {
    const auto truth = first_of_all(walls, {before[i], before[i] + velocities[i], swarm.radii[i]});
    const bool overlapped = std::any_of(report.overlaps.begin(), report.overlaps.end(),
                                        [&](const SphereOverlap& o) { return o.particle == i; });
    while (c < contacts.size() && contacts[c].particle < i) ++c;
    const bool has = c < contacts.size() && contacts[c].particle == i;
    if (!overlapped) {
      EXPECT_EQ(has, truth.has_value()) << i;
      if (has && truth) EXPECT_NEAR(contacts[c].time_of_impact, *truth, sphere_time_bound) << i;
    } else if (expect_room) {
      ADD_FAILURE() << "sphere " << i << " overlaps by " << report.overlaps.front().depth;
    }
    const Vec3& x = swarm.particles[i].position;
    if (expect_room)
      checked.worst_overlap =
          std::max(checked.worst_overlap, (swarm.radii[i] - clearance(walls, x)) / slack_of(x, swarm.radii[i]));
  }
  for (const Contact& contact : contacts) {
    const auto hits = report.step.contacts.walls_of(contact);
    EXPECT_GE(hits.size(), 1U);
    for (const WallHit& hit : hits) EXPECT_NEAR(norm(hit.normal), 1.0, 1e-14);
  }
  checked.contacts = static_cast<int>(contacts.size());
  checked.unfinished = static_cast<int>(report.step.counters.unfinished);
  swarm.expect_valid();
  return checked;
}

TEST(AdvanceSpheres, InBoxesOfEveryTypeAgainstAllWalls) {
  const std::array<CellType, 4> types = {CellType::hexahedron, CellType::tetrahedron, CellType::prism,
                                         CellType::pyramid};
  int contacts = 0;
  int unfinished = 0;
  for (std::size_t k = 0; k < types.size(); ++k) {
    for (const double radius : {0.01, 0.2, 0.6, 1.4}) {
      Swarm swarm(cubes(6, types[k], radius > 1.0 ? 0.01 : 0.1, 0.3, k + 1), k + 5);
      swarm.fill(static_cast<std::size_t>(std::max(2, scaled(6, 60))), radius, {0, 0, 0}, {6, 6, 6}, 0.8);
      EXPECT_GE(swarm.radii.size(), 1U);
      for (int step = 0; step < std::max(2, scaled(6, 40)); ++step) {
        for (Vec3& v : swarm.velocities) v += swarm.vector(0.1);
        const Checked checked = checked_step(swarm, k % 2 == 0 ? bouncing() : sliding());
        EXPECT_LE(checked.worst_overlap, 1.0);
        contacts += checked.contacts;
        unfinished += checked.unfinished;
      }
    }
  }
  EXPECT_GT(contacts, scaled(100, 2000));
  EXPECT_LE(unfinished, contacts / 50);
}

TEST(AdvanceSpheres, LargerThanManyCells) {
  Swarm swarm(cubes(8, CellType::hexahedron, 0.004, 0.2, 3), 2);
  swarm.fill(4, 2.6, {0, 0, 0}, {8, 8, 8}, 1.0);
  swarm.fill(4, 1.9, {0, 0, 0}, {8, 8, 8}, 1.0);
  ASSERT_GE(swarm.radii.size(), 4U);
  int contacts = 0;
  for (int step = 0; step < std::max(2, scaled(10, 60)); ++step) {
    const Checked checked = checked_step(swarm, bouncing());
    EXPECT_LE(checked.worst_overlap, 1.0);
    contacts += checked.contacts;
    for (Vec3& v : swarm.velocities) v += swarm.vector(0.2);
  }
  EXPECT_GT(contacts, scaled(5, 50));
}

TEST(AdvanceSpheres, InAVessel) {
  VesselOptions options;
  options.core = 3;
  options.rings = 2;
  options.tissue_layers = 1;
  options.step_length = 1.4e-3;
  Swarm swarm(generate_vessel(options), 4);
  for (const double radius : {0.05e-3, 0.4e-3, 1.2e-3})
    swarm.fill(4, radius, {-2e-3, -2e-3, -25e-3}, {2e-3, 2e-3, 5e-3}, 1e-3);
  ASSERT_GE(swarm.radii.size(), 9U);
  int contacts = 0;
  for (int step = 0; step < std::max(2, scaled(12, 100)); ++step) {
    const Checked checked = checked_step(swarm, sliding());
    EXPECT_LE(checked.worst_overlap, 1.0);
    contacts += checked.contacts;
    for (Vec3& v : swarm.velocities) v += Vec3{0.2e-3, 0.0, 0.3e-3};
  }
  EXPECT_GT(contacts, scaled(10, 100));
}

// Walls that twist and bend: the first contact is that of the walls' true motion; overlaps are rounding, or what the
// walls did after a contact.
TEST(AdvanceSpheres, InADeformingBox) {
  BoxOptions options;
  options.cells = {5, 5, 10};
  options.size = {5, 5, 10};
  options.blocked_layer = true;
  options.blocked_share = 0.05;
  const MeshData mesh = generate_box(options);
  DeformationStep twist;
  twist.kind = DeformationKind::twist;
  twist.amplitude = 0.6;
  twist.period = 40.0;
  twist.centre = {2.5, 2.5, 0.0};
  twist.length = 10.0;
  DeformationStep bend = twist;
  bend.kind = DeformationKind::bend;
  bend.direction = {1.0, 0.0, 0.0};
  for (const auto& steps : {std::vector{twist}, std::vector{bend}}) {
    const Deformation deformation(steps, mesh.points);
    Swarm swarm(mesh, 6);
    for (const double radius : {0.02, 0.2, 0.7}) swarm.fill(5, radius, {1, 1, 1}, {4, 4, 9}, 0.2);
    int contacts = 0;
    double left = 0.0;
    for (int step = 1; step <= std::max(3, scaled(20, 80)); ++step) {
      deformation.positions(step, swarm.environment.next_positions());
      swarm.environment.move();
      std::vector<Vec3> before;
      for (std::size_t i = 0; i < swarm.radii.size(); ++i) before.push_back(swarm.particles[i].position);
      const auto walls = all_walls(swarm.environment.complex(), true);
      const std::vector<Vec3> velocities = swarm.velocities;
      const SphereReport report = swarm.step(bouncing());
      for (std::uint32_t i = 0; i < swarm.radii.size(); ++i) {
        const auto& all = report.step.contacts.contacts;
        const auto mine = std::find_if(all.begin(), all.end(), [&](const Contact& c) { return c.particle == i; });
        const bool overlapped = std::any_of(report.overlaps.begin(), report.overlaps.end(),
                                            [&](const SphereOverlap& o) { return o.particle == i; });
        const auto truth = first_of_all(walls, {before[i], before[i] + velocities[i], swarm.radii[i]});
        if (truth && !overlapped) {
          ASSERT_NE(mine, all.end()) << i;
          EXPECT_LE(mine->time_of_impact, *truth + sphere_time_bound);
          EXPECT_GE(mine->time_of_impact, *truth - sphere_time_bound);
        }
        const Vec3& x = swarm.particles[i].position;
        const double depth = swarm.radii[i] - clearance(walls, x);
        left = std::max(left, depth / swarm.radii[i]);
        EXPECT_LE(depth, 0.05 * swarm.radii[i]) << step << " " << i;
      }
      contacts += static_cast<int>(report.step.contacts.contacts.size());
      swarm.expect_valid();
    }
    EXPECT_GT(contacts, scaled(20, 100));
    RecordProperty("left", std::to_string(left));
  }
}

TEST(AdvanceSpheres, InThePlane) {
  RectangleOptions options;
  options.cells = {6, 6};
  options.size = {6, 6};
  options.blocked_share = 0.1;
  Swarm swarm(generate_rectangle(options), 8);
  const auto walls = all_walls(swarm.environment.complex(), false);
  for (int k = 0; k < 400 && swarm.radii.size() < 20; ++k) {
    const Vec3 x = {swarm.random.uniform(0, 6), swarm.random.uniform(0, 6), 0.0};
    const double radius = k % 2 == 0 ? 0.3 : 0.9;
    Vec3 v = swarm.vector(0.8);
    v.z = 0.0;
    if (clearance(walls, x) > radius) swarm.add(x, radius, v);
  }
  ASSERT_GE(swarm.radii.size(), 5U);
  int contacts = 0;
  for (int step = 0; step < 30; ++step) {
    const Checked checked = checked_step(swarm, bouncing());
    EXPECT_LE(checked.worst_overlap, 1.0);
    contacts += checked.contacts;
  }
  EXPECT_GT(contacts, 20);
}

// Cells are cut, blocked and freed around spheres.
TEST(AdvanceSpheres, AfterEdits) {
  Swarm swarm(cubes(6, CellType::hexahedron, 0.05, 0.0, 2), 3);
  swarm.fill(20, 0.3, {0, 0, 0}, {6, 6, 6}, 0.5);
  int contacts = 0;
  for (int step = 0; step < 12; ++step) {
    const auto cells = swarm.environment.map().cells();
    const Cell cell = cells[swarm.random.below(static_cast<std::uint32_t>(cells.size()))];
    const bool free = swarm.environment.map().is_free(cell);
    swarm.environment.edit([&](ComplexEdit& edit) { edit.topology().set_free(cell, !free); });
    swarm.environment.update_after_edit(swarm.particles);
    swarm.step(bouncing());  // moves out those that the edit left in a wall
    const Checked checked = checked_step(swarm, bouncing(), false, false);
    contacts += checked.contacts;
  }
  EXPECT_GT(contacts, 20);
}

}  // namespace dartcast::all_walls_test
