// Contacts of colliding spheres with walls: reported once, where and when they are, and without loss of energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/random.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "dynamics/collider.hpp"
#include "support/point_block.hpp"
#include "support/tier.hpp"

namespace dartcast::collision_contacts_test {

constexpr double g = 9.81;

MeshData box_of(const Vec3& size, std::array<std::uint32_t, 3> cells = {4, 4, 4}) {
  BoxOptions o;
  o.cells = cells;
  o.size = size;
  return generate_box(o);
}

SimulationOptions falling(double dt, const WallResponse& walls, bool collide = true, double restitution = 0.0) {
  SimulationOptions o;
  o.dt = dt;
  o.gravity = {0.0, 0.0, -g};
  o.response = walls;
  if (collide) o.collisions = CollisionOptions{.restitution = restitution};
  return o;
}

// A contact as a report has it.
struct Seen {
  std::uint64_t step = 0;
  std::uint64_t id = 0;
  Contact contact;
  WallHit wall;

  [[nodiscard]] double time(double dt) const { return (double(step) + contact.time_of_impact) * dt; }
};

void take_step(Simulation& simulation, std::vector<Seen>& seen) {
  const SimulationStep& step = simulation.step();
  for (std::size_t k = 0; k < step.contacts().size(); ++k) {
    const Contact& c = step.contacts()[k];
    seen.push_back({simulation.steps() - 1, step.contact_ids[k], c, step.report.contacts.walls_of(c).front()});
  }
}

std::vector<Seen> run(Simulation& simulation, int steps) {
  std::vector<Seen> seen;
  for (int i = 0; i < steps; ++i) take_step(simulation, seen);
  return seen;
}

// The energy of a unit of mass that free fall keeps (docs/method.md, "Reflection").
double energy_of_leapfrog(const Simulation& simulation, std::size_t i) {
  const Vec3 v = simulation.velocities()[i] + simulation.options().gravity * (0.5 * simulation.options().dt);
  return 0.5 * dot(v, v) - dot(simulation.options().gravity, simulation.particles()[i].position);
}

// Restitution 1 for 8 s, from where a sphere has 6.4 J/kg above the floor: the energy stays, and with it the height.
TEST(CollisionContacts, BouncesKeepTheEnergy) {
  constexpr double r = 0.5;
  constexpr double above = 6.4;
  for (const double dt : {1e-3, 4e-3}) {
    Environment environment(box_of({4, 4, 4}), Threads{1});
    Simulation simulation(environment, falling(dt, Reflect{1.0}, true, 1.0));
    simulation.add(std::vector<Vec3>{{1.3, 1.7, r + above / g}}, {}, r);
    const double start = energy_of_leapfrog(simulation, 0);
    double highest = 0.0;
    double lowest = 4.0;
    const int steps = static_cast<int>(8.0 / dt);
    for (int i = 0; i < steps; ++i) {
      simulation.step();
      const double z = simulation.particles()[0].position.z;
      lowest = std::min(lowest, z);
      if (i * dt > 7.0) highest = std::max(highest, z);
      ASSERT_NEAR(energy_of_leapfrog(simulation, 0), start, 1e-3 * above) << i;
    }
    EXPECT_NEAR(g * (highest - r), above, 1e-3 * above) << dt;
    EXPECT_GE(lowest, r * (1.0 - 1e-12));
    // Half a period is the fall.
    const double fall = std::sqrt(2.0 * above) / g;
    EXPECT_EQ(simulation.contact_counts()[0], static_cast<std::uint32_t>((8.0 / fall + 1.0) / 2.0));
  }
}

// A block on the floor: 4 cells of 64.
MeshData box_with_block() {
  MeshData mesh = box_of({16, 16, 16});
  mesh.free.assign(mesh.cell_count(), 1);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    Vec3 x;
    for (const std::uint32_t p : mesh.cell(c)) x += mesh.points[p] * 0.125;
    if (std::abs(x.x - 8.0) < 4.0 && std::abs(x.y - 8.0) < 4.0 && x.z < 4.0) mesh.free[c] = 0;
  }
  return mesh;
}

