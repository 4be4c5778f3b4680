// Impulses between rigid bodies, spheres and walls.
#include "dynamics/rigid_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.hpp"
#include "bodies/body_motion.hpp"

namespace dartcast::rigid_solver_test {

constexpr double dt = 0.01;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double in(double low, double high) { return random_.uniform(low, high); }
  Vec3 vector(double most = 1.0) { return {in(-most, most), in(-most, most), in(-most, most)}; }
  Vec3 direction() {
    while (true) {
      const Vec3 v = vector();
      if (norm(v) > 0.2 && norm(v) < 1.0) return v * (1.0 / norm(v));
    }
  }
  std::size_t below(std::size_t n) { return random_.below(static_cast<std::uint32_t>(n)); }

 private:
  Random random_;
};

// A body of some points, with its tensor of inertia.
struct Lump {
  RigidMover mover;
  double mass = 0.0;
  std::vector<double> masses;
  std::vector<Vec3> points;
};

Lump lump(Draw& draw) {
  Lump l;
  for (int i = 0; i < 6; ++i) {
    l.masses.push_back(draw.in(0.1, 1.0));
    l.points.push_back(draw.vector());
  }
  std::vector<Vec3> velocities;
  const Vec3 common = draw.vector();
  const Vec3 angular_velocity = draw.vector(3.0);
  for (const Vec3& x : l.points) velocities.push_back(common + cross(angular_velocity, x));
  const RigidMotion m = rigid_motion(l.masses, l.points, velocities);
  l.mass = m.mass;
  l.mover.inverse_mass = 1.0 / m.mass;
  l.mover.turns = true;
  l.mover.inverse_inertia = inverse_inertia(l.masses, l.points, m.centre);
  l.mover.centre = m.centre;
  l.mover.velocity = m.velocity;
  l.mover.angular_velocity = m.angular_velocity;
  return l;
}

double kinetic(const Lump& l, const RigidMover& m) {
  double sum = 0.0;
  for (std::size_t i = 0; i < l.points.size(); ++i) {
    const Vec3 v = m.velocity_at(l.points[i]);
    sum += 0.5 * l.masses[i] * dot(v, v);
  }
  return sum;
}

Vec3 angular(const Lump& l, const RigidMover& m) {
  Vec3 sum;
  for (std::size_t i = 0; i < l.points.size(); ++i) sum += cross(l.points[i], m.velocity_at(l.points[i]) * l.masses[i]);
  return sum;
}

RigidContact touch(const Vec3& normal, const Vec3& at) {
  RigidContact c;
  c.a = 0;
  c.a_id = 1;
  c.b = 1;
  c.b_id = 2;
  c.normal = normal;
  c.point_a = c.point_b = at;
  return c;
}

SolverOptions options() {
  SolverOptions o;
  o.dt = dt;
  return o;
}

// One contact without friction: the velocities part at -e times what they came at; momenta and energy as they must be.
TEST(RigidSolver, OneContactIsAsNewtonsLaw) {
  Draw draw(1);
  int hit = 0;
  for (int i = 0; i < 500; ++i) {
    const Lump a = lump(draw);
    const Lump b = lump(draw);
    std::vector<RigidMover> movers = {a.mover, b.mover};
    RigidContact c = touch(draw.direction(), draw.vector());
    c.restitution = i % 3 * 0.5;
    const auto speed = [&] {
      return dot(movers[1].velocity_at(c.point_b) - movers[0].velocity_at(c.point_a), c.normal);
    };
    const double before = speed();
    RigidSolver().solve(std::span(&c, 1), movers, options());
    if (before >= 0.0) {
      EXPECT_EQ(movers[0].velocity, a.mover.velocity);
      EXPECT_EQ(movers[1].angular_velocity, b.mover.angular_velocity);
      continue;
    }
    ++hit;
    ASSERT_NEAR(speed(), -c.restitution * before, 1e-12);
    const Vec3 momentum =
        (movers[0].velocity - a.mover.velocity) * a.mass + (movers[1].velocity - b.mover.velocity) * b.mass;
    ASSERT_LE(norm(momentum), 1e-13);
    const Vec3 turning = angular(a, movers[0]) + angular(b, movers[1]) - angular(a, a.mover) - angular(b, b.mover);
    ASSERT_LE(norm(turning), 1e-12);
    // The energy that the law removes: (1 - e^2) / 2 of the effective mass times the speed squared.
    const Vec3 impulse = (movers[1].velocity - b.mover.velocity) * b.mass;
    const double lost = 0.5 * (1.0 - c.restitution) * norm(impulse) * -before;
    const double had = kinetic(a, a.mover) + kinetic(b, b.mover);
    ASSERT_NEAR(kinetic(a, movers[0]) + kinetic(b, movers[1]), had - lost, 1e-12 * had);
  }
  EXPECT_GT(hit, 100);
}

