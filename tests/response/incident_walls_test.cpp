// Walls that meet at edges and vertices, and what they make of a velocity: for particles and bodies alike.
#include "response/incident_walls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/random.hpp"
#include "bodies/body_contact.hpp"
#include "support/tier.hpp"

namespace dartcast::incident_walls_test {

Vec3 direction(Random& random) {
  while (true) {
    const Vec3 v = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(v) > 0.1 && norm(v) < 1.0) return v * (1.0 / norm(v));
  }
}

std::vector<WallHit> walls_of(const std::vector<Vec3>& normals) {
  std::vector<WallHit> walls;
  for (const Vec3& n : normals) {
    walls.emplace_back();
    walls.back().normal = n * (1.0 / norm(n));
  }
  return walls;
}

double deepest(const Vec3& v, const std::vector<WallHit>& walls) {
  double most = 0.0;
  for (const WallHit& w : walls) most = std::max(most, -dot(v, w.normal));
  return most;
}

// Dykstra's projections, far more of them than it takes.
Vec3 projected(const Vec3& v, const std::vector<WallHit>& walls) {
  std::vector<Vec3> taken(walls.size());
  Vec3 x = v;
  for (int round = 0; round < 20000; ++round) {
    for (std::size_t i = 0; i < walls.size(); ++i) {
      const Vec3 y = x + taken[i];
      x = y - walls[i].normal * std::min(0.0, dot(y, walls[i].normal));
      taken[i] = y - x;
    }
  }
  return x;
}

TEST(IncidentWalls, HoldBackToTheNearestVelocity) {
  Random random(1);
  std::array<int, 4> counts{};
  for (int i = 0; i < std::max(100, test::scaled(300, 3000)); ++i) {
    std::vector<Vec3> normals;
    const Vec3 common = direction(random);  // so that something is free
    for (int k = 0; k < 1 + i % 6; ++k) {
      const Vec3 n = direction(random);
      normals.push_back(dot(n, common) < 0.1 ? n - common * (2.0 * dot(n, common)) + common * 0.1 : n);
    }
    const auto walls = walls_of(normals);
    const Vec3 v = direction(random);
    const HeldBack held = held_back(v, walls);
    ++counts[held.count];
    ASSERT_LE(deepest(held.velocity, walls), 1e-13) << i;
    ASSERT_LE(norm(held.velocity - projected(v, walls)), 1e-6) << i;
    Vec3 sum = v;
    for (unsigned k = 0; k < held.count; ++k) {
      ASSERT_GE(held.impulse[k], 0.0);
      sum += held.wall[k]->normal * held.impulse[k];
    }
    ASSERT_LE(norm(sum - held.velocity), 1e-12) << i;
  }
  EXPECT_GT(*std::min_element(counts.begin(), counts.end()), 5);
}

// Walls that are one plane up to rounding count once.
TEST(IncidentWalls, FansOfOnePlaneAreOneWall) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Vec3 n = direction(random);
    std::vector<Vec3> normals = {n};
    for (int k = 0; k < 5; ++k) normals.push_back(n + direction(random) * 1e-16);
    const auto walls = walls_of(normals);
    const Vec3 v = n * -1.0 + direction(random) * 0.5;
    const Vec3 out = after_impact(v, walls, [](const WallHit&, double) { return WallSurface{0.5, 0.0}; });
    const Vec3 expected = v - n * (1.5 * dot(v, n));
    ASSERT_LE(norm(out - expected), 1e-14);
  }
}

