// Spheres of a simulation that meet each other and walls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "dynamics/collider.hpp"
#include "support/tier.hpp"
#include "support/with_response.hpp"

namespace dartcast::collisions_test {

MeshData box_of(std::array<std::uint32_t, 3> cells, const Vec3& size) {
  BoxOptions o;
  o.cells = cells;
  o.size = size;
  return generate_box(o);
}

SimulationOptions colliding(double dt, double restitution, double friction) {
  SimulationOptions o;
  o.dt = dt;
  o.collisions = CollisionOptions{};
  o.collisions->restitution = restitution;
  o.collisions->friction = friction;
  return o;
}

double kinetic(const Simulation& simulation) {
  double sum = 0.0;
  for (std::size_t i = 0; i < simulation.radii().size(); ++i)
    sum += std::pow(simulation.radii()[i], 3) * dot(simulation.velocities()[i], simulation.velocities()[i]);
  return sum;
}

double deepest_overlap(const Simulation& simulation) {
  double deepest = 0.0;
  const auto states = simulation.particles().states();
  for (std::size_t i = 0; i < states.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double room = norm(states[i].position - states[j].position) - simulation.radii()[i] - simulation.radii()[j];
      deepest = std::max(deepest, -room);
    }
  }
  return deepest;
}

// Places of a lattice above the ground, somewhat off it.
std::vector<Vec3> lattice(std::size_t count, std::uint32_t across, const Vec3& corner, double spacing) {
  Random random(11);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = [&](std::size_t k) { return spacing * (double(k) + random.uniform(-0.05, 0.05)); };
    places.push_back(corner + Vec3{at(i % across), at(i / across % across), at(i / across / across)});
  }
  return places;
}

// Grains are poured into a vessel (a box), come to rest and stay so.
TEST(Collisions, GrainsComeToRest) {
  const std::size_t count = std::max<std::size_t>(30, test::scaled<std::size_t>(300, 10000));
  const bool large = count > 1000;
  const std::uint32_t across = large ? 14 : 6;
  const double r = 0.01;
  const double width = 2.4 * r * across;
  const double height = 2.4 * r * (double(count) / across / across + 3);
  Environment environment(box_of({across / 2, across / 2, across}, {width, width, height}), Threads{1});
  SimulationOptions o = colliding(large ? 2e-3 : 4e-3, 0.3, 0.3);
  if (large) o.collisions->iterations = 20;
  o.gravity = {0, 0, -9.81};
  Simulation simulation(environment, test::with_response(o, Reflect{0.3, 0.3}));
  const auto places = lattice(count, across, Vec3{1.2 * r, 1.2 * r, 2.0 * r}, 2.4 * r);
  for (std::size_t i = 0; i < count; ++i) simulation.add(std::span(&places[i], 1), {}, r * (i % 3 == 0 ? 0.8 : 1.0));
  ASSERT_EQ(simulation.particles().size(), count);
  double peak = 0.0;
  int resting = 0;
  std::size_t reported = 0;  // in the second half of the rest
  for (int i = 0; i < 6000 && resting < 1000; ++i) {
    const std::size_t contacts = simulation.step().contacts().size();
    reported = resting < 500 ? 0 : reported + contacts;
    const double energy = kinetic(simulation);
    peak = std::max(peak, energy);
    resting = energy < 1e-6 * peak ? resting + 1 : 0;
  }
  EXPECT_EQ(resting, 1000) << count;
  EXPECT_EQ(reported, 0U);
  EXPECT_EQ(simulation.totals().wall_overlaps, 0U);
  EXPECT_LT(simulation.totals().collisions.deepest, 0.5 * r);
  EXPECT_EQ(simulation.totals().counters.unfinished, 0U);
  if (!large) {
    EXPECT_LT(deepest_overlap(simulation), 1e-3 * r);
  }
  for (const ParticleState& s : simulation.particles().states()) EXPECT_GE(s.position.z, 0.8 * r * (1.0 - 1e-9));
  EXPECT_EQ(audit(environment.complex(), simulation.particles()).failed, 0U);
}

