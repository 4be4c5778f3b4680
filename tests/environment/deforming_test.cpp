// Scenes that deform: walls that sweep over particles at rest, long contact with a moving wall, a blade that turns.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "complex/simplex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "support/meshes.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::deforming_test {

using test::positions_of;
using test::scaled;

// Exact: in the closed simplex named, of a free cell, at the current positions.
void expect_valid(const Environment& env, const Particles& particles) {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const ParticleState& s = particles[i];
    ASSERT_TRUE(env.map().is_free(s.cell)) << "particle " << i;
    const Corners v = env.complex().corners(s.at());
    for (unsigned f = 0; f < 4; ++f) {
      ASSERT_NE(orient_facet(v, f, s.position), Sign::negative) << "particle " << i << ", facet " << f;
      ASSERT_NE(orient_facet(v, f, s.position), Sign::undecidable) << "particle " << i;
    }
  }
}

// Random points in the free cells of a mesh over a box.
void scatter(Environment& env, Particles& particles, std::size_t count, const Vec3& size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  while (particles.size() < count) {
    std::vector<Vec3> points;
    for (std::size_t i = particles.size(); i < count; ++i)
      points.push_back({size.x * unit(random), size.y * unit(random), size.z * unit(random)});
    env.add(particles, points);
  }
}

template <class CombinatorialMap>
void move_all(Environment& env, std::span<const Vec3> rest, CombinatorialMap&& map) {
  auto next = env.next_positions();
  for (std::size_t i = 0; i < rest.size(); ++i) next[i] = map(rest[i]);
  env.move();
}

// Blocks the cells whose corners' mean satisfies `inside`.
template <class Inside>
void block(MeshData& mesh, Inside&& inside) {
  mesh.free.assign(mesh.cell_count(), 1);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    Vec3 mean;
    for (const std::uint32_t v : mesh.cell(c)) mean += mesh.points[v];
    if (inside(mean * (1.0 / static_cast<double>(mesh.cell(c).size())))) mesh.free[c] = 0;
  }
}

class DeformingByType : public testing::TestWithParam<CellType> {};
INSTANTIATE_TEST_SUITE_P(Types, DeformingByType,
                         testing::Values(CellType::hexahedron, CellType::tetrahedron, CellType::prism,
                                         CellType::pyramid));

// A blocked slab travels through a box of particles at rest: each stays on its side, and only those on its way are
// moved.
TEST_P(DeformingByType, SlabThatSweepsOverParticlesAtRest) {
  MeshData mesh = test::unit_box({10, 3, 3}, GetParam());
  block(mesh, [](const Vec3& m) { return m.x > 4.0 && m.x < 5.0; });
  Environment env(mesh);
  const std::vector<Vec3> rest(mesh.points);
  Particles particles;
  scatter(env, particles, scaled<std::size_t>(2000, 20000), {10.0, 3.0, 3.0}, 1);
  const std::vector<Vec3> start = positions_of(particles);
  const std::size_t steps = 60;
  double travelled = 0.0;
  std::size_t pushed = 0;
  for (std::size_t step = 1; step <= steps; ++step) {
    travelled = 3.5 * static_cast<double>(step) / steps;
    const double front = 5.0 + travelled;
    const double back = 4.0 + travelled;
    move_all(env, rest, [&](Vec3 p) {
      p.x = p.x <= 4.0 ? p.x / 4.0 * back : p.x >= 5.0 ? front + (p.x - 5.0) / 5.0 * (10.0 - front) : p.x + travelled;
      return p;
    });
    const auto targets = positions_of(particles);
    env.advance(particles, targets,
                [](const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier) {
                  return AfterContact{slid(c.unused, walls, earlier), true};
                });
    ASSERT_NO_FATAL_FAILURE(expect_valid(env, particles));
  }
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3& p = particles[i].position;
    if (start[i].x < 4.5) {
      EXPECT_LE(p.x, 4.0 + travelled) << i;
      EXPECT_EQ(p, start[i]) << "nothing touched particle " << i;
    } else {
      EXPECT_GE(p.x, 5.0 + travelled - 1e-9) << i;
      if (start[i].x > 5.0 + travelled) {
        EXPECT_EQ(p, start[i]) << "nothing touched particle " << i;
      } else {
        EXPECT_NEAR(p.x, 5.0 + travelled, 1e-9) << i;
        ++pushed;
      }
    }
  }
  EXPECT_GT(pushed, particles.size() / 5);
}

