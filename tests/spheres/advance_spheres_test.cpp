// Spheres against walls: cases with known answers.
#include <gtest/gtest.h>

#include "dartcast/deformation.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/spheres.hpp"
#include "support/sphere_checks.hpp"

namespace dartcast::advance_spheres_test {

using test::all_walls;
using test::bouncing;
using test::clearance;
using test::cubes;
using test::scaled;
using test::slack_of;
using test::sliding;
using test::Swarm;

// A wall goes over a sphere at rest: it is carried along in front of it.
TEST(AdvanceSpheres, PushedByAWall) {
  Swarm swarm(cubes(4));
  swarm.add({2.25, 2.125, 1.0}, 0.25);
  swarm.add({2.25, 2.125, 3.5}, 0.25);
  auto next = swarm.environment.next_positions();
  for (std::size_t i = 0; i < next.size(); ++i) {
    next[i] = swarm.environment.positions()[i];
    next[i].z = 2.0 + 0.5 * next[i].z;  // the floor rises to 2
  }
  swarm.environment.move();
  const SphereReport report = swarm.step(sliding());
  ASSERT_EQ(report.step.contacts.contacts.size(), 1U);
  const Contact& c = report.step.contacts.contacts[0];
  EXPECT_EQ(c.particle, 0U);
  EXPECT_NEAR(c.time_of_impact, 0.375, sphere_time_bound);
  EXPECT_EQ(c.kind, Kind::face);
  EXPECT_NEAR(c.wall_displacement.z, 2.0, 1e-14);
  EXPECT_NEAR(norm(c.point - Vec3{2.25, 2.125, 2}), 0.0, 1e-14);
  EXPECT_NEAR(swarm.particles[0].position.z, 2.25, 1e-12);
  EXPECT_NEAR(swarm.particles[1].position.z, 3.5, 1e-12);
  EXPECT_NEAR(swarm.velocities[0].z, 2.0, 1e-12);
  EXPECT_TRUE(report.overlaps.empty());
}

// Without a response it stays where it touched the wall, and goes along with that for the rest of the step.
TEST(AdvanceSpheres, CarriedByAWall) {
  Swarm swarm(cubes(4));
  swarm.add({2.25, 2.125, 1.0}, 0.25);
  auto next = swarm.environment.next_positions();
  for (std::size_t i = 0; i < next.size(); ++i) {
    const Vec3& x = swarm.environment.positions()[i];
    next[i] = {x.x + 0.4, x.y, 2.0 + 0.5 * x.z};
  }
  swarm.environment.move();
  const SphereReport report = swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii,
                                                    std::vector<Vec3>{swarm.particles[0].position});
  ASSERT_EQ(report.step.stopped.size(), 1U);
  EXPECT_LE(norm(swarm.particles[0].position - Vec3{2.5, 2.125, 2.25}), 1e-9);
  EXPECT_LE(norm(report.step.stopped[0].unused - Vec3{-0.25, 0.0, -1.25}), 1e-8);
  EXPECT_LE(norm(report.step.contacts.contacts[0].displacement - Vec3{-0.4, 0.0, -2.0}), 1e-14);
}

// A floor that tilts as it rises: the sphere ends at the distance of its radius from where it is then.
TEST(AdvanceSpheres, CarriedByAWallThatTurns) {
  Swarm swarm(cubes(4));
  swarm.add({2.25, 2.125, 1.0}, 0.25);
  auto next = swarm.environment.next_positions();
  for (std::size_t i = 0; i < next.size(); ++i) {
    const Vec3& x = swarm.environment.positions()[i];
    next[i] = {x.x, x.y, x.z + 0.5 * x.x + 0.1 * x.y};
  }
  swarm.environment.move();
  const SphereReport report = swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii,
                                                    std::vector<Vec3>{swarm.particles[0].position});
  const Vec3& x = swarm.particles[0].position;
  EXPECT_NEAR(clearance(all_walls(swarm.environment.complex(), false), x), 0.25, slack_of(x, 0.25));
  EXPECT_TRUE(report.overlaps.empty());
}

