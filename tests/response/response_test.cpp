// The responses of particles at walls: the operators alone, and in whole steps.
#include "dartcast/response.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/random.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/expectations.hpp"
#include "support/random_vectors.hpp"

namespace dartcast::respond_test {

using test::expect_near;
using test::random_vector;

WallHit wall(const Vec3& normal) {
  WallHit hit;
  hit.normal = normal * (1.0 / norm(normal));
  return hit;
}
std::vector<WallHit> walls(const std::vector<Vec3>& normals) {
  std::vector<WallHit> all;
  for (const Vec3& n : normals) all.push_back(wall(n));
  return all;
}

TEST(Reflected, AgainstTheDefinition) {
  EXPECT_EQ(reflected({1, 2, -3}, walls({{0, 0, 1}}), 1.0, 0.0), (Vec3{1, 2, 3}));
  EXPECT_EQ(reflected({1, 2, -3}, walls({{0, 0, 1}}), 0.5, 0.0), (Vec3{1, 2, 1.5}));
  EXPECT_EQ(reflected({1, 2, -3}, walls({{0, 0, 1}}), 0.0, 0.0), (Vec3{1, 2, 0}));
  EXPECT_EQ(reflected({1, 2, 3}, walls({{0, 0, 1}}), 0.5, 0.5), (Vec3{1, 2, 3}));  // leaves: nothing to do
  // Coulomb: the tangential velocity loses friction times the change of the normal one, (1 + e) |vn|, and never turns
  // around.
  expect_near(reflected({10, 0, -2}, walls({{0, 0, 1}}), 0.5, 0.25), {10 - 0.25 * 1.5 * 2, 0, 1});
  expect_near(reflected({3, 4, -2}, walls({{0, 0, 1}}), 1.0, 0.5), {3 * 0.6, 4 * 0.6, 2});
  expect_near(reflected({0.1, 0, -2}, walls({{0, 0, 1}}), 1.0, 0.5), {0, 0, 2});
}

TEST(Reflected, FromSeveralWalls) {
  EXPECT_EQ(reflected({-1, -2, 3}, walls({{1, 0, 0}, {0, 1, 0}}), 1.0, 0.0), (Vec3{1, 2, 3}));
  EXPECT_EQ(reflected({-1, -2, -3}, walls({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), 0.5, 0.0), (Vec3{0.5, 1, 1.5}));
  EXPECT_EQ(reflected({-1, 2, 3}, walls({{1, 0, 0}, {0, 1, 0}}), 1.0, 0.0), (Vec3{1, 2, 3}));
}

// Between walls that throw it to and fro too often it runs along them: all that an elastic rebound may lose.
TEST(Reflected, AnElasticReboundKeepsTheSpeedAndEnergyNeverGrows) {
  Random random(1);
  int lost = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<WallHit> all;
    for (std::uint32_t k = random.below(3) + 1; k > 0; --k) all.push_back(wall(random_vector(random)));
    const Vec3 v = random_vector(random) * std::ldexp(1.0, static_cast<int>(random.below(60)) - 30);
    const double speed = norm(v);
    const Vec3 elastic = reflected(v, all, 1.0, 0.0);
    EXPECT_LE(dot(elastic, elastic), dot(v, v));
    const bool kept = norm(elastic) >= speed * (1 - 4e-15);
    lost += kept ? 0 : 1;
    if (all.size() == 1) EXPECT_TRUE(kept) << i;
    const double restitution = random.uniform();
    const double friction = random.uniform() * 2;
    const Vec3 r = reflected(v, all, restitution, friction);
    EXPECT_LE(dot(r, r), dot(v, v));
    for (const WallHit& w : all) EXPECT_GE(dot(r, w.normal), -1e-13 * speed);
    if (all.size() == 1) {
      const double into = dot(v, all[0].normal);
      EXPECT_NEAR(dot(r, all[0].normal), into < 0 ? -restitution * into : into, 4e-15 * speed);
      EXPECT_GE(dot(r - all[0].normal * dot(r, all[0].normal), v), -4e-15 * speed * speed);  // tangential: same way
    }
  }
  EXPECT_LT(lost, 100);
}

TEST(Slid, AlongOneWall) {
  EXPECT_EQ(slid({1, 2, -3}, walls({{0, 0, 1}}), {}), (Vec3{1, 2, 0}));
  EXPECT_EQ(slid({1, 2, 3}, walls({{0, 0, 1}}), {}), (Vec3{1, 2, 3}));
  EXPECT_EQ(slid({0, 0, -3}, walls({{0, 0, 1}}), {}), Vec3{});
}

TEST(Slid, IntoACreaseAndACorner) {
  EXPECT_EQ(slid({-1, 2, -3}, walls({{0, 0, 1}}), walls({{1, 0, 0}})), (Vec3{0, 2, 0}));
  EXPECT_EQ(slid({-1, 2, -3}, walls({{0, 0, 1}, {1, 0, 0}}), {}), (Vec3{0, 2, 0}));
  EXPECT_EQ(slid({-1, -2, -3}, walls({{0, 0, 1}}), walls({{1, 0, 0}, {0, 1, 0}})), Vec3{});
  EXPECT_EQ(slid({-1, -2, -3}, walls({{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}), {}), Vec3{});
  // An earlier wall that the projection leaves does not join.
  EXPECT_EQ(slid({1, 2, -3}, walls({{0, 0, 1}}), walls({{1, 0, 0}})), (Vec3{1, 2, 0}));
}

TEST(Slid, NearlyCoplanarTrianglesMakeNoFalseCrease) {
  for (const double bend : {1e-2, 1e-5, 1e-9, 1e-13}) {
    const Vec3 v{1, 0.25, -0.5};
    const auto on = [&](const WallHit& w) { return v - w.normal * dot(v, w.normal); };
    // Two triangles of a warped face, which bends up towards the free side: on from the earlier to the newest.
    const auto newest = walls({{-bend, 0, 1}});
    expect_near(slid(v, newest, walls({{bend, 0, 1}})), on(newest[0]), 1e-13);
    // Both met at once at their common edge, whether the face bends up or down there.
    const auto up = walls({{bend, 0, 1}, {-bend, 0, 1}});
    expect_near(slid(v, up, {}), on(up[1]), 1e-13);
    expect_near(slid(v, std::vector<WallHit>{up[1], up[0]}, {}), on(up[1]), 1e-13);
    // The same plane again.
    expect_near(slid(v, newest, newest), on(newest[0]), 1e-13);
  }
}

TEST(Slid, NeverPointsIntoAWallNorGrows) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    std::vector<WallHit> now, earlier;
    for (std::uint32_t k = random.below(3) + 1; k > 0; --k) now.push_back(wall(random_vector(random)));
    for (std::uint32_t k = random.below(3); k > 0; --k) earlier.push_back(wall(random_vector(random)));
    const Vec3 v = random_vector(random);
    const Vec3 s = slid(v, now, earlier);
    EXPECT_LE(norm(s), norm(v) * (1 + 1e-14));
    EXPECT_GE(dot(s, v), -1e-14);
    bool opposed = false;
    for (const WallHit& w : now) opposed = opposed || dot(v, w.normal) < 0.0;
    if (!opposed) {
      EXPECT_EQ(s, v);
      continue;
    }
    for (const WallHit& w : now) EXPECT_GE(dot(s, w.normal), -1e-11);
    for (const WallHit& w : earlier) EXPECT_GE(dot(s, w.normal), -1e-11);
  }
}

