#include "dartcast/bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/meshes.hpp"
#include "support/point_block.hpp"
#include "support/tier.hpp"

namespace dartcast::bodies_test {

using test::scaled;

Environment room(std::uint32_t cells = 6, double size = 1.0) {
  return Environment(test::cube_of(cells, size), Threads{1});
}

// A lattice of n x n x n points with this spacing, turned somehow, around a centre.
std::vector<Vec3> block(int n, double spacing, const Vec3& centre, const Quaternion& turn = {1, {0.3, 0.2, 0.1}}) {
  return test::block(n, spacing, centre, turn);
}

BodiesOptions options(double dt, const Vec3& gravity = {}) {
  BodiesOptions o;
  o.dt = dt;
  o.gravity = gravity;
  return o;
}

WallResponses bouncing(double restitution, double friction) {
  WallResponse r;
  r.restitution = restitution;
  r.friction = friction;
  return WallResponses(r);
}

constexpr Vec3 earth = {0.0, 0.0, -9.81};

double kinetic_energy(const Bodies& bodies) {
  double sum = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) sum += bodies.energy(b).kinetic;
  return sum;
}

// --- free motion

TEST(Bodies, StiffBodyThatSpinsFreelyKeepsItsMomenta) {
  for (const double pull : {0.0, 0.1, 1.0}) {
    Environment environment = room(6, 10.0);
    Bodies bodies(environment, options(1e-3));
    BodyOptions o;
    o.mass = 2.0;
    o.pull = pull;
    o.damping = pull;
    o.velocity = {1.0, -0.5, 0.25};
    o.angular_velocity = {3.0, 5.0, -2.0};
    ASSERT_EQ(bodies.add(block(5, 0.1, {4.0, 5.0, 5.0}), o).body, 0U);
    const RigidMotion before = bodies.rigid_motion_of(0);
    const auto steps = scaled(1000, 4000);
    for (int i = 0; i < steps; ++i) bodies.step();
    const RigidMotion after = bodies.rigid_motion_of(0);
    // Places are rounded by 2^-50, accelerations by 1 / dt^2 times that, velocities in a step by 1e-12.
    EXPECT_LE(norm(after.velocity - before.velocity), 1e-10);
    EXPECT_LE(norm(after.angular_momentum - before.angular_momentum), 1e-8 * norm(before.angular_momentum)) << pull;
    EXPECT_LE(norm(after.centre - (before.centre + before.velocity * (1e-3 * steps))), 1e-10);
    EXPECT_NEAR(bodies.energy(0).kinetic, before.kinetic_energy(), 1e-3 * before.kinetic_energy());
    // A cube spins about a fixed axis; by then it has turned a good deal.
    const Quaternion q = bodies.fits(0).front().rotation;
    EXPECT_NEAR(std::abs(dot(normalized(Quaternion{0.0, q.v}).v, Vec3{3, 5, -2})) / norm(Vec3{3, 5, -2}), 1.0, 1e-6);
  }
}

TEST(Bodies, FallAsTheyShould) {
  Environment environment = room(6, 10.0);
  Bodies bodies(environment, options(1e-3, earth));
  BodyOptions o;
  o.velocity = {1.0, 0.0, 3.0};  // up, over its highest point, and down again
  bodies.add(block(3, 0.1, {4.0, 5.0, 5.0}), o);
  const RigidMotion before = bodies.rigid_motion_of(0);
  const auto steps = scaled(700, 700);
  const double t = 1e-3 * steps;
  for (int i = 0; i < steps; ++i) {
    bodies.step();
    ASSERT_EQ(bodies.counters().contacts[2], 0U);
  }
  const RigidMotion after = bodies.rigid_motion_of(0);
  EXPECT_LE(norm(after.centre - (before.centre + before.velocity * t + earth * (0.5 * t * t))), 1e-10);
  EXPECT_LE(norm(after.velocity - (before.velocity + earth * t)), 1e-10);
}

