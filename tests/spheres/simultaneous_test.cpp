// Points and walls that move at the same time: cases with known answers, and random ones against all walls of the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/spheres.hpp"
#include "dartcast/validity.hpp"
#include "support/element_checks.hpp"
#include "support/meshes.hpp"
#include "support/sphere_checks.hpp"

namespace dartcast::simultaneous_test {

using test::all_walls;
using test::cubes;
using test::random_vector;
using test::scaled;

constexpr double time_bound = 0x1p-20;

// Points among walls that move with a map from place to place.
struct Cloud {
  explicit Cloud(MeshData mesh, Threads threads = Threads{1}) : environment(std::move(mesh), threads) {}

  bool add(const Vec3& x, const Vec3& velocity = {}) {
    if (environment.add(particles, std::vector<Vec3>{x})[0].location.place != Place::free) return false;
    velocities.push_back(velocity);
    statuses.push_back(ParticleStatus::alive);
    return true;
  }
  template <class Map>
  void move(const Map& map) {
    std::vector<Vec3> after;
    for (const Vec3& x : environment.positions()) after.push_back(map(x));
    environment.move(after);
  }
  [[nodiscard]] std::vector<Vec3> targets() const {
    std::vector<Vec3> all;
    for (std::size_t i = 0; i < particles.size(); ++i) all.push_back(particles[i].position + velocities[i]);
    return all;
  }
  StepReport step(const WallResponses& responses, const StepOptions& options = {}) {
    StepReport report =
        stepper.advance(environment, particles, targets(), respond_with(responses, velocities, statuses, 1.0), options);
    expect_in_order(report);
    return report;
  }
  static void expect_in_order(const StepReport& report) {
    const std::vector<Contact>& all = report.contacts.contacts;
    for (std::size_t i = 1; i < all.size(); ++i) {
      if (all[i].particle == all[i - 1].particle)
        EXPECT_GE(all[i].time_of_impact, all[i - 1].time_of_impact) << "particle " << all[i].particle;
    }
  }
  void expect_valid() const {
    const Audit audit = dartcast::audit(environment.complex(), particles, Threads{1});
    EXPECT_EQ(audit.failed, 0U) << audit.first;
  }

