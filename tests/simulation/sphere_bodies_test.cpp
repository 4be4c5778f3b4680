// Spheres that meet bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/simulation_state.hpp"
#include "support/meshes.hpp"
#include "support/point_block.hpp"
#include "support/tier.hpp"
#include "support/with_response.hpp"

namespace dartcast::sphere_bodies_test {

using test::scaled;

constexpr double dt = 1e-3;
constexpr double spacing = 0.05;

double mass_of(double radius, double density) { return density * 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3); }

// Spheres and bodies in one simulation.
struct Both {
  Environment environment;
  Simulation simulation;
  double density;

  Both(MeshData mesh, const Vec3& gravity, const CollisionOptions& collisions, const WallResponse& walls,
       Threads threads = {1})
      : environment(std::move(mesh), threads),
        simulation(environment, test::with_response(flow_options(gravity, collisions), walls)),
        density(collisions.density) {}
  static SimulationOptions flow_options(const Vec3& gravity, const CollisionOptions& collisions) {
    SimulationOptions o;
    o.dt = dt;
    o.gravity = gravity;
    o.collisions = collisions;
    o.body_collisions = std::nullopt;
    return o;
  }

  [[nodiscard]] Bodies& bodies() { return *simulation.bodies(); }
  [[nodiscard]] const Bodies& bodies() const { return *simulation.bodies(); }

  void add_body(int n, const Vec3& centre, const Vec3& velocity, double mass, double damping = 0.0) {
    BodyOptions o;
    o.mass = mass;
    o.radius = 0.6 * spacing;
    o.velocity = velocity;
    o.damping = damping;
    ASSERT_TRUE(simulation.add_body(test::block(n, spacing, centre, Quaternion{}), o).refused.empty());
  }
  void step() { simulation.step(); }

  [[nodiscard]] double mass(std::size_t sphere) const { return mass_of(simulation.radii()[sphere], density); }
  [[nodiscard]] Vec3 momentum() const {
    Vec3 sum;
    for (std::size_t i = 0; i < simulation.radii().size(); ++i) sum += simulation.velocities()[i] * mass(i);
    for (std::size_t b = 0; b < bodies().size(); ++b)
      sum += bodies().rigid_motion_of(b).velocity * bodies().rigid_motion_of(b).mass;
    return sum;
  }
  [[nodiscard]] double kinetic() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < simulation.radii().size(); ++i)
      sum += 0.5 * mass(i) * dot(simulation.velocities()[i], simulation.velocities()[i]);
    for (std::size_t b = 0; b < bodies().size(); ++b) sum += bodies().energy(b).kinetic;
    return sum;
  }
  [[nodiscard]] double deepest() const {
    double deepest = 0.0;
    for (std::size_t i = 0; i < simulation.radii().size(); ++i) {
      for (std::size_t p = 0; p < bodies().radii().size(); ++p) {
        const double gap = norm(simulation.particles()[i].position - bodies().positions()[p]) - simulation.radii()[i] -
                           bodies().radii()[p];
        deepest = std::max(deepest, -gap);
      }
    }
    return deepest;
  }
  [[nodiscard]] std::uint64_t contacts() const {
    return simulation.totals().counters.contacts[2] + bodies().counters().contacts[2];
  }
  [[nodiscard]] std::size_t failed() const { return simulation.audit().failed; }
  [[nodiscard]] std::string hash() const { return simulation.state_hash().hex(); }
};

// A ball along the line through a body's centre: as Newton's law for two masses says.
TEST(SphereBodies, ReboundAsTheFormulaSays) {
  const double r = 0.04;
  for (const double restitution : {0.0, 0.5, 1.0}) {
    for (const double ratio : {1e-4, 0.1, 1.0, 20.0}) {  // of the ball's mass to the body's
      CollisionOptions c;
      c.restitution = restitution;
      Both both(test::cube_of(6, 1.0), {}, c, WallResponse{});
      const double m = mass_of(r, c.density);
      const double body = m / ratio;
      both.add_body(3, {0.5, 0.5, 0.5}, {}, body);
      both.simulation.add(std::vector<Vec3>{{0.3, 0.5, 0.5}}, {1.5, 0.0, 0.0}, r);
      const Vec3 before = both.momentum();
      for (int i = 0; i < 60; ++i) both.step();
      ASSERT_EQ(both.contacts(), 0U);
      const double common = 1.5 * m / (m + body);
      EXPECT_NEAR(both.simulation.velocities()[0].x, common - restitution * 1.5 * body / (m + body), 1e-9);
      EXPECT_NEAR(both.bodies().rigid_motion_of(0).velocity.x, common * (1.0 + restitution), 1e-9);
      // A body's places are rounded, and so its velocity, by some 2^-50 / dt in a step.
      EXPECT_LE(norm(both.momentum() - before), 1e-11 * (m + body));
      EXPECT_LE(both.deepest(), 1e-6 * r);
    }
  }
}