// Where a body that vibrates and spins is after a given time.
std::vector<Vec3> shaken(int steps) {
  constexpr double time = 0.2;
  Environment environment = room(3, 10.0);
  Bodies bodies(environment, options(time / steps, {0.0, 0.0, -1.0}));
  BodyOptions o;
  o.stiffness = 400.0;
  o.pull = 0.0;
  o.angular_velocity = {2.0, 1.0, 3.0};
  bodies.add(block(3, 0.3, {5.0, 5.0, 5.0}), o);
  for (std::size_t p = 0; p < bodies.positions().size(); ++p) {
    const Vec3 x = bodies.positions()[p] - Vec3{5, 5, 5};
    bodies.velocities()[p] += Vec3{x.x * 2.0, -x.y, x.x * x.z * 5.0};
  }
  for (int i = 0; i < steps; ++i) bodies.step();
  return {bodies.positions().begin(), bodies.positions().end()};
}

TEST(Bodies, IntegrateWithOrderFour) {
  const auto exact = shaken(1024);
  const auto error = [&](int steps) {
    const auto x = shaken(steps);
    double most = 0.0;
    for (std::size_t p = 0; p < x.size(); ++p) most = std::max(most, norm(x[p] - exact[p]));
    return most;
  };
  const double coarse = error(16);
  const double fine = error(32);
  EXPECT_GT(coarse, 1e-9);
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.3) << coarse << " " << fine;
}

// --- the energy law

struct Material {
  double stiffness;  // times dt^2
  double pull;
  double damping;
  double restitution;
  double friction;
  double linear = 0.0;
  bool clusters = false;
};