// With friction the impulse is in the cone, and slip ends or goes on against it.
TEST(RigidSolver, FrictionIsCoulombs) {
  Draw draw(2);
  int sticks = 0;
  int slips = 0;
  for (int i = 0; i < 500; ++i) {
    const Lump a = lump(draw);
    const Lump b = lump(draw);
    std::vector<RigidMover> movers = {a.mover, b.mover};
    RigidContact c = touch(draw.direction(), draw.vector());
    c.friction = draw.in(0.1, 1.5);
    SolverOptions o = options();
    o.iterations = 2000;
    RigidSolver().solve(std::span(&c, 1), movers, o);
    const Vec3 impulse = (movers[1].velocity - b.mover.velocity) * b.mass;
    const double normal_impulse = dot(impulse, c.normal);
    if (normal_impulse < 1e-3) continue;
    const Vec3 tangent_impulse = impulse - c.normal * normal_impulse;
    const Vec3 left = movers[1].velocity_at(c.point_b) - movers[0].velocity_at(c.point_a);
    ASSERT_NEAR(dot(left, c.normal), 0.0, 1e-9);
    ASSERT_LE(norm(tangent_impulse), c.friction * normal_impulse * (1.0 + 1e-9));
    if (norm(left) < 1e-6) {
      ++sticks;
      continue;
    }
    ++slips;
    ASSERT_NEAR(norm(tangent_impulse), c.friction * normal_impulse, 1e-6 * normal_impulse);
    ASSERT_NEAR(dot(tangent_impulse, left), -norm(tangent_impulse) * norm(left),
                1e-6 * norm(tangent_impulse) * norm(left));
  }
  EXPECT_GT(sticks, 30);
  EXPECT_GT(slips, 30);
}

// The contacts of spheres as those of rigid bodies.
std::vector<RigidContact> as_rigid(std::span<const PairContact> pairs, std::span<const WallContact> walls,
                                   std::span<const std::uint64_t> ids) {
  std::vector<RigidContact> contacts;
  for (const PairContact& p : pairs) {
    RigidContact c = touch(p.normal, {});
    c.a = p.a;
    c.b = p.b;
    c.a_id = ids[p.a];
    c.b_id = ids[p.b];
    c.gap = p.gap;
    c.restitution = 0.4;
    contacts.push_back(c);
  }
  for (const WallContact& w : walls) {
    RigidContact c;
    c.b = w.sphere;
    c.b_id = ids[w.sphere];
    c.normal = w.normal;
    c.gap = w.gap;
    c.restitution = w.restitution;
    c.friction = w.friction;
    c.wall_velocity = w.wall_velocity;
    contacts.push_back(c);
  }
  return contacts;
}

// A random cluster of spheres with walls, without friction: the result of ContactSolver, step after step.
TEST(RigidSolver, SpheresAreAsInTheContactSolver) {
  Draw draw(3);
  constexpr std::size_t count = 40;
  std::vector<RigidMover> movers(count);
  std::vector<std::uint64_t> ids(count);
  std::vector<double> inverse(count);
  std::vector<Vec3> velocities(count);
  std::vector<Vec3> displacements(count);
  for (std::size_t i = 0; i < count; ++i) {
    ids[i] = 7 * i % count;
    inverse[i] = movers[i].inverse_mass = i == 5 ? 0.0 : draw.in(0.5, 2.0);
    velocities[i] = movers[i].velocity = draw.vector();
  }
  std::vector<PairContact> pairs;
  std::vector<WallContact> walls;
  for (int i = 0; i < 120; ++i) {
    auto a = static_cast<std::uint32_t>(draw.below(count));
    auto b = static_cast<std::uint32_t>(draw.below(count));
    if (a == b) continue;
    if (ids[a] > ids[b]) std::swap(a, b);
    if (std::any_of(pairs.begin(), pairs.end(), [&](const PairContact& p) { return p.a == a && p.b == b; })) continue;
    pairs.push_back({a, b, draw.direction(), draw.in(-0.001, 0.002)});
  }
  for (std::uint32_t i = 0; i < 30; ++i)
    walls.push_back({3 * (i / 3), draw.direction(), draw.in(-0.001, 0.001), draw.vector(0.1), 0.3, 0.0});
  const std::vector<RigidContact> contacts = as_rigid(pairs, walls, ids);
  SolverOptions o = options();
  o.restitution = 0.4;
  o.resting_speed = 0.05;
  ContactSolver expected;
  RigidSolver solver;
  for (int step = 0; step < 5; ++step) {
    expected.solve(pairs, walls, {ids, inverse, velocities, displacements}, o);
    solver.solve(contacts, movers, o);
    EXPECT_EQ(solver.loaded_pairs(), expected.loaded_pairs());
    EXPECT_EQ(solver.loaded_walls(), expected.loaded_walls());
    ASSERT_EQ(solver.cached_impulses().size(), expected.cached_impulses().size());
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_LE(norm(movers[i].velocity - velocities[i]), 1e-12) << step;
      ASSERT_LE(norm(movers[i].position_delta - displacements[i]), 1e-14) << step;
      velocities[i] += Vec3{0.0, 0.0, -0.3};
      movers[i].velocity = velocities[i];
    }
  }
}

