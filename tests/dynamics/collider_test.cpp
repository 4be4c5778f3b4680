// A step's collisions against all pairs, one by one.
#include "dynamics/collider.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "support/sphere_checks.hpp"

namespace dartcast::collide_test {

constexpr double dt = 0.05;

// Spheres in a box with blocked cells, with the motions that they want.
struct Cloud {
  Environment environment;
  Particles particles;
  std::vector<std::uint64_t> ids;
  std::vector<double> radii;
  std::vector<double> inverse_masses;
  std::vector<Vec3> velocities;
  std::vector<WallContact> walls;

  Cloud(std::size_t count, std::uint64_t seed, unsigned threads = 1)
      : environment(test::cubes(4, CellType::hexahedron, 0.15, 0.2), Threads{threads}) {
    Random random(seed);
    const auto vector = [&](double most) {
      return Vec3{random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
    };
    std::vector<Vec3> places(count);
    for (Vec3& x : places) x = Vec3{2.0, 2.0, 2.0} + vector(1.99);
    environment.add(particles, places);
    const std::size_t added = particles.size();
    ids.resize(added);
    for (std::size_t i = 0; i < added; ++i) {
      ids[i] = (i * 7919U) % 104729U;  // in another order than the particles
      radii.push_back(i % 10 == 0 ? 0.0 : random.uniform(0.02, 0.2));
      inverse_masses.push_back(i % 13 == 0 ? 0.0 : random.uniform(0.5, 2.0));
      velocities.push_back(vector(4.0));
      const Vec3 n = vector(1.0);
      if (i % 9 == 1)
        walls.push_back({std::uint32_t(i), n * (1.0 / norm(n)), random.uniform(-0.01, 0.02), {}, 0.3, 0.2});
    }
  }

  // Without any search.
  [[nodiscard]] std::vector<PairContact> all_contacts(CollisionCounts& counts) const {
    std::vector<PairContact> contacts;
    for (std::uint32_t i = 0; i < radii.size(); ++i) {
      for (std::uint32_t j = i + 1; j < radii.size(); ++j) {
        if (radii[i] == 0.0 || radii[j] == 0.0) continue;
        const std::uint32_t a = ids[i] < ids[j] ? i : j;
        const std::uint32_t b = i + j - a;
        const auto motion = [&](std::uint32_t k) {
          return SphereMotion{particles[k].position, velocities[k] * dt, radii[k]};
        };
        const auto room = [&](std::uint32_t k) {
          return radii[k] / 16.0 + std::min(norm(velocities[k] * dt), radii[k]);
        };
        const Approach near = approach(motion(a), motion(b));
        if (near.distance > std::max(room(a), room(b))) continue;
        if (separated(environment.complex(), particles[a], particles[b])) continue;
        contacts.push_back({a, b, near.normal, near.gap - std::min(radii[a], radii[b]) / 1024.0});
        ++counts.pairs_near;
        if (near.distance >= 0.0) continue;
        ++counts.overlaps;
        counts.deepest = std::max(counts.deepest, -near.distance);
      }
    }
    return contacts;
  }
};

// The walls that the solver takes, sphere by sphere: not those of a sphere that comes to one faster than it would at
// rest, or leaves one, comes to none slowly, and that no other can reach at the speeds that both have.
std::vector<WallContact> solved_walls(const Cloud& cloud, std::span<const PairContact> pairs, const SolverOptions& o) {
  std::vector<WallContact> solved;
  for (std::uint32_t i = 0; i < cloud.radii.size(); ++i) {
    const auto of_sphere = [&](const WallContact& w) { return w.sphere == i; };
    const auto nearing = [&](const WallContact& w) { return -dot(cloud.velocities[i] - w.wall_velocity, w.normal); };
    const auto gap = [&](const WallContact& w) { return w.gap - cloud.radii[i] / 1024.0; };
    const bool shared = std::any_of(pairs.begin(), pairs.end(), [&](const PairContact& p) {
      return (p.a == i || p.b == i) && p.gap <= (norm(cloud.velocities[p.a]) + norm(cloud.velocities[p.b])) * o.dt;
    });
    const auto slow = [&](const WallContact& w) {
      return of_sphere(w) && nearing(w) > 0.0 && nearing(w) <= o.resting_speed && nearing(w) * o.dt > gap(w);
    };
    const auto own = [&](const WallContact& w) {
      return of_sphere(w) && (nearing(w) <= 0.0 || (nearing(w) > o.resting_speed && nearing(w) * o.dt > gap(w)));
    };
    const bool lone = !shared && std::none_of(cloud.walls.begin(), cloud.walls.end(), slow) &&
                      std::any_of(cloud.walls.begin(), cloud.walls.end(), own);
    for (const WallContact& w : cloud.walls) {
      if (!of_sphere(w) || lone) continue;
      solved.push_back(w);
      solved.back().gap = gap(w);
    }
  }
  return solved;
}

SolverOptions options() {
  SolverOptions o;
  o.dt = dt;
  o.restitution = 0.4;
  o.friction = 0.3;
  o.resting_speed = 0.1;
  return o;
}

// Distances without walls that are sure to be true: 0, or what is measured from all walls.
std::vector<double> clearances(const Cloud& cloud) {
  const auto walls = test::all_walls(cloud.environment.complex(), false);
  std::vector<double> room;
  for (std::size_t i = 0; i < cloud.radii.size(); ++i) {
    double least = std::numeric_limits<double>::max();
    for (const MovingTriangle& w : walls)
      least = std::min(least, nearest_on_triangle(w.to, cloud.particles[i].position).distance);
    room.push_back(i % 3 == 0 ? 0.0 : least);
  }
  return room;
}

TEST(Collider, FindsAndSolvesWhatAllPairsSay) {
  for (const std::uint64_t seed : {1U, 2U}) {
    Cloud cloud(std::max<std::size_t>(600, test::scaled<std::size_t>(600, 2000)), seed);
    CollisionCounts expected;
    const std::vector<PairContact> pairs = cloud.all_contacts(expected);
    const std::vector<WallContact> walls = solved_walls(cloud, pairs, options());
    EXPECT_LT(walls.size(), cloud.walls.size());
    std::vector<Vec3> velocities = cloud.velocities;
    std::vector<Vec3> displacements(velocities.size());
    ContactSolver solver;
    solver.solve(pairs, walls, {cloud.ids, cloud.inverse_masses, velocities, displacements}, options());
    EXPECT_GT(expected.overlaps, 20U);
    EXPECT_GT(solver.loaded_pairs(), 20U);
    EXPECT_GT(solver.loaded_walls(), 5U);
    for (const bool known : {false, true}) {
      std::vector<Vec3> found = cloud.velocities;
      std::vector<Vec3> moved(found.size());
      const std::vector<double> room = known ? clearances(cloud) : std::vector<double>{};
      Collider collider;
      const CollisionCounts counts =
          collider.collide(cloud.environment.complex(),
                           {cloud.particles.states(), cloud.ids, cloud.radii, cloud.inverse_masses, room, found, moved},
                           cloud.walls, options(), Threads{1});
      EXPECT_EQ(counts.pairs_near, expected.pairs_near);
      EXPECT_GE(counts.pairs_tested, counts.pairs_near);
      EXPECT_EQ(counts.overlaps, expected.overlaps);
      EXPECT_EQ(counts.deepest, expected.deepest);
      EXPECT_EQ(counts.pairs_touching, solver.loaded_pairs());
      EXPECT_EQ(counts.walls_touching, solver.loaded_walls());
      EXPECT_EQ(collider.new_walls().size(), solver.loaded_walls());  // no impulse is of a step before
      EXPECT_EQ(found, velocities);
      EXPECT_EQ(moved, displacements);
      // Impulses that the solver keeps in memory are not taken for those of this step.
      collider.solver().set_cached_impulses({});
      found = cloud.velocities;
      const CollisionCounts again =
          collider.collide(cloud.environment.complex(),
                           {cloud.particles.states(), cloud.ids, cloud.radii, cloud.inverse_masses, room, found, moved},
                           cloud.walls, options(), Threads{1});
      EXPECT_EQ(again.pairs_near, counts.pairs_near);
      EXPECT_EQ(found, velocities);
    }
  }
}

// All pairs that come near each other by the rule are given to the solver, no others.
TEST(Collider, NearPairsAgainstAll) {
  for (const double speed : {0.0, 0.01, 0.3, 3.0}) {
    test::Swarm swarm(test::cubes(3), 5);
    const int count = std::max(30, test::scaled(400, 1500));
    for (int i = 0; i < count; ++i) {
      const Vec3 x = {swarm.random.uniform(0.1, 2.9), swarm.random.uniform(0.1, 2.9), swarm.random.uniform(0.1, 2.9)};
      swarm.add(x, swarm.random.uniform(0.1, 0.5) * 2.8 / std::cbrt(count), swarm.vector(speed));
    }
    const std::size_t size = swarm.radii.size();
    std::vector<std::uint64_t> ids(size);
    std::vector<SphereMotion> spheres;
    std::vector<double> rooms;
    for (std::size_t i = 0; i < size; ++i) {
      ids[i] = i;
      spheres.push_back({swarm.particles[i].position, swarm.velocities[i] * 0.1, swarm.radii[i]});
      rooms.push_back(near_share * swarm.radii[i] + std::min(norm(spheres[i].displacement), swarm.radii[i]));
    }
    std::uint64_t near = 0;
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = i + 1; j < size; ++j)
        near += approach(spheres[i], spheres[j]).distance <= std::max(rooms[i], rooms[j]) ? 1U : 0U;
    }
    const std::vector<double> inverse_masses(size, 1.0);
    std::vector<Vec3> displacements(size);
    SolverOptions slow = options();
    slow.dt = 0.1;
    Collider collider;
    const CollisionCounts counts = collider.collide(
        swarm.environment.complex(),
        {swarm.particles.states(), ids, swarm.radii, inverse_masses, {}, swarm.velocities, displacements}, {}, slow,
        Threads{1});
    EXPECT_EQ(counts.pairs_near, near);
    EXPECT_GE(counts.pairs_tested, near);
    EXPECT_GT(near, size / 4);
  }
}