// The velocity after answer_motion(), without forces.
Vec3 bounced(const Vec3& v, const std::vector<WallHit>& walls, double restitution, double friction) {
  WallResponse r;
  r.restitution = restitution;
  r.friction = friction;
  const WallResponses responses(r);
  std::vector<Leg> legs(1);
  legs[0].before = legs[0].after = v;
  std::vector<PassBody> bodies(1);
  std::vector<std::uint32_t> body_of(1);
  std::vector<Vec3> none(1);
  std::vector<TouchedFaces> on(1);
  std::vector<TouchedFaces> next(1);
  std::vector<ParticleStatus> statuses(1, ParticleStatus::alive);
  const Pass pass{&responses, {}, 1e-3, bodies, body_of, none, none, on, next, statuses, legs};
  Contact contact;
  contact.time_of_impact = 0.5;
  answer_motion(pass, contact, walls, {});
  return legs[0].after;
}

// Wedges and corners, wide and narrow, met along a plane of their symmetry: the velocity stays in it. Whatever is met:
// no velocity into a wall, no energy gained.
TEST(IncidentWalls, SymmetricWedgesAnswerInTheirPlane) {
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    // Between the plane of symmetry and the normals: of any size.
    const double half = i % 2 == 0 ? random.uniform(0.02, 1.55) : std::pow(10.0, -random.uniform(1.0, 6.0));
    const double rounding = 1e-13 + 1e-15 / half;  // of normals, and so of where the planes meet
    const Vec3 axis = direction(random);
    const Vec3 side = [&] {
      const Vec3 d = cross(axis, direction(random));
      return d * (1.0 / norm(d));
    }();
    const Vec3 edge = cross(axis, side);
    std::vector<Vec3> normals = {axis * std::cos(half) + side * std::sin(half),
                                 axis * std::cos(half) - side * std::sin(half)};
    if (i % 3 == 1) normals.push_back(axis * std::cos(half) + edge * std::sin(half));  // a corner, still symmetric
    if (i % 3 == 2) normals.push_back(axis);
    const auto walls = walls_of(normals);
    auto reversed = walls;
    std::reverse(reversed.begin(), reversed.end());
    const Vec3 v = axis * -1.0 + edge * random.uniform(-1.0, 1.0);
    for (const double e : {1.0, 0.5, 0.0}) {
      for (const double friction : {0.0, 0.3}) {
        const Vec3 out = bounced(v, walls, e, friction);
        EXPECT_LE(std::abs(dot(out, side)), rounding) << i << ' ' << half << ' ' << e;
        EXPECT_LE(deepest(out, walls), 1e-13);
        EXPECT_LE(norm(out), norm(v) * (1.0 + 1e-14));
        EXPECT_LE(norm(out - bounced(v, reversed, e, friction)), rounding);
      }
    }
  }
}

// A right angle, met head on: back the way it came; a wide one, where the sequence of two reflections would turn it.
TEST(IncidentWalls, WedgesReboundAsTheyShould) {
  for (const double half : {0.3, 0.25 * std::numbers::pi, 1.2}) {
    const auto walls = walls_of({{std::sin(half), 0, std::cos(half)}, {-std::sin(half), 0, std::cos(half)}});
    for (const double e : {1.0, 0.5, 0.0}) {
      const Vec3 out = bounced({0.0, 0.7, -2.0}, walls, e, 0.0);
      EXPECT_NEAR(out.x, 0.0, 1e-14);
      EXPECT_NEAR(out.y, 0.7, 1e-14);
      EXPECT_NEAR(out.z, 2.0 * e, 1e-14);
    }
  }
}

// Beside the plane of symmetry one wall may throw it at the other: nothing is lost while these are few, and in a narrow
// wedge, where they are many, it ends along the walls.
TEST(IncidentWalls, WedgesThatThrowItToAndFro) {
  Random random(6);
  int lost = 0;
  int kept = 0;
  for (int i = 0; i < 500; ++i) {
    const double half = random.uniform(0.8, 1.57);
    const auto walls = walls_of({{std::sin(half), 0, std::cos(half)}, {-std::sin(half), 0, std::cos(half)}});
    const Vec3 v = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 0)};
    const Vec3 out = bounced(v, walls, 1.0, 0.0);
    ASSERT_LE(deepest(out, walls), 1e-13) << half;
    ASSERT_LE(norm(out), norm(v) * (1.0 + 1e-14)) << half;
    const bool all = norm(out) > norm(v) * (1.0 - 1e-13);
    ++(all ? kept : lost);
    EXPECT_TRUE(all || half > 1.47) << half;  // 32 impacts do where the walls open by 5.7 degrees
  }
  EXPECT_GT(kept, 100);
  EXPECT_GT(lost, 10);
}

