// First touches of moving spheres and triangles, against 40 digits.
#include "dynamics/swept_sphere.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "oracle/first_touch.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::swept_sphere_test {

using test::random_vector;

using oracle::Digits;
using oracle::TouchOracle;

struct Case {
  MovingSphere sphere;
  MovingTriangle triangle;
};

TouchOracle oracle_of(const Case& c) { return {c.triangle.from, c.triangle.to, c.sphere.from, c.sphere.to}; }

double largest_in(const Case& c) {
  double largest = c.sphere.radius;
  for (unsigned i = 0; i < 3; ++i) {
    largest = std::max({largest, norm(c.triangle.from[i] - c.sphere.from), norm(c.triangle.to[i] - c.sphere.to)});
  }
  return largest;
}

struct Tally {
  std::array<int, 3> touched{};
  int apart = 0;
  int grazed = 0;  // reported though there is none, within the bound
};

// The time is never late and within the bound; nothing is missed, and nothing invented but what grazes.
void check(const Case& c, Tally& tally) {
  const TouchOracle truth = oracle_of(c);
  if (truth.distance(0) <= Digits(c.sphere.radius)) return;
  const auto expected = truth.first(c.sphere.radius);
  const auto found = first_touch(c.sphere, c.triangle);
  if (!expected) {
    if (!found) {
      ++tally.apart;
      return;
    }
    ++tally.grazed;
    ASSERT_LE(double(truth.distance(found->contact) - c.sphere.radius), grazing_bound * largest_in(c));
    return;
  }
  ++tally.touched[static_cast<std::size_t>(expected->dimension)];
  ASSERT_TRUE(found.has_value()) << double(expected->time);
  if (found->at_start) {
    ASSERT_LE(double(truth.distance(0) - c.sphere.radius), 0x1p-44 * largest_in(c));
    return;
  }
  const double late = double(Digits(found->time) - expected->time);
  ASSERT_LE(late, 0.0);
  ASSERT_GE(late, -sphere_time_bound);
  ASSERT_GE(found->contact, found->time);
  ASSERT_LE(found->contact, found->time + sphere_time_bound);
}

enum class Motion { still, shifted, turning };

// A contact at a chosen time with a chosen part of the triangle: 1, 2 or 3 corners. `graze` >= 0: the motion is along
// the sphere there, and by so much off it.
Case aimed(Random& random, unsigned corners, Motion motion, double graze) {
  Case c;
  std::array<double, 3> w{};
  double sum = 0.0;
  for (unsigned i = 0; i < corners; ++i) sum += w[i] = random.uniform(0.05, 1.0);
  std::array<Vec3, 3> at;
  for (Vec3& v : at) v = random_vector(random, 1.0);
  const double size = std::exp(random.uniform(-4.0, 2.0));
  Vec3 point;
  for (unsigned i = 0; i < 3; ++i) {
    at[i] *= size;
    point += at[i] * (w[i] / sum);
  }
  Vec3 normal = cross(at[1] - at[0], at[2] - at[0]);
  if (corners == 2) {  // away from the third corner
    const Vec3 e = at[1] - at[0];
    const Vec3 away = (at[2] - at[0]) - e * (dot(at[2] - at[0], e) / dot(e, e));
    normal = normal * (random.uniform(-1.0, 1.0) / norm(normal)) - away * (1.0 / norm(away));
  } else if (corners == 1) {
    const Vec3 middle = (at[1] + at[2]) * 0.5 - at[0];
    normal = middle * (-1.0 / norm(middle)) + random_vector(random, 0.3);
  }
  normal = normal * (1.0 / norm(normal));
  const double radius = std::exp(random.uniform(-4.0, 2.0));
  const double t = random.uniform(0.05, 0.95);
  std::array<Vec3, 3> speed{};  // of the corners, in the whole of the motion
  const Vec3 shift = motion == Motion::still ? Vec3{} : random_vector(random, 1.0);
  Vec3 there;
  for (unsigned i = 0; i < 3; ++i) {
    speed[i] = shift + (motion == Motion::turning ? random_vector(random, size) : Vec3{});
    there += speed[i] * (w[i] / sum);
  }
  Vec3 own = random_vector(random, std::exp(random.uniform(-3.0, 2.0)));
  if (graze >= 0.0) own = own - normal * dot(own, normal);
  own += there;
  const Vec3 centre = point + normal * (radius + (random.below(2) == 0 ? graze : -graze));
  c.sphere = {centre - own * t, centre + own * (1.0 - t), radius};
  for (unsigned i = 0; i < 3; ++i) {
    c.triangle.from[i] = at[i] - speed[i] * t;
    c.triangle.to[i] = motion == Motion::turning ? at[i] + speed[i] * (1.0 - t)
                                                 : c.triangle.from[i] + (motion == Motion::still ? Vec3{} : shift);
  }
  return c;
}