// Thrown about in a room with pillars: floor, corners, edges.
void expect_energy_law(const Material& m, std::uint64_t seed) {
  BoxOptions box;
  box.cells = {6, 6, 6};
  box.size = {1.0, 1.0, 1.0};
  box.blocked_share = 0.08;
  box.seed = seed;
  Environment environment(generate_box(box), Threads{1});
  constexpr double dt = 1e-3;
  Bodies bodies(environment, options(dt, earth), bouncing(m.restitution, m.friction));
  Random random(seed);
  const auto u = [&] { return random.uniform(-1.0, 1.0); };
  BodyOptions o;
  o.stiffness = m.stiffness / (dt * dt);
  o.pull = m.pull;
  o.damping = m.damping;
  o.match.linear = m.linear;
  for (int tries = 0; bodies.size() < 2 && tries < 1000; ++tries) {
    o.velocity = {8 * u(), 8 * u(), 8 * u()};
    o.angular_velocity = {30 * u(), 30 * u(), 30 * u()};
    const auto points = block(4, 0.05, {0.5 + 0.3 * u(), 0.5 + 0.3 * u(), 0.5 + 0.3 * u()}, {u(), {u(), u(), u()}});
    o.match.clusters = m.clusters ? overlapping_clusters(points, 0.1) : std::vector<std::vector<std::uint32_t>>{};
    bodies.add(points, o);
  }
  ASSERT_EQ(bodies.size(), 2U);
  std::array<double, 2> last = {bodies.energy(0).total(), bodies.energy(1).total()};
  for (int i = 0; i < scaled(500, 20'000); ++i) {
    const BodiesStep& step = bodies.step();
    ASSERT_EQ(step.input, 0.0);
    for (std::size_t b = 0; b < 2; ++b) {
      const BodyEnergy e = bodies.energy(b);
      ASSERT_GE(std::min({e.kinetic, e.potential, e.matching}), 0.0);
      ASSERT_LE(e.total(), last[b] * (1.0 + 2.0 * energy_slack)) << "step " << i << ", body " << b;
      last[b] = e.total();
    }
  }
  EXPECT_GT(bodies.counters().contacts[2], 0U);
  EXPECT_EQ(audit(environment.complex(), bodies.particles()).failed, 0U);
}

TEST(Bodies, EnergyNeverGrows) {
  const Material materials[] = {
      {1.0, 0.1, 0.0, 0.5, 0.3},
      {1.0, 1.0, 10.0, 1.0, 0.0},
      {0.25, 0.0, 0.0, 1.0, 0.0},
      {0.01, 0.05, 1.0, 0.9, 0.5},
      {0.5, 0.5, 0.0, 0.0, 1.0},
      {0.1, 0.1, 5.0, 0.5, 0.3, 0.5},
      {0.1, 0.02, 0.0, 0.8, 0.3, 0.0, true},
      {0.5, 0.1, 0.0, 1.0, 0.2, 0.7, true},
  };
  std::uint64_t seed = 1;
  for (const Material& m : materials) {
    expect_energy_law(m, seed++);
    if (HasFatalFailure()) return;
  }
}

// --- walls

// Comes to rest, stays there, and lies on the floor.
TEST(Bodies, DroppedOnAFloorComesToRest) {
  if (test::sanitized()) GTEST_SKIP() << "takes its full number of steps";
  for (const double stiffness : {1.0, 0.1}) {
    Environment environment = room();
    Bodies bodies(environment, options(1e-3, earth), bouncing(0.4, 0.4));
    BodyOptions o;
    o.stiffness = stiffness * 1e6;
    o.pull = 0.3;
    o.damping = 20.0;
    o.angular_velocity = {1, 2, 3};
    bodies.add(block(5, 0.04, {0.5, 0.5, 0.4}), o);
    double peak = 0.0;
    for (int i = 0; i < 2500; ++i) {
      bodies.step();
      peak = std::max(peak, kinetic_energy(bodies));
    }
    const std::vector<Vec3> rest(bodies.positions().begin(), bodies.positions().end());
    for (int i = 0; i < 1000; ++i) {
      bodies.step();
      ASSERT_LE(kinetic_energy(bodies), 1e-6 * peak);
    }
    double lowest = 1.0;
    double moved = 0.0;
    for (std::size_t p = 0; p < rest.size(); ++p) {
      lowest = std::min(lowest, bodies.positions()[p].z);
      moved = std::max(moved, norm(bodies.positions()[p] - rest[p]));
    }
    EXPECT_LE(lowest, 1e-9);
    EXPECT_LE(moved, 1e-4);
    EXPECT_NEAR(bodies.rigid_motion_of(0).centre.z, 0.08, 0.003);  // it lies on a face
  }
}

// On a tilted floor: above the friction angle it slides, below it stays.
TEST(Bodies, SlideAboveTheFrictionAngle) {
  for (const bool steep : {false, true}) {
    Environment environment = room();
    const double angle = 0.4;
    const Vec3 gravity = Vec3{std::sin(angle), 0.0, -std::cos(angle)} * 9.81;
    Bodies bodies(environment, options(1e-3, gravity), bouncing(0.0, std::tan(angle) * (steep ? 0.5 : 1.2)));
    BodyOptions o;
    o.damping = 20.0;
    bodies.add(block(4, 0.05, {0.3, 0.5, 0.0751}, {}), o);
    const auto steps = scaled(300, 300);
    for (int i = 0; i < steps; ++i) bodies.step();
    const double t = 1e-3 * steps;
    const double way = bodies.rigid_motion_of(0).centre.x - 0.3;
    if (steep) {
      EXPECT_NEAR(way, 0.5 * (0.5 * 9.81 * std::sin(angle)) * t * t, 0.1 * way);
    } else {
      EXPECT_LE(std::abs(way), 1e-3);
    }
  }
}

// A single particle is a body, too: what it does at a wall is what its patch says.
TEST(Bodies, ParticleBouncesAsItsPatchSays) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    Environment environment = room();
    Bodies bodies(environment, options(1e-3), bouncing(restitution, 0.25));
    BodyOptions o;
    o.pull = 0.0;
    o.velocity = {1.0, 0.0, -1.0};
    bodies.add(std::vector<Vec3>{{0.4, 0.5, 0.0105}}, o);
    for (int i = 0; i < 20; ++i) bodies.step();
    const Vec3 v = bodies.velocities()[0];
    EXPECT_NEAR(v.z, restitution, 1e-12);
    EXPECT_NEAR(v.x, 1.0 - 0.25 * (1.0 + restitution), 1e-12);
  }
}