// Contacts of a sphere that falls onto an edge of the block, and comes to rest there.
TEST(CollisionContacts, LoneSpheresReportAsWithoutCollisions) {
  constexpr double dt = 0.01;
  const auto all = [&](bool collide) {
    Environment environment(box_with_block(), Threads{1});
    Simulation simulation(environment, falling(dt, Reflect{0.5}, collide));
    simulation.add(std::vector<Vec3>{{6.0, 8.0, 12.5}}, {}, 3.0);
    std::vector<Seen> seen = run(simulation, 400);
    EXPECT_EQ(simulation.contact_counts()[0], seen.size());
    const auto& kinds = simulation.totals().counters.contacts;
    EXPECT_EQ(kinds[0] + kinds[1] + kinds[2], seen.size());
    return seen;
  };
  const std::vector<Seen> alone = all(false);
  const std::vector<Seen> colliding = all(true);
  ASSERT_GE(colliding.size(), 3U);
  EXPECT_NEAR(colliding[0].time(dt), std::sqrt(2.0 * 5.5 / g), dt);
  EXPECT_LE(norm(colliding[0].contact.point - Vec3{6.0, 8.0, 4.0}), 1e-9);
  EXPECT_EQ(colliding[0].wall.normal, (Vec3{0.0, 0.0, 1.0}));
  // The same to the bit, until the sphere comes to rest on the block.
  std::size_t same = 0;
  while (same < colliding.size() && same < alone.size() && colliding[same].step == alone[same].step &&
         colliding[same].contact.time_of_impact == alone[same].contact.time_of_impact &&
         colliding[same].contact.point == alone[same].contact.point &&
         colliding[same].contact.dart == alone[same].contact.dart && colliding[same].wall.face == alone[same].wall.face)
    ++same;
  EXPECT_GE(same, 3U);
  EXPECT_LE(colliding.size(), same + 2);  // the touch that it stays with is reported once
}

// A tower of spheres falls on a floor, which may rise. The lowest meets the floor among others, so that the solver
// answers. The contact is where free fall meets the floor; once the tower rests, no more are reported.
TEST(CollisionContacts, SpheresAmongOthersReportEachTouchOnce) {
  constexpr double dt = 2e-3;
  constexpr double r = 0.25;
  for (const double rise : {0.0, 0.5}) {
    const MeshData mesh = box_of({4, 4, 4});
    Environment environment(mesh, Threads{1});
    Simulation simulation(environment, falling(dt, Reflect{0.0}));
    for (int k = 0; k < 3; ++k)
      simulation.add(std::vector<Vec3>{{1.3, 1.7, 0.5 + r + 2.0 * r * (1.0 + 2.0 * resting_gap) * k}}, {}, r);
    std::vector<Vec3> shift;
    for (const Vec3& x : mesh.points) shift.push_back({0.0, 0.0, rise * (1.0 - x.z / 4.0)});
    if (rise > 0.0) simulation.pull(shift, 1.0);
    std::vector<Seen> seen;
    std::vector<double> floor = {0.0};
    for (int i = 0; i < 700; ++i) {
      take_step(simulation, seen);
      floor.push_back(environment.positions()[0].z);
    }
    EXPECT_EQ(simulation.totals().wall_overlaps, 0U);
    std::size_t meets = 1;
    while (0.5 - g * dt * dt * double(meets * (meets + 1)) / 2.0 > floor[meets] + resting_gap * r) ++meets;
    ASSERT_FALSE(seen.empty());
    EXPECT_EQ(seen[0].step, meets - 1) << rise;
    const Contact& c = seen[0].contact;
    EXPECT_GT(c.time_of_impact, 0.0);
    EXPECT_LT(c.time_of_impact, 1.0);
    EXPECT_LE(norm(c.point - Vec3{1.3, 1.7, floor[meets]}), 6.0 * rise * dt * dt + 1e-15);
    EXPECT_EQ(seen[0].wall.normal, (Vec3{0.0, 0.0, 1.0}));
    EXPECT_NEAR(c.wall_displacement.z, floor[meets] - floor[meets - 1], 6.0 * rise * dt * dt);
    EXPECT_EQ(seen[0].wall.patch, environment.map().patch("zmin"));
    EXPECT_EQ(simulation.totals().contacts_by_patch[seen[0].wall.patch.value], seen.size());
    EXPECT_EQ(simulation.totals().counters.contacts[2], seen.size());
    EXPECT_EQ(simulation.contact_counts()[0], seen.size());
    EXPECT_LE(seen.size(), 3U) << rise;
    for (const Seen& s : seen) {
      EXPECT_EQ(s.id, 0U);
      EXPECT_LT(s.step, 200U);
    }
  }
}