class Aimed : public testing::TestWithParam<std::tuple<unsigned, Motion>> {};

TEST_P(Aimed, FirstTouchIsNeverLateAndWithinTheBound) {
  const auto [corners, motion] = GetParam();
  Random random(40 + corners);
  Tally tally;
  const int cases = std::max(40, test::scaled(240, 34000));
  for (int i = 0; i < cases && !HasFatalFailure(); ++i) {
    const int way = i % 4;
    const double graze = way < 2 ? -1.0 : way == 2 ? 0.0 : std::exp(random.uniform(-37.0, -7.0));
    SCOPED_TRACE(i);
    check(aimed(random, corners, motion, graze), tally);
  }
  EXPECT_GE(tally.touched[corners - 1], test::sanitized() ? 0 : cases / 80 + 1);
  EXPECT_GE(tally.apart, test::sanitized() ? 0 : cases / 40 + 1);
  RecordProperty("grazed", tally.grazed);
}

INSTANTIATE_TEST_SUITE_P(All, Aimed,
                         testing::Combine(testing::Values(1U, 2U, 3U),
                                          testing::Values(Motion::still, Motion::shifted, Motion::turning)));

TEST(FirstTouch, OfAnything) {
  Random random(7);
  Tally tally;
  const int cases = std::max(40, test::scaled(500, 100000));
  for (int i = 0; i < cases && !HasFatalFailure(); ++i) {
    Case c;
    const double size = std::exp(random.uniform(-3.0, 3.0));
    for (unsigned k = 0; k < 3; ++k) {
      c.triangle.from[k] = random_vector(random, size);
      c.triangle.to[k] = random_vector(random, size);
      if (i % 5 == 0 && k == 2) {  // flat: a side twice, or a corner three times
        c.triangle.from[k] = c.triangle.from[1];
        c.triangle.to[k] = c.triangle.to[1];
      }
      if (i % 10 == 0 && k > 0) {
        c.triangle.from[k] = c.triangle.from[0];
        c.triangle.to[k] = c.triangle.to[0];
      }
    }
    const double far = std::exp(random.uniform(-1.0, 2.0));
    c.sphere = {random_vector(random, far), random_vector(random, far), std::exp(random.uniform(-4.0, 1.0))};
    if (i % 7 == 0) c.sphere.to = c.sphere.from;
    SCOPED_TRACE(i);
    check(c, tally);
  }
  for (const int n : tally.touched) EXPECT_GT(n, cases / 100);
  EXPECT_GT(tally.apart, cases / 10);
}

// The motion ends where the sphere touches, or a few units in the last place before.
TEST(FirstTouch, EndsAtTheTouch) {
  Random random(11);
  Tally tally;
  const int cases = std::max(40, test::scaled(600, 100000));
  for (int i = 0; i < cases && !HasFatalFailure(); ++i) {
    Case c = aimed(random, 3, Motion::still, -1.0);
    const auto& v = c.triangle.to;
    Vec3 normal = cross(v[1] - v[0], v[2] - v[0]);
    normal = normal * (1.0 / norm(normal));
    const double off = (static_cast<double>(random.below(9)) - 4.0) * 0x1p-54 * largest_in(c);
    c.sphere.to = (v[0] + v[1] + v[2]) * (1.0 / 3.0) + normal * (c.sphere.radius + off);
    c.sphere.from = c.sphere.to + normal * random.uniform(0.1, 1.0) + random_vector(random, i % 2 == 0 ? 0.0 : 0.05);
    SCOPED_TRACE(i);
    check(c, tally);
  }
  EXPECT_GT(tally.touched[2], cases / 10);
  EXPECT_GT(tally.apart, cases / 10);
}

// On a lattice the distance is the radius exactly.
TEST(FirstTouch, GrazesExactly) {
  const std::array<Vec3, 3> t = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  const auto graze = [&](const Vec3& from, const Vec3& to, double radius) {
    return first_touch({from, to, radius}, {t, t});
  };
  const auto corner = graze({-1, -8, 0}, {-1, 8, 0}, 1.0);  // passes the corner (0, 0, 0), and then a side, at 1
  ASSERT_TRUE(corner);
  EXPECT_LE(corner->time, 0.5);
  EXPECT_GE(corner->time, 0.5 - sphere_time_bound);
  const auto side = graze({2, -8, 3}, {2, 8, 3}, 3.0);
  ASSERT_TRUE(side);
  EXPECT_LE(side->time, 0.5);
  EXPECT_GE(side->time, 0.5 - sphere_time_bound);
  EXPECT_FALSE(graze({2, -8, 3}, {2, 8, 3}, std::nextafter(3.0, 0.0)));
  EXPECT_FALSE(graze({-1, -8, 0}, {-1, 8, 0}, std::nextafter(1.0, 0.0)));
}

