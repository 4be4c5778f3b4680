// Bodies against each other.
#include "bodies/body_collisions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dynamics/collider.hpp"
#include "support/meshes.hpp"
#include "support/point_block.hpp"
#include "support/tier.hpp"

namespace dartcast::body_collisions_test {

using test::scaled;

constexpr double dt = 1e-3;
constexpr double spacing = 0.05;

Environment room(unsigned threads = 1) { return Environment(test::cube_of(6, 1.0), Threads{threads}); }

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
  for (const auto& [stiffness, pull, lost] : {Case{0.05, 0.0, 1e-9}, Case{0.05, 0.1, 1e-9}, Case{1.0, 0.1, 1e-9}}) {
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

BodiesOptions rebounding(double restitution, double friction = 0.0, const Vec3& gravity = {}) {
  BodiesOptions o = colliding(gravity, friction);
  o.collisions->restitution = restitution;
  return o;
}

// Face to face, whatever they weigh: as Newton's law for two masses says.
TEST(BodyCollisions, RigidBodiesReboundAsTheFormulaSays) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    for (const double ratio : {1.0, 0.2, 30.0}) {
      Environment environment = room();
      Bodies bodies(environment, rebounding(restitution, 0.3));
      BodyOptions o = ball_set({2.0, 0.0, 0.0});
      bodies.add(block(3, {0.35, 0.5, 0.5}), o);
      o.velocity.x = -1.0;
      o.mass = ratio;
      bodies.add(block(3, {0.6, 0.5, 0.5}), o);
      const Sums before = sums(bodies);
      std::uint64_t impacts = 0;
      for (int i = 0; i < 100; ++i) impacts += bodies.step().collisions.impacts;
      EXPECT_EQ(impacts, 9U);
      const double common = (2.0 - ratio) / (1.0 + ratio);
      const double approach = 3.0;
      const double left = common - restitution * approach * ratio / (1.0 + ratio);
      const double right = common + restitution * approach / (1.0 + ratio);
      EXPECT_NEAR(bodies.rigid_motion_of(0).velocity.x, left, 1e-8);
      EXPECT_NEAR(bodies.rigid_motion_of(1).velocity.x, right, 1e-8);
      const Sums after = sums(bodies);
      EXPECT_LE(norm(after.momentum - before.momentum), 1e-9);
      EXPECT_LE(norm(after.angular_momentum - before.angular_momentum), 1e-9);
      EXPECT_LE(norm(bodies.rigid_motion_of(0).angular_velocity), 1e-6);
      const double lost = 0.5 * (1.0 - restitution * restitution) * ratio / (1.0 + ratio) * approach * approach;
      EXPECT_NEAR(after.energy, before.energy - lost, 1e-6);
    }
  }
}

// Two balls may come as near as leaves them the gap of rest, from where a motion apart would take them first.
TEST(BodyCollisions, GapsAreUsedUp) {
  Environment environment = room();
  const double r = 0.03;
  const double room_left = 0.02 * r;
  const std::vector<Vec3> places = {{0.4, 0.5, 0.5}, {0.4 + 2.0 * r + room_left, 0.5, 0.5}};
  Particles particles;
  environment.add(particles, places);
  ASSERT_EQ(particles.size(), 2U);
  const std::vector<std::uint32_t> body_of = {0, 1};
  const std::vector<std::uint64_t> ids = {0, 1};
  const std::vector<double> radii(2, r);
  const std::vector<double> inverse_masses(2, 1.0);
  for (const double parting : {0.0, 0.1}) {
    const std::vector<Vec3> velocities = {{-0.5 * parting, 0, 0}, {0.5 * parting, 0, 0}};
    std::vector<Vec3> led_to = {{9.0, 0, 0}, {-9.0, 0, 0}};
    std::vector<Vec3> pushes(2);
    BodyCollisions collisions;
    const BodyParticles balls{body_of, ids, places, radii, inverse_masses};
    collisions.find(environment.complex(), particles.states(), balls, led_to, dt, Threads{1});
    collisions.solve(balls, BodyCollisionOptions{}, dt, velocities, led_to, pushes);
    EXPECT_NEAR((led_to[0].x - led_to[1].x) * dt, (room_left - resting_gap * r) + parting * dt, 1e-15);
    EXPECT_EQ(pushes[0], Vec3{});
  }
}