  Environment environment;
  Particles particles;
  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;
  SimultaneousStepper stepper;
};

std::string hash_of(const Particles& particles) {
  StateHash hash;
  for (std::size_t i = 0; i < particles.size(); ++i) hash.add(i, particles[i], {});
  return hash.hex();
}

const WallResponses& elastic() {
  static const WallResponses responses(WallResponse{WallResponseKind::reflect, 1.0, 0.0});
  return responses;
}

Vec3 turned(const Vec3& x, double angle, const Vec3& centre) {
  const Vec3 d = x - centre;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return centre + Vec3{c * d.x - s * d.y, s * d.x + c * d.y, d.z};
}

// The floor of a box rises while a point falls: they meet at the height that both reach at the same time.
TEST(Simultaneous, AFallingPointAndARisingFloor) {
  Cloud cloud(cubes(4));
  ASSERT_TRUE(cloud.add({2.25, 2.125, 1.0}, {0.25, 0.0, -0.5}));
  cloud.move([](const Vec3& x) { return Vec3{x.x, x.y, 1.0 + 0.75 * x.z}; });  // the floor goes from 0 to 1
  const StepReport report = cloud.step(elastic());
  ASSERT_EQ(report.contacts.contacts.size(), 1U);
  const Contact& c = report.contacts.contacts[0];
  EXPECT_NEAR(c.time_of_impact, 1.0 / 1.5, time_bound);
  EXPECT_LE(c.time_of_impact, 1.0 / 1.5);
  EXPECT_EQ(c.kind, Kind::face);
  EXPECT_NEAR(c.point.z, 2.0 / 3.0, 2e-6);
  EXPECT_NEAR(c.wall_displacement.z, 1.0, 1e-12);
  EXPECT_NEAR(norm(report.contacts.walls_of(c)[0].normal - Vec3{0.0, 0.0, 1.0}), 0.0, 1e-12);
  // Relative to the wall -1.5 becomes 1.5.
  EXPECT_NEAR(norm(cloud.velocities[0] - Vec3{0.25, 0.0, 2.5}), 0.0, 1e-12);
  EXPECT_NEAR(norm(cloud.particles[0].position - Vec3{2.5, 2.125, 2.0 / 3.0 + 2.5 / 3.0}), 0.0, 2e-5);
  cloud.expect_valid();
}

// A point flies to and fro between a floor and a ceiling that both move, several times in each step. The truth: one event
// after another, on a line.
TEST(Simultaneous, ManyContactsInOneStep) {
  Random random(11);
  for (int k = 0; k < scaled(200, 2000); ++k) {
    Cloud cloud(cubes(2, test::cube_types[static_cast<std::size_t>(k) % 4]));
    const double z = random.uniform(0.2, 1.8);
    const double speed = random.uniform(-6.0, 6.0);
    const double floor = random.uniform(-0.4, 0.4);  // how far they move
    const double ceiling = random.uniform(-0.4, 0.4);
    ASSERT_TRUE(cloud.add({0.7, 0.9, z}, {0.125, 0.25, speed}));
    cloud.move([&](const Vec3& x) { return x + Vec3{0.0, 0.0, floor + (ceiling - floor) * 0.5 * x.z}; });
    const StepReport report = cloud.step(elastic());
    double at = z;
    double v = speed;
    double time = 0.0;
    std::vector<double> times;
    while (true) {
      const double to_floor = v < floor ? (at - floor * time) / (floor - v) : 2.0;
      const double to_ceiling = v > ceiling ? (2.0 + ceiling * time - at) / (v - ceiling) : 2.0;
      const double next = std::min(to_floor, to_ceiling);
      if (time + next > 1.0) break;
      time += next;
      at += v * next;
      v = 2.0 * (to_floor < to_ceiling ? floor : ceiling) - v;
      times.push_back(time);
    }
    at += v * (1.0 - time);
    ASSERT_EQ(report.contacts.contacts.size(), times.size());
    for (std::size_t i = 0; i < times.size(); ++i)
      EXPECT_NEAR(report.contacts.contacts[i].time_of_impact, times[i], 1e-4);
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(report.contacts.contacts[i].earlier, i);
    EXPECT_EQ(cloud.particles[0].touching_count, 0);
    EXPECT_NEAR(cloud.velocities[0].z, v, 1e-9);
    EXPECT_NEAR(norm(cloud.particles[0].position - Vec3{0.825, 1.15, at}), 0.0, 1e-4);
    cloud.expect_valid();
  }
}

// A wall that comes to a point at rest pushes it along, and never passes over it.
TEST(Simultaneous, AWallPushesAPointAtRest) {
  for (const WallResponses* responses : {&elastic(), &test::sliding()}) {
    Cloud cloud(cubes(4, CellType::tetrahedron));
    ASSERT_TRUE(cloud.add({2.25, 2.125, 0.25}));
    cloud.move([](const Vec3& x) { return Vec3{x.x, x.y, 1.0 + 0.75 * x.z}; });
    const StepReport report = cloud.step(*responses);
    ASSERT_EQ(report.contacts.contacts.size(), 1U);
    EXPECT_NEAR(report.contacts.contacts[0].time_of_impact, 0.25, time_bound);
    const bool slides = responses == &test::sliding();
    EXPECT_NEAR(cloud.velocities[0].z, slides ? 1.0 : 2.0, 1e-12);
    EXPECT_NEAR(cloud.particles[0].position.z, slides ? 1.0 : 1.75, 1e-5);
    EXPECT_GT(cloud.particles[0].position.z, 1.0);
    cloud.expect_valid();
  }
}

// Aimed at the inside of a face, at the middle of an edge, and at a corner of a blocked cube that moves and turns. All
// numbers are exact.
TEST(Simultaneous, KindsOfContacts) {
  MeshData mesh = cubes(3);
  mesh.free.assign(27, 1);
  mesh.free[13] = 0;  // from (1, 1, 1) to (2, 2, 2)
  Random random(17);
  const auto small = [&] { return std::floor(random.uniform(-4.0, 5.0)) / 64.0; };
  for (int k = 0; k < scaled(150, 1500); ++k) {
    const auto kind = std::array{Kind::face, Kind::edge, Kind::vertex}[static_cast<std::size_t>(k) % 3];
    const Vec3 aim = kind == Kind::face   ? Vec3{1.5, 1.375, 2.0}
                     : kind == Kind::edge ? Vec3{1.0, 1.5, 2.0}
                                          : Vec3{1.0, 1.0, 2.0};
    const std::array<Vec3, 3> a = {
        Vec3{small(), small(), small()}, {small(), small(), small()}, {small(), small(), small()}};
    const auto moved = [&](const Vec3& x) {
      return x + Vec3{dot(a[0], x), dot(a[1], x), dot(a[2], x)} + Vec3{0.0, 0.0, 0.5};
    };
    Cloud cloud(mesh);
    const Vec3 at_half = (aim + moved(aim)) * 0.5;
    const Vec3 half_way = {-0.125, -0.25, -0.25};
    ASSERT_TRUE(cloud.add(at_half - half_way, half_way * 2.0));
    cloud.move(moved);
    const StepReport report = cloud.step(elastic());
    ASSERT_GE(report.contacts.contacts.size(), 1U);
    const Contact& c = report.contacts.contacts[0];
    EXPECT_NEAR(c.time_of_impact, 0.5, time_bound);
    EXPECT_EQ(c.kind, kind);
    EXPECT_EQ(c.wall_count, kind == Kind::face ? 1U : kind == Kind::edge ? 2U : 3U);
    EXPECT_LE(norm(c.point - at_half), 1e-5);
    cloud.expect_valid();
  }
}

struct Differences {
  int contacts = 0;
  int missed = 0;    // by Environment::advance()
  int invented = 0;  // likewise
};

// The normal of the wall that is met first, as it stands then.
void expect_a_normal_of(std::span<const MovingTriangle> walls, const MovingElement& point, const Contact& contact,
                        const ContactList& list) {
  double nearest = 2.0;
  for (const MovingTriangle& w : walls) {
    const auto time = test::boxes_meet(point, w) ? test::first_touch_of(point, w) : std::nullopt;
    if (!time || *time > contact.time_of_impact + 2.0 * time_bound) continue;
    std::array<Vec3, 3> v;
    for (std::size_t i = 0; i < 3; ++i) v[i] = w.from[i] + (w.to[i] - w.from[i]) * *time;
    const Vec3 normal = cross(v[2] - v[0], v[1] - v[0]);
    nearest = std::min(nearest, norm(normal * (1.0 / norm(normal)) - list.walls_of(contact)[0].normal));
  }
  EXPECT_LE(nearest, 1e-4);
}

// The first contact of each point against that with all walls of the scene.
Differences compare(std::uint64_t seed, const std::function<Vec3(const Vec3&)>& map, double speed) {
  Cloud cloud(cubes(6, test::cube_types[seed % 4], 0.15, 0.2, seed));
  Random random(seed);
  for (int k = 0; k < 60; ++k)
    cloud.add(random_vector(random, 3.0) + Vec3{3, 3, 3}, k % 3 == 0 ? Vec3{} : random_vector(random, speed));
  Particles carried = cloud.particles;
  const std::vector<Vec3> targets = cloud.targets();
  const std::vector<ParticleState> before(carried.states().begin(), carried.states().end());
  cloud.move(map);
  if (first_inversion(cloud.environment.complex())) return {};
  const auto walls = all_walls(cloud.environment.complex(), true);
  const StepReport report = cloud.stepper.advance(cloud.environment, cloud.particles, targets);
  const StepReport rides = cloud.environment.advance(carried, targets);
  cloud.expect_valid();
  Differences d;
  for (std::uint32_t i = 0; i < before.size(); ++i) {
    MovingElement point;
    point.from[0] = before[i].position;
    point.to[0] = targets[i];
    const auto truth = test::first_touch_of(point, walls);
    const auto of_point = [&](const StepReport& r) {
      return std::find_if(r.contacts.contacts.begin(), r.contacts.contacts.end(),
                          [&](const Contact& c) { return c.particle == i; });
    };
    const auto found = of_point(report);
    const bool rode = of_point(rides) != rides.contacts.contacts.end();
    d.contacts += truth ? 1 : 0;
    d.missed += truth && !rode ? 1 : 0;
    d.invented += !truth && rode ? 1 : 0;
    EXPECT_EQ(found != report.contacts.contacts.end(), truth.has_value()) << "seed " << seed << ", point " << i;
    if (truth && found != report.contacts.contacts.end()) {
      EXPECT_LE(std::abs(found->time_of_impact - *truth), time_bound) << "seed " << seed << ", point " << i;
    }
    if (!truth) {
      EXPECT_EQ(cloud.particles[i].position, targets[i]);
      continue;
    }
    expect_a_normal_of(walls, point, *found, report.contacts);
  }
  return d;
}

TEST(Simultaneous, FirstContactsAreThoseWithAllWalls) {
  Differences turning;
  Differences waving;
  const auto add = [](Differences& sum, const Differences& d) {
    sum.contacts += d.contacts;
    sum.missed += d.missed;
    sum.invented += d.invented;
  };
  for (std::uint64_t seed = 1; seed <= scaled<std::uint64_t>(200, 4000); ++seed) {
    add(turning, compare(
                     seed,
                     [](const Vec3& x) {
                       return turned(x, 0.1, {3, 3, 3});
                     },
                     0.3));
    add(waving, compare(
                    seed, [](const Vec3& x) { return test::waved(std::vector<Vec3>{x}, 0.15)[0]; }, 0.3));
  }
  for (const Differences& d : {turning, waving})
    std::printf("contacts %d; carried along: missed %d, invented %d\n", d.contacts, d.missed, d.invented);
  EXPECT_GT(turning.contacts, test::sanitized() ? 10 : 500);
  EXPECT_GT(waving.contacts, test::sanitized() ? 10 : 300);
  if (!test::sanitized()) EXPECT_GT(turning.missed + turning.invented, 0);  // else the option has no use
}

// Points in a closed chamber, and around it, over many steps in which all walls move to and fro, much farther than the
// points come from each wall. None ever passes one.
TEST(Simultaneous, NoPointLeavesItsChamber) {
  MeshData mesh = cubes(5, CellType::tetrahedron, 0.0, 0.2, 7);
  mesh.free.assign(mesh.cell_count(), 1);
  const std::size_t parts = mesh.cell_count() / 125;
  const auto distance_of = [](std::size_t cube) {  // from the middle cube, in cubes
    const std::array<int, 3> at = {int(cube % 5), int(cube / 5 % 5), int(cube / 25)};
    return std::max({std::abs(at[0] - 2), std::abs(at[1] - 2), std::abs(at[2] - 2)});
  };
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) mesh.free[c] = distance_of(c / parts) == 1 ? 0 : 1;
  Cloud cloud(std::move(mesh));
  const std::vector<Vec3> rest(cloud.environment.positions().begin(), cloud.environment.positions().end());
  Random random(3);
  for (int k = 0; k < 400; ++k) {
    const Vec3 at = random_vector(random, k % 10 == 0 ? 0.4 : 2.4);
    cloud.add(at + Vec3{2.5, 2.5, 2.5}, random_vector(random, 0.2));
  }
  const auto is_inside = [&](const ParticleState& s) {
    return distance_of(cloud.environment.map().source(s.cell) / parts) == 0;
  };
  std::vector<bool> inside;
  for (const ParticleState& s : cloud.particles.states()) inside.push_back(is_inside(s));
  EXPECT_GT(std::count(inside.begin(), inside.end(), true), 20);
  std::uint64_t contacts = 0;
  for (int step = 1; step <= scaled(150, 3000); ++step) {
    std::vector<Vec3> after;
    for (const Vec3& x : rest) {
      const Vec3 turning = turned(x, 0.3 * std::sin(0.4 * step), {2.5, 2.5, 2.5});
      after.push_back(test::waved(std::vector<Vec3>{turning}, 0.12 * std::sin(0.7 * step))[0]);
    }
    cloud.environment.move(after);
    const WallResponses& responses = step % 3 == 0 ? test::sliding() : test::bouncing();
    contacts += cloud.step(responses).contacts.contacts.size();
    cloud.expect_valid();
    for (std::size_t i = 0; i < inside.size(); ++i)
      ASSERT_EQ(is_inside(cloud.particles[i]), inside[i]) << "step " << step;
    for (Vec3& v : cloud.velocities) v = v * std::min(1.0, 0.5 / std::max(norm(v), 1e-9));
  }
  EXPECT_GT(contacts, test::sanitized() ? 10U : 3000U);
}