TEST(IncidentWalls, NothingGoesIntoAWallOrGainsEnergyWhateverIsMet) {
  Random random(4);
  for (int i = 0; i < 3000; ++i) {
    std::vector<Vec3> normals;
    for (std::size_t k = 0; k < 1 + random.below(7); ++k) normals.push_back(direction(random));
    if (i % 2 == 0) normals.push_back(normals.front() + direction(random) * 1e-9);
    if (i % 5 == 0) normals.push_back(normals.front() * -1.0);  // no way but along
    const auto walls = walls_of(normals);
    const Vec3 v = direction(random);
    const Vec3 out = bounced(v, walls, i % 3 * 0.5, i % 7 == 0 ? 0.4 : 0.0);
    ASSERT_LE(deepest(out, walls), 1e-12) << i;
    ASSERT_LE(norm(out), 1.0 + 1e-13) << i;
  }
}

// Walls of different answers that nearly face each other do not give more than they took.
TEST(IncidentWalls, MixedAnswersAddNoEnergy) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    std::vector<Vec3> normals = {direction(random), direction(random), direction(random)};
    if (i % 2 == 0) normals[1] = normals[0] * -1.0 + normals[2] * random.uniform(0.0, 0.1);
    const auto walls = walls_of(normals);
    const Vec3 v = direction(random);
    const Vec3 out = after_impact(v, walls, [&](const WallHit& w, double) {
      return WallSurface{&w == &walls[0] ? 1.0 : 0.0, 0.0};
    });
    ASSERT_LE(norm(out), 1.0 + 1e-13) << i;
  }
}

// --- the law as particles and bodies share it

// Walls of a fan at a vertex, nearly in one plane; two that face each other; several of the same plane; each with a
// patch of its own.
std::vector<WallHit> random_walls(Random& random) {
  std::vector<Vec3> normals;
  for (std::size_t k = 0; k < 1 + random.below(6); ++k) normals.push_back(direction(random));
  if (random.below(2) == 0)
    normals.push_back(normals.front() + direction(random) * std::pow(10.0, -random.uniform(1.0, 17.0)));
  if (random.below(4) == 0) normals.push_back(normals.front() * -1.0);
  if (random.below(4) == 0) normals.push_back(normals.back());
  auto walls = walls_of(normals);
  for (WallHit& w : walls) w.patch = Patch{static_cast<std::uint16_t>(random.below(3))};
  return walls;
}

WallSurface mixed_surface(const WallHit& wall, double) {
  constexpr std::array<WallSurface, 3> surfaces = {{{1.0, 0.0}, {0.5, 0.3}, {0.0, 0.0}}};
  return surfaces[wall.patch.value];
}

template <class T>
void shuffle(Random& random, std::vector<T>& values) {
  for (std::size_t i = values.size(); i > 1; --i)
    std::swap(values[i - 1], values[random.below(static_cast<std::uint32_t>(i))]);
}