// A particle pressed on a floor that heaves for 10^4 steps follows it, and goes nowhere else.
TEST_P(DeformingByType, ContactWithMovingFloorFor10000Steps) {
  const MeshData mesh = test::unit_box({3, 3, 3}, GetParam());
  Environment env(mesh);
  const std::vector<Vec3> rest(mesh.points);
  Particles particles;
  env.add(particles, std::vector<Vec3>{{1.3, 1.6, 0.0}, {0.7, 2.2, 0.25}, {1.5, 1.5, 0.0}, {2.0, 1.0, 0.0}});
  ASSERT_EQ(particles.size(), 4U);
  const auto start = positions_of(particles);
  const std::size_t steps = scaled<std::size_t>(10000, 100000);
  for (std::size_t step = 1; step <= steps; ++step) {
    const double floor = 0.4 * std::sin(0.05 * static_cast<double>(step));
    move_all(env, rest, [&](Vec3 p) {
      p.z = floor + p.z / 3.0 * (3.0 - floor);
      return p;
    });
    auto targets = positions_of(particles);
    for (Vec3& t : targets) t.z -= 0.1;
    const StepReport report = env.advance(particles, targets, [](const Contact& c, auto walls, auto earlier) {
      return AfterContact{slid(c.unused, walls, earlier), true};
    });
    ASSERT_TRUE(report.held.empty());
    ASSERT_NO_FATAL_FAILURE(expect_valid(env, particles)) << "step " << step;
    if (step < 10) continue;  // the second has some way to fall
    for (std::size_t i = 0; i < particles.size(); ++i) {
      ASSERT_NEAR(particles[i].position.z, floor, 1e-9) << "particle " << i << ", step " << step;
      ASSERT_GT(particles[i].touching_count, 0) << "particle " << i << ", step " << step;
    }
  }
  for (std::size_t i = 0; i < particles.size(); ++i) {
    EXPECT_NEAR(particles[i].position.x, start[i].x, 1e-9) << i;
    EXPECT_NEAR(particles[i].position.y, start[i].y, 1e-9) << i;
  }
}

// Maps a box over (radius, turn, height) to a ring that is turned by an angle.
struct Ring {
  double sectors;
  Vec3 operator()(const Vec3& p, double angle) const {
    const double radius = 1.0 + p.x;
    const double phi = 1.8 * std::numbers::pi * p.y / sectors + angle;
    return {radius * std::cos(phi), radius * std::sin(phi), p.z};
  }
};