// In the plane walls are edges.
TEST(Simultaneous, InThePlane) {
  RectangleOptions box;
  box.cells = {6, 6};
  box.size = {6.0, 6.0};
  box.type = CellType::triangle;
  box.blocked_share = 0.1;
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= scaled<std::uint64_t>(40, 400); ++seed) {
    box.seed = seed;
    Cloud cloud(generate_rectangle(box));
    Random random(seed);
    for (int k = 0; k < 40; ++k) {
      Vec3 at = random_vector(random, 3.0) + Vec3{3, 3, 0};
      Vec3 velocity = random_vector(random, 0.5);
      at.z = velocity.z = 0.0;
      cloud.add(at, velocity);
    }
    const std::vector<Vec3> targets = cloud.targets();
    const std::vector<ParticleState> before(cloud.particles.states().begin(), cloud.particles.states().end());
    cloud.move([](const Vec3& x) { return turned(x, 0.2, {3, 3, 0}); });
    const auto walls = all_walls(cloud.environment.complex(), true);
    const StepReport report = cloud.step(test::bouncing());
    cloud.expect_valid();
    for (std::uint32_t i = 0; i < before.size(); ++i) {
      MovingElement point;
      point.from[0] = before[i].position;
      point.to[0] = targets[i];
      const auto truth = test::first_touch_of(point, walls);
      const auto found = std::find_if(report.contacts.contacts.begin(), report.contacts.contacts.end(),
                                      [&](const Contact& c) { return c.particle == i; });
      ASSERT_EQ(found != report.contacts.contacts.end(), truth.has_value()) << "seed " << seed << ", point " << i;
      if (!truth) continue;
      ++contacts;
      EXPECT_LE(std::abs(found->time_of_impact - *truth), time_bound);
      EXPECT_EQ(found->kind, Kind::edge);
    }
  }
  EXPECT_GT(contacts, test::sanitized() ? 5 : 100);
}