// Several contacts of one step: times grow, and the walls met before come with each.
TEST(AdvanceSpheres, ContactsInTheirOrder) {
  Swarm swarm(cubes(4));
  swarm.add({2.25, 2.125, 1.0}, 0.25, {4.0, 0.0, -3.0});
  const WallResponses elastic(WallResponse{WallResponseKind::reflect, 1.0, 0.0});
  const SphereReport report = swarm.step(elastic);
  const auto& contacts = report.step.contacts.contacts;
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_NEAR(contacts[0].time_of_impact, 0.25, sphere_time_bound);
  EXPECT_NEAR(contacts[1].time_of_impact, 0.375, 2 * sphere_time_bound);
  EXPECT_EQ(report.step.contacts.earlier_walls_of(contacts[0]).size(), 0U);
  ASSERT_EQ(report.step.contacts.earlier_walls_of(contacts[1]).size(), 1U);
  EXPECT_LE(norm(report.step.contacts.earlier_walls_of(contacts[1])[0].normal - Vec3{0, 0, 1}), 1e-14);
  EXPECT_LE(norm(report.step.contacts.walls_of(contacts[1])[0].normal - Vec3{-1, 0, 0}), 1e-14);
  EXPECT_LE(norm(swarm.particles[0].position - Vec3{1.25, 2.125, 2.5}), 1e-8);
  EXPECT_LE(norm(swarm.velocities[0] - Vec3{-4, 0, 3}), 1e-13);
}

// No more contacts than asked for, and then the sphere is reported as stopped.
TEST(AdvanceSpheres, ContactsAreLimited) {
  for (const bool sphere : {false, true}) {
    Swarm swarm(cubes(4));
    swarm.add({2.25, 2.125, 1.0}, sphere ? 0.25 : 0.0);
    StepOptions options;
    options.max_contacts = 3;
    std::size_t asked = 0;
    const ContactCallback into = [&](const Contact& c, std::span<const WallHit>,
                                     std::span<const WallHit>) -> AfterContact {
      EXPECT_EQ(c.last, ++asked >= 3);
      return {Vec3{0, 0, -1}, false};
    };
    const SphereReport report = swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii,
                                                      std::vector<Vec3>{{2.25, 2.125, -1.0}}, into, options);
    EXPECT_EQ(asked, 3U);
    EXPECT_EQ(report.step.contacts.contacts.size(), 4U);
    ASSERT_EQ(report.step.stopped.size(), 1U);
    EXPECT_EQ(report.step.counters.unfinished, 1U);
    EXPECT_EQ(report.step.counters.contacts[2], 4U);
  }
}

TEST(AdvanceSpheres, MeetsAFaceAnEdgeAndACorner) {
  MeshData mesh = cubes(4);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[1 + 4 * (1 + 4 * 1)] = 0;  // the cube [1, 2]^3
  Swarm swarm(mesh);
  swarm.add({1.5, 1.5, 3.0}, 0.5, {0, 0, -1});     // its top
  swarm.add({2.5, 1.5, 2.5}, 0.5, {-1, 0, -1});    // the edge x = 2, z = 2
  swarm.add({2.5, 2.5, 2.5}, 0.25, {-1, -1, -1});  // the corner (2, 2, 2)
  const SphereReport report =
      swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii,
                            std::vector<Vec3>{{1.5, 1.5, 2.0}, {1.5, 1.5, 1.5}, {1.5, 1.5, 1.5}});
  const auto& contacts = report.step.contacts.contacts;
  ASSERT_EQ(contacts.size(), 3U);
  EXPECT_EQ(contacts[0].kind, Kind::face);
  EXPECT_NEAR(contacts[0].time_of_impact, 0.5, sphere_time_bound);
  EXPECT_EQ(contacts[1].kind, Kind::edge);
  EXPECT_NEAR(contacts[1].time_of_impact, 0.5 - std::sqrt(0.125), sphere_time_bound);
  EXPECT_EQ(contacts[2].kind, Kind::vertex);
  EXPECT_NEAR(contacts[2].time_of_impact, 0.5 - 0.25 / std::sqrt(3.0), sphere_time_bound);
  for (const Contact& c : contacts) {
    const double radius = swarm.radii[c.particle];
    const Vec3& x = swarm.particles[c.particle].position;
    EXPECT_NEAR(norm(x - c.point), radius, slack_of(x, radius));
    const auto walls = report.step.contacts.walls_of(c);
    ASSERT_EQ(walls.size(), 1U);
    EXPECT_LE(norm(walls[0].normal * radius + c.point - x), 1e-14);
    EXPECT_LE(norm(c.unused - c.displacement * (1.0 - c.time_of_impact)), 1e-8);
  }
  EXPECT_EQ(report.step.stopped.size(), 3U);
  EXPECT_LE(norm(contacts[2].point - Vec3{2, 2, 2}), 1e-15);
}