// Two chambers of a ring, parted by a blade, turn about particles at rest: none changes chambers, and a particle is
// moved only when the blade or an end of the ring has come to it.
TEST_P(DeformingByType, BladeThatTurns) {
  const std::uint32_t sectors = 40;
  MeshData mesh = test::unit_box({6, sectors, 2}, GetParam());
  block(mesh, [](const Vec3& m) { return m.y > 20.0 && m.y < 21.0; });
  const std::vector<Vec3> flat(mesh.points);
  const Ring ring{static_cast<double>(sectors)};
  for (Vec3& p : mesh.points) p = ring(p, 0.0);
  Environment env(mesh);
  Particles particles;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Vec3> points;
  std::vector<double> turn;  // place along the ring, in sectors
  for (std::size_t i = 0; i < scaled<std::size_t>(2000, 20000); ++i) {
    const double y = unit(random) < 0.5 ? 20.0 * unit(random) : 21.0 + 19.0 * unit(random);
    const Vec3 p = ring({0.3 + 5.4 * unit(random), y, 2.0 * unit(random)}, 0.0);
    if (env.locate(p).place != Place::free) continue;
    points.push_back(p);
    turn.push_back(y);
  }
  env.add(particles, points);
  const double total = 1.2;
  const std::size_t steps = 24;  // 0.05 a step: at the rim a third of a cell
  const double sector = 1.8 * std::numbers::pi / sectors;
  for (std::size_t step = 1; step <= steps; ++step) {
    const double angle = total * static_cast<double>(step) / steps;
    move_all(env, flat, [&](const Vec3& p) { return ring(p, angle); });
    const auto targets = positions_of(particles);
    env.advance(particles, targets, [](const Contact& c, auto walls, auto earlier) {
      return AfterContact{slid(c.unused, walls, earlier), true};
    });
    ASSERT_NO_FATAL_FAILURE(expect_valid(env, particles));
  }
  std::size_t pushed = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const bool first_chamber = turn[i] < 20.5;
    const std::uint32_t source = env.map().source(particles[i].cell);
    const double y = flat[mesh.cell(source)[0]].y;
    EXPECT_EQ(y < 20.5, first_chamber) << "particle " << i << " changed chambers";
    // Behind it comes the start of the ring or the blade; they sweep total / sector sectors.
    const double gap = turn[i] - (first_chamber ? 0.0 : 21.0);
    const double swept = total / sector;
    if (gap > swept + 0.5) EXPECT_EQ(particles[i].position, points[i]) << "nothing touched particle " << i;
    if (gap < swept - 0.5) {
      EXPECT_NE(particles[i].position, points[i]) << "the blade passed particle " << i;
      ++pushed;
    }
  }
  EXPECT_GT(pushed, particles.size() / 8);
}

// With the ring turning far in one step, splitting keeps the error of the chord within its tolerance.
TEST(Deforming, LargeTurnsAreSplit) {
  const std::uint32_t sectors = 40;
  MeshData mesh = test::unit_box({6, sectors, 2}, CellType::hexahedron);
  const std::vector<Vec3> flat(mesh.points);
  const Ring ring{static_cast<double>(sectors)};
  for (Vec3& p : mesh.points) p = ring(p, 0.0);
  Environment env(mesh);
  Particles particles;
  // Just outside the inner border, and away from the ends: the true motion (rest) meets no wall; the chord's sagitta
  // would.
  std::vector<Vec3> points;
  for (int i = 12; i < 36; ++i) points.push_back(ring({0.02, i + 0.37, 1.0}, 0.0));
  for (int i = 12; i < 36; ++i) points.push_back(ring({3.0, i + 0.37, 1.0}, 0.0));
  env.add(particles, points);
  move_all(env, flat, [&](const Vec3& p) { return ring(p, 0.8); });
  const StepReport report = env.advance(particles, points);
  EXPECT_GT(report.counters.steps_split, 0U);
  ASSERT_NO_FATAL_FAILURE(expect_valid(env, particles));
  for (std::size_t i = 0; i < particles.size(); ++i) EXPECT_EQ(particles[i].position, points[i]) << i;

  // The same in one part: the chord cuts the inner wall.
  Environment coarse(mesh);
  Particles again;
  coarse.add(again, points);
  move_all(coarse, flat, [&](const Vec3& p) { return ring(p, 0.8); });
  StepOptions options;
  options.tolerance = 1e9;
  EXPECT_FALSE(coarse.advance(again, points, {}, options).contacts.contacts.empty());
}

