#include "dynamics/contact_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dynamics/sphere_pairs.hpp"
#include "dynamics/sphere_touch.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::contact_solver_test {

using test::random_vector;

// Spheres in free space, or above planes.
struct Crowd {
  std::vector<Vec3> positions;
  std::vector<Vec3> velocities;
  std::vector<double> radii;
  std::vector<double> inverse_masses;
  std::vector<std::uint64_t> ids;
  std::vector<Vec3> displacements;
  SolverOptions options;
  ContactSolver solver;
  std::vector<WallContact> walls;

  void add(const Vec3& position, const Vec3& velocity, double radius, double mass) {
    ids.push_back(positions.size());
    positions.push_back(position);
    velocities.push_back(velocity);
    radii.push_back(radius);
    inverse_masses.push_back(1.0 / mass);
    displacements.emplace_back();
  }

  [[nodiscard]] std::vector<PairContact> contacts() const {
    std::vector<SphereMotion> spheres;
    for (std::size_t i = 0; i < positions.size(); ++i)
      spheres.push_back({positions[i], velocities[i] * options.dt, radii[i]});
    PairFinder finder;
    std::vector<PairContact> found;
    for (const SpherePair& p : finder.find(spheres)) {
      const Approach a = approach(spheres[p.a], spheres[p.b]);
      if (a.distance <= 0.0) found.push_back({p.a, p.b, a.normal, a.gap});
    }
    return found;
  }

  void step(std::span<const PairContact> pairs) {
    solver.solve(pairs, walls, {ids, inverse_masses, velocities, displacements}, options);
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += displacements[i];
  }
  void step() { step(contacts()); }

  [[nodiscard]] Vec3 momentum() const {
    Vec3 sum;
    for (std::size_t i = 0; i < velocities.size(); ++i) sum += velocities[i] * (1.0 / inverse_masses[i]);
    return sum;
  }
  [[nodiscard]] double energy() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < velocities.size(); ++i) sum += dot(velocities[i], velocities[i]) / inverse_masses[i];
    return 0.5 * sum;
  }
};

// v1' = (m1 v1 + m2 v2 - m2 e (v1 - v2)) / (m1 + m2), and the other way round, along the line of centres.
TEST(ContactSolver, TwoBodiesReboundByTheFormula) {
  Random random(1);
  for (int i = 0; i < std::max(5, test::scaled(200, 5000)); ++i) {
    Crowd crowd;
    crowd.options.dt = 0.5;
    crowd.options.restitution = random.uniform();
    const double m1 = random.uniform(0.1, 10.0);
    const double m2 = random.uniform(0.1, 10.0);
    const Vec3 u1 = random_vector(random, 1.0);
    const Vec3 u2 = random_vector(random, 1.0);
    crowd.add({0, 0, 0}, u1, random.uniform(0.1, 0.5), m1);
    crowd.add(random_vector(random, 1.0), u2, random.uniform(0.1, 0.5), m2);
    const auto contacts = crowd.contacts();
    crowd.step();
    Vec3 v1 = u1;
    Vec3 v2 = u2;
    const double nearing = contacts.empty() ? 0.0 : dot(u1 - u2, contacts.front().normal);
    if (nearing > 0.0) {
      const Vec3 impulse =
          contacts.front().normal * ((1.0 + crowd.options.restitution) * nearing / (1.0 / m1 + 1.0 / m2));
      v1 -= impulse * (1.0 / m1);
      v2 += impulse * (1.0 / m2);
    }
    EXPECT_LE(norm(crowd.velocities[0] - v1), 1e-13);
    EXPECT_LE(norm(crowd.velocities[1] - v2), 1e-13);
    const bool overlap = !contacts.empty() && contacts.front().gap < 0.0;
    if (!overlap) {
      EXPECT_GE(norm(crowd.positions[1] - crowd.positions[0]), crowd.radii[0] + crowd.radii[1] - 1e-13);
    }
  }
}