TEST(AdvanceSpheres, ComesToRestInACorner) {
  Swarm swarm(cubes(3));
  swarm.add({1.0, 1.25, 1.5}, 0.3, {-0.05, -0.05, -0.05});
  std::size_t most = 0;
  for (int step = 0; step < 300; ++step) {
    for (Vec3& v : swarm.velocities) v += Vec3{-0.003, -0.003, -0.003};
    const SphereReport report = swarm.step(sliding());
    most = std::max(most, report.step.contacts.contacts.size());
    EXPECT_TRUE(report.step.stopped.empty());
    EXPECT_TRUE(report.overlaps.empty());
    if (step > 150) {
      ASSERT_GE(report.step.contacts.contacts.size(), 1U);
      EXPECT_EQ(report.step.contacts.walls_of(report.step.contacts.contacts.back()).size(), 3U);
    }
  }
  EXPECT_LE(most, 3U);
  EXPECT_LE(norm(swarm.particles[0].position - Vec3{0.3, 0.3, 0.3}), 1e-13);
  EXPECT_LE(norm(swarm.velocities[0]), 1e-15);
}

TEST(AdvanceSpheres, SlidesAndRollsForTenThousandSteps) {
  MeshData mesh = cubes(6);
  mesh.free.assign(mesh.cell_count(), 1);
  for (unsigned j = 0; j < 6; ++j) mesh.free[3 + 6 * j] = 0;  // a step of height 1 on the floor
  Swarm swarm(mesh);
  swarm.add({4.5, 3.0, 1.4}, 0.4);      // on the step's edge, and down
  swarm.add({1.0, 3.0, 0.125}, 0.125);  // on the floor, to and fro
  swarm.add({5.0, 1.0, 0.75}, 0.75);
  const auto walls = all_walls(swarm.environment.complex(), false);
  const int steps = scaled(3000, 10000);
  std::size_t contacts = 0;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < swarm.radii.size(); ++i) {
      swarm.velocities[i].z -= 1e-3;
      swarm.velocities[i].x = 1e-2 * std::sin(0.01 * step + double(i));
      swarm.velocities[i].y = 7e-3 * std::cos(0.013 * step);
    }
    const SphereReport report = swarm.step(sliding());
    contacts += report.step.contacts.contacts.size();
    ASSERT_TRUE(report.overlaps.empty()) << step;
    ASSERT_TRUE(report.step.stopped.empty()) << step;
    for (std::size_t i = 0; i < swarm.radii.size(); ++i) {
      if (step % 8 != 0) break;
      const Vec3& x = swarm.particles[i].position;
      const double room = clearance(walls, x);
      ASSERT_GE(room, swarm.radii[i] - 2 * slack_of(x, swarm.radii[i])) << step << " " << i;
      ASSERT_LE(room, swarm.radii[i] + (step > 100 ? 1e-2 : 1.0)) << step << " " << i;
    }
  }
  EXPECT_GE(contacts, 2U * static_cast<std::size_t>(steps));
  EXPECT_LE(contacts, 8U * static_cast<std::size_t>(steps));
}