// Random scenes of all types, obstacles and responses, all vertices moving at random at every step: states stay exact.
TEST(Deforming, RandomMotionOfAllVertices) {
  const unsigned rounds = test::full_tier() ? 240 : test::sanitized() ? 6 : 24;
  for (unsigned seed = 0; seed < rounds; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    BoxOptions options;
    options.cells = {5, 4, 4};
    options.size = {5.0, 4.0, 4.0};
    options.blocked_share = 0.15;
    options.seed = seed;
    options.jitter = 0.3;
    test::set_kind(options, static_cast<int>(seed % 5));
    const MeshData mesh =
        seed % 6 == 5
            ? generate_octahedra({.cells = {3, 3, 3}, .size = Vec3{1.0, 1.0, 1.0}, .blocked_share = 0.2, .seed = seed})
            : generate_box(options);
    Environment env(mesh);
    const std::vector<Vec3> rest(mesh.points);
    Particles particles;
    scatter(env, particles, 200, {2.5, 2.5, 2.5}, seed);
    std::vector<Vec3> velocity(particles.size());
    std::vector<ParticleStatus> fate(particles.size());
    for (Vec3& v : velocity) v = {unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5};
    static constexpr std::array kinds = {WallResponseKind::reflect, WallResponseKind::slide, WallResponseKind::stick};
    const WallResponse response{kinds[seed % 3], unit(random), 0.3 * unit(random)};
    const WallResponses responses(response);
    const double scale = norm(rest[mesh.cell(0)[0]] - rest[mesh.cell(0)[1]]);
    for (int step = 0; step < 60; ++step) {
      move_all(env, rest, [&](Vec3 p) {
        const double a = 0.25 * std::sin(0.1 * step + p.x);
        const Vec3 shift{0.03 * scale * (unit(random) - 0.5), 0.03 * scale * (unit(random) - 0.5),
                         0.03 * scale * (unit(random) - 0.5)};
        return Vec3{p.x + 0.3 * a * p.y, p.y - a * p.z * 0.3, p.z + 0.2 * a} + shift;
      });
      auto targets = positions_of(particles);
      for (std::size_t i = 0; i < targets.size(); ++i)
        targets[i] += velocity[i] * (fate[i] == ParticleStatus::alive ? 0.4 : 0.0);
      const StepReport report = env.advance(particles, targets, respond_with(responses, velocity, fate, 0.4));
      ASSERT_TRUE(report.held.empty()) << "seed " << seed << ", step " << step;
      ASSERT_NO_FATAL_FAILURE(expect_valid(env, particles)) << "seed " << seed << ", step " << step;
    }
  }
}

// The rebound from a wall in motion uses the wall motion that the detection used: elastic, from a piston of speed w, a
// particle of speed v comes back with v + 2 w.
TEST(Deforming, ReboundFromPiston) {
  const MeshData mesh = test::unit_box({4, 2, 2}, CellType::hexahedron);
  Environment env(mesh);
  const std::vector<Vec3> rest(mesh.points);
  Particles particles;
  env.add(particles, std::vector<Vec3>{{0.6, 0.7, 1.1}});
  const double dt = 0.1;
  const double piston = 0.5;
  std::vector<Vec3> velocity = {{-1.0, 0.2, 0.0}};
  std::vector<ParticleStatus> fate(1);
  const WallResponses responses(WallResponse{WallResponseKind::reflect, 1.0, 0.0});
  std::size_t contacts = 0;
  for (int step = 1; step <= 20; ++step) {
    const double x = piston * dt * step;
    move_all(env, rest, [&](Vec3 p) {
      p.x = x + p.x / 4.0 * (4.0 - x);
      return p;
    });
    const Vec3 p = particles[0].position;
    const std::vector<Vec3> target = {p + velocity[0] * dt};
    const auto report = env.advance(particles, target, respond_with(responses, velocity, fate, dt));
    contacts += report.contacts.contacts.size();
    for (const Contact& c : report.contacts.contacts) {
      EXPECT_NEAR(c.wall_displacement.x, piston * dt, 1e-12);
      EXPECT_NEAR(c.point.x, x, 1e-12);
    }
    ASSERT_NO_FATAL_FAILURE(expect_valid(env, particles));
  }
  EXPECT_EQ(contacts, 1U);
  EXPECT_NEAR(velocity[0].x, 1.0 + 2 * piston, 1e-9);
  EXPECT_NEAR(velocity[0].y, 0.2, 1e-12);
}

}  // namespace dartcast::deforming_test
