// Bodies that carry a surface: no edge and no triangle of it meets a wall, and the energy law holds. The truth is the audit
// of SolidSet, which shares no code with steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "bodies/body_surfaces.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "solids/audit_solids.hpp"
#include "support/element_checks.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/solid_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::bodies_edges_test {

using test::random_vector;

// A ball of particles, those of its surface and a few inside, and the surface.
struct Ball {
  std::vector<Vec3> points;
  BodyOptions options;

  Ball(const Vec3& at, double radius, unsigned halvings = 1) {
    options.surface = test::moved(test::ball(radius, halvings), at);
    points = test::moved(test::ball(0.99 * radius, 0), at).points;
    for (const Vec3& p : test::ball(0.5 * radius, 0).points) points.push_back(p + at);
    options.mass = 2.0;
    options.damping = 5.0;
  }
};

BodiesOptions falling(double dt = 2e-3) {
  BodiesOptions o;
  o.dt = dt;
  o.gravity = {0.0, 0.0, -9.81};
  return o;
}

// Bodies among obstacles, one or more of them, with or without their surfaces as edges.
struct Tossed {
  Environment environment;
  Bodies bodies;
  Random random;

  explicit Tossed(std::uint64_t seed, bool edges = true)
      : environment(test::cubes(5, seed % 2 == 0 ? CellType::hexahedron : CellType::tetrahedron, 0.12, 0.2, seed),
                    Threads{1 + static_cast<unsigned>(seed % 2)}),
        bodies(environment, falling(), WallResponses(Reflect{0.5, seed % 3 == 0 ? 0.5 : 0.0})),
        random(seed) {
    for (int tries = 0; bodies.size() < 3 && tries < 3000; ++tries) {
      Ball ball(random_vector(random, 2.5) + Vec3{2.5, 2.5, 2.5}, random.uniform(0.2, 0.7));
      ball.options.velocity = random_vector(random, 4.0);
      ball.options.angular_velocity = random_vector(random, 5.0);
      const SolidMesh surface = ball.options.surface;
      if (!edges) ball.options.surface = {};
      if (bodies.add(ball.points, ball.options).body != 0xffffffffU) surfaces.push_back(surface);
    }
  }
  std::vector<SolidMesh> surfaces;  // at rest

  // One step; whether the energy law holds.
  [[nodiscard]] bool step() {
    double before = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) before += bodies.energy(b).total();
    const BodiesStep& done = bodies.step();
    contacts += done.edges.size();
    double after = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) after += bodies.energy(b).total();
    return after <= (before + std::max(0.0, done.input)) * (1.0 + 2.0 * energy_slack);
  }
  double move(double size) {
    return bodies.move_with(test::waved(environment.positions(), random.uniform(-size, size)));
  }
  std::size_t contacts = 0;
};

TEST(BodiesEdges, NoPartOfASurfaceMeetsAWallAndTheEnergyLawHolds) {
  std::size_t checked = 0;
  std::size_t contacts = 0;
  for (std::uint64_t seed = 1; seed <= std::max<std::uint64_t>(2, test::scaled<std::uint64_t>(12, 200)); ++seed) {
    Tossed run(seed);
    for (int i = 0; i < 120; ++i) {
      if (seed % 3 == 1) run.move(0.02);
      ASSERT_TRUE(run.step()) << seed << " " << i;
      const SolidAudit audit = run.bodies.audit();
      ASSERT_EQ(audit.failed, 0U) << seed << " " << i << ": " << audit.first;
      checked += audit.checked;
    }
    EXPECT_EQ(audit(run.environment.complex(), run.bodies.particles()).failed, 0U);
    contacts += run.contacts;
  }
  EXPECT_GT(checked, 20000U);
  EXPECT_GT(contacts, 100U);
}