TEST(FirstTouch, StartsOnTheWall) {
  const std::array<Vec3, 3> t = {{{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}}};
  const auto touch = [&](const Vec3& from, const Vec3& to, double slack = 0.0) {
    return first_touch({from, to, 1.0}, {t, t}, slack);
  };
  EXPECT_FALSE(touch({0, 0, 1}, {0, 0, 2}));
  EXPECT_FALSE(touch({0, 0, 1}, {1, 0, 1}));
  EXPECT_FALSE(touch({0, 0, 1}, {0, 0, 1}));
  EXPECT_FALSE(touch({0, 0, 0.5}, {1, 0, 0.5}));
  EXPECT_FALSE(touch({0, 0, 0.5}, {1, 0, 0.75}));
  for (const double z : {1.0, 0.5, 1.0 + 0x1p-52, 1.0 - 0x1p-52}) {
    const auto into = touch({0, 0, z}, {1, 0, z - 0.25});
    ASSERT_TRUE(into);
    EXPECT_EQ(into->time, 0.0);
    EXPECT_LE(into->contact, 1e-14);
  }
  const auto slow = touch({0, 0, 1}, {1, 0, 1 - 0x1p-30}, 0x1p-40);
  ASSERT_TRUE(slow);
  EXPECT_TRUE(slow->at_start);
  EXPECT_EQ(slow->time, 0.0);
  EXPECT_FALSE(touch({0, 0, 1}, {1, 0, 1 - 0x1p-41}, 0x1p-40));
}

// It leaves the triangle that it touches, which then comes after it.
TEST(FirstTouch, OfAWallThatWasLeft) {
  MovingTriangle t = {{{{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}}}, {{{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}}}};
  // The side at y = -8 swings up, and the sphere moves to it and up faster at first.
  t.to[0].z = t.to[1].z = 6.0;
  t.to[2].z = -6.0;
  const auto touch = first_touch({{0, 7, 1}, {0, -8, 4}, 1.0}, t);
  ASSERT_TRUE(touch);
  EXPECT_FALSE(touch->at_start);
  const TouchOracle truth(t.from, t.to, {0, 7, 1}, {0, -8, 4});
  EXPECT_LE(double(truth.distance(touch->time + sphere_time_bound)), 1.0);
  for (int k = 1; k <= 64; ++k) EXPECT_GT(double(truth.distance(Digits(touch->time) * k / 64)), 1.0);
}

TEST(FirstTouch, IsTheSameAtAnyScale) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Case c = aimed(random, 1U + random.below(3), Motion::turning, -1.0);
    const auto found = first_touch(c.sphere, c.triangle);
    for (const double s : {0x1p-280, 0x1p+280}) {
      Case d = c;
      for (Vec3& v : d.triangle.from) v *= s;
      for (Vec3& v : d.triangle.to) v *= s;
      d.sphere = {c.sphere.from * s, c.sphere.to * s, c.sphere.radius * s};
      const auto other = first_touch(d.sphere, d.triangle);
      ASSERT_EQ(found.has_value(), other.has_value());
      if (found) EXPECT_EQ(found->time, other->time);
    }
  }
}

TEST(NearestOnTriangle, AgainstDigits) {
  Random random(5);
  const int cases = std::max(40, test::scaled(3000, 100000));
  for (int i = 0; i < cases; ++i) {
    std::array<Vec3, 3> t;
    for (Vec3& v : t) v = random_vector(random, 1.0);
    if (i % 5 == 0) t[2] = t[1];
    if (i % 10 == 0) t[1] = t[0];
    const Vec3 x = random_vector(random, std::exp(random.uniform(-3.0, 3.0)));
    const NearestOnTriangle n = nearest_on_triangle(t, x);
    EXPECT_NEAR(n.distance, double(TouchOracle(t, t, x, x).distance(0)), 0x1p-48 * (2.0 + norm(x)));
    EXPECT_NEAR(n.weights[0] + n.weights[1] + n.weights[2], 1.0, 1e-15);
    EXPECT_NEAR(norm(n.point + n.normal * n.distance - x), 0.0, 0x1p-50 * (2.0 + norm(x)));
  }
}

}  // namespace dartcast::swept_sphere_test