// In a box that is turned no wall's plane is free of rounding; into its edges and corners, too.
TEST(AdvanceSpheres, SlidesInATurnedBox) {
  MeshData mesh = cubes(5);
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  const auto turned = [&](const Vec3& x) {
    const Vec3 y = {c * x.x - s * x.y, s * x.x + c * x.y, x.z};
    return Vec3{y.x, c * y.y - s * y.z, s * y.y + c * y.z};
  };
  for (Vec3& x : mesh.points) x = turned(x) + Vec3{100.0, 20.0, 3.0};
  Swarm swarm(mesh);
  for (const double radius : {0.1, 0.45, 1.3}) swarm.add(turned({2.5, 2.5, 1.5}) + Vec3{100.0, 20.0, 3.0}, radius);
  const auto walls = all_walls(swarm.environment.complex(), false);
  std::size_t contacts = 0;
  const int steps = std::max(100, scaled(1000, 10000));
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < swarm.radii.size(); ++i)
      swarm.velocities[i] += turned({1e-3 * std::sin(0.01 * step + double(i)), 7e-4 * std::cos(0.013 * step), -1e-3});
    const SphereReport report = swarm.step(sliding());
    contacts += report.step.contacts.contacts.size();
    ASSERT_TRUE(report.overlaps.empty()) << step;
    ASSERT_TRUE(report.step.stopped.empty()) << step;
    for (std::size_t i = 0; i < swarm.radii.size(); ++i) {
      if (step % 8 != 0) break;
      const Vec3& x = swarm.particles[i].position;
      ASSERT_GE(clearance(walls, x), swarm.radii[i] - 2 * slack_of(x, swarm.radii[i])) << step << " " << i;
    }
  }
  EXPECT_GE(contacts, (test::sanitized() ? 1U : 2U) * static_cast<std::size_t>(steps));
  EXPECT_LE(contacts, 10U * static_cast<std::size_t>(steps));
}

// A slide that rounding leaves behind the wall is lifted off it, as for points.
TEST(AdvanceSpheres, SlidesAreLiftedOffTheWall) {
  Swarm swarm(cubes(4));
  swarm.add({1.25, 2.125, 0.25}, 0.25);
  const ContactCallback nearly_along = [](const Contact&, std::span<const WallHit>,
                                          std::span<const WallHit>) -> AfterContact {
    return {Vec3{1.0, 0.0, -1e-12}, true};
  };
  const SphereReport report = swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii,
                                                    std::vector<Vec3>{{2.25, 2.125, 0.0}}, nearly_along);
  EXPECT_EQ(report.step.contacts.contacts.size(), 1U);
  EXPECT_LE(norm(swarm.particles[0].position - Vec3{2.25, 2.125, 0.25}), 1e-12);
}

TEST(AdvanceSpheres, TouchingExactly) {
  Swarm swarm(cubes(4));
  swarm.add({1.0, 2.0, 0.5}, 0.5);
  const auto move = [&](const Vec3& to) {
    return swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii, std::vector<Vec3>{to});
  };
  EXPECT_TRUE(move({1.0, 2.0, 0.5}).step.contacts.contacts.empty());  // no way
  EXPECT_TRUE(move({2.0, 2.0, 0.5}).step.contacts.contacts.empty());  // along
  EXPECT_EQ(swarm.particles[0].position, (Vec3{2.0, 2.0, 0.5}));
  const SphereReport into = move({2.0, 2.0, 0.25});
  ASSERT_EQ(into.step.contacts.contacts.size(), 1U);
  EXPECT_EQ(into.step.contacts.contacts[0].time_of_impact, 0.0);
  EXPECT_EQ(into.step.contacts.contacts[0].unused, (Vec3{0, 0, -0.25}));
  EXPECT_EQ(swarm.particles[0].position, (Vec3{2.0, 2.0, 0.5}));
  EXPECT_TRUE(move({2.0, 2.0, 1.0}).step.contacts.contacts.empty());  // off
  EXPECT_TRUE(move({2.0, 2.0, 0.5}).step.contacts.contacts.size() <= 1);
}