// In free space, within a large box: momentum is kept while they collide.
TEST(Collisions, KeepMomentum) {
  Environment environment(box_of({8, 8, 8}, {4, 4, 4}), Threads{1});
  Simulation simulation(environment, colliding(0.01, 0.9, 0.2));
  Random random(3);
  Vec3 momentum;
  double sum = 0.0;
  const auto mass = [](double r) { return r * r * r; };
  for (int i = 0; i < 1000; ++i) {
    const double r = random.uniform(0.02, 0.08);
    const Vec3 place = {random.uniform(1.5, 2.5), random.uniform(1.5, 2.5), random.uniform(1.5, 2.5)};
    const Vec3 velocity = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    simulation.add(std::span(&place, 1), velocity, r);
    momentum += velocity * mass(r);
    sum += norm(velocity) * mass(r);
  }
  for (int i = 0; i < std::max(2, test::scaled(40, 40)); ++i) {  // later they meet walls
    simulation.step();
    EXPECT_EQ(simulation.totals().counters.contacts[0], 0U);
  }
  EXPECT_GT(simulation.totals().collisions.pairs_touching, 500U);
  for (std::size_t i = 0; i < 1000; ++i) momentum -= simulation.velocities()[i] * mass(simulation.radii()[i]);
  EXPECT_LT(norm(momentum), 1e-14 * sum);
}

// The same bits for any number of threads, and for a run that continues from a checkpoint.
TEST(Collisions, ThreadsAndCheckpoints) {
  const auto run = [](unsigned threads, int save_at) {
    BoxOptions box;
    box.cells = {5, 5, 5};
    box.size = {2.5, 2.5, 2.5};
    box.blocked_share = 0.1;
    box.jitter = 0.2;
    Environment environment(generate_box(box), Threads{threads});
    SimulationOptions o = colliding(1e-2, 0.4, 0.3);
    o.gravity = {0.0, 0.0, -10.0};
    Simulation simulation(environment, test::with_response(o, Reflect{0.4, 0.3}));
    const std::size_t count = std::max<std::size_t>(60, test::scaled<std::size_t>(600, 3000));
    simulation.add_random(count / 4, {1.0, 0.0, -2.0}, 0.12);
    simulation.add_random(count / 2, {0.0, 1.0, -2.0}, 0.06);
    simulation.add_random(count / 4, {0.0, 0.0, -1.0});
    for (int i = 0; i < 40; ++i) {
      if (i == save_at) {
        const SimulationCheckpoint saved = simulation.checkpoint();
        Environment again(generate_box(box), Threads{threads});
        Simulation other(again, test::with_response(o, Reflect{0.4, 0.3}));
        other.restore(saved);
        for (; i < 40; ++i) other.step();
        return other.state_hash().hex();
      }
      simulation.step();
    }
    EXPECT_GT(simulation.totals().collisions.pairs_touching, count / 10);
    return simulation.state_hash().hex();
  };
  const std::string one = run(1, -1);
  EXPECT_EQ(run(2, -1), one);
  EXPECT_EQ(run(5, -1), one);
  EXPECT_EQ(run(1, 25), one);
}