TEST(WallResponses, RefuseWhatIsOutOfRange) {
  for (const double bad : {-0.1, 1.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(WallResponses({WallResponseKind::reflect, bad, 0.0}), InvalidArgument);
    WallResponses r;
    EXPECT_THROW(r.set(Patch{1}, {WallResponseKind::reflect, bad, 0.0}), InvalidArgument);
    if (bad != 1.1) EXPECT_THROW(r.set(Patch{1}, {WallResponseKind::slide, 1.0, bad}), InvalidArgument);
    EXPECT_EQ(r.of(Patch{1}).kind, WallResponseKind::reflect);
  }
  std::vector<Vec3> velocities(2);
  std::vector<ParticleStatus> statuses(2);
  const WallResponses r;
  for (const double dt : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(respond_with(r, velocities, statuses, dt), InvalidArgument);
  EXPECT_THROW(respond_with(r, velocities, std::span<ParticleStatus>(statuses).first(1), 1.0), InvalidArgument);
}

TEST(WallResponses, AreMadeOfValues) {
  const WallResponse bouncing = Reflect{0.5, 0.1};
  EXPECT_EQ(bouncing.kind, WallResponseKind::reflect);
  EXPECT_EQ(bouncing.restitution, 0.5);
  EXPECT_EQ(bouncing.friction, 0.1);
  EXPECT_EQ(WallResponse(Reflect{}).restitution, 1.0);
  EXPECT_EQ(WallResponse(Slide{}).kind, WallResponseKind::slide);
  EXPECT_EQ(WallResponse(Stick{}).kind, WallResponseKind::stick);
  EXPECT_EQ(WallResponse(Absorb{}).kind, WallResponseKind::absorb);
  EXPECT_EQ(WallResponse(Escape{}).kind, WallResponseKind::escape);
  EXPECT_EQ(WallResponses(Slide{}).of(Patch{3}).kind, WallResponseKind::slide);
}

TEST(WallResponses, OfAPatchOrTheGeneralOne) {
  WallResponses r({WallResponseKind::slide});
  r.set(Patch{3}, {WallResponseKind::absorb});
  EXPECT_EQ(r.of(Patch{0}).kind, WallResponseKind::slide);
  EXPECT_EQ(r.of(Patch{2}).kind, WallResponseKind::slide);
  EXPECT_EQ(r.of(Patch{3}).kind, WallResponseKind::absorb);
  EXPECT_EQ(r.of(Patch{9}).kind, WallResponseKind::slide);
  r.set(Patch{3}, {WallResponseKind::stick});
  EXPECT_EQ(r.of(Patch{3}).kind, WallResponseKind::stick);
}

// --- whole steps in a box of 2 x 2 x 2 cubes

struct Scene {
  Scene() : environment(generate_box(options())) {}
  static BoxOptions options() {
    BoxOptions o;
    o.cells = {2, 2, 2};
    o.size = {2, 2, 2};
    return o;
  }
  void add(const Vec3& position, const Vec3& velocity) {
    environment.add(particles, std::vector<Vec3>{position});
    velocities.push_back(velocity);
    statuses.push_back(ParticleStatus::alive);
  }
  StepReport step(double dt = 1.0) {
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i) targets.push_back(particles[i].position + velocities[i] * dt);
    return environment.advance(particles, targets, respond_with(responses, velocities, statuses, dt));
  }

  Environment environment;
  Particles particles;
  WallResponses responses;
  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;
};

TEST(RespondWith, ReflectsPositionsAndVelocities) {
  Scene s;
  s.responses = WallResponses({WallResponseKind::reflect, 1.0, 0.0});
  s.add({1.5, 0.75, 0.5}, {1, 0, 0});
  s.add({1.5, 1.5, 1.75}, {1, 1, 0.5});   // into the corner
  s.add({0.5, 0.75, 0.25}, {3.5, 0, 0});  // to the far side and back to the near one
  const StepReport report = s.step();
  EXPECT_EQ(s.particles[0].position, (Vec3{1.5, 0.75, 0.5}));
  EXPECT_EQ(s.velocities[0], (Vec3{-1, 0, 0}));
  EXPECT_EQ(s.particles[1].position, (Vec3{1.5, 1.5, 1.75}));
  EXPECT_EQ(s.velocities[1], (Vec3{-1, -1, -0.5}));
  EXPECT_EQ(s.particles[2].position, (Vec3{0, 0.75, 0.25}));
  EXPECT_EQ(report.contacts.contacts.size(), 4U);  // the last ends on the near side: a contact at its end
  EXPECT_TRUE(report.stopped.empty());
}

TEST(RespondWith, RestitutionAndSlideLoseTheNormalPart) {
  Scene s;
  s.responses = WallResponses({WallResponseKind::reflect, 0.5, 0.0});
  s.responses.set(s.environment.map().patch("ymax"), {WallResponseKind::slide});
  s.add({1.5, 0.75, 0.5}, {1, 0, 0});
  s.add({0.25, 1.5, 0.5}, {1, 1, 0.25});
  s.step();
  EXPECT_EQ(s.particles[0].position, (Vec3{1.75, 0.75, 0.5}));
  EXPECT_EQ(s.velocities[0], (Vec3{-0.5, 0, 0}));
  EXPECT_EQ(s.particles[1].position, (Vec3{1.25, 2, 0.75}));
  EXPECT_EQ(s.velocities[1], (Vec3{1, 0, 0.25}));
}

TEST(RespondWith, StatusPerPatch) {
  Scene s;
  s.responses.set(s.environment.map().patch("xmax"), {WallResponseKind::absorb});
  s.responses.set(s.environment.map().patch("xmin"), {WallResponseKind::escape});
  s.responses.set(s.environment.map().patch("zmin"), {WallResponseKind::stick});
  s.add({1.5, 0.5, 0.5}, {1, 0, 0});
  s.add({0.5, 0.5, 0.75}, {-1, 0, 0});
  s.add({0.5, 0.75, 0.5}, {0.25, 0, -1});
  s.add({0.5, 0.5, 0.5}, {0.25, 0, 0});
  const StepReport report = s.step();
  EXPECT_EQ(s.statuses, (std::vector<ParticleStatus>{ParticleStatus::absorbed, ParticleStatus::escaped,
                                                     ParticleStatus::stuck, ParticleStatus::alive}));
  EXPECT_EQ(s.particles[0].position, (Vec3{2, 0.5, 0.5}));
  EXPECT_EQ(s.particles[1].position, (Vec3{0, 0.5, 0.75}));
  EXPECT_EQ(s.particles[2].position, (Vec3{0.625, 0.75, 0}));
  EXPECT_EQ(s.velocities[2], Vec3{});
  EXPECT_EQ(report.contacts.contacts.size(), 3U);
  // From now on they stay where they are, whatever pushes them against the wall.
  const Vec3 stuck = s.particles[2].position;
  s.velocities[2] = {0, 0, -1};
  s.step();
  EXPECT_EQ(s.particles[2].position, stuck);
  EXPECT_EQ(s.particles[0].position, (Vec3{2, 0.5, 0.5}));
  EXPECT_EQ(s.statuses[2], ParticleStatus::stuck);
}

TEST(RespondWith, AWallThatMovesGivesItsVelocity) {
  for (const WallResponseKind kind : {WallResponseKind::reflect, WallResponseKind::slide, WallResponseKind::stick}) {
    Scene s;
    s.responses = WallResponses({kind, 1.0, 0.0});
    s.add({0.125, 0.75, 0.5}, {0, 0, 0});
    // The wall x = 0 moves by 1/4 in a step of 1/2: past the particle at rest.
    std::vector<Vec3> points(s.environment.positions().begin(), s.environment.positions().end());
    for (Vec3& p : points) {
      if (p.x == 0.0) p.x = 0.25;
    }
    s.environment.move(points);
    const StepReport report = s.step(0.5);
    ASSERT_GE(report.contacts.contacts.size(), 1U);
    expect_near(report.contacts.contacts[0].wall_displacement, {0.25, 0, 0});
    expect_near(s.velocities[0], kind == WallResponseKind::reflect ? Vec3{1, 0, 0} : Vec3{0.5, 0, 0}, 1e-12);
    EXPECT_GE(s.particles[0].position.x, 0.25);
    EXPECT_EQ(s.statuses[0], kind == WallResponseKind::stick ? ParticleStatus::stuck : ParticleStatus::alive);
  }
}

TEST(RespondWith, ABilliardKeepsItsEnergyAndAnInelasticOneLosesIt) {
  for (const double restitution : {1.0, 0.7}) {
    Scene s;
    s.responses = WallResponses({WallResponseKind::reflect, restitution, restitution < 1.0 ? 0.1 : 0.0});
    Random random(5);
    for (int i = 0; i < 60; ++i) {
      const Vec3 at{random.uniform(0, 2), random.uniform(0, 2), random.uniform(0, 2)};
      s.add(at, random_vector(random) * 2.0);
    }
    std::vector<double> speeds;
    for (const Vec3& v : s.velocities) speeds.push_back(norm(v));
    std::uint64_t contacts = 0;
    for (int step = 0; step < 200; ++step) {
      contacts += s.step(0.1).contacts.contacts.size();
      for (std::size_t i = 0; i < speeds.size(); ++i) {
        const double speed = norm(s.velocities[i]);
        EXPECT_LE(speed, speeds[i] * (1 + 1e-14));
        if (restitution == 1.0) EXPECT_GE(speed, speeds[i] * (1 - 1e-14));
        speeds[i] = speed;
        const Vec3& p = s.particles[i].position;
        EXPECT_TRUE(p.x >= 0 && p.x <= 2 && p.y >= 0 && p.y <= 2 && p.z >= 0 && p.z <= 2);
      }
    }
    EXPECT_GT(contacts, 300U);
  }
}

// --- narrow corners

// A wedge with a level edge at the bottom, `angle` wide, its sides one unit long.
MeshData wedge(double angle) {
  MeshData mesh;
  const double half = std::sin(angle / 2);
  const double height = std::cos(angle / 2);
  mesh.points = {{0, 0, 0}, {half, 0, height}, {-half, 0, height}, {0, 1, 0}, {half, 1, height}, {-half, 1, height}};
  mesh.add_cell(CellType::prism, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  return mesh;
}

// Straight down into a symmetric wedge: whichever wall is met first, the velocity points into none.
TEST(RespondWith, AtTheLastContactNoVelocityPointsIntoAWallMet) {
  for (const double degrees : {0.1, 1.6, 10.0, 45.0, 89.0}) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
      for (const unsigned most : {1U, 2U, 5U, 16U}) {
        const double angle = degrees * 3.14159265358979 / 180.0;
        Environment environment(wedge(angle), Threads{1});
        Particles particles;
        environment.add(particles, std::vector<Vec3>{{0, 0.5, 0.25}, {0.1 * std::sin(angle / 2), 0.5, 0.25}});
        ASSERT_EQ(particles.size(), 2U);
        std::vector<Vec3> velocities = {{0, 0.1, -1}, {0.01 * angle, 0.2, -1}};
        std::vector<ParticleStatus> statuses(2, ParticleStatus::alive);
        const WallResponses responses({WallResponseKind::reflect, restitution, 0.0});
        const std::vector<Vec3> before = velocities;
        std::vector<Vec3> targets;
        for (std::size_t i = 0; i < 2; ++i) targets.push_back(particles[i].position + velocities[i]);
        StepOptions options;
        options.max_contacts = most;
        const StepReport report =
            environment.advance(particles, targets, respond_with(responses, velocities, statuses, 1.0), options);
        std::array<bool, 2> solved{};
        for (const Contact& c : report.contacts.contacts) {
          if (!c.last || std::exchange(solved[c.particle], true)) continue;  // the next one is not answered
          for (const auto& met : {report.contacts.walls_of(c), report.contacts.earlier_walls_of(c)}) {
            for (const WallHit& w : met)
              EXPECT_GE(dot(velocities[c.particle], w.normal), -1e-13) << degrees << ' ' << restitution << ' ' << most;
          }
        }
        for (std::size_t i = 0; i < 2; ++i)
          EXPECT_LE(dot(velocities[i], velocities[i]), dot(before[i], before[i])) << degrees << ' ' << restitution;
      }
    }
  }
}