// Friction takes at most its share of the normal impulse from the tangential velocity, and never reverses it.
TEST(ContactSolver, FrictionOfTwoBodies) {
  for (const double friction : {0.1, 0.3, 10.0}) {
    Crowd crowd;
    crowd.options.dt = 1.0;
    crowd.options.restitution = 0.5;
    crowd.options.friction = friction;
    crowd.add({0, 0, 0}, {1.0, 0.4, 0.0}, 0.5, 1.0);
    crowd.add({1, 0, 0}, {-1.0, -0.4, 0.0}, 0.5, 1.0);
    crowd.step(std::vector<PairContact>{{0, 1, {1, 0, 0}, 0.0}});
    EXPECT_NEAR(crowd.velocities[0].x, -0.5, 1e-15);
    EXPECT_NEAR(crowd.velocities[0].y, std::max(0.0, 0.4 - friction * 1.5), 1e-15);
    EXPECT_NEAR(crowd.velocities[1].y, -std::max(0.0, 0.4 - friction * 1.5), 1e-15);
  }
}

// All contacts of a gas that collides and overlaps: momentum is kept, energy not gained.
TEST(ContactSolver, KeepsMomentum) {
  for (const double friction : {0.0, 0.5}) {
    Random random(2);
    Crowd crowd;
    crowd.options.dt = 0.02;
    crowd.options.restitution = 0.8;
    crowd.options.friction = friction;
    for (int i = 0; i < 1000; ++i)
      crowd.add(random_vector(random, 1.0), random_vector(random, 1.0), random.uniform(0.02, 0.1),
                random.uniform(0.1, 2));
    const Vec3 before = crowd.momentum();
    double sum = 0.0;
    for (std::size_t i = 0; i < 1000; ++i) sum += norm(crowd.velocities[i]) / crowd.inverse_masses[i];
    double energy = crowd.energy();
    std::size_t contacts = 0;
    const int steps = std::max(2, test::scaled(20, 200));
    for (int i = 0; i < steps; ++i) {
      crowd.step();
      contacts += crowd.solver.loaded_pairs();
      EXPECT_LE(crowd.energy(), energy * (1.0 + 1e-12));
      energy = crowd.energy();
    }
    EXPECT_GT(contacts, 50U * static_cast<std::size_t>(std::min(steps, 20)));  // later they have dispersed
    EXPECT_LT(norm(crowd.momentum() - before), 1e-14 * sum);
  }
}

// Spheres that are put into each other part at the rate told, and have no velocity from it.
TEST(ContactSolver, PartsOverlapsWithoutEnergy) {
  Random random(3);
  Crowd crowd;
  for (int i = 0; i < 200; ++i) crowd.add(random_vector(random, 0.5), {}, 0.1, random.uniform(0.5, 2.0));
  crowd.add(crowd.positions[0], {}, 0.1, 1.0);  // centres that coincide
  const auto deepest = [&] {
    double depth = 0.0;
    for (const PairContact& c : crowd.contacts()) depth = std::max(depth, -c.gap);
    return depth;
  };
  const double before = deepest();
  EXPECT_EQ(before, 0.2);
  for (int i = 0; i < 400; ++i) {
    crowd.step();
    EXPECT_EQ(crowd.energy(), 0.0);
  }
  EXPECT_LT(deepest(), 1e-2 * before);
}

// A pair may come as near as its gap allows, not nearer; one that passes by is not touched.
TEST(ContactSolver, GapsAreUsedUp) {
  Crowd crowd;
  crowd.options.dt = 1.0;
  crowd.add({0, 0, 0}, {1, 0, 0}, 0.5, 1.0);
  crowd.add({1.25, 0, 0}, {-1, 0, 0}, 0.5, 1.0);
  crowd.step();
  EXPECT_DOUBLE_EQ(crowd.positions[0].x, 0.125);
  EXPECT_DOUBLE_EQ(crowd.positions[1].x, 1.125);
  Crowd hit;
  hit.options.dt = 1.0;
  hit.options.restitution = 1.0;
  hit.add({0, 0, 0}, {4, 0, 0}, 0.5, 1.0);
  hit.add({2, 1.0001, 0}, {0, 0, 0}, 0.5, 1.0);
  std::vector<SphereMotion> spheres = {{{0, 0, 0}, {4, 0, 0}, 0.5}, {{2, 1.0001, 0}, {}, 0.5}};
  const Approach near = approach(spheres[0], spheres[1]);
  hit.step(std::vector<PairContact>{{0, 1, near.normal, near.gap}});
  EXPECT_EQ(hit.positions[0], (Vec3{4, 0, 0}));
  EXPECT_EQ(hit.velocities[1], (Vec3{}));
}

