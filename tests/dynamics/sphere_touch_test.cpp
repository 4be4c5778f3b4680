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

// Compares with the truth; returns whether there is a touch.
bool expect_true(const SphereMotion& a, const SphereMotion& b) {
  const Truth expected = truth(a, b);
  const auto found = first_meeting(a, b);
  EXPECT_EQ(found.has_value(), expected.time.has_value());
  if (!found || !expected.time) return false;
  EXPECT_EQ(found->overlap, expected.overlap);
  const Decimal early = *expected.time - found->time;
  EXPECT_GE(early, 0);
  EXPECT_LE(early, pair_time_bound);
  EXPECT_GE(found->time, 0.0);
  EXPECT_NEAR(norm(found->normal), 1.0, 1e-15);
  EXPECT_TRUE(found->depth == 0.0 || (found->depth > 0.0 && found->overlap));  // the least ones are rounded to 0
  return true;
}

// Powers of ten from 10^-low to 1.
double random_size(Random& random, double low) { return std::pow(10.0, -random.uniform(0.0, low)); }

TEST(SphereTouch, AgreesWithExactArithmetic) {
  Random random(1);
  int touches = 0;
  const int cases = test::scaled(5000, 100000);
  for (int i = 0; i < cases; ++i) {
    const SphereMotion a = {random_vector(random, 1.0), random_vector(random, random_size(random, 9)),
                            0.5 * random_size(random, 3)};
    const SphereMotion b = {a.centre + random_vector(random, 1.0), random_vector(random, 2.0 * random_size(random, 9)),
                            random_size(random, 3)};
    touches += expect_true(a, b) ? 1 : 0;
  }
  EXPECT_GT(touches, cases / 40);
}

// Aimed so that they pass at the sum of the radii, up to rounding and somewhat more: both sides occur.
TEST(SphereTouch, GrazingIsDecidedExactly) {
  Random random(2);
  int touches = 0;
  const int cases = test::scaled(2000, 100000);
  for (int i = 0; i < cases; ++i) {
    const Vec3 across = {0.0, 1.0, 0.0};
    const SphereMotion a = {random_vector(random, 1.0), random_vector(random, 1.0), random_size(random, 3)};
    const double radius = random_size(random, 3);
    const double off = 1.0 + random.uniform(-1.0, 1.0) * std::pow(10.0, -random.uniform(8.0, 18.0));
    const Vec3 at_middle = across * ((a.radius + radius) * off);
    const Vec3 motion = {random_size(random, 6), 0.0, random_size(random, 6)};
    const SphereMotion b = {a.centre + at_middle - motion * random.uniform(), a.displacement + motion, radius};
    touches += expect_true(a, b) ? 1 : 0;
  }
  EXPECT_GT(touches, cases / 5);
  EXPECT_LT(touches, cases * 4 / 5);
}

// Distance 5 and radii 2 and 3, in lattice numbers: nothing is rounded.
TEST(SphereTouch, ExactTouches) {
  const SphereMotion a = {{0, 0, 0}, {0, 0, 0}, 2.0};
  EXPECT_TRUE(expect_true(a, {{3, 4, 0}, {0, 0, 0}, 3.0}));      // at rest in touch
  EXPECT_TRUE(expect_true(a, {{3, 4, 0}, {1, 1, 0}, 3.0}));      // leaving
  EXPECT_TRUE(expect_true(a, {{-8, 5, 0}, {16, 0, 0}, 3.0}));    // grazing in passing
  EXPECT_TRUE(expect_true(a, {{-8, 5, 0}, {8, 0, 0}, 3.0}));     // grazing at the end of the step
  EXPECT_TRUE(expect_true(a, {{0, 10, 0}, {0, -5, 0}, 3.0}));    // arriving at the end of the step
  EXPECT_FALSE(expect_true(a, {{-8, 5, 0}, {7.9, 0, 0}, 3.0}));  // the step ends before
  EXPECT_FALSE(expect_true(a, {{0, 10, 0}, {0, -4.9, 0}, 3.0}));
  const double beyond = std::nextafter(5.0, 6.0);
  EXPECT_FALSE(expect_true(a, {{-8, beyond, 0}, {16, 0, 0}, 3.0}));
  const double within = std::nextafter(5.0, 4.0);
  EXPECT_TRUE(expect_true(a, {{-8, within, 0}, {16, 0, 0}, 3.0}));
}