// Heaps that are divided into regions, on a floor that rises: the same bits for any number of threads, and from a
// checkpoint.
TEST(Collisions, HeapsAreTheSameOnAnyNumberOfThreads) {
  const double r = 0.01;
  const std::uint32_t across = 24;
  const double width = 2.1 * r * across;
  const std::size_t count = 8400;                          // the fewest that make two regions are 8192
  const int steps = 3 * std::max(5, test::scaled(6, 20));  // in fewer the heap does not touch the floor
  const MeshData mesh = box_of({6, 6, 6}, {width, width, 2.0 * width});
  std::vector<Vec3> shift(mesh.points.size());
  for (std::size_t i = 0; i < shift.size(); ++i)
    shift[i] = {0.0, 0.0, 2.0 * r * (1.0 - mesh.points[i].z / (2.0 * width))};
  const auto run = [&](unsigned threads, int save_at) {
    Environment environment(mesh, Threads{threads});
    SimulationOptions o = colliding(2e-3, 0.3, 0.3);
    o.gravity = {0.0, 0.0, -9.81};
    Simulation simulation(environment, test::with_response(o, Reflect{0.3, 0.3}));
    simulation.add(lattice(count, across, {1.05 * r, 1.05 * r, 1.2 * r}, 2.1 * r), {}, r);
    for (int i = 0; i < steps; ++i) {
      if (i == steps / 2) simulation.pull(shift, 0.01);
      if (i == save_at) {
        Environment again(mesh, Threads{threads});
        Simulation other(again, test::with_response(o, Reflect{0.3, 0.3}));
        other.restore(simulation.checkpoint());
        for (; i < steps; ++i) {
          if (i == steps / 2) other.pull(shift, 0.01);
          other.step();
        }
        return other.state_hash().hex();
      }
      simulation.step();
    }
    EXPECT_GT(simulation.totals().collisions.pairs_touching, count / 10);
    return simulation.state_hash().hex();
  };
  const std::string one = run(1, -1);
  for (const unsigned threads : test::all_or_first({3U, 2U, 7U})) EXPECT_EQ(run(threads, -1), one) << threads;
  EXPECT_EQ(run(2, steps / 3), one);
}

// A sphere on a slope of the box's floor: gravity is tilted instead.
TEST(Collisions, FrictionAngle) {
  for (const double share : {0.9, 1.1}) {
    Environment environment(box_of({10, 2, 2}, {10, 2, 2}), Threads{1});
    const double angle = std::atan(0.5) * share;
    SimulationOptions o = colliding(2e-3, 0.0, 0.5);
    o.gravity = {9.81 * std::sin(angle), 0.0, -9.81 * std::cos(angle)};
    Simulation simulation(environment, test::with_response(o, Reflect{0.0, 0.5}));
    const double r = 0.1;
    simulation.add(std::vector<Vec3>{{1.0, 1.0, r * (1.0 + resting_gap)}}, {}, r);
    const int steps = 400;
    for (int i = 0; i < steps; ++i) simulation.step();
    const double acceleration = std::max(0.0, 9.81 * (std::sin(angle) - 0.5 * std::cos(angle)));
    EXPECT_NEAR(simulation.velocities()[0].x, acceleration * steps * o.dt, 1e-9);
    EXPECT_NEAR(simulation.velocities()[0].z, 0.0, 1e-9);
  }
}

// Two spheres meet in the middle of a box, one bounces off a wall: as the formulas say.
TEST(Collisions, ReboundAtWallsAndEachOther) {
  Environment environment(box_of({4, 4, 4}, {4, 4, 4}), Threads{1});
  Simulation simulation(environment, test::with_response(colliding(0.01, 0.5, 0.0), Reflect{0.25, 0.0}));
  simulation.add(std::vector<Vec3>{{1.0, 2.0, 2.0}}, {1.0, 0.0, 0.0}, 0.2);
  simulation.add(std::vector<Vec3>{{3.0, 2.0, 2.0}}, {-1.0, 0.0, 0.0}, 0.2);
  simulation.add(std::vector<Vec3>{{0.5, 0.5, 0.5}}, {0.0, 0.0, -2.0}, 0.2);
  simulation.add(std::vector<Vec3>{{3.5, 3.5, 0.5}}, {0.0, 0.0, -50.0}, 0.2);  // too far to be near: its own contact
  simulation.add(std::vector<Vec3>{{0.5, 2.0, 2.0}}, {1.0, 0.0, 0.0});         // a point: meets no sphere
  for (int i = 0; i < 100; ++i) simulation.step();
  EXPECT_NEAR(simulation.velocities()[0].x, -0.5, 1e-12);
  EXPECT_NEAR(simulation.velocities()[1].x, 0.5, 1e-12);
  EXPECT_NEAR(simulation.velocities()[2].z, 0.5, 1e-12);
  EXPECT_NEAR(std::abs(simulation.velocities()[3].z), 12.5 * 0.25, 1e-9);
  EXPECT_NEAR(simulation.velocities()[4].x, 1.0, 1e-15);
}