TEST(Rebounded, TheOrderOfTheWallsChangesNoBit) {
  Random random(11);
  const int cases = test::scaled(5000, 100000);
  for (int i = 0; i < cases; ++i) {
    std::vector<WallHit> walls = random_walls(random);
    const Vec3 v = direction(random) * std::pow(10.0, random.uniform(-5.0, 5.0));
    const Vec3 lead = i % 2 == 0 ? Vec3{} : direction(random) * random.uniform(0.0, norm(v));
    const Vec3 out = rebounded(v, walls, mixed_surface, lead);
    const Vec3 held = held_back(v, walls).velocity;
    for (int k = 0; k < 4; ++k) {
      shuffle(random, walls);
      if (k == 3) walls.push_back(walls.front());  // nor does a wall listed twice
      ASSERT_EQ(rebounded(v, walls, mixed_surface, lead), out) << i;
      ASSERT_EQ(held_back(v, walls).velocity, held) << i;
      const std::span<const WallHit> all = walls;
      const std::size_t half = walls.size() / 2;
      ASSERT_EQ(rebounded(v, JointWalls(all.subspan(half), all.first(half)), mixed_surface, lead), out) << i;
    }
  }
}

// Energy as it is computed, not up to rounding; and directions up to rounding_share.
void expect_lawful(const Vec3& v, const std::vector<WallHit>& walls, const Vec3& out) {
  ASSERT_LE(dot(out, out), dot(v, v));
  ASSERT_LE(deepest(out, walls), rounding_share * norm(v));
}

TEST(Rebounded, NeverGainsEnergyAsComputedNorPointsIntoAWall) {
  Random random(12);
  const int cases = test::scaled(20000, 500000);
  for (int i = 0; i < cases; ++i) {
    const std::vector<WallHit> walls = random_walls(random);
    const Vec3 v = direction(random) * std::pow(10.0, random.uniform(-5.0, 5.0));
    expect_lawful(v, walls, rebounded(v, walls, mixed_surface));
    for (const double e : {0.0, 0.5, 1.0}) {
      const double friction = i % 3 == 0 ? random.uniform() : 0.0;
      expect_lawful(v, walls, rebounded(v, walls, [&](const WallHit&, double) { return WallSurface{e, friction}; }));
    }
    expect_lawful(v, walls, held_back(v, walls).velocity);
    if (::testing::Test::HasFatalFailure()) FAIL() << i;
  }
}

TEST(Rebounded, InWedgesFromATenthOfADegreeToNinety) {
  Random random(13);
  const int cases = test::scaled(5000, 100000);
  for (int i = 0; i < cases; ++i) {
    const double angle = 0.1 * std::pow(900.0, random.uniform()) * std::numbers::pi / 180.0;
    const Vec3 edge = direction(random);
    const Vec3 raw = cross(edge, direction(random));
    const Vec3 out_of_it = raw * (1.0 / norm(raw));  // in the plane of symmetry
    const Vec3 side = cross(edge, out_of_it);
    std::vector<Vec3> normals;
    for (const double s : {1.0, -1.0})
      normals.push_back(out_of_it * std::sin(angle / 2) + side * (s * std::cos(angle / 2)));
    if (i % 2 == 0) normals.push_back(edge);  // a vertex
    const auto walls = walls_of(normals);
    const Vec3 v = direction(random);
    for (const double e : {0.0, 0.5, 1.0}) {
      const Vec3 out = rebounded(v, walls, [&](const WallHit&, double) {
        return WallSurface{e, i % 5 == 0 ? 0.2 : 0.0};
      });
      expect_lawful(v, walls, out);
      if (::testing::Test::HasFatalFailure()) FAIL() << i << " at " << angle << " with " << e;
      if (e == 0.0 && i % 5 != 0) {
        ASSERT_LE(norm(out - held_back(v, walls).velocity), 1e-12) << i;
      }
    }
  }
}

