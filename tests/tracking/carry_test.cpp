#include "tracking/carry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "complex/simplex.hpp"
#include "support/tier.hpp"

namespace dartcast::ride_test {

// Coordinates of points in simplices down to the thinnest, against exact determinants.
TEST(Barycentric, IsRightInSlivers) {
  Random random(3);
  int thin = 0;
  const int cases = test::scaled(20000, 2000000);
  for (int i = 0; i < cases; ++i) {
    const double height = std::exp2(random.uniform(-52.0, 0.0));
    Corners v;
    for (Vec3& c : v) c = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) * height};
    const Vec3 shear{random.uniform(-1, 1), random.uniform(-1, 1), 0.0};
    for (Vec3& c : v) c.z += dot(shear, c);
    if (volume_sign(v) != Sign::positive) std::swap(v[0], v[1]);
    if (volume_sign(v) != Sign::positive) continue;
    const Weights given = {random.uniform(), random.uniform(), random.uniform(), random.uniform()};
    const double sum = given[0] + given[1] + given[2] + given[3];
    const Vec3 x = detail::combine(v, {given[0] / sum, given[1] / sum, given[2] / sum, given[3] / sum});
    std::array<double, 4> truth{};
    bool inside = true;
    for (unsigned k = 0; k < 4; ++k) {
      const auto& f = facet_corners[k];
      truth[k] = orient3d_value(v[f[0]], v[f[1]], v[f[2]], x) / orient3d_value(v[0], v[1], v[2], v[3]);
      inside = inside && truth[k] >= 0.0;
    }
    if (!inside) continue;
    thin += height < 0x1p-30 ? 1 : 0;
    const Weights w = detail::barycentric(v, x);
    for (unsigned k = 0; k < 4; ++k) ASSERT_NEAR(w[k], truth[k], 0x1p-26) << "case " << i << ", height " << height;
  }
  EXPECT_GT(thin, cases / 20);
}

}  // namespace dartcast::ride_test