// Beside the centre: the body turns, and angular momentum is kept, but for the way within a step.
TEST(SphereBodies, TurnWhatTheyHitBesideItsCentre) {
  const double r = 0.04;
  CollisionOptions c;
  c.restitution = 0.5;
  Both both(test::cube_of(6, 1.0), {}, c, WallResponse{});
  const double m = mass_of(r, c.density);
  both.add_body(3, {0.5, 0.5, 0.5}, {}, 2.0 * m);
  both.simulation.add(std::vector<Vec3>{{0.3, 0.56, 0.5}}, {1.5, 0.0, 0.0}, r);
  const auto angular = [&] {
    const RigidMotion body = both.bodies().rigid_motion_of(0);
    return body.angular_momentum + cross(body.centre, body.velocity * body.mass) +
           cross(both.simulation.particles()[0].position, both.simulation.velocities()[0] * m);
  };
  const Vec3 before = angular();
  for (int i = 0; i < 80; ++i) both.step();
  ASSERT_EQ(both.contacts(), 0U);
  EXPECT_LT(both.bodies().rigid_motion_of(0).angular_velocity.z, -1.0);
  EXPECT_LE(norm(angular() - before), 1e-3 * norm(before));
}

// Thrown into resting spheres: momentum is kept until something comes to a wall; then all of it goes on bouncing.
TEST(SphereBodies, MomentumIsKept) {
  CollisionOptions c;
  c.restitution = 0.6;
  c.friction = 0.3;
  Both both(test::cube_of(6, 1.0), {}, c, WallResponse{WallResponseKind::reflect, 0.6, 0.2});
  Random random(5);
  const double r = 0.03;
  both.add_body(4, {0.25, 0.5, 0.5}, {4.0, 0.1, -0.2}, 3.0);
  for (int i = 0; i < 60; ++i) {
    const auto off = [&] { return random.uniform(-0.003, 0.003); };
    const Vec3 x = {0.5 + 0.07 * (i % 3) + off(), 0.36 + 0.07 * (i / 3 % 5) + off(), 0.4 + 0.07 * (i / 15) + off()};
    both.simulation.add(std::span(&x, 1), {}, r * random.uniform(0.5, 1.0));
  }
  const Vec3 before = both.momentum();
  double energy = both.kinetic();
  int free = 0;
  double deepest = 0.0;
  for (int i = 0; i < 400; ++i) {
    both.step();
    deepest = std::max(deepest, both.deepest());
    if (both.contacts() + both.simulation.totals().collisions.walls_touching > 0) continue;
    ++free;
    ASSERT_LE(norm(both.momentum() - before), 1e-9 * norm(before)) << i;
  }
  EXPECT_GE(free, 40);
  EXPECT_GT(both.simulation.totals().collisions.pairs_touching, 100U);
  EXPECT_LE(both.kinetic(), energy);
  EXPECT_LE(deepest, 0.5 * r);
  EXPECT_LE(both.deepest(), 0.05 * r);  // none stays
  EXPECT_EQ(both.failed(), 0U);
}

// Dropped on a heap: all comes to rest, no overlap stays, and a body's energy grows only by the reported amount.
TEST(SphereBodies, BodyComesToRestOnSpheres) {
  if (test::sanitized()) GTEST_SKIP() << "takes its full number of steps";
  CollisionOptions c;
  c.restitution = 0.2;
  c.friction = 0.5;
  c.iterations = 20;
  Both both(test::cube_of(6, 0.6), {0.0, 0.0, -9.81}, c, WallResponse{WallResponseKind::reflect, 0.2, 0.5});
  const double r = 0.04;
  for (int i = 0; i < 49; ++i) {
    const Vec3 x = {0.042 + 0.085 * (i % 7) + 0.0003 * (i % 5), 0.042 + 0.085 * (i / 7), 0.041};
    both.simulation.add(std::span(&x, 1), {}, r * (i % 3 == 0 ? 0.9 : 1.0));
  }
  both.add_body(4, {0.3, 0.3, 0.25}, {0.3, 0.0, -1.0}, 20.0, 20.0);
  double peak = 0.0;
  double last = both.bodies().energy(0).total();
  for (int i = 0; i < 2500; ++i) {
    both.step();
    const BodiesStep& step = both.simulation.bodies_step();
    const double now = both.bodies().energy(0).total();
    ASSERT_LE(now, last + step.input + (last + std::abs(step.input)) * 2.0 * energy_slack) << i;
    last = now;
    peak = std::max(peak, both.kinetic());
  }
  EXPECT_LE(both.kinetic(), 1e-6 * peak);
  EXPECT_LE(both.deepest(), 1e-3 * r);
  EXPECT_GT(both.bodies().rigid_motion_of(0).centre.z, 1.5 * spacing + 0.6 * spacing + r);  // on them, not among them
  EXPECT_EQ(both.failed(), 0U);
}