// Walls met one after the other where the particle is answer together: in the corner of a box that is turned, with
// rounding between them.
TEST(RespondWith, WallsMetAtOnePlaceAnswerTogether) {
  Environment environment(wedge(0.03), Threads{1});
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{1e-12, 0.5, 1e-9}});
  ASSERT_EQ(particles.size(), 1U);
  std::vector<Vec3> velocity = {{0.0, 0.0, -0.01}};
  std::vector<ParticleStatus> fate(1, ParticleStatus::alive);
  const WallResponses responses({WallResponseKind::reflect, 0.5, 0.0});
  const StepReport report = environment.advance(particles, std::vector<Vec3>{particles[0].position + velocity[0]},
                                                respond_with(responses, velocity, fate, 1.0));
  ASSERT_GE(report.contacts.contacts.size(), 2U);
  EXPECT_LE(report.contacts.contacts.size(), 3U);
  EXPECT_EQ(report.contacts.contacts[0].together, 0U);
  EXPECT_EQ(report.contacts.contacts[1].together, 1U);
  EXPECT_NEAR(velocity[0].x, 0.0, 1e-3);
  EXPECT_NEAR(velocity[0].z, 0.005, 1e-4);
}

// A contact of a particle with a wall at rest or moving, half way through a step of 1 s.
AfterContact meet(const WallResponse& response, const Vec3& normal, Vec3& velocity, ParticleStatus& status,
                  const Vec3& wall_velocity = {}) {
  Contact contact;
  contact.time_of_impact = 0.5;
  contact.wall_displacement = wall_velocity;
  contact.unused = (velocity - wall_velocity) * 0.5;
  const WallResponses responses(response);
  const std::vector<WallHit> met = walls({normal});
  return respond_with(responses, {&velocity, 1}, {&status, 1}, 1.0)(contact, met, {});
}