// Bodies of one particle each are balls.
TEST(BodyCollisions, BodiesOfOneParticleMeet) {
  Environment environment = room();
  Bodies bodies(environment, rebounding(0.5));
  bodies.add(std::vector<Vec3>{{0.4, 0.5, 0.5}}, ball_set({1.0, 0.0, 0.0}));
  bodies.add(std::vector<Vec3>{{0.6, 0.5, 0.5}}, ball_set({-1.0, 0.0, 0.0}));
  for (int i = 0; i < 120; ++i) bodies.step();
  EXPECT_NEAR(bodies.velocities()[0].x, -0.5, 1e-9);
  EXPECT_NEAR(bodies.velocities()[1].x, 0.5, 1e-9);
}

// Turned, beside each other's centres, three at once: energy never grows, and momenta are kept. The first goes first:
// in one step of a thousand or so it takes up to 10^-4 of them.
TEST(BodyCollisions, ReboundsKeepMomentaAndAddNoEnergy) {
  Random random(9);
  const auto u = [&] { return random.uniform(-1.0, 1.0); };
  std::uint64_t impacts = 0;
  std::uint64_t steps = 0;
  std::uint64_t cut = 0;
  for (int i = 0; i < std::max(12, scaled(24, 400)); ++i) {
    Environment environment = room();
    Bodies bodies(environment, rebounding(i % 4 * (1.0 / 3.0), i % 2 * 0.5));
    const double x[] = {0.3, 0.5, 0.7};
    for (int k = 0; k < 3; ++k) {
      BodyOptions o = ball_set({3.0 * (1 - k), u(), u()});
      o.angular_velocity = {10 * u(), 10 * u(), 10 * u()};
      o.mass = random.uniform(0.2, 3.0);
      const Quaternion rotation_delta = {u(), {u(), u(), u()}};
      bodies.add(block(3, {x[k], 0.5 + 0.05 * u(), 0.5 + 0.05 * u()}, rotation_delta), o);
    }
    ASSERT_EQ(bodies.size(), 3U);
    const Sums before = sums(bodies);
    double energy = before.energy;
    for (int step = 0; step < 60 && bodies.counters().contacts[2] == 0; ++step) {
      const Sums last = sums(bodies);
      const BodiesStep& done = bodies.step();
      impacts += done.collisions.impacts;
      if (bodies.counters().contacts[2] > 0) break;
      const Sums now = sums(bodies);
      ASSERT_LE(now.energy, energy * (1.0 + 4.0 * energy_slack)) << i << ' ' << step;
      energy = now.energy;
      const double change = norm(now.momentum - last.momentum);
      ASSERT_LE(change, 1e-3) << i << ' ' << step;
      cut += change > 1e-9 ? 1 : 0;
      ++steps;
    }
  }
  EXPECT_LE(cut, 2 + steps / 500);
  EXPECT_GT(impacts, 20U);
}

// One on top of the other: both come to rest.
void expect_rest(const std::optional<double>& restitution) {
  Environment environment = room();
  WallResponse floor;
  floor.restitution = 0.2;
  floor.friction = 0.6;
  BodiesOptions options = colliding({0.0, 0.0, -9.81}, 0.6);
  options.collisions->restitution = restitution;
  Bodies bodies(environment, options, WallResponses(floor));
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

TEST(BodyCollisions, BodiesRestOnEachOther) {
  if (test::sanitized()) GTEST_SKIP() << "takes its full number of steps";
  expect_rest({});
  expect_rest(0.4);
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
  refused([](BodyCollisionOptions& o) { o.restitution = 1.5; });
  refused([](BodyCollisionOptions& o) { o.restitution = std::nan(""); });
  refused([](BodyCollisionOptions& o) { o.position_correction = 2.0; });
  refused([](BodyCollisionOptions& o) { o.iterations = 0; });
}

}  // namespace dartcast::body_collisions_test