// The test above would see it.
TEST(BodiesEdges, WithoutThemSurfacesCrossWalls) {
  std::size_t count = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Tossed run(seed, false);
    std::vector<CarriedSurface> carried;
    for (std::size_t b = 0; b < run.bodies.size(); ++b) {
      const auto first = run.bodies.first_particle(b);
      carried.emplace_back(run.surfaces[b].points, run.bodies.positions().subspan(first, run.bodies.particle_count(b)));
    }
    for (int i = 0; i < 60; ++i) {
      EXPECT_TRUE(run.step());
      const WallAudit walls(run.environment.complex());
      for (std::size_t b = 0; b < carried.size() && i % 10 == 0; ++b) {
        std::vector<Vec3> points(run.surfaces[b].points.size());
        const auto first = run.bodies.first_particle(b);
        carried[b].positions(run.bodies.positions().subspan(first, run.bodies.particle_count(b)), points);
        for (const SolidElement& e : elements_of(run.surfaces[b])) count += walls.meets_wall(points, e) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(count, 20U);
}

// A floor with one pillar, thinner than the distance between a body's particles.
MeshData pillar() {
  BoxOptions box;
  box.cells = {9, 9, 6};
  box.size = {9.0, 9.0, 6.0};
  MeshData mesh = generate_box(box);
  for (Vec3& x : mesh.points) {  // the middle column of cells is a tenth as wide
    x.x = x.x <= 4.0 ? x.x * 4.45 / 4.0 : 4.55 + (x.x - 5.0) * 4.45 / 4.0;
    x.y = x.y <= 4.0 ? x.y * 4.45 / 4.0 : 4.55 + (x.y - 5.0) * 4.45 / 4.0;
  }
  return mesh;
}

TEST(BodiesEdges, APillarBetweenParticlesHoldsABody) {
  for (const bool edges : {true, false}) {
    Environment environment(pillar(), Threads{1});
    environment.edit([&](ComplexEdit& e) {
      for (const double z : {0.5, 1.5}) e.topology().set_free(environment.locate({4.5, 4.5, z}).simplex.cell, false);
    });
    Bodies bodies(environment, falling());
    Ball ball({4.52, 4.49, 3.6}, 1.4, 2);
    // No particle is near the axis: below the body's surface is all that could meet the pillar.
    std::erase_if(ball.points, [](const Vec3& p) { return std::hypot(p.x - 4.5, p.y - 4.5) < 0.3; });
    if (!edges) ball.options.surface = {};
    ASSERT_EQ(bodies.add(ball.points, ball.options).body, 0U);
    const CarriedSurface carried(test::moved(test::ball(1.4, 2), {4.52, 4.49, 3.6}).points, ball.points);
    std::vector<Vec3> followed(carried.vertex_count());
    double lowest = 10.0;
    double farthest = 0.0;  // between the surface and where its particles carry it
    for (int i = 0; i < 200; ++i) {
      bodies.step();
      carried.positions(bodies.positions(), followed);
      for (std::size_t v = 0; edges && v < followed.size(); ++v)
        farthest = std::max(farthest, norm(followed[v] - bodies.surface(0)[v]));
      lowest = std::min(lowest, bodies.rigid_motion_of(0).centre.z);
      if (edges) {
        ASSERT_EQ(bodies.audit().failed, 0U) << i;
      }
    }
    RecordProperty("farthest", std::to_string(farthest));
    EXPECT_LE(farthest, 0.05);
    if (edges) EXPECT_LE(bodies.energy(0).kinetic, 0.2);
    if (edges) EXPECT_GT(lowest, 2.0 + 1.2);  // the pillar is 2 high; the surface gives way a little
    if (!edges) EXPECT_LT(lowest, 2.9);
  }
}

TEST(BodiesEdges, GoOnFromACheckpointInCopiesAndForAnyThreads) {
  Tossed run(4);
  for (int i = 0; i < 120; ++i) EXPECT_TRUE(run.step());
  const BodiesCheckpoint saved = run.bodies.checkpoint();
  Bodies copy(run.bodies);
  std::vector<std::string> hashes;
  for (int i = 0; i < 40; ++i) {
    run.bodies.step();
    hashes.push_back(run.bodies.state_hash().hex());
  }
  for (int i = 0; i < 40; ++i) {
    copy.step();
    ASSERT_EQ(copy.state_hash().hex(), hashes[static_cast<std::size_t>(i)]) << i;
  }
  run.environment.set_threads({5});
  run.bodies.restore(saved);
  for (int i = 0; i < 40; ++i) {
    run.bodies.step();
    ASSERT_EQ(run.bodies.state_hash().hex(), hashes[static_cast<std::size_t>(i)]) << i;
  }
  BodiesCheckpoint bad = saved;
  bad.surfaces.states.pop_back();
  bad.surfaces.held_weights.pop_back();
  EXPECT_THROW(run.bodies.restore(bad), InvalidArgument);
  EXPECT_EQ(run.bodies.state_hash().hex(), hashes.back());
  EXPECT_GT(run.contacts, 0U);
}

TEST(BodiesEdges, AnEditThatPiercesASurfaceHoldsTheBody) {
  Environment environment(test::cubes(6), Threads{1});
  Bodies bodies(environment, falling());
  Ball ball({3.0, 3.0, 4.5}, 1.2);
  ball.points.erase(ball.points.begin() + 12, ball.points.end());  // none inside the cell that is blocked
  ASSERT_EQ(bodies.add(ball.points, ball.options).body, 0U);
  const Cell cell = environment.locate({3.9, 3.4, 4.4}).simplex.cell;
  for (const Vec3& p : bodies.positions()) EXPECT_NE(environment.locate(p).simplex.cell, cell);
  const auto set_free = [&](bool free) {
    environment.edit([&](ComplexEdit& e) { e.topology().set_free(cell, free); });
    bodies.update_after_edit();
  };
  set_free(false);
  const std::vector<Vec3> before(bodies.positions().begin(), bodies.positions().end());
  for (int i = 0; i < 20; ++i) EXPECT_EQ(bodies.step().stuck, std::vector<std::uint32_t>{0});
  for (std::size_t p = 0; p < before.size(); ++p) EXPECT_EQ(bodies.positions()[p], before[p]);
  set_free(true);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(bodies.step().stuck.empty());
  EXPECT_LT(bodies.rigid_motion_of(0).centre.z, 4.5);
  EXPECT_EQ(bodies.audit().failed, 0U);
}

// Particles that stick carry the surface, too, and do not move.
TEST(BodiesEdges, ABodyThatSticksToAWallStaysThere) {
  Environment environment(test::cubes(4), Threads{1});
  Bodies bodies(environment, falling(), WallResponses(Stick{}));
  Ball ball({2.0, 2.0, 1.5}, 0.8);
  for (Vec3& x : ball.options.surface.points) x.z = std::max(x.z, 0.75);  // flat below: particles meet the floor first
  ball.options.angular_velocity = {0.0, 3.0, 0.0};
  ASSERT_EQ(bodies.add(ball.points, ball.options).body, 0U);
  for (int i = 0; i < 400; ++i) {
    bodies.step();
    ASSERT_EQ(bodies.audit().failed, 0U) << i;
    ASSERT_LE(bodies.energy(0).total(), 200.0) << i;
  }
  EXPECT_GT(std::count(bodies.statuses().begin(), bodies.statuses().end(), ParticleStatus::stuck), 0);
}

// Its surface meets the wall first.
TEST(BodiesEdges, ASurfaceAtAnEscapeWallTakesItsBodyAway) {
  Environment environment(test::cubes(6), Threads{1});
  Bodies bodies(environment, falling(), WallResponses(Escape{}));
  for (const double x : {1.5, 4.5}) {
    Ball ball({x, 3.0, x < 2.0 ? 1.5 : 4.5}, 0.8);
    ASSERT_LT(bodies.add(ball.points, ball.options).body, 2U);
  }
  for (int i = 0; i < 400 && bodies.size() == 2; ++i) bodies.step();
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_EQ(bodies.id(0), 1U);
  EXPECT_GT(bodies.surface(0)[0].x, 3.0);  // that of the other body
  bodies.step();
  EXPECT_EQ(bodies.audit().failed, 0U);
}

TEST(BodiesEdges, RefusesWhatHasNoRoomAndMovesWithoutThem) {
  Environment environment(test::cubes(4), Threads{1});
  Bodies bodies(environment, falling());
  Ball ball({2.0, 2.0, 0.83}, 0.84);  // particles have room, the surface is below the floor
  const AddBodyResult refused = bodies.add(ball.points, ball.options);
  EXPECT_EQ(refused.body, 0xffffffffU);
  EXPECT_TRUE(refused.refused.empty());
  EXPECT_NE(refused.surface.refusal, SolidRefusal::none);
  EXPECT_EQ(bodies.size(), 0U);
  EXPECT_EQ(bodies.particles().size(), 0U);
  Ball flat({2.0, 2.0, 2.0}, 0.5);
  flat.points.resize(3);
  EXPECT_THROW(bodies.add(flat.points, flat.options), InvalidArgument);
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  environment.move(rest);
  EXPECT_NO_THROW(bodies.step());  // no surface yet
  Ball good({2.0, 2.0, 2.0}, 0.5);
  ASSERT_EQ(bodies.add(good.points, good.options).body, 0U);
  EXPECT_EQ(bodies.surface(0).size(), good.options.surface.points.size());
  environment.move(rest);
  const StateHash before = bodies.state_hash();
  EXPECT_THROW(bodies.step(), InvalidArgument);
  EXPECT_THROW(bodies.move_with(rest), InvalidArgument);
  EXPECT_EQ(bodies.state_hash(), before);
}

// Positions that are no numbers are no way for the cells around a surface.
TEST(BodiesEdges, WallsThatGoNowhereStayWhereTheyAre) {
  Environment environment(test::cubes(4), Threads{1});
  Bodies bodies(environment, falling());
  Ball ball({2.0, 2.0, 2.0}, 0.5);
  ASSERT_EQ(bodies.add(ball.points, ball.options).body, 0U);
  bodies.step();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    const StateHash before = bodies.state_hash();
    const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
    const std::vector<Vec3> nowhere(rest.size(), Vec3{bad, bad, bad});
    EXPECT_EQ(bodies.move_with(nowhere), 0.0);
    EXPECT_TRUE(std::equal(rest.begin(), rest.end(), environment.positions().begin()));
    EXPECT_EQ(bodies.state_hash(), before);
    EXPECT_THROW(bodies.move_with(rest), InvalidArgument);  // before a step
    bodies.step();
    EXPECT_EQ(bodies.audit().failed, 0U);
  }
}

// A row takes out the velocity towards its wall, and no energy is added.
TEST(SurfaceRows, TakeOutTheApproach) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    std::vector<double> masses;
    std::vector<Vec3> velocities;
    for (int i = 0; i < 8; ++i) {
      masses.push_back(random.uniform(0.1, 3.0));
      velocities.push_back(random_vector(random));
    }
    SurfaceRow row;
    row.normal = random_vector(random);
    row.normal = row.normal * (1.0 / norm(row.normal));
    row.friction = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 2.0);
    double rest = 1.0;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const double w = i == 3 ? rest : random.uniform(-0.5, 1.0);
      rest -= w;
      row.weights.emplace_back(2 * i, w);
      row.mobility += w * w / masses[2 * i];
    }
    const auto energy = [&] {
      double sum = 0.0;
      for (std::size_t i = 0; i < 8; ++i) sum += 0.5 * masses[i] * dot(velocities[i], velocities[i]);
      return sum;
    };
    const auto along_normal = [&] {
      double sum = 0.0;
      for (const auto& [p, w] : row.weights) sum += w * dot(row.normal, velocities[p]);
      return sum;
    };
    const double before = energy();
    const double speed = along_normal();
    stop_approach({&row, 1}, masses, velocities);
    EXPECT_LE(energy(), before * (1.0 + 1e-14));
    EXPECT_NEAR(along_normal(), std::max(0.0, speed), 1e-13);
  }
}

}  // namespace dartcast::bodies_edges_test