TEST(SphereTouch, OverlapHasItsDepth) {
  const auto touch = first_meeting({{0, 0, 0}, {1, 0, 0}, 2.0}, {{0, 0, 4}, {0, 0, 0}, 3.0});
  ASSERT_TRUE(touch);
  EXPECT_TRUE(touch->overlap);
  EXPECT_DOUBLE_EQ(touch->depth, 1.0);
  EXPECT_EQ(touch->time, 0.0);
  EXPECT_EQ(touch->normal, (Vec3{0, 0, 1}));
}

// Where the centres are one, the normal is opposite to the relative motion, or along x.
TEST(SphereTouch, CoincidentCentresHaveANormal) {
  const SphereMotion a = {{1, 2, 3}, {0, 0, 2}, 1.0};
  EXPECT_EQ(first_meeting(a, {{1, 2, 3}, {0, 0, 0}, 1.0})->normal, (Vec3{0, 0, -1}));
  EXPECT_EQ(first_meeting(a, {{1, 2, 3}, {0, 0, 2}, 1.0})->normal, (Vec3{1, 0, 0}));
  EXPECT_DOUBLE_EQ(first_meeting(a, {{1, 2, 3}, {0, 0, 2}, 1.0})->depth, 2.0);
  EXPECT_EQ(approach(a, {{1, 2, 3}, {0, 0, 0}, 1.0}).normal, (Vec3{0, 0, -1}));
  EXPECT_EQ(approach(a, {{1, 2, 3}, {0, 0, 0}, 1.0}).gap, -2.0);
}

// All magnitudes that coordinates may have, and mixtures of them.
TEST(SphereTouch, ExtremeMagnitudes) {
  Random random(3);
  for (const int e : {-299, -200, 150, 298}) {
    const double unit = std::ldexp(1.0, e);
    for (int i = 0; i < 50; ++i) {
      const SphereMotion a = {random_vector(random, unit), random_vector(random, unit), 0.3 * unit};
      const SphereMotion b = {random_vector(random, unit), random_vector(random, 2.0 * unit), 0.3 * unit};
      expect_true(a, b);
      const auto small = random_vector(random, 1.0);
      expect_true(a, {b.centre, small, b.radius});
      expect_true(a, {b.centre, b.displacement, 1.0});
    }
  }
}

// The half-space contains every motion that touches nothing, and none that ends in an overlap on the way it came.
TEST(SphereTouch, ApproachHoldsFreeMotionsAndNoOthers) {
  Random random(4);
  int free = 0;
  const int cases = test::scaled(20000, 500000);
  for (int i = 0; i < cases; ++i) {
    const SphereMotion a = {random_vector(random, 1.0), random_vector(random, 1.0), random.uniform(0.01, 0.3)};
    const SphereMotion b = {random_vector(random, 1.0), random_vector(random, 1.0), random.uniform(0.01, 0.3)};
    const Approach found = approach(a, b);
    const Approach mirrored = approach(b, a);
    EXPECT_EQ(found.gap, mirrored.gap);
    EXPECT_EQ(found.normal, -mirrored.normal);
    const auto touch = first_meeting(a, b);
    const double change = dot(b.displacement - a.displacement, found.normal);
    if (touch && touch->overlap) {
      EXPECT_NEAR(found.gap, -touch->depth, 1e-14);
      EXPECT_NEAR(norm(found.normal - touch->normal), 0.0, 1e-12);
      continue;
    }
    EXPECT_GE(found.gap, -1e-14);
    EXPECT_EQ(found.distance > 1e-14, !touch.has_value()) << found.distance;
    if (touch) {
      EXPECT_LE(change, -found.gap + 1e-14);
      EXPECT_NEAR(norm(found.normal - touch->normal), 0.0, 1e-6 / std::sqrt(a.radius + b.radius));
    } else {
      ++free;
      EXPECT_GE(change, -found.gap - 1e-14);
    }
  }
  EXPECT_GT(free, cases / 4);
}

}  // namespace dartcast::sphere_touch_test