TEST(Simultaneous, AnyNumberOfThreads) {
  std::vector<std::string> hashes;
  for (const unsigned threads : {0U, 1U, 2U, 5U}) {
    Cloud cloud(cubes(6, CellType::prism, 0.1, 0.2, 3), Threads{threads});
    Random random(5);
    for (int k = 0; k < 2000; ++k) cloud.add(random_vector(random, 3.0) + Vec3{3, 3, 3}, random_vector(random, 0.4));
    std::size_t contacts = 0;
    for (int step = 0; step < 3; ++step) {
      cloud.move([&](const Vec3& x) { return turned(x, 0.1, {3, 3, 3}); });
      contacts += cloud.step(test::bouncing()).contacts.contacts.size();
    }
    EXPECT_GT(contacts, 100U);
    hashes.push_back(hash_of(cloud.particles));
  }
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

// A point that sticks is carried by its wall from then on, and meets no other.
TEST(Simultaneous, StickingPoints) {
  const WallResponses sticky(WallResponse{WallResponseKind::stick, 0.0, 0.0});
  Cloud cloud(cubes(4));
  ASSERT_TRUE(cloud.add({2.25, 2.125, 0.25}));
  cloud.move([](const Vec3& x) { return Vec3{x.x + 0.5, x.y, 1.0 + 0.75 * x.z}; });
  ASSERT_EQ(cloud.step(sticky).contacts.contacts.size(), 1U);
  EXPECT_EQ(cloud.statuses[0], ParticleStatus::stuck);
  // It meets the floor at the time 1/4, at x = 2.25, and goes along with it: 0.375 farther.
  EXPECT_NEAR(norm(cloud.particles[0].position - Vec3{2.625, 2.125, 1.0}), 0.0, 2e-6);
  cloud.expect_valid();
  for (int step = 1; step < 20; ++step) {
    cloud.velocities[0] = {-0.01 * step, 0.0, -0.05 * step};
    cloud.move([&](const Vec3& x) { return x + cloud.velocities[0]; });
    EXPECT_TRUE(cloud.step(sticky).contacts.contacts.empty());
    cloud.expect_valid();
  }
}

// A point that starts on a wall and leaves it is carried along, as by Environment::advance(), to the last bit.
TEST(Simultaneous, PointsThatLeaveAWall) {
  Cloud cloud(cubes(4, CellType::tetrahedron));
  for (const Vec3& x : {Vec3{1.25, 2.5, 0.0}, Vec3{1.0, 2.0, 0.0}, Vec3{0.0, 0.0, 0.0}})
    ASSERT_TRUE(cloud.add(x, {0.25, 0.25, 1.5}));
  Particles carried = cloud.particles;
  std::vector<Vec3> velocities = cloud.velocities;
  const auto targets = cloud.targets();
  cloud.move([](const Vec3& x) { return turned(x, 0.1, {2.0, 2.0, 2.0}) + Vec3{0.0, 0.0, 0.25}; });
  EXPECT_TRUE(cloud.step(elastic()).contacts.contacts.empty());
  cloud.environment.advance(carried, targets, respond_with(elastic(), velocities, cloud.statuses, 1.0));
  EXPECT_EQ(hash_of(cloud.particles), hash_of(carried));
  cloud.expect_valid();
}

// One that is pressed against its wall has a contact there, and is off it afterwards.
TEST(Simultaneous, PointsThatArePressedAgainstAWall) {
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron}) {
    Cloud cloud(cubes(4, type));
    ASSERT_TRUE(cloud.add({1.25, 2.5, 0.0}));
    double floor = 0.0;
    for (int step = 0; step < 40; ++step) {
      const double rise = 0.01 * std::sin(0.5 * step);
      cloud.velocities[0].x = 0.02;
      cloud.velocities[0].z -= 0.001;
      cloud.move([&](const Vec3& x) { return x + Vec3{0.0, 0.0, rise * (1.0 - 0.1 * x.z)}; });
      floor += rise * (1.0 - 0.1 * floor);
      const StepReport report = cloud.step(test::sliding());
      for (const Contact& c : report.contacts.contacts) EXPECT_EQ(c.time_of_impact > 0.0, step > 0) << step;
      EXPECT_EQ(report.contacts.contacts.size() > 0, cloud.particles[0].position.z < floor + 1e-5) << step;
      EXPECT_GT(cloud.particles[0].position.z, floor);
      cloud.expect_valid();
    }
    EXPECT_NEAR(cloud.particles[0].position.x, 2.05, 1e-6);
  }
}