// A ball on a body on the floor: neither moves. The ball's contacts do not include the floor, so the ball's stored
// velocity stays near g dt.
TEST(SphereBodies, ASphereStandsOnABody) {
  if (test::sanitized()) GTEST_SKIP() << "takes its full number of steps";
  for (const double ratio : {10.0, 0.5}) {  // of the body's mass to the ball's
    CollisionOptions c;
    c.restitution = 0.2;
    c.friction = 0.5;
    Both both(test::cube_of(6, 0.6), {0.0, 0.0, -9.81}, c, WallResponse{WallResponseKind::reflect, 0.2, 0.5});
    const double r = 0.04;
    both.add_body(4, {0.3, 0.3, 0.08}, {}, ratio * mass_of(r, c.density), 20.0);
    const Vec3 x = {0.3, 0.3, 0.3};
    both.simulation.add(std::span(&x, 1), {0.0, 0.0, -1.0}, r);
    for (int i = 0; i < 1000; ++i) both.step();
    const Vec3 ball = both.simulation.particles()[0].position;
    const Vec3 body = both.bodies().rigid_motion_of(0).centre;
    for (int i = 0; i < 500; ++i) both.step();
    EXPECT_LE(norm(both.simulation.particles()[0].position - ball), 1e-4 * r) << ratio;
    EXPECT_LE(norm(both.bodies().rigid_motion_of(0).centre - body), 1e-4 * r) << ratio;
    EXPECT_LE(norm(both.simulation.velocities()[0]), 2.0 * 9.81 * dt) << ratio;
    EXPECT_LE(norm(both.bodies().rigid_motion_of(0).velocity), 9.81 * dt / ratio) << ratio;
    EXPECT_LE(both.deepest(), 0.01 * r) << ratio;
    EXPECT_EQ(both.failed(), 0U);
  }
}

TEST(SphereBodies, AreTheSameBitsForAnyNumberOfThreadsAndFromACheckpoint) {
  const int half = std::max(80, scaled(80, 400));
  const auto prepared = [](unsigned threads) {
    CollisionOptions c;
    c.restitution = 0.3;
    c.friction = 0.4;
    auto both = std::make_unique<Both>(test::cube_of(6, 1.0), Vec3{0.0, 0.0, -9.81}, c,
                                       WallResponse{WallResponseKind::reflect, 0.3, 0.4}, Threads{threads});
    both->add_body(4, {0.3, 0.4, 0.2}, {2.0, 0.5, 0.0}, 2.0);
    both->add_body(3, {0.6, 0.6, 0.3}, {-2.0, 0.0, 1.0}, 0.2);
    return both;
  };
  const auto fill = [](Both& both) {
    both.simulation.add_random(150, {0.0, 0.0, -1.0}, 0.03);
    both.simulation.add_random(20, {0.0, 0.0, -1.0});
  };
  std::string expected;
  for (const unsigned threads : {1U, 2U, 5U}) {
    const auto both = prepared(threads);
    fill(*both);
    for (int i = 0; i < half; ++i) both->step();
    const SimulationCheckpoint saved = both->simulation.checkpoint();
    EXPECT_FALSE(saved.state().particles.impulses.empty());
    for (int i = 0; i < half; ++i) both->step();
    if (expected.empty()) expected = both->hash();
    EXPECT_EQ(both->hash(), expected);
    const auto resumed = prepared(threads);
    resumed->simulation.restore(saved);
    for (int i = 0; i < half; ++i) resumed->step();
    EXPECT_EQ(resumed->hash(), expected);
    EXPECT_GT(both->simulation.totals().collisions.pairs_touching, 100U);
  }
}