// Triangles of one fan, flat up to 10^-3: nothing but the plane's answer, and no false crease.
TEST(Rebounded, AFanThatIsNearlyFlatIsOneWall) {
  Random random(14);
  for (int i = 0; i < 2000; ++i) {
    const double bend = std::pow(10.0, -random.uniform(3.0, 16.0));
    const Vec3 n = direction(random);
    std::vector<Vec3> normals;
    for (int k = 0; k < 6; ++k) normals.push_back(n + direction(random) * bend);
    const auto walls = walls_of(normals);
    const Vec3 v = direction(random) - n;
    if (dot(v, n) > -0.1) continue;
    const Vec3 plane = v - n * dot(v, n);
    const Vec3 held = held_back(v, walls).velocity;
    ASSERT_LE(norm(held - plane), 8.0 * bend + 1e-14) << i;
    const Vec3 out = rebounded(v, walls, [](const WallHit&, double) { return WallSurface{1.0, 0.0}; });
    ASSERT_LE(norm(out - (plane - n * dot(v, n))), 16.0 * bend + 1e-14) << i;
  }
}

double energy_of_moment(const Vec3& v, const Vec3& lead) { return 0.5 * dot(v, v) + dot(lead, v); }

// With an acceleration the energy of the moment does not grow; a particle that comes to rest may keep |lead|^2 / 2.
TEST(Rebounded, TheEnergyOfTheMomentDoesNotGrow) {
  Random random(15);
  const int cases = test::scaled(20000, 500000);
  int kept = 0;
  for (int i = 0; i < cases; ++i) {
    const std::vector<WallHit> walls = random_walls(random);
    const Vec3 v = direction(random);
    const Vec3 lead = direction(random) * std::pow(10.0, random.uniform(-6.0, 1.0));
    const double before = energy_of_moment(v, lead);
    for (const double e : {0.0, 0.5, 1.0}) {
      const Vec3 out = rebounded(
          v, walls,
          [&](const WallHit&, double) {
            return WallSurface{e, 0.0};
          },
          lead);
      ASSERT_LE(deepest(out, walls), rounding_share * (1.0 + 4.0 * norm(lead))) << i;
      const double grown = energy_of_moment(out, lead) - before;
      const double rounding = 1e-14 * (1.0 + norm(lead));
      ASSERT_LE(grown, 0.5 * dot(lead, lead) + rounding) << i;
      if (grown > rounding) ASSERT_LE(energy_of_moment(out, lead), rounding) << i;  // only where it comes to rest
    }
    // One elastic wall: to the bit of rounding the same, where it does bounce.
    const auto wall = walls_of({walls.front().normal});
    if (dot(v, wall[0].normal) >= 0.0) continue;
    const Vec3 out = rebounded(
        v, wall,
        [](const WallHit&, double) {
          return WallSurface{1.0, 0.0};
        },
        lead);
    if (dot(out, wall[0].normal) < 1e-9) continue;
    ++kept;
    ASSERT_NEAR(energy_of_moment(out, lead), before, 1e-14 * (1.0 + dot(lead, lead))) << i;
  }
  EXPECT_GT(kept, cases / 10);
}

TEST(Shortened, ToWhatMayBeSpent) {
  EXPECT_EQ(shortened({3, 4, 0}, 25.0, {}), (Vec3{3, 4, 0}));
  EXPECT_EQ(shortened({3, 4, 0}, 0.0, {}), Vec3{});
  EXPECT_EQ(shortened({}, -1.0, {1, 0, 0}), Vec3{});
  EXPECT_NEAR(norm(shortened({3, 4, 0}, 6.25, {})), 2.5, 1e-15);
  // (s 5)^2 + 2 (s 3) = 8 at s = (sqrt(9 + 200) - 3) / 25
  EXPECT_NEAR(shortened({3, 4, 0}, 8.0, {1, 0, 0}).x, 3.0 * (std::sqrt(209.0) - 3.0) / 25.0, 1e-15);
  // Nothing on the line is that little: its least, at s = 3 / 25, or the end nearest to it.
  EXPECT_NEAR(shortened({3, 4, 0}, -4.0, {-1, 0, 0}).x, 9.0 / 25.0, 1e-15);
  EXPECT_EQ(shortened({3, 4, 0}, -4.0, {1, 0, 0}), Vec3{});
}

}  // namespace dartcast::incident_walls_test
