// Bodies against each other.
#include "dartcast/bodies/body_collisions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bodies/point_block.hpp"
#include "dartcast/base/error.hpp"
#include "dartcast/bodies/bodies.hpp"
#include "dartcast/environment/audit.hpp"
#include "dartcast/mesh/generate_box.hpp"
#include "tier.hpp"

namespace dartcast {
namespace {

using test::scaled;

constexpr double dt = 1e-3;
constexpr double spacing = 0.05;

Environment room(unsigned threads = 1) {
  BoxOptions box;
  box.cells = {6, 6, 6};
  return Environment(generate_box(box), Threads{threads});
}

BodiesOptions colliding(const Vec3& gravity, double friction) {
  BodiesOptions o;
  o.dt = dt;
  o.gravity = gravity;
  o.collisions.emplace();
  o.collisions->friction = friction;
  return o;
}

std::vector<Vec3> block(int n, const Vec3& centre, const Quaternion& turn = {}) {
  return test::block(n, spacing, centre, turn);
}

BodyOptions ball_set(const Vec3& velocity) {
  BodyOptions o;
  o.radius = 0.6 * spacing;  // particles of one body overlap: that is nothing to them
  o.velocity = velocity;
  return o;
}

struct Sums {
  Vec3 momentum;
  Vec3 angular_momentum;
  double energy = 0.0;
};
Sums sums(const Bodies& bodies) {
  Sums s;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidMotion m = bodies.rigid_motion_of(b);
    s.momentum += m.velocity * m.mass;
    s.angular_momentum += m.angular_momentum + cross(m.centre, m.velocity * m.mass);
    s.energy += bodies.energy(b).total();
  }
  return s;
}

// In free space: momentum is what it was, energy never grows, and nobody passes through.
TEST(BodyCollisions, BodiesThatMeetBounceOffEachOther) {
  struct Case {
    double stiffness;  // times dt^2
    double pull;
    double lost;  // share of momentum that may go: where the law of energy cuts velocities of stiff bodies
  };
  for (const auto& [stiffness, pull, lost] : {Case{0.05, 0.0, 1e-9}, Case{0.05, 0.1, 1e-9}, Case{1.0, 0.1, 0.02}}) {
    Environment environment = room();
    Bodies bodies(environment, colliding({}, 0.0));
    BodyOptions o = ball_set({2.0, 0.0, 0.0});
    o.pull = pull;
    o.stiffness = stiffness / (dt * dt);
    bodies.add(block(3, {0.35, 0.5, 0.5}), o);
    o.velocity.x = -2.0;
    bodies.add(block(3, {0.65, 0.51, 0.49}, {1, {0.1, 0.2, 0.3}}), o);
    ASSERT_EQ(bodies.size(), 2U);
    const Sums before = sums(bodies);
    double energy = before.energy;
    std::uint64_t touching = 0;
    double deepest = 0.0;
    for (int i = 0; i < 120; ++i) {
      const BodiesStep& step = bodies.step();
      touching += step.collisions.pairs_touching;
      deepest = std::max(deepest, step.collisions.deepest);
      const Sums now = sums(bodies);
      ASSERT_LE(now.energy, energy * (1.0 + 2.0 * energy_slack)) << i;
      energy = now.energy;
    }
    const Sums after = sums(bodies);
    EXPECT_GT(touching, 0U);
    EXPECT_LE(deepest, 0.3 * spacing);
    EXPECT_LE(norm(after.momentum - before.momentum), 2.0 * lost);
    // Forces act along the normals of the touch, not along the line of the centres as they are.
    EXPECT_LE(norm(after.angular_momentum - before.angular_momentum), std::max(2.0 * lost, 1e-3));
    EXPECT_LT(bodies.rigid_motion_of(0).velocity.x, -0.5);
    EXPECT_GT(bodies.rigid_motion_of(1).velocity.x, 0.5);
    EXPECT_LT(bodies.rigid_motion_of(0).centre.x + 2.0 * spacing, bodies.rigid_motion_of(1).centre.x);
    EXPECT_EQ(bodies.counters().contacts[2], 0U);
  }
}

// One on top of the other: both come to rest.
TEST(BodyCollisions, BodiesRestOnEachOther) {
  if (test::sanitized()) GTEST_SKIP() << "takes its full number of steps";
  Environment environment = room();
  Response floor;
  floor.restitution = 0.2;
  floor.friction = 0.6;
  Bodies bodies(environment, colliding({0.0, 0.0, -9.81}, 0.6), Responses(floor));
  BodyOptions o = ball_set({});
  o.damping = 20.0;
  o.pull = 0.3;
  bodies.add(block(4, {0.5, 0.5, 0.1}), o);
  bodies.add(block(3, {0.51, 0.49, 0.3}), o);
  double peak = 0.0;
  double end = 0.0;
  double total = sums(bodies).energy;
  for (int i = 0; i < 2000; ++i) {
    bodies.step();
    const double kinetic = bodies.energy(0).kinetic + bodies.energy(1).kinetic;
    peak = std::max(peak, kinetic);
    if (i >= 1500) end = std::max(end, kinetic);
    const double now = sums(bodies).energy;
    ASSERT_LE(now, total * (1.0 + 2.0 * energy_slack)) << i;
    total = now;
  }
  EXPECT_LE(end, 1e-6 * peak);
  // The lower one on the floor, the upper one on it: lattice spheres of radius 0.6 spacings.
  EXPECT_NEAR(bodies.rigid_motion_of(0).centre.z, 1.5 * spacing, 0.2 * spacing);
  const double gap = bodies.rigid_motion_of(1).centre.z - bodies.rigid_motion_of(0).centre.z;
  EXPECT_GT(gap, 2.5 * spacing);
  EXPECT_LT(gap, 4.0 * spacing);
  EXPECT_EQ(audit(environment.complex(), bodies.particles()).failed, 0U);
}

TEST(BodyCollisions, WithoutRadiiOrThroughAWallNobodyMeets) {
  BoxOptions box;
  box.cells = {7, 3, 3};
  box.size = {0.7, 0.3, 0.3};
  MeshData mesh = generate_box(box);
  mesh.free.assign(mesh.cell_count(), 1);
  for (std::size_t c = 3; c < mesh.cell_count(); c += 7) mesh.free[c] = 0;  // a wall across
  Environment environment(std::move(mesh), Threads{1});
  Bodies bodies(environment, colliding({}, 0.0));
  BodyOptions o = ball_set({});
  o.radius = 0.2;  // through the wall
  bodies.add(std::vector<Vec3>{{0.25, 0.15, 0.15}}, o);
  bodies.add(std::vector<Vec3>{{0.45, 0.15, 0.15}}, o);
  o.radius = 0.0;
  bodies.add(std::vector<Vec3>{{0.26, 0.15, 0.15}}, o);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(bodies.step().collisions.pairs_near, 0U);
  EXPECT_EQ(bodies.velocities()[0], Vec3{});
}

TEST(BodyCollisions, AreTheSameBitsForAnyNumberOfThreadsAndFromACheckpoint) {
  const int half = scaled(100, 500);
  const auto prepared = [](Environment& environment) {
    Bodies bodies(environment, colliding({0.0, 0.0, -9.81}, 0.3));
    for (int k = 0; k < 6; ++k) {
      const Vec3 centre = {0.3 + 0.4 * (k & 1), 0.5 + 0.01 * k, 0.12 + 0.2 * (k >> 1)};
      bodies.add(block(3, centre, {1, {0.1 * k, 0.2, 0.0}}), ball_set({0.5 - (k & 1), 0.0, 0.0}));
    }
    return bodies;
  };
  std::string expected;
  for (const unsigned threads : {1U, 2U, 5U}) {
    Environment environment = room(threads);
    Bodies bodies = prepared(environment);
    ASSERT_EQ(bodies.size(), 6U);
    for (int i = 0; i < half; ++i) bodies.step();
    const Bodies::Checkpoint saved = bodies.checkpoint();
    for (int i = 0; i < half; ++i) bodies.step();
    if (expected.empty()) expected = bodies.state_hash().hex();
    EXPECT_EQ(bodies.state_hash().hex(), expected);
    Environment other = room(threads);
    Bodies resumed = prepared(other);
    resumed.restore(saved);
    for (int i = 0; i < half; ++i) resumed.step();
    EXPECT_EQ(resumed.state_hash().hex(), expected);
  }
}

TEST(BodyCollisions, RefuseOptionsOutOfRange) {
  Environment environment = room();
  const auto refused = [&](auto change) {
    BodiesOptions o = colliding({}, 0.0);
    change(*o.collisions);
    EXPECT_THROW(Bodies(environment, o), InvalidArgument);
  };
  refused([](BodyCollisionOptions& o) { o.friction = -1.0; });
  refused([](BodyCollisionOptions& o) { o.friction = std::numeric_limits<double>::infinity(); });
  refused([](BodyCollisionOptions& o) { o.push = 2.0; });
  refused([](BodyCollisionOptions& o) { o.iterations = 0; });
}

}  // namespace
}  // namespace dartcast