// Another order of particles, other threads: the same bits.
TEST(Collider, IsTheSameForAnyOrderAndThreads) {
  std::vector<Vec3> expected;
  for (const unsigned threads : {1U, 2U, 5U}) {
    for (const bool turned : {false, true}) {
      Cloud cloud(std::max<std::size_t>(60, test::scaled<std::size_t>(900, 2000)), 3, threads);
      const std::size_t count = cloud.radii.size();
      std::vector<std::size_t> order(count);
      std::iota(order.begin(), order.end(), std::size_t{0});
      if (turned) std::reverse(order.begin(), order.end());
      std::vector<ParticleState> states;
      std::vector<std::uint64_t> ids;
      std::vector<double> radii;
      std::vector<double> inverse;
      std::vector<Vec3> velocities;
      for (const std::size_t i : order) {
        states.push_back(cloud.particles[i]);
        ids.push_back(cloud.ids[i]);
        radii.push_back(cloud.radii[i]);
        inverse.push_back(cloud.inverse_masses[i]);
        velocities.push_back(cloud.velocities[i]);
      }
      std::vector<WallContact> walls = cloud.walls;
      for (WallContact& w : walls) {
        if (turned) w.sphere = static_cast<std::uint32_t>(count - 1 - w.sphere);
      }
      std::vector<Vec3> moved(count);
      Collider collider;
      collider.collide(cloud.environment.complex(), {states, ids, radii, inverse, {}, velocities, moved}, walls,
                       options(), Threads{threads});
      if (turned) std::reverse(velocities.begin(), velocities.end());
      if (expected.empty()) expected = velocities;
      EXPECT_EQ(velocities, expected) << threads << turned;
    }
  }
}

TEST(Collider, CountsAddUp) {
  CollisionCounts a = {1, 2, 3, 4, 5, 0.5};
  a += CollisionCounts{10, 20, 30, 40, 50, 0.25};
  EXPECT_EQ(a.pairs_tested, 11U);
  EXPECT_EQ(a.pairs_near, 22U);
  EXPECT_EQ(a.pairs_touching, 33U);
  EXPECT_EQ(a.walls_touching, 44U);
  EXPECT_EQ(a.overlaps, 55U);
  EXPECT_EQ(a.deepest, 0.5);
}

TEST(Collider, RefusesSpansThatDiffer) {
  Cloud cloud(50, 4);
  std::vector<Vec3> moved(cloud.radii.size());
  Collider collider;
  const auto collide = [&](std::span<const double> radii, std::span<const double> room) {
    collider.collide(cloud.environment.complex(),
                     {cloud.particles.states(), cloud.ids, radii, cloud.inverse_masses, room, cloud.velocities, moved},
                     {}, options(), Threads{1});
  };
  const std::vector<double> few(3, 0.1);
  EXPECT_THROW(collide(few, {}), InvalidArgument);
  EXPECT_THROW(collide(cloud.radii, few), InvalidArgument);
}

}  // namespace dartcast::collide_test
