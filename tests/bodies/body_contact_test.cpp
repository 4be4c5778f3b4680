#include "bodies/body_contact.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"

namespace dartcast::body_contact_test {

// The share is the largest one whose potential energy the kinetic energy covers. Every smaller share is covered, too.
TEST(PotentialEnergy, EnergyLimitedShareIsAsFarAsTheEnergyReaches) {
  Random random(1);
  const auto vector = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
  int limited = 0;
  for (int i = 0; i < 2000; ++i) {
    const PotentialEnergy potential{random.uniform(0.0, 10.0), vector(), vector()};
    const Vec3 x = vector();
    const Vec3 d = vector();
    const double kinetic = random.below(4) == 0 ? 0.0 : random.uniform();
    const double share = potential.affordable_share(x, d, kinetic);
    ASSERT_GE(share, 0.0);
    ASSERT_LE(share, 1.0);
    for (int k = 0; k <= 8; ++k) ASSERT_LE(potential.rise(x, d * (share * k / 8)), kinetic + 1e-12);
    if (share == 1.0) continue;
    ++limited;
    ASSERT_NEAR(potential.rise(x, d * share), kinetic, 1e-12);
    ASSERT_GT(potential.rise(x, d), kinetic);
  }
  EXPECT_GT(limited, 100);
}

}  // namespace dartcast::body_contact_test
