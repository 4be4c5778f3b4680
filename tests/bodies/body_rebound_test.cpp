// Impacts of bodies, as given to them.
#include "bodies/body_rebound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.hpp"

namespace dartcast::body_rebound_test {

constexpr double dt = 1e-3;

// Bodies of one particle each.
struct Balls {
  std::vector<std::uint32_t> body_of;
  std::vector<std::uint64_t> ids;
  std::vector<Vec3> positions;
  std::vector<double> radii;
  std::vector<double> inverse_masses;
  std::vector<RigidMover> movers;

  void add(const Vec3& x, const Vec3& velocity, double inverse_mass) {
    body_of.push_back(static_cast<std::uint32_t>(ids.size()));
    ids.push_back(ids.size());
    positions.push_back(x);
    radii.push_back(0.1);
    inverse_masses.push_back(inverse_mass);
    RigidMover m;
    m.inverse_mass = inverse_mass;
    m.centre = x;
    m.velocity = velocity;
    movers.push_back(m);
  }
  std::uint64_t solve(double restitution, unsigned iterations = 10, double resting_speed = 0.01) {
    std::vector<SpherePair> pairs;
    for (std::uint32_t a = 0; a < ids.size(); ++a) {
      for (std::uint32_t b = a + 1; b < ids.size(); ++b) pairs.push_back({a, b});
    }
    BodyCollisionOptions options;
    options.restitution = restitution;
    options.iterations = iterations;
    return BodyRebounds().solve({body_of, ids, positions, radii, inverse_masses}, pairs, options, dt, resting_speed,
                                movers);
  }
  [[nodiscard]] double energy() const {
    double sum = 0.0;
    for (const RigidMover& m : movers) {
      if (m.inverse_mass > 0.0) sum += 0.5 * dot(m.velocity, m.velocity) / m.inverse_mass;
    }
    return sum;
  }
  [[nodiscard]] Vec3 momentum() const {
    Vec3 sum;
    for (const RigidMover& m : movers) {
      if (m.inverse_mass > 0.0) sum += m.velocity * (1.0 / m.inverse_mass);
    }
    return sum;
  }
};

TEST(BodyRebounds, OfABodyThatCannotBePushed) {
  for (const bool first : {false, true}) {
    Balls balls;
    balls.add({0, 0, 0}, {first ? 0.0 : 2.0, 0, 0}, first ? 0.0 : 1.0);
    balls.add({0.2001, 0, 0}, {first ? -2.0 : 0.0, 0, 0}, first ? 1.0 : 0.0);
    EXPECT_EQ(balls.solve(0.5), 1U);
    EXPECT_NEAR(balls.movers[first ? 1 : 0].velocity.x, first ? 1.0 : -1.0, 1e-12);
    EXPECT_EQ(balls.movers[first ? 0 : 1].velocity, Vec3{});
  }
}

// Only what touches in the step, and comes faster than what rests; others are left as they are, to the bit.
TEST(BodyRebounds, LeaveOthersAsTheyAre) {
  Balls balls;
  balls.add({0, 0, 0}, {1.0, 0, 0}, 1.0);
  balls.add({0.203, 0, 0}, {-1.0, 0, 0}, 1.0);  // in a step and a half
  balls.add({0, 1, 0}, {0.004, 0, 0}, 1.0);
  balls.add({0.2, 1, 0}, {-0.004, 0, 0}, 1.0);  // rests
  EXPECT_EQ(balls.solve(1.0), 0U);
  balls.add({0, 2, 0}, {1.0, 0, 0}, 1.0);
  balls.add({0.2, 2, 0}, {-1.0, 0, 0}, 1.0);
  const std::vector<RigidMover> before = balls.movers;
  EXPECT_EQ(balls.solve(1.0), 1U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(balls.movers[i].velocity, before[i].velocity);
  EXPECT_NEAR(balls.movers[4].velocity.x, -1.0, 1e-12);
  EXPECT_NEAR(balls.movers[5].velocity.x, 1.0, 1e-12);
}

// Bodies that turn, hit beside their centres while they pass by: momentum and angular momentum to rounding.
TEST(BodyRebounds, KeepAngularMomentum) {
  Random random(2);
  const auto vector = [&](double most) {
    return Vec3{random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
  };
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    Balls balls;
    balls.add({0, 0, 0}, {3.0, 0, 0}, 1.0);
    balls.add(Vec3{0.205, 0, 0} + vector(0.01), Vec3{-3.0, 0, 0} + vector(40.0), 0.5);
    for (RigidMover& m : balls.movers) {
      m.turns = true;
      m.centre += vector(0.3);
      m.angular_velocity = vector(20.0);
      m.inverse_inertia = Mat3{{4.0, 0.0, 0.0}, {0.0, 4.0, 0.0}, {0.0, 0.0, 4.0}};
    }
    const auto angular = [&] {
      Vec3 sum;
      for (const RigidMover& m : balls.movers)
        sum += cross(m.centre, m.velocity * (1.0 / m.inverse_mass)) + m.angular_velocity * 0.25;
      return sum;
    };
    const Vec3 before = angular();
    const Vec3 momentum = balls.momentum();
    if (balls.solve(i % 2 * 0.7) == 0) continue;
    ++hits;
    ASSERT_LE(norm(angular() - before), 1e-12) << i;
    ASSERT_LE(norm(balls.momentum() - momentum), 1e-12) << i;
  }
  EXPECT_GT(hits, 30);
}

// Clusters that the solver does not finish, of very different masses.
TEST(BodyRebounds, AddNoEnergyHoweverFarTheSolverCame) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    Balls balls;
    for (int k = 0; k < 12; ++k) {
      const auto u = [&] { return random.uniform(-1.0, 1.0); };
      balls.add({0.15 * u(), 0.15 * u(), 0.15 * u()}, {u(), u(), u()}, std::pow(10.0, random.uniform(-4.0, 4.0)));
    }
    const double energy = balls.energy();
    const Vec3 momentum = balls.momentum();
    double most = 0.0;
    for (const RigidMover& m : balls.movers) most += norm(m.velocity) / m.inverse_mass;
    const double restitution = i % 2 == 0 ? 1.0 : 0.5;
    EXPECT_GT(balls.solve(restitution, 1), 0U);
    ASSERT_LE(balls.energy(), energy * (1.0 + 1e-12)) << i;
    ASSERT_LE(norm(balls.momentum() - momentum), 1e-10 * most) << i;
  }
}

}  // namespace dartcast::body_rebound_test
