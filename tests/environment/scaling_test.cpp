// Scenes scaled by powers of two and shifted, over the range in which signs are exact.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "support/particle_checks.hpp"

namespace dartcast::scaling_test {

MeshData scene(double scale, const Vec3& shift) {
  BoxOptions o;
  o.cells = {4, 4, 4};
  o.size = {4, 4, 4};
  o.mixed = true;
  o.blocked_share = 0.1;
  o.jitter = 0.25;
  MeshData mesh = generate_box(o);
  for (Vec3& p : mesh.points) p = (p + shift) * scale;
  return mesh;
}

struct Outcome {
  std::vector<ParticleState> states;
  std::vector<Vec3> velocities;
  std::vector<Contact> contacts;
  Counters counters;
};

enum class Motion { still, deforming };

// A random flight with rebounds; all lengths are multiples of `scale`, a power of two.
Outcome run(double scale, const Vec3& shift, Motion motion, int steps) {
  const MeshData mesh = scene(scale, shift);
  Environment environment(mesh, Threads{1});
  Particles particles;
  Random random(6);
  std::vector<Vec3> start = test::random_points(100, {0, 0, 0}, {4, 4, 4}, random);
  for (Vec3& p : start) p = (p + shift) * scale;
  environment.add(particles, start);
  EXPECT_GT(particles.size(), 80U);
  Outcome outcome;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    outcome.velocities.push_back(Vec3{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)} * scale);
  }
  std::vector<ParticleStatus> statuses(particles.size(), ParticleStatus::alive);
  const WallResponses responses({WallResponseKind::reflect, 0.9, 0.05});
  std::vector<Vec3> targets(particles.size());
  for (int step = 1; step <= steps; ++step) {
    for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = particles[i].position + outcome.velocities[i] * 0.25;
    if (motion == Motion::deforming) {
      const auto next = environment.next_positions();
      for (std::size_t i = 0; i < next.size(); ++i) {
        // Products of doubles, so that the deformation itself scales to the bit.
        const double turn = 0.02 * std::sin(0.4 * step);
        const Vec3& p = mesh.points[i];
        next[i] = {p.x + turn * (p.y - shift.y * scale), p.y - turn * (p.x - shift.x * scale), p.z};
      }
      environment.move();
    }
    const StepReport report =
        environment.advance(particles, targets, respond_with(responses, outcome.velocities, statuses, 0.25));
    outcome.contacts.insert(outcome.contacts.end(), report.contacts.contacts.begin(), report.contacts.contacts.end());
    outcome.counters += report.counters;
    EXPECT_TRUE(report.held.empty());
  }
  EXPECT_EQ(test::check_states(environment, particles), "") << "scale " << scale;
  outcome.states = test::copy_of(particles);
  return outcome;
}

void expect_scaled(const Outcome& a, const Outcome& b, double scale) {
  ASSERT_EQ(a.states.size(), b.states.size());
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    ParticleState s = a.states[i];
    s.position *= scale;
    ASSERT_TRUE(test::same_bits(s, b.states[i])) << "particle " << i;
    ASSERT_EQ(test::bits(a.velocities[i] * scale), test::bits(b.velocities[i])) << "particle " << i;
  }
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    const Contact& x = a.contacts[i];
    const Contact& y = b.contacts[i];
    EXPECT_EQ(x.particle, y.particle);
    EXPECT_EQ(x.kind, y.kind);
    EXPECT_EQ(x.dart, y.dart);
    EXPECT_EQ(x.time_of_impact, y.time_of_impact);
    EXPECT_EQ(x.point * scale, y.point);
    EXPECT_EQ(x.unused * scale, y.unused);
    EXPECT_EQ(x.wall_displacement * scale, y.wall_displacement);
  }
  EXPECT_EQ(a.counters.orientation.tests, b.counters.orientation.tests);
  EXPECT_EQ(a.counters.steps_split, b.counters.steps_split);
}

constexpr int steps = 40;

TEST(Scaling, ByPowersOfTwoGivesTheSameBits) {
  for (const Motion motion : {Motion::still, Motion::deforming}) {
    const Outcome one = run(1.0, {}, motion, steps);
    EXPECT_GT(one.contacts.size(), 300U);
    for (const int k : {-220, -131, -60, -1, 1, 13, 100, 200, 250, 290}) {
      SCOPED_TRACE(k);
      const double scale = std::ldexp(1.0, k);
      expect_scaled(one, run(scale, {}, motion, steps), scale);
    }
  }
}

// Smaller still the filters decide nothing, and values are rounded from exact ones: other last bits, but nothing is
// lost.
TEST(Scaling, DownToTheSmallestMagnitudes) {
  for (const Motion motion : {Motion::still, Motion::deforming}) {
    const Outcome one = run(1.0, {}, motion, 4);
    for (const int k : {-235, -250}) {
      SCOPED_TRACE(k);
      const double scale = std::ldexp(1.0, k);
      const Outcome small = run(scale, {}, motion, 4);
      ASSERT_EQ(small.states.size(), one.states.size());
      EXPECT_EQ(small.contacts.size(), one.contacts.size());
      for (std::size_t i = 0; i < one.states.size(); ++i) {
        EXPECT_LT(norm((small.states[i].position * (1.0 / scale)) - one.states[i].position), 1e-11) << "particle " << i;
      }
    }
  }
}

TEST(Scaling, ShiftedScenesLoseNobody) {
  for (const Motion motion : {Motion::still, Motion::deforming}) {
    for (const int k : {20, 30, 40}) {
      SCOPED_TRACE(k);
      const Vec3 shift{std::ldexp(1.0, k), -std::ldexp(1.0, k), std::ldexp(0.75, k)};
      const Outcome far = run(1.0, shift, motion, steps);
      EXPECT_GT(far.contacts.size(), 300U);
    }
  }
}

TEST(Scaling, RefusedOutsideTheRange) {
  EXPECT_THROW(Environment(scene(0x1p+299, {})), InvalidMesh);  // 4 * 2^299
  EXPECT_THROW(Environment(scene(0x1p-305, {})), InvalidMesh);  // all counts as 0: the cells are flat
  Environment environment(scene(1.0, {}));
  Particles particles;
  EXPECT_THROW(environment.add(particles, std::vector<Vec3>{{0x1p+301, 1, 1}}), InvalidArgument);
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}, {0x1p-300, 0, 0}});
  EXPECT_THROW(environment.advance(particles, std::vector<Vec3>(particles.size(), Vec3{0, -0x1p+301, 0})),
               InvalidArgument);
}

}  // namespace dartcast::scaling_test