// On a plane tilted by an angle: below the friction angle it sticks, above it slides with g (sin - mu cos).
TEST(ContactSolver, FrictionAngle) {
  const double friction = 0.5;
  const double dt = 1e-3;
  const double gravity = 9.81;
  for (const double share : {0.5, 0.99, 1.01, 1.5}) {
    const double angle = std::atan(friction) * share;
    const Vec3 normal = {-std::sin(angle), 0.0, std::cos(angle)};
    const Vec3 downhill = {-std::cos(angle), 0.0, -std::sin(angle)};
    Crowd crowd;
    crowd.options.dt = dt;
    crowd.options.resting_speed = 2.0 * gravity * dt;
    crowd.add(normal * 0.1, {}, 0.1, 2.0);
    const int steps = 1000;
    for (int i = 0; i < steps; ++i) {
      crowd.velocities[0].z -= gravity * dt;
      crowd.walls = {{0, normal, dot(crowd.positions[0], normal) - 0.1, {}, 0.3, friction}};
      crowd.step();
    }
    const double acceleration = std::max(0.0, gravity * (std::sin(angle) - friction * std::cos(angle)));
    EXPECT_NEAR(dot(crowd.velocities[0], downhill), acceleration * dt * steps, 1e-9) << share;
    EXPECT_NEAR(dot(crowd.positions[0], normal), 0.1, 1e-12);
    if (share < 1.0) {
      EXPECT_LT(norm(crowd.velocities[0]), 1e-12);
    }
  }
}

TEST(ContactSolver, WallsMoveAndRebound) {
  Crowd crowd;
  crowd.options.dt = 1.0;
  crowd.add({0, 0, 1}, {0, 0, -1}, 0.5, 3.0);
  crowd.walls = {{0, {0, 0, 1}, 0.0, {0.0, 0.0, 2.0}, 0.5, 0.0}};
  crowd.step();
  EXPECT_DOUBLE_EQ(crowd.velocities[0].z, 2.0 + 0.5 * 3.0);
  EXPECT_DOUBLE_EQ(crowd.displacements[0].z, 2.0 + 0.5 * 3.0);     // it is there, and rebounds at once
  crowd.walls = {{0, {0, 0, 1}, 0.0, {0.0, 0.0, 3.4}, 1.0, 0.0}};  // slower than it: no contact
  crowd.step();
  EXPECT_DOUBLE_EQ(crowd.velocities[0].z, 3.5);
}

// A pair that has no other contact moves to where it touches, and on from there; another contact stops it there.
TEST(ContactSolver, LonePairsReboundAtTheirTime) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    Crowd crowd;
    crowd.options.dt = 0.5;
    crowd.options.restitution = random.uniform(0.1, 1.0);
    crowd.add({0, 0, 0}, {random.uniform(1.0, 2.0), 0, 0.25}, 0.5, random.uniform(0.5, 2.0));
    const double gap = random.uniform(0.0, 0.5);
    crowd.add({1.0 + gap, 0, 0}, {random.uniform(-1.0, 0.0), 0, 0.25}, 0.5, random.uniform(0.5, 2.0));
    const std::vector<Vec3> before = crowd.velocities;
    const std::vector<Vec3> start = crowd.positions;
    const double nearing = before[0].x - before[1].x;
    crowd.step();
    const double touch = std::min(gap / nearing, crowd.options.dt);
    for (const std::size_t k : {0U, 1U}) {
      const Vec3 expected = start[k] + before[k] * touch + crowd.velocities[k] * (crowd.options.dt - touch);
      EXPECT_LE(norm(crowd.positions[k] - expected), 1e-14) << i;
    }
    if (gap >= nearing * crowd.options.dt) continue;
    EXPECT_NEAR(crowd.velocities[1].x - crowd.velocities[0].x, crowd.options.restitution * nearing, 1e-14);
    crowd.positions = start;
    crowd.velocities = before;
    crowd.walls = {{0, {0, 1, 0}, 1.0, {}, 0.0, 0.0}};
    crowd.solver.set_cached_impulses({});
    crowd.step();
    EXPECT_NEAR(crowd.positions[1].x - crowd.positions[0].x, 1.0, 1e-14);
  }
}