// Restitution 1 on a sphere that is stuck to the floor: that contact is as one with a wall.
TEST(CollisionContacts, BouncesOnAStuckSphereKeepTheEnergy) {
  constexpr double r = 0.2;
  constexpr double dt = 1e-3;
  Environment environment(box_of({4, 4, 4}), Threads{1});
  Simulation simulation(environment, falling(dt, Stick{}, true, 1.0));
  simulation.add(std::vector<Vec3>{{2.0, 2.0, r + 0.01}}, {}, r);
  for (int i = 0; i < 100; ++i) simulation.step();
  ASSERT_EQ(simulation.statuses()[0], ParticleStatus::stuck);
  simulation.add(std::vector<Vec3>{{2.0, 2.0, 3.0 * r + 0.6}}, {}, r);
  const double start = energy_of_leapfrog(simulation, 1);
  for (int i = 0; i < 4000; ++i) simulation.step();
  EXPECT_GT(simulation.totals().collisions.pairs_touching, 4U);
  EXPECT_NEAR(energy_of_leapfrog(simulation, 1), start, 1e-9);
}

// Restitution 1: contacts of two spheres, and of a sphere and a wall, that no other contact joins keep the energy of all.
// A body in the scene changes nothing: another solver then takes the same contacts.
TEST(CollisionContacts, LoneContactsOfManyKeepTheEnergy) {
  constexpr double dt = 1e-4;
  for (const bool with_body : {false, true}) {
    Environment environment(box_of({4, 4, 4}), Threads{1});
    Simulation simulation(environment, falling(dt, Reflect{1.0}, true, 1.0));
    if (with_body) {
      ASSERT_TRUE(simulation.add_body(test::block(3, 0.05, {0.1, 0.1, 0.1}, Quaternion{}), {}).refused.empty());
    }
    Random random(5);
    for (int i = 0; i < 50; ++i) {
      const auto at = [&](int k) { return 0.9 + 0.5 * k + random.uniform(-0.1, 0.1); };
      const Vec3 x = {at(i % 5), at(i / 5 % 5), at(i / 25)};
      const Vec3 v = {random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0)};
      simulation.add(std::span(&x, 1), v, 0.1);
    }
    const auto energy = [&] {
      double sum = 0.0;
      for (std::size_t i = 0; i < 50; ++i) sum += energy_of_leapfrog(simulation, i);
      return sum;
    };
    const double start = energy();
    const int steps = std::max(5000, test::scaled(5000, 20000));
    const std::vector<Seen> seen = run(simulation, steps);
    const CollisionCounts& c = simulation.totals().collisions;
    EXPECT_GT(seen.size(), 50U);
    EXPECT_GT(c.pairs_touching, 15U);
    EXPECT_EQ(c.walls_touching, 0U);  // none among others
    EXPECT_NEAR(energy(), start, 1e-12 * start);
    std::uint64_t counted = 0;
    for (const std::uint64_t hits : simulation.totals().contacts_by_patch) counted += hits;
    EXPECT_EQ(counted, seen.size());
  }
}

// Points among spheres that collide meet no sphere: they keep their energy at walls, too.
TEST(CollisionContacts, PointsAmongSpheresKeepTheEnergy) {
  Environment environment(box_of({4, 4, 4}), Threads{1});
  Simulation simulation(environment, falling(1e-3, Reflect{1.0}));
  simulation.add(std::vector<Vec3>{{1.0, 1.0, 1.0}}, {}, 0.25);
  simulation.add(std::vector<Vec3>{{3.0, 3.0, 0.65}}, {});
  const double start = energy_of_leapfrog(simulation, 1);
  for (int i = 0; i < 4000; ++i) simulation.step();
  EXPECT_GE(simulation.contact_counts()[1], 5U);
  EXPECT_NEAR(energy_of_leapfrog(simulation, 1), start, 1e-9);
}