// A floor that rises carries what lies on it.
TEST(Collisions, MovingWallsCarry) {
  const MeshData mesh = box_of({4, 4, 4}, {4, 4, 4});
  Environment environment(mesh, Threads{1});
  SimulationOptions o = colliding(0.01, 0.0, 0.3);
  o.gravity = {0, 0, -9.81};
  Simulation simulation(environment, test::with_response(o, Reflect{0.0, 0.3}));
  std::vector<Vec3> shift(mesh.points.size());
  for (std::size_t i = 0; i < shift.size(); ++i) shift[i] = {0.0, 0.0, 0.5 * (1.0 - mesh.points[i].z / 4.0)};
  const auto places = lattice(60, 4, {0.5, 0.5, 0.4}, 0.65);
  simulation.add(places, {}, 0.3);
  for (int i = 0; i < 150; ++i) simulation.step();
  simulation.pull(shift, 1.0);
  for (int i = 0; i < 150; ++i) simulation.step();
  for (const ParticleState& s : simulation.particles().states()) {
    EXPECT_FALSE(s.held);
    EXPECT_GE(s.position.z, 0.5 + 0.3 - 1e-9);
  }
  EXPECT_LT(deepest_overlap(simulation), 0.02 * 0.3);
  EXPECT_EQ(audit(environment.complex(), simulation.particles()).failed, 0U);
}

// Discs in the plane.
TEST(Collisions, InThePlane) {
  RectangleOptions rectangle;
  rectangle.cells = {6, 6};
  rectangle.size = {6.0, 6.0};
  Environment environment(generate_rectangle(rectangle), Threads{1});
  SimulationOptions o = colliding(0.01, 0.2, 0.3);
  o.gravity = {0, -9.81, 0};
  Simulation simulation(environment, test::with_response(o, Reflect{0.2, 0.3}));
  std::vector<Vec3> places;
  for (int i = 0; i < 40; ++i) places.push_back({0.5 + 0.62 * (i % 8) + 0.01 * (i % 3), 0.5 + 0.7 * (i / 8), 0.0});
  simulation.add(places, {}, 0.25);
  double peak = 0.0;
  for (int i = 0; i < 1500; ++i) {
    simulation.step();
    peak = std::max(peak, kinetic(simulation));
  }
  EXPECT_LT(kinetic(simulation), 1e-6 * peak);
  EXPECT_LT(deepest_overlap(simulation), 1e-3);
  for (const ParticleState& s : simulation.particles().states()) EXPECT_EQ(s.position.z, 0.0);
}

TEST(Collisions, RefuseWhatIsOutOfRange) {
  Environment environment(box_of({2, 2, 2}, {2, 2, 2}), Threads{1});
  const auto refused = [&](auto&& spoil) {
    SimulationOptions o = colliding(0.01, 0.5, 0.5);
    spoil(*o.collisions);
    EXPECT_THROW(Simulation(environment, o), InvalidArgument);
  };
  refused([](CollisionOptions& c) { c.restitution = 1.1; });
  refused([](CollisionOptions& c) { c.friction = -0.1; });
  refused([](CollisionOptions& c) { c.density = 0.0; });
  refused([](CollisionOptions& c) { c.iterations = 0; });
  Simulation simulation(environment, colliding(0.01, 0.5, 0.5));
  EXPECT_THROW(simulation.add(std::vector<Vec3>{{1, 1, 1}}, {}, -1.0), InvalidArgument);
  EXPECT_THROW(simulation.add_random(1, {}, std::nan("")), InvalidArgument);
  EXPECT_EQ(simulation.particles().size(), 0U);
}

}  // namespace dartcast::collisions_test