TEST(Bodies, StickToSomeWallsAndLeaveAtOthers) {
  Environment environment = room();
  WallResponses responses;
  WallResponse stick;
  stick.kind = WallResponseKind::stick;
  responses.set(environment.map().patch("zmin"), stick);
  WallResponse escape;
  escape.kind = WallResponseKind::escape;
  responses.set(environment.map().patch("xmax"), escape);
  Bodies bodies(environment, options(1e-3, earth), responses);
  BodyOptions o;
  o.damping = 30.0;
  bodies.add(block(3, 0.05, {0.3, 0.5, 0.2}), o);
  o.velocity = {3.0, 0.0, 3.0};
  bodies.add(block(3, 0.05, {0.6, 0.5, 0.5}), o);
  bodies.add(block(3, 0.05, {0.6, 0.2, 0.5}), {});
  std::vector<std::uint32_t> gone;
  for (int i = 0; i < 400; ++i) {
    const auto& step = bodies.step();
    gone.insert(gone.end(), step.gone.begin(), step.gone.end());
  }
  EXPECT_EQ(gone, std::vector<std::uint32_t>{1});
  ASSERT_EQ(bodies.size(), 2U);
  EXPECT_EQ(bodies.id(1), 2U);
  EXPECT_EQ(bodies.first_particle(1), 27U);
  EXPECT_EQ(bodies.body_of()[27], 1U);
  EXPECT_EQ(bodies.particles().size(), 54U);
  const auto stuck = std::count(bodies.statuses().begin(), bodies.statuses().end(), ParticleStatus::stuck);
  EXPECT_GE(stuck, 1);
  for (std::size_t p = 0; p < 54; ++p) {
    if (bodies.statuses()[p] == ParticleStatus::stuck) EXPECT_NEAR(bodies.positions()[p].z, 0.0, 1e-12);
  }
}

// --- scenes that deform

// A floor that rises takes the body along; once it stands still the law holds again.
TEST(Bodies, AreLiftedByAFloorThatRises) {
  Environment environment = room();
  Bodies bodies(environment, options(1e-3, earth), bouncing(0.2, 0.5));
  BodyOptions o;
  o.pull = 0.3;
  o.damping = 20.0;
  bodies.add(block(4, 0.05, {0.5, 0.5, 0.2}), o);
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  const int steps = 600;
  double input = 0.0;
  for (int i = 1; i <= steps; ++i) {
    auto next = rest;
    for (Vec3& p : next) p.z += 0.3 * (1.0 - p.z) * std::min(1.0, i / 500.0);
    if (i <= 510) {
      environment.move(next);
    }
    const double before = bodies.energy(0).total();
    const BodiesStep& step = bodies.step();
    input += step.input;
    ASSERT_LE(bodies.energy(0).total(), (before + step.input) * (1.0 + 2.0 * energy_slack)) << i;
    if (i > 511) ASSERT_EQ(step.input, 0.0);
    ASSERT_EQ(audit(environment.complex(), bodies.particles()).failed, 0U);
  }
  EXPECT_GT(input, 1.0);  // at least the 0.2 m against gravity
  for (const Vec3& x : bodies.positions()) ASSERT_GE(x.z, 0.3 - 1e-12);
}

// --- the same bits

TEST(Bodies, AreTheSameBitsForAnyNumberOfThreads) {
  std::string expected;
  for (const unsigned threads : {1U, 2U, 5U}) {
    BoxOptions box;
    box.cells = {5, 5, 5};
    box.size = {1.0, 1.0, 1.0};
    box.jitter = 0.3;
    Environment environment(generate_box(box), Threads{threads});
    Bodies bodies(environment, options(1e-3, earth), bouncing(0.5, 0.3));
    BodyOptions o;
    for (int k = 0; k < 8; ++k) {
      o.angular_velocity = {1.0 * k, 2.0, -3.0};
      const Vec3 centre = {0.25 + 0.5 * (k & 1), 0.25 + 0.5 * (k >> 1 & 1), 0.25 + 0.5 * (k >> 2)};
      ASSERT_EQ(bodies.add(block(5, 0.04, centre), o).body, static_cast<std::uint32_t>(k));
    }
    for (int i = 0; i < scaled(300, 3000); ++i) bodies.step();
    if (expected.empty()) expected = bodies.state_hash().hex();
    EXPECT_EQ(bodies.state_hash().hex(), expected) << threads;
  }
}