// Bilinear between speeds and angles, as at the ends beyond them; relative to the moving wall.
TEST(RestitutionTables, GiveTheRestitutionOfSpeedAndAngle) {
  WallResponse r = Reflect{};
  r.table = {{1.0, 3.0, 10.0}, {20.0, 60.0}, {1.0, 0.8, 0.7, 0.5, 0.2, 0.1}};
  const auto truth = [](double speed, double degrees) {
    const double s = std::clamp(speed, 1.0, 10.0);
    const double a = (std::clamp(degrees, 20.0, 60.0) - 20.0) / 40.0;
    const auto row = [&](double low, double high) { return low + a * (high - low); };
    if (s <= 3.0) return row(1.0, 0.8) + (s - 1.0) / 2.0 * (row(0.7, 0.5) - row(1.0, 0.8));
    return row(0.7, 0.5) + (s - 3.0) / 7.0 * (row(0.2, 0.1) - row(0.7, 0.5));
  };
  const double turn = std::atan2(0.0, -1.0);
  for (const double speed : {0.1, 1.0, 2.0, 3.0, 5.5, 10.0, 40.0}) {
    for (const double degrees : {1.0, 20.0, 33.0, 60.0, 89.0}) {
      for (const Vec3& moving : {Vec3{}, Vec3{0.3, -0.2, 0.7}}) {
        const double angle = degrees * turn / 180.0;
        const Vec3 along = Vec3{std::cos(angle), 0.0, -std::sin(angle)} * speed;
        Vec3 v = along + moving;
        ParticleStatus status = ParticleStatus::alive;
        const AfterContact after = meet(r, {0, 0, 1}, v, status, moving);
        const double e = truth(speed, degrees);
        expect_near(v - moving, {along.x, 0.0, -e * along.z}, 1e-12 * speed);
        expect_near(after.displacement, Vec3{along.x, 0.0, -e * along.z} * 0.5, 1e-12 * speed);
      }
    }
  }
}