// A lone sphere that meets what cannot move keeps the energy of the moment, of which the acceleration is a part: one half
// of |v + a dt / 2|^2, less a x (docs/method.md, "Reflection").
TEST(ContactSolver, LoneReboundsKeepTheEnergyOfTheMoment) {
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    Crowd crowd;
    crowd.options.dt = 0.1;
    crowd.options.restitution = 1.0;
    crowd.options.acceleration = random_vector(random, 2.0);
    crowd.add({0, 0, 0}, {random.uniform(2.0, 3.0), 0.5, 0.25}, 0.5, random.uniform(0.5, 2.0));
    const double gap = random.uniform(0.0, 0.17);
    const bool wall = i % 2 == 0;
    if (wall) {
      crowd.walls = {{0, {-1, 0, 0}, gap, {}, 1.0, 0.0}};
    } else {
      crowd.add({1.0 + gap, 0, 0}, {}, 0.5, 1.0);
      crowd.inverse_masses[1] = 0.0;
    }
    const auto energy = [&] {
      const Vec3 v = crowd.velocities[0] + crowd.options.acceleration * (0.5 * crowd.options.dt);
      return 0.5 * dot(v, v) - dot(crowd.options.acceleration, crowd.positions[0]);
    };
    const double start = energy();
    crowd.velocities[0] += crowd.options.acceleration * crowd.options.dt;
    const std::vector<PairContact> pair = {{0, 1, {1, 0, 0}, gap}};
    crowd.step(wall ? std::span<const PairContact>{} : pair);
    EXPECT_LT(crowd.velocities[0].x, -1.5);
    EXPECT_NEAR(energy(), start, 1e-13) << i;
  }
}

// One that cannot be pushed stays; the result does not depend on the order of spheres and contacts.
TEST(ContactSolver, OrderDoesNotMatter) {
  Random random(4);
  Crowd first;
  first.options.dt = 0.05;
  first.options.restitution = 0.4;
  first.options.friction = 0.3;
  for (int i = 0; i < 100; ++i)
    first.add(random_vector(random, 0.5), random_vector(random, 1.0), random.uniform(0.05, 0.1),
              random.uniform(0.5, 2.0));
  first.inverse_masses[5] = first.inverse_masses[6] = 0.0;
  const Vec3 fixed = first.velocities[5];
  std::vector<std::uint32_t> order(100);
  std::iota(order.begin(), order.end(), 0U);
  for (std::uint32_t i = 99; i > 0; --i) std::swap(order[i], order[random.below(i + 1)]);
  Crowd second;
  second.options = first.options;
  std::vector<std::uint32_t> place(100);
  for (std::uint32_t k = 0; k < 100; ++k) {
    const std::uint32_t i = order[k];
    second.add(first.positions[i], first.velocities[i], first.radii[i], 1.0);
    second.ids.back() = i;
    second.inverse_masses.back() = first.inverse_masses[i];
    place[i] = k;
  }
  for (int step = 0; step < 5; ++step) {
    for (const std::uint32_t i : {3U, 1U, 2U}) {
      first.walls.push_back({i, {0, 0, 1}, 0.01, {}, 0.2, 0.1});
      second.walls.push_back({place[i], {0, 0, 1}, 0.01, {}, 0.2, 0.1});
      first.walls.insert(first.walls.begin(), {i, {0, 1, 0}, 0.01, {}, 0.2, 0.1});
      second.walls.push_back({place[i], {0, 1, 0}, 0.01, {}, 0.2, 0.1});
    }
    std::vector<PairContact> contacts = first.contacts();
    EXPECT_GT(contacts.size(), 10U);
    std::vector<PairContact> mirrored;
    for (const PairContact& c : contacts) mirrored.push_back({place[c.b], place[c.a], -c.normal, c.gap});
    std::reverse(mirrored.begin(), mirrored.end());
    first.step(contacts);
    second.step(mirrored);
    for (std::uint32_t i = 0; i < 100; ++i) {
      EXPECT_EQ(first.positions[i], second.positions[place[i]]);
      EXPECT_EQ(first.velocities[i], second.velocities[place[i]]);
    }
    EXPECT_TRUE(std::equal(first.solver.cached_impulses().begin(), first.solver.cached_impulses().end(),
                           second.solver.cached_impulses().begin(), second.solver.cached_impulses().end()));
  }
  EXPECT_EQ(first.velocities[5], fixed);
}