TEST(Bodies, GoOnFromACheckpointToTheSameBits) {
  const auto prepared = [](Environment& environment) {
    Bodies bodies(environment, options(1e-3, earth), bouncing(0.5, 0.3));
    BodyOptions o;
    o.velocity = {2.0, 1.0, -1.0};
    o.angular_velocity = {5.0, 4.0, 3.0};
    bodies.add(block(4, 0.05, {0.5, 0.5, 0.3}), o);
    o.match.linear = 0.3;
    bodies.add(block(3, 0.05, {0.2, 0.2, 0.3}), o);
    return bodies;
  };
  Environment environment = room();
  Bodies whole = prepared(environment);
  for (int i = 0; i < 150; ++i) whole.step();
  const Bodies::Checkpoint saved = whole.checkpoint();
  for (int i = 0; i < 150; ++i) whole.step();
  Environment other = room();
  Bodies resumed = prepared(other);
  resumed.restore(saved);
  EXPECT_EQ(resumed.steps(), 150U);
  for (int i = 0; i < 150; ++i) resumed.step();
  EXPECT_EQ(resumed.state_hash(), whole.state_hash());
  EXPECT_EQ(resumed.counters().particle_steps, whole.counters().particle_steps);

  Bodies::Checkpoint wrong = saved;
  wrong.particles.pop_back();
  EXPECT_THROW(resumed.restore(wrong), InvalidArgument);
  wrong = saved;
  wrong.ids.front() = 7;
  EXPECT_THROW(resumed.restore(wrong), InvalidArgument);
  wrong = saved;
  wrong.particles.front().state.position.x += 0.5;
  EXPECT_THROW(resumed.restore(wrong), InvalidArgument);
  EXPECT_EQ(resumed.state_hash(), whole.state_hash());
}

// --- edits

TEST(Bodies, FollowEdits) {
  Environment environment = room(4);
  Bodies bodies(environment, options(1e-3, earth), bouncing(0.3, 0.3));
  bodies.add(block(4, 0.04, {0.5, 0.5, 0.3}), {});
  bodies.add(block(4, 0.04, {0.85, 0.85, 0.3}), {});
  for (int i = 0; i < 20; ++i) bodies.step();
  const Cell under = bodies.particles()[0].cell;
  environment.edit([&](ComplexEdit& edit) { edit.topology().set_free(under, false); });
  EXPECT_THROW(bodies.step(), InvalidArgument);
  const UpdateReport moved = bodies.update_after_edit();
  EXPECT_GT(moved.orphaned.size(), 0U);
  for (int i = 0; i < 50; ++i) bodies.step();
  EXPECT_EQ(audit(environment.complex(), bodies.particles()).failed, 0U);
  ASSERT_EQ(bodies.size(), 2U);

  environment.edit([&](ComplexEdit& edit) { edit.topology().set_free(bodies.particles()[3].cell, false); });
  bodies.update_after_edit(OrphanPolicy::absorb);
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_EQ(bodies.id(0), 1U);
  EXPECT_EQ(bodies.particles().size(), 64U);
  for (int i = 0; i < 50; ++i) bodies.step();
  EXPECT_EQ(audit(environment.complex(), bodies.particles()).failed, 0U);
}

// --- refusals

TEST(Bodies, RefuseWhatIsOutOfRange) {
  Environment environment = room();
  EXPECT_THROW(Bodies(environment, options(0.0)), InvalidArgument);
  EXPECT_THROW(Bodies(environment, options(1e-3, {0, 0, std::numeric_limits<double>::infinity()})), InvalidArgument);
  Bodies bodies(environment, options(1e-3));
  const auto points = block(2, 0.1, {0.5, 0.5, 0.5});
  const auto refused = [&](const std::function<void(BodyOptions&)>& change) {
    BodyOptions o;
    change(o);
    EXPECT_THROW(bodies.add(points, o), InvalidArgument);
  };
  refused([](BodyOptions& o) { o.mass = 0.0; });
  refused([](BodyOptions& o) { o.masses = {1.0}; });
  refused([](BodyOptions& o) { o.radius = -1.0; });
  refused([](BodyOptions& o) { o.stiffness = 1.01e6; });
  refused([](BodyOptions& o) { o.pull = 1.5; });
  refused([](BodyOptions& o) { o.damping = -1.0; });
  refused([](BodyOptions& o) { o.velocity.x = std::numeric_limits<double>::quiet_NaN(); });
  EXPECT_EQ(bodies.size(), 0U);
  auto outside = points;
  outside[5].x = 2.0;
  const AddBodyResult added = bodies.add(outside, {});
  EXPECT_EQ(added.body, 0xffffffffU);
  EXPECT_EQ(added.refused, std::vector<std::uint32_t>{5});
  EXPECT_EQ(bodies.particles().size(), 0U);
  bodies.step();  // of none
  EXPECT_EQ(bodies.steps(), 1U);
}

}  // namespace dartcast::bodies_test