// Without a response a point stays at the wall.
TEST(Simultaneous, WithoutAResponse) {
  Cloud cloud(cubes(4));
  ASSERT_TRUE(cloud.add({2.25, 2.125, 0.25}, {0.0, 0.5, 0.0}));
  const auto targets = cloud.targets();
  cloud.move([](const Vec3& x) { return Vec3{x.x, x.y, 1.0 + 0.75 * x.z}; });
  const StepReport report = cloud.stepper.advance(cloud.environment, cloud.particles, targets);
  ASSERT_EQ(report.stopped.size(), 1U);
  EXPECT_NEAR(norm(report.stopped[0].unused - Vec3{0.0, 0.375, -0.75}), 0.0, 1e-5);
  EXPECT_NEAR(norm(cloud.particles[0].position - Vec3{2.25, 2.25, 1.0}), 0.0, 2e-6 + 0.0);
  cloud.expect_valid();
}

// A point between two walls that close in on it meets more of them than a step allows: they carry it then.
TEST(Simultaneous, MoreContactsThanAllowed) {
  for (const unsigned most : {1U, 2U, 5U}) {
    Cloud cloud(cubes(2));
    ASSERT_TRUE(cloud.add({1.0, 1.0, 1.0}, {0.0, 0.0, 40.0}));
    const auto targets = cloud.targets();
    cloud.move([](const Vec3& x) { return Vec3{x.x, x.y, 1.0 + 0.05 * (x.z - 1.0)}; });
    StepOptions options;
    options.max_contacts = most;
    const auto rebound = [](const Contact& c, auto, auto) {  // at the last contact, too
      return AfterContact{{c.unused.x, c.unused.y, -c.unused.z}, true};
    };
    const StepReport report = cloud.stepper.advance(cloud.environment, cloud.particles, targets, rebound, options);
    EXPECT_GE(report.contacts.contacts.size(), most);
    EXPECT_LE(report.contacts.contacts.size(), most + 1U);
    EXPECT_EQ(report.counters.unfinished, 1U);
    EXPECT_NEAR(cloud.particles[0].position.z, 1.0, 0.05 + 1e-12);
    cloud.expect_valid();
  }
}

