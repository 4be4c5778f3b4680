// Spheres whose clearances are known.
#include <gtest/gtest.h>

#include "dartcast/spheres.hpp"
#include "support/sphere_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::clearances_test {

using test::clearance;
using test::cubes;
using test::Swarm;

// Where clearances hold the way no walls are looked for, and nothing else changes; they are believed.
TEST(Clearances, SaveTheSearch) {
  const WallResponses bouncing(WallResponse{WallResponseKind::reflect, 0.9, 0.1});
  const auto run = [&bouncing](double share, std::size_t& contacts) {
    Swarm swarm(cubes(4, CellType::hexahedron, 0.1), 7);
    swarm.fill(test::scaled<std::size_t>(60, 400), 0.2, {0.2, 0.2, 0.2}, {3.8, 3.8, 3.8}, 0.3);
    const auto walls = test::all_walls(swarm.environment.complex(), false);
    for (int step = 0; step < 10; ++step) {
      std::vector<Vec3> targets;
      std::vector<double> clearances;
      for (std::size_t i = 0; i < swarm.radii.size(); ++i) {
        targets.push_back(swarm.particles[i].position + swarm.velocities[i]);
        clearances.push_back(share * clearance(walls, swarm.particles[i].position));
      }
      const ContactCallback respond = respond_with(bouncing, swarm.velocities, swarm.statuses, 1.0);
      const SphereReport report =
          swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii, targets, respond, {}, clearances);
      contacts += report.step.contacts.contacts.size();
    }
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < swarm.radii.size(); ++i) places.push_back(swarm.particles[i].position);
    return places;
  };
  std::size_t without = 0;
  std::size_t with = 0;
  std::size_t wrong = 0;
  const std::vector<Vec3> places = run(0.0, without);
  EXPECT_EQ(run(1.0, with), places);
  EXPECT_EQ(with, without);
  run(1e9, wrong);
  EXPECT_LT(wrong, without);
}

TEST(Clearances, CountForNothingAfterAMove) {
  Swarm swarm(cubes(4));
  swarm.add({2.25, 2.125, 1.0}, 0.25);
  auto next = swarm.environment.next_positions();
  for (std::size_t i = 0; i < next.size(); ++i) {
    next[i] = swarm.environment.positions()[i];
    next[i].z = 2.0 + 0.5 * next[i].z;  // the floor rises to 2
  }
  swarm.environment.move();
  const std::vector<Vec3> stay = {swarm.particles[0].position};
  const SphereReport report =
      swarm.stepper.advance(swarm.environment, swarm.particles, swarm.radii, stay, {}, {}, std::vector<double>{1.0});
  ASSERT_EQ(report.step.contacts.contacts.size(), 1U);
  EXPECT_NEAR(report.step.contacts.contacts[0].time_of_impact, 0.375, sphere_time_bound);  // the centre's is 0.5
}

}  // namespace dartcast::clearances_test