TEST(AdvanceSpheres, OverlapsAreMovedOut) {
  Swarm swarm(cubes(4));
  swarm.add({2.0, 2.0, 0.25}, 0.5);
  swarm.add({0.25, 0.25, 0.125}, 0.5);
  swarm.add({2.0, 2.0, 2.0}, 0.5);
  const SphereReport report = swarm.step(sliding());
  ASSERT_EQ(report.overlaps.size(), 4U);
  EXPECT_EQ(report.overlaps[0].particle, 0U);
  EXPECT_DOUBLE_EQ(report.overlaps[0].depth, 0.25);
  EXPECT_EQ(report.overlaps[0].left, 0.0);
  EXPECT_EQ(report.overlaps[0].normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(report.overlaps[0].point, (Vec3{2, 2, 0}));
  EXPECT_EQ(report.overlaps[1].particle, 1U);
  EXPECT_DOUBLE_EQ(report.overlaps[1].depth, 0.375);
  EXPECT_LE(norm(swarm.particles[0].position - Vec3{2, 2, 0.5}), 1e-14);
  EXPECT_LE(norm(swarm.particles[1].position - Vec3{0.5, 0.5, 0.5}), 1e-13);
  EXPECT_EQ(swarm.particles[2].position, (Vec3{2, 2, 2}));
  EXPECT_TRUE(swarm.step(sliding()).overlaps.empty());
}

TEST(AdvanceSpheres, WithoutRoomItStaysInTheMiddle) {
  BoxOptions options;
  options.cells = {8, 8, 1};
  options.size = {8, 8, 1};
  Swarm swarm(generate_box(options));
  swarm.add({2.0, 2.0, 0.25}, 0.75, {0.25, 0, 0});
  for (int step = 0; step < 10; ++step) {
    const SphereReport report = swarm.step(sliding());
    ASSERT_EQ(report.overlaps.size(), step == 0 ? 1U : 2U);
    EXPECT_NEAR(report.overlaps[0].left, 0.25, 1e-6);
    EXPECT_NEAR(swarm.particles[0].position.z, 0.5, 1e-6);
    EXPECT_NEAR(swarm.particles[0].position.x, 2.25 + 0.25 * step, 1e-9);  // along it may go
  }
}

// Walls that close in on a sphere: it is held in the middle, reported, and free again when they open.
TEST(AdvanceSpheres, SqueezedBetweenWalls) {
  Swarm swarm(cubes(4));
  swarm.add({2.0, 2.0, 1.0}, 0.75);
  const std::vector<Vec3> rest(swarm.environment.positions().begin(), swarm.environment.positions().end());
  const auto squeeze = [&](double height) {
    auto next = swarm.environment.next_positions();
    for (std::size_t i = 0; i < next.size(); ++i)
      next[i] = {rest[i].x, rest[i].y, 2.0 + (rest[i].z - 2.0) * height / 4.0};
    swarm.environment.move();
    for (Vec3& v : swarm.velocities) v = {};
    return swarm.step(sliding());
  };
  for (double height = 4.0; height > 1.0; height -= 0.25) {
    const SphereReport report = squeeze(height);
    const double z = swarm.particles[0].position.z;
    if (height >= 1.5) EXPECT_GE(z, 2.0 - height / 2 + 0.75 - 1e-12) << height;
    if (height < 1.5) {
      EXPECT_FALSE(report.overlaps.empty()) << height;
      EXPECT_NEAR(z, 2.0, 1e-5) << height;
    }
    swarm.expect_valid();
  }
  for (double height = 1.0; height <= 4.0; height += 0.25) squeeze(height);
  const SphereReport report = squeeze(4.0);
  EXPECT_TRUE(report.overlaps.empty());
}

TEST(AdvanceSpheres, OfRadiusZeroArePoints) {
  const auto run = [](bool spheres) {
    Swarm swarm(cubes(5, CellType::hexahedron, 0.1, 0.3, 2), 3);
    swarm.fill(40, 1e-9, {0, 0, 0}, {5, 5, 5}, 0.5);
    std::fill(swarm.radii.begin(), swarm.radii.end(), 0.0);
    std::vector<Vec3> where;
    for (int step = 0; step < 20; ++step) {
      std::vector<Vec3> targets;
      for (std::size_t i = 0; i < swarm.radii.size(); ++i)
        targets.push_back(swarm.particles[i].position + swarm.velocities[i]);
      const ContactCallback respond = respond_with(bouncing(), swarm.velocities, swarm.statuses, 1.0);
      const StepReport report =
          spheres ? swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii, targets, respond).step
                  : swarm.environment.advance(swarm.particles, targets, respond);
      for (const Contact& c : report.contacts.contacts) where.push_back(c.point);
      for (const ParticleState& s : swarm.particles.states()) where.push_back(s.position);
    }
    return where;
  };
  EXPECT_EQ(run(true), run(false));
}