// Two spheres side by side come to the floor, and a little earlier to a wall that absorbs them: the last contact of each
// is that one, and times do not fall.
TEST(CollisionContacts, TheLastContactIsThatWhichAbsorbs) {
  constexpr double r = 0.25;
  Environment environment(box_of({4, 4, 4}), Threads{1});
  SimulationOptions o = falling(0.01, Reflect{0.5});
  o.patch_responses = {{"xmax", Absorb{}}};
  Simulation simulation(environment, o);
  for (const double y : {1.0, 1.0 + 2.0 * r + 0.01})
    simulation.add(std::vector<Vec3>{{4.0 - r - 0.03, y, r + 0.05}}, {10.0, 0.0, -10.0}, r);
  const SimulationStep& step = simulation.step();
  EXPECT_EQ(step.collisions.walls_touching, 2U);
  ASSERT_EQ(step.left.size(), 2U);
  ASSERT_EQ(step.contacts().size(), 4U);
  for (const LeftParticle& left : step.left) {
    const std::uint32_t k = left.contact;
    const auto patch = [&](std::uint32_t c) { return step.report.contacts.walls_of(step.contacts()[c]).front().patch; };
    EXPECT_EQ(step.contact_ids[k], left.id);
    EXPECT_EQ(patch(k), environment.map().patch("xmax"));
    EXPECT_EQ(step.contact_ids[k - 1], left.id);
    EXPECT_EQ(patch(k - 1), environment.map().patch("zmin"));
    EXPECT_LE(step.contacts()[k - 1].time_of_impact, step.contacts()[k].time_of_impact);
    EXPECT_NEAR(step.contacts()[k].time_of_impact, 0.3, 1e-6);
  }
}

// Spheres of a heap on a floor that rises, in two segments a step: the same contacts to the bit for any number of
// threads, and from a checkpoint.
TEST(CollisionContacts, AreTheSameForThreadsAndCheckpoints) {
  const MeshData mesh = box_of({1.2, 1.2, 4.0});
  std::vector<Vec3> shift;
  for (const Vec3& x : mesh.points) shift.push_back({0.0, 0.0, 0.2 * (1.0 - x.z / 4.0)});
  const auto contacts = [&](unsigned threads, int save_at) {
    Environment environment(mesh, Threads{threads});
    SimulationOptions o = falling(4e-3, Reflect{0.4, 0.3}, true, 0.4);
    o.substeps = 2;
    o.collisions->friction = 0.3;
    Simulation simulation(environment, o);
    for (int k = 0; k < 300; ++k) {
      const Vec3 x = {0.11 + 0.12 * (k % 9) + 0.001 * (k % 7), 0.11 + 0.12 * (k / 9 % 9), 0.1 + 0.12 * (k / 81)};
      simulation.add(std::span(&x, 1), {0.5, 0.0, 0.0}, 0.05);
    }
    simulation.pull(shift, 0.4);
    std::vector<Seen> seen = run(simulation, save_at);
    Environment again(mesh, Threads{threads});
    Simulation other(again, o);
    other.pull(shift, 0.4);
    other.restore(simulation.checkpoint());
    for (const Seen& s : run(other, 150 - save_at)) seen.push_back(s);
    return seen;
  };
  const std::vector<Seen> one = contacts(1, 0);
  EXPECT_GT(one.size(), 300U);
  for (const auto& [threads, save_at] : {std::pair(2U, 0), std::pair(3U, 40)}) {
    const std::vector<Seen> other = contacts(threads, save_at);
    ASSERT_EQ(other.size(), one.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
      const Contact& a = one[k].contact;
      const Contact& b = other[k].contact;
      ASSERT_TRUE(one[k].step == other[k].step && one[k].id == other[k].id && a.time_of_impact == b.time_of_impact &&
                  a.point == b.point && a.kind == b.kind && a.wall_displacement == b.wall_displacement &&
                  a.displacement == b.displacement && one[k].wall.face == other[k].wall.face &&
                  one[k].wall.normal == other[k].wall.normal)
          << k;
    }
  }
}

}  // namespace dartcast::collision_contacts_test