TEST(StickBelow, HoldsParticlesThatMeetTheWallSlowly) {
  WallResponse r = Reflect{0.5};
  r.stick_below = 1.0;
  for (const double into : {0.5, 0.999, 1.0, 2.0}) {
    Vec3 v = {3.0, 0.0, 0.25 - into};
    ParticleStatus status = ParticleStatus::alive;
    const AfterContact after = meet(r, {0, 0, 1}, v, status, {0.0, 0.0, 0.25});
    const bool sticks = into < 1.0;
    EXPECT_EQ(status, sticks ? ParticleStatus::stuck : ParticleStatus::alive) << into;
    EXPECT_EQ(after.displacement == Vec3{}, sticks);
    expect_near(v, sticks ? Vec3{0.0, 0.0, 0.25} : Vec3{3.0, 0.0, 0.25 + 0.5 * into});
  }
  r.kind = WallResponseKind::slide;
  Vec3 v = {3.0, 0.0, -0.5};
  ParticleStatus status = ParticleStatus::alive;
  (void)meet(r, {0, 0, 1}, v, status);
  EXPECT_EQ(status, ParticleStatus::alive);
}

TEST(RestitutionTables, RefuseWhatIsOutOfRange) {
  const auto expect = [](const WallResponse& r, const char* part) {
    test::expect_refused([&] { const WallResponses responses(r); }, part);
  };
  WallResponse r;
  r.stick_below = -1.0;
  expect(r, "the speed to stick below");
  r = {};
  r.table = {{1.0, 1.0}, {10.0}, {1.0, 1.0}};
  expect(r, "speeds of a restitution table");
  r.table = {{1.0}, {10.0, 91.0}, {1.0, 1.0}};
  expect(r, "angles of a restitution table");
  r.table = {{1.0}, {10.0, 90.0}, {1.0}};
  expect(r, "a value between 0 and 1");
  r.table = {{1.0}, {10.0, 90.0}, {1.0, 1.1}};
  expect(r, "a value between 0 and 1");
  r.table = {{}, {10.0}, {}};
  expect(r, "speeds of a restitution table");
}

}  // namespace dartcast::respond_test