TEST(SphereBodies, ThroughAWallNobodyMeets) {
  BoxOptions box;
  box.cells = {7, 3, 3};
  box.size = {0.7, 0.3, 0.3};
  MeshData mesh = generate_box(box);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[3 + 7 * (1 + 3)] = 0;  // a pillar in the middle
  Both both(std::move(mesh), {}, CollisionOptions{}, WallResponse{});
  BodyOptions o;
  o.radius = 0.12;
  both.simulation.add_body(std::vector<Vec3>{{0.25, 0.15, 0.15}}, o);
  both.simulation.add(std::vector<Vec3>{{0.45, 0.15, 0.15}}, {}, 0.1);
  both.simulation.add(std::vector<Vec3>{{0.27, 0.15, 0.15}}, {});  // a point
  for (int i = 0; i < 3; ++i) both.step();
  EXPECT_GT(both.simulation.totals().collisions.pairs_tested, 0U);
  EXPECT_EQ(both.simulation.totals().collisions.pairs_near, 0U);
  EXPECT_EQ(both.bodies().velocities()[0], Vec3{});
  o.radius = 0.02;
  both.simulation.add_body(std::vector<Vec3>{{0.48, 0.15, 0.15}}, o);  // on the other side
  both.step();
  EXPECT_EQ(both.simulation.totals().collisions.pairs_near, 1U);
}

// A body gets an impulse for one step only, and its energy is reported.
TEST(SphereBodies, ABodyIsGivenSomethingOnce) {
  Both both(test::cube_of(6, 1.0), {}, CollisionOptions{}, WallResponse{});
  both.add_body(3, {0.4, 0.5, 0.5}, {}, 2.0);
  RigidMover m = both.bodies().predicted_state(0);
  m.velocity.x = 1.5;
  m.position_delta.x = 1.5 * dt;
  both.bodies().apply_impulse(0, m);
  EXPECT_NEAR(both.bodies().step().input, 0.5 * 2.0 * 1.5 * 1.5, 1e-9);
  EXPECT_NEAR(both.bodies().rigid_motion_of(0).centre.x, 0.4 + 1.5 * dt, 1e-12);
  EXPECT_EQ(both.bodies().step().input, 0.0);
  EXPECT_NEAR(both.bodies().rigid_motion_of(0).velocity.x, 1.5, 1e-9);
}

TEST(SphereBodies, ContactsBetweenBodiesAreTheirOwn) {
  Both both(test::cube_of(6, 1.0), {}, CollisionOptions{}, WallResponse{});
  both.add_body(3, {0.4, 0.5, 0.5}, {1.0, 0.0, 0.0}, 1.0);
  both.add_body(3, {0.56, 0.5, 0.5}, {-1.0, 0.0, 0.0}, 1.0);
  both.simulation.add(std::vector<Vec3>{{0.8, 0.8, 0.8}}, {}, 0.02);
  both.step();
  EXPECT_GT(both.simulation.totals().collisions.pairs_tested, 0U);
  EXPECT_EQ(both.simulation.totals().collisions.pairs_near, 0U);
}

// A body that sticks to a wall by one of its particles gives no way.
TEST(SphereBodies, ABodyThatAWallHoldsGivesNoWay) {
  CollisionOptions c;
  c.restitution = 1.0;
  Both both(test::cube_of(6, 1.0), {}, c, WallResponse{WallResponseKind::stick, 0.0, 0.0});
  both.add_body(3, {0.06, 0.5, 0.5}, {-2.0, 0.0, 0.0}, 1.0);
  for (int i = 0; i < 50; ++i) both.step();
  ASSERT_TRUE(std::find(both.bodies().statuses().begin(), both.bodies().statuses().end(), ParticleStatus::stuck) !=
              both.bodies().statuses().end());
  both.simulation.add(std::vector<Vec3>{{0.4, 0.5, 0.5}}, {-2.0, 0.0, 0.0}, 0.04);
  for (int i = 0; i < 150; ++i) both.step();
  EXPECT_NEAR(both.simulation.velocities()[0].x, 2.0, 0.02);  // it still trembles
}

TEST(SphereBodies, RefuseWhatIsOutOfRange) {
  Environment environment(test::cube_of(6, 1.0), Threads{1});
  SimulationOptions o;
  o.collisions = CollisionOptions{};
  o.substeps = 2;
  const std::vector<Vec3> points = {{0.4, 0.4, 0.4}, {0.5, 0.4, 0.4}, {0.4, 0.5, 0.4}, {0.4, 0.4, 0.5}};
  EXPECT_THROW(Simulation(environment, o).add_body(points, {}), InvalidArgument);
  o.collisions.reset();
  EXPECT_NO_THROW(Simulation(environment, o).add_body(points, {}));
}

}  // namespace dartcast::sphere_bodies_test
