#include "dynamics/sphere_touch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <optional>

#include "base/random.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::sphere_touch_test {

using test::random_vector;

using Fraction = boost::multiprecision::cpp_rational;
using Decimal = boost::multiprecision::cpp_bin_float_100;

// The quadratic of two spheres, in fractions, and its first root in 100 digits.
struct Truth {
  bool overlap = false;
  std::optional<Decimal> time;
};

Truth truth(const SphereMotion& s, const SphereMotion& t) {
  const auto part = [](double x, double y) { return Fraction(y) - Fraction(x); };
  const Fraction p[3] = {part(s.centre.x, t.centre.x), part(s.centre.y, t.centre.y), part(s.centre.z, t.centre.z)};
  const Fraction d[3] = {part(s.displacement.x, t.displacement.x), part(s.displacement.y, t.displacement.y),
                         part(s.displacement.z, t.displacement.z)};
  const Fraction radius = Fraction(s.radius) + Fraction(t.radius);
  Fraction a = 0;
  Fraction b = 0;
  Fraction c = -radius * radius;
  for (int k = 0; k < 3; ++k) {
    a += d[k] * d[k];
    b += p[k] * d[k];
    c += p[k] * p[k];
  }
  if (c <= 0) return {c < 0, Decimal(0)};
  const Fraction disc = b * b - a * c;
  if (b >= 0 || disc < 0) return {};
  const Decimal time = Decimal(c) / (Decimal(-b) + sqrt(Decimal(disc)));
  if (time > 1) return {};
  return {false, time};
}

// From the first centre to the second, at a time.
Vec3 between(const SphereMotion& a, const SphereMotion& b, double time) {
  return b.centre - a.centre + time * (b.displacement - a.displacement);
}

TEST(SphereTouch, OverlapHasItsDepth) {
  const Approach found = approach({{0, 0, 0}, {1, 0, 0}, 2.0}, {{0, 0, 4}, {0, 0, 0}, 3.0});
  EXPECT_DOUBLE_EQ(found.gap, -1.0);
  EXPECT_DOUBLE_EQ(found.distance, -1.0);
  EXPECT_EQ(found.normal, (Vec3{0, 0, 1}));
}

// Where the centres are one, the normal is opposite to the relative motion, or along x.
TEST(SphereTouch, CoincidentCentresHaveANormal) {
  const SphereMotion a = {{1, 2, 3}, {0, 0, 2}, 1.0};
  EXPECT_EQ(approach(a, {{1, 2, 3}, {0, 0, 2}, 1.0}).normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(approach(a, {{1, 2, 3}, {0, 0, 0}, 1.0}).normal, (Vec3{0, 0, -1}));
  EXPECT_EQ(approach(a, {{1, 2, 3}, {0, 0, 0}, 1.0}).gap, -2.0);
}

// All magnitudes that coordinates may have.
TEST(SphereTouch, ExtremeMagnitudes) {
  const SphereMotion a = {{0, 0, 0}, {1, 0, 0}, 1.0};
  const SphereMotion b = {{4, 0, 0}, {0, 0, 0}, 2.0};
  for (const int e : {-299, -200, 150, 298}) {
    const double unit = std::ldexp(1.0, e);
    const auto scaled = [&](const SphereMotion& s) {
      return SphereMotion{s.centre * unit, s.displacement * unit, s.radius * unit};
    };
    const Approach found = approach(scaled(a), scaled(b));
    EXPECT_EQ(found.gap, unit) << e;
    EXPECT_EQ(found.distance, 0.0) << e;
    EXPECT_EQ(found.normal, (Vec3{1, 0, 0})) << e;
  }
}

// The half-space contains every motion that touches nothing, and none that ends in an overlap on the way it came.
TEST(SphereTouch, ApproachHoldsFreeMotionsAndNoOthers) {
  Random random(4);
  int free = 0;
  const int cases = test::scaled(5000, 100000);
  for (int i = 0; i < cases; ++i) {
    const SphereMotion a = {random_vector(random, 1.0), random_vector(random, 1.0), random.uniform(0.01, 0.3)};
    const SphereMotion b = {random_vector(random, 1.0), random_vector(random, 1.0), random.uniform(0.01, 0.3)};
    const Approach found = approach(a, b);
    const Approach mirrored = approach(b, a);
    EXPECT_EQ(found.gap, mirrored.gap);
    EXPECT_EQ(found.normal, -mirrored.normal);
    const Truth touch = truth(a, b);
    const double change = dot(b.displacement - a.displacement, found.normal);
    if (touch.overlap) {
      const Vec3 way = between(a, b, 0.0);
      EXPECT_NEAR(found.gap, norm(way) - a.radius - b.radius, 1e-14);
      EXPECT_NEAR(norm(found.normal - way * (1.0 / norm(way))), 0.0, 1e-12);
      continue;
    }
    EXPECT_GE(found.gap, -1e-14);
    EXPECT_EQ(found.distance > 1e-14, !touch.time.has_value()) << found.distance;
    if (touch.time) {
      const Vec3 way = between(a, b, touch.time->convert_to<double>());
      EXPECT_LE(change, -found.gap + 1e-14);
      EXPECT_NEAR(norm(found.normal - way * (1.0 / norm(way))), 0.0, 1e-6 / std::sqrt(a.radius + b.radius));
    } else {
      ++free;
      EXPECT_GE(change, -found.gap - 1e-14);
    }
  }
  EXPECT_GT(free, cases / 4);
}

}  // namespace dartcast::sphere_touch_test