// Spheres with one contact each, with another, a wall or one that cannot be pushed: as in ContactSolver, which rebounds
// them at their time.
TEST(RigidSolver, LoneSpheresAreAsInTheContactSolver) {
  Draw draw(9);
  constexpr std::uint32_t count = 60;
  std::vector<RigidMover> movers(count);
  std::vector<std::uint64_t> ids(count);
  std::vector<double> inverse(count);
  std::vector<Vec3> velocities(count);
  std::vector<Vec3> displacements(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    ids[i] = i;
    inverse[i] = movers[i].inverse_mass = i % 12 == 1 ? 0.0 : draw.in(0.5, 2.0);
    velocities[i] = movers[i].velocity = inverse[i] > 0.0 ? draw.vector() : Vec3{};
  }
  SolverOptions o = options();
  o.restitution = 0.8;
  o.acceleration = draw.vector(5.0);
  std::vector<PairContact> pairs;
  std::vector<WallContact> walls;
  for (std::uint32_t i = 0; i < 40; i += 2) pairs.push_back({i, i + 1, draw.direction(), draw.in(0.0, 0.5 * o.dt)});
  for (std::uint32_t i = 40; i < count; ++i)
    walls.push_back({i, draw.direction(), draw.in(0.0, 0.5 * o.dt), draw.vector(0.1), o.restitution, 0.0});
  ContactSolver expected;
  expected.solve(pairs, walls, {ids, inverse, velocities, displacements}, o);
  RigidSolver solver;
  std::vector<RigidContact> contacts = as_rigid(pairs, walls, ids);
  for (RigidContact& c : contacts) c.restitution = o.restitution;
  solver.solve(contacts, movers, o);
  EXPECT_GT(expected.loaded_pairs(), 3U);
  EXPECT_GT(expected.loaded_walls(), 3U);
  EXPECT_EQ(solver.new_walls().size(), expected.new_walls().size());
  for (std::size_t k = 0; k < expected.new_walls().size(); ++k)
    EXPECT_EQ(solver.new_walls()[k], expected.new_walls()[k] + pairs.size());
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_LE(norm(movers[i].velocity - velocities[i]), 1e-12) << i;
    EXPECT_LE(norm(movers[i].position_delta - displacements[i]), 1e-14) << i;
  }
}

// Many contacts of bodies: the result does not hang on the order, and goes on from what was kept.
TEST(RigidSolver, OrderDoesNotMatterAndKeptImpulsesGoOn) {
  Draw draw(4);
  std::vector<RigidMover> movers;
  for (int i = 0; i < 6; ++i) movers.push_back(lump(draw).mover);
  std::vector<RigidContact> contacts;
  for (std::uint32_t i = 0; i < 30; ++i) {
    RigidContact c = touch(draw.direction(), draw.vector());
    c.a = i % 6;
    c.b = (i + 1 + i / 6) % 6;
    c.a_id = i;
    c.b_id = 100 + i;
    if (i % 7 == 0) c.a = RigidContact::wall;
    c.point_b = draw.vector();
    c.gap = draw.in(-0.01, 0.01);
    c.friction = 0.3;
    if (c.a != c.b) contacts.push_back(c);
  }
  std::vector<RigidContact> reversed(contacts.rbegin(), contacts.rend());
  RigidSolver one;
  RigidSolver other;
  std::vector<RigidMover> again = movers;
  for (int step = 0; step < 3; ++step) {
    one.solve(contacts, movers, options());
    other.solve(reversed, again, options());
    ASSERT_FALSE(one.cached_impulses().empty());
    for (std::size_t i = 0; i < movers.size(); ++i) {
      ASSERT_EQ(movers[i].velocity, again[i].velocity);
      ASSERT_EQ(movers[i].angular_velocity, again[i].angular_velocity);
      ASSERT_EQ(movers[i].position_delta, again[i].position_delta);
      ASSERT_EQ(movers[i].rotation_delta, again[i].rotation_delta);
      movers[i].velocity += Vec3{0.0, 0.0, -0.1};
      again[i].velocity = movers[i].velocity;
    }
    const std::vector<CachedImpulse> kept(one.cached_impulses().begin(), one.cached_impulses().end());
    other = RigidSolver();
    other.set_cached_impulses(kept);
  }
}

// Overlaps are corrected without a change of velocities.
TEST(RigidSolver, PushesDoNotChangeVelocities) {
  Draw draw(6);
  for (int i = 0; i < 50; ++i) {
    const Lump a = lump(draw);
    const Lump b = lump(draw);
    std::vector<RigidMover> movers = {a.mover, b.mover};
    for (RigidMover& m : movers) m.velocity = m.angular_velocity = {};
    RigidContact c = touch(draw.direction(), draw.vector());
    c.gap = -0.1;
    RigidSolver().solve(std::span(&c, 1), movers, options());
    EXPECT_EQ(movers[0].velocity, Vec3{});
    EXPECT_EQ(movers[1].angular_velocity, Vec3{});
    const auto moved = [&](const RigidMover& m) {
      return m.position_delta + cross(m.rotation_delta, c.point_a - m.centre);
    };
    EXPECT_NEAR(dot(moved(movers[1]) - moved(movers[0]), c.normal), 0.02, 1e-12);
  }
}

}  // namespace dartcast::rigid_solver_test