// Where a cell turns over the step is that of Environment::advance(), to the last bit.
TEST(Simultaneous, CellsThatBecomeFlat) {
  Cloud cloud(cubes(4));
  ASSERT_TRUE(cloud.add({1.5, 1.5, 1.5}, {0.1, 0.0, 0.0}));
  Particles carried = cloud.particles;
  const auto targets = cloud.targets();
  cloud.move([](const Vec3& x) { return x.z == 1.0 ? x + Vec3{0.0, 0.0, 1.5} : x; });
  const StepReport report = cloud.stepper.advance(cloud.environment, cloud.particles, targets);
  const StepReport rides = cloud.environment.advance(carried, targets);
  EXPECT_EQ(report.held.size(), rides.held.size());
  EXPECT_EQ(hash_of(cloud.particles), hash_of(carried));
}

TEST(Simultaneous, BadInputChangesNothing) {
  Cloud cloud(cubes(4));
  ASSERT_TRUE(cloud.add({2.25, 2.125, 0.25}));
  cloud.move([](const Vec3& x) { return Vec3{x.x, x.y, 1.0 + 0.75 * x.z}; });
  const auto before = hash_of(cloud.particles);
  const auto advance = [&](const std::vector<Vec3>& targets, const ContactCallback& respond) {
    cloud.stepper.advance(cloud.environment, cloud.particles, targets, respond);
  };
  EXPECT_THROW(advance({}, {}), InvalidArgument);
  EXPECT_THROW(advance({{std::nan(""), 0.0, 0.0}}, {}), InvalidArgument);
  const auto far = [](const Contact&, auto, auto) { return AfterContact{{std::nan(""), 0.0, 0.0}, false}; };
  EXPECT_THROW(advance(cloud.targets(), far), InvalidArgument);
  EXPECT_EQ(hash_of(cloud.particles), before);
  EXPECT_NO_THROW(advance(cloud.targets(), {}));
}

}  // namespace dartcast::simultaneous_test