// So small that its centre comes to the wall: it is a point with other words, asked once.
TEST(AdvanceSpheres, SmallerThanRounding) {
  for (const bool response : {false, true}) {
    Swarm swarm(cubes(4));
    swarm.add({1.25, 2.125, 0.25}, 1e-300);
    swarm.add({1.25, 2.125, 0.25}, 0.0);
    std::array<int, 2> asked{};
    const ContactCallback rebound = [&](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit>) {
      ++asked[c.particle];
      EXPECT_NEAR(c.time_of_impact, 0.5, 1e-12);
      return AfterContact{reflected(c.unused, walls, 1.0, 0.0), true};
    };
    const SphereReport report = swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii,
                                                      std::vector<Vec3>{{2.25, 2.125, -0.25}, {2.25, 2.125, -0.25}},
                                                      response ? ContactCallback(rebound) : ContactCallback{});
    EXPECT_EQ(report.step.contacts.contacts.size(), 2U);
    EXPECT_EQ(asked[0], response ? 1 : 0);
    EXPECT_EQ(asked[1], asked[0]);
    EXPECT_LE(norm(swarm.particles[0].position - swarm.particles[1].position), 1e-14);
    EXPECT_EQ(report.step.stopped.size(), response ? 0U : 2U);
  }
}

// Points among spheres are what they are alone, to the last bit.
TEST(AdvanceSpheres, PointsAmongSpheres) {
  const auto run = [](bool spheres) {
    Swarm swarm(cubes(5, CellType::hexahedron, 0.1, 0.3, 2), 3);
    swarm.fill(40, 0.2, {0, 0, 0}, {5, 5, 5}, 0.5);
    for (std::size_t i = 0; i < swarm.radii.size(); ++i)
      if (!spheres || i % 2 == 0) swarm.radii[i] = 0.0;
    std::vector<Vec3> where;
    for (int step = 0; step < 20; ++step) {
      const SphereReport report = swarm.step(bouncing());
      for (const Contact& c : report.step.contacts.contacts) {
        if (c.particle % 2 != 0) continue;
        where.push_back(c.point);
        for (const WallHit& w : report.step.contacts.walls_of(c)) where.push_back(w.normal);
      }
      for (std::size_t i = 0; i < swarm.radii.size(); i += 2) where.push_back(swarm.particles[i].position);
    }
    return where;
  };
  EXPECT_EQ(run(true), run(false));
}