// Started from the kept impulses, a stack of spheres needs no more than a few iterations to rest.
TEST(ContactSolver, WarmStartCarriesAStack) {
  const auto fall = [](bool keep) {
    Crowd crowd;
    crowd.options.dt = 0.01;
    crowd.options.resting_speed = 0.2;
    crowd.options.iterations = 4;
    for (int i = 0; i < 20; ++i) crowd.add({0, 0, 0.5 + i}, {}, 0.5, 1.0);
    for (int step = 0; step < 2000; ++step) {
      for (Vec3& v : crowd.velocities) v.z -= 9.81 * crowd.options.dt;
      crowd.walls = {{0, {0, 0, 1}, crowd.positions[0].z - 0.5, {}, 0.0, 0.0}};
      std::vector<PairContact> contacts;
      for (std::uint32_t i = 0; i + 1 < 20; ++i)
        contacts.push_back({i, i + 1, {0, 0, 1}, crowd.positions[i + 1].z - crowd.positions[i].z - 1.0});
      const std::vector<CachedImpulse> kept(crowd.solver.cached_impulses().begin(),
                                            crowd.solver.cached_impulses().end());
      crowd.solver.set_cached_impulses(keep ? std::span<const CachedImpulse>(kept) : std::span<const CachedImpulse>());
      crowd.step(contacts);
    }
    return crowd.energy();
  };
  EXPECT_LT(fall(true), 1e-12);
  EXPECT_GT(fall(false), 1e-3);
}

TEST(ContactSolver, RefusesWhatIsOutOfRange) {
  const auto refuses = [](auto&& spoil) {
    Crowd crowd;
    crowd.add({0, 0, 0}, {1, 0, 0}, 0.5, 1.0);
    crowd.add({1, 0, 0}, {0, 0, 0}, 0.5, 1.0);
    std::vector<PairContact> pairs = {{0, 1, {1, 0, 0}, 0.0}};
    spoil(crowd, pairs);
    const auto velocities = crowd.velocities;
    EXPECT_THROW(crowd.step(pairs), InvalidArgument);
    EXPECT_EQ(crowd.velocities, velocities);
  };
  refuses([](Crowd& c, auto&) { c.options.dt = 0.0; });
  refuses([](Crowd& c, auto&) { c.options.restitution = 1.5; });
  refuses([](Crowd& c, auto&) { c.options.friction = -1.0; });
  refuses([](Crowd& c, auto&) { c.options.position_correction = std::nan(""); });
  refuses([](Crowd& c, auto&) { c.options.resting_speed = -1.0; });
  refuses([](Crowd& c, auto&) { c.ids.pop_back(); });
  refuses([](Crowd&, auto& pairs) { pairs[0].b = 2; });
  refuses([](Crowd&, auto& pairs) { pairs[0].b = 0; });
  refuses([](Crowd& c, auto&) { c.walls.push_back({2, {0, 0, 1}, 0.0, {}, 0.0, 0.0}); });
  refuses([](Crowd& c, auto&) { c.walls.push_back({1, {0, 0, 1}, 0.0, {}, 2.0, 0.0}); });
}

}  // namespace dartcast::contact_solver_test