TEST(AdvanceSpheres, TheSameBitsForAnyThreads) {
  const auto run = [](unsigned threads) {
    Swarm swarm(cubes(6, CellType::tetrahedron, 0.1, 0.2, 2), 3, Threads{threads});
    swarm.fill(static_cast<std::size_t>(std::max(30, scaled(700, 2000))), 0.1, {0, 0, 0}, {6, 6, 6}, 0.7);
    std::vector<Vec3> where;
    for (int step = 0; step < 5; ++step) {
      const SphereReport report = swarm.step(bouncing());
      for (const Contact& c : report.step.contacts.contacts) where.push_back(c.point);
      for (const WallHit& w : report.step.contacts.walls) where.push_back(w.normal);
      for (const ParticleState& s : swarm.particles.states()) where.push_back(s.position);
    }
    return where;
  };
  const auto one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(5));
}

TEST(AdvanceSpheres, TheSameBitsInAnyOrder) {
  const auto run = [](bool reversed) {
    Swarm swarm(cubes(5, CellType::prism, 0.1, 0.2, 2), 3);
    swarm.fill(60, 0.15, {0, 0, 0}, {5, 5, 5}, 0.7);
    std::vector<std::uint32_t> order(swarm.radii.size());
    for (std::uint32_t i = 0; i < order.size(); ++i)
      order[i] = reversed ? static_cast<std::uint32_t>(order.size()) - 1 - i : i;
    swarm.particles.reorder(order);
    if (reversed) std::reverse(swarm.velocities.begin(), swarm.velocities.end());
    for (int step = 0; step < 10; ++step) swarm.step(bouncing());
    std::vector<Vec3> where;
    for (const ParticleState& s : swarm.particles.states()) where.push_back(s.position);
    if (reversed) std::reverse(where.begin(), where.end());
    return where;
  };
  EXPECT_EQ(run(false), run(true));
}

TEST(AdvanceSpheres, RefusesWhatIsNoRadius) {
  Swarm swarm(cubes(3));
  swarm.add({1.5, 1.5, 1.5}, 0.25);
  const std::vector<Vec3> target = {{1.0, 1.0, 1.0}};
  const auto with = [&](std::vector<double> radii) {
    return swarm.stepper.advance(swarm.environment, swarm.particles, radii, target);
  };
  EXPECT_THROW(with({-1.0}), InvalidArgument);
  EXPECT_THROW(with({std::numeric_limits<double>::quiet_NaN()}), InvalidArgument);
  EXPECT_THROW(with({std::numeric_limits<double>::infinity()}), InvalidArgument);
  EXPECT_THROW(with({0.25, 0.25}), InvalidArgument);
  EXPECT_THROW(swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii, target, {}, {},
                                     std::vector<double>{1.0, 1.0}),
               InvalidArgument);
  EXPECT_THROW(
      swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii, std::vector<Vec3>{{std::nan(""), 0, 0}}),
      InvalidArgument);
  EXPECT_EQ(swarm.particles[0].position, (Vec3{1.5, 1.5, 1.5}));
}

TEST(AdvanceSpheres, AResponseThatThrowsChangesNothing) {
  Swarm swarm(cubes(3));
  swarm.add({1.5, 1.5, 1.5}, 0.25);
  swarm.add({0.5, 1.5, 1.5}, 0.25);
  const ContactCallback bad = [](const Contact&, std::span<const WallHit>, std::span<const WallHit>) -> AfterContact {
    return {Vec3{std::nan(""), 0, 0}, false};
  };
  const std::vector<Vec3> targets = {{2, 1, 1}, {-1, 1.5, 1.5}};
  EXPECT_THROW(swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii, targets, bad), InvalidArgument);
  EXPECT_EQ(swarm.particles[0].position, (Vec3{1.5, 1.5, 1.5}));
  EXPECT_EQ(swarm.particles[1].position, (Vec3{0.5, 1.5, 1.5}));
}

}  // namespace dartcast::advance_spheres_test
