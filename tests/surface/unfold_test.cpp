// Triangles laid out in the plane, and the ways out of them, against 50 digits: fat ones, and as thin as there are.
#include "surface/unfold.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/geodesic_oracle.hpp"
#include "support/surface_meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::unfold_test {

using detail::Exit;
using detail::Frame;
using detail::Heading;
using detail::TriangleWeights;
using detail::Unfolded;
using test::Point3;
using test::Real;

// A triangle whose third corner is off the line of the others by a share of about 2^-bits of its length.
std::array<Vec3, 3> thin_triangle(Random& random, int bits) {
  const Vec3 a = test::random_vector(random);
  const Vec3 b = test::random_vector(random);
  const double s = random.uniform(-0.5, 1.5);
  return {a, b, a + (b - a) * s + test::random_vector(random) * std::ldexp(1.0, -bits)};
}

double relative(const Real& a, double b) { return static_cast<double>(abs((a - b) / a)); }

TEST(Unfolding, KeepsTheHeightsOfThinTriangles) {
  Random random(1);
  for (int i = 0; i < test::scaled(3000, 100000); ++i) {
    const auto [a, b, c] = thin_triangle(random, static_cast<int>(random.below(60)));
    if (!detail::has_area(a, b, c)) continue;
    const Unfolded t = detail::unfold(a, b, c);
    const Point3 base = test::point3(b) - test::point3(a);
    const Point3 side = test::point3(c) - test::point3(a);
    const Point3 n = test::outer(base, side);
    const Real length = test::size(base);
    ASSERT_LE(relative(length, t.length / t.scale), 0x1p-50);
    ASSERT_LE(relative(test::size(n) / length, t.height / t.scale), 0x1p-44);
    const double size = static_cast<double>(std::max(length, test::size(side)));
    ASSERT_LE(abs(test::inner(base, side) / length - t.x / t.scale), size * 0x1p-49);
    const Frame f = detail::frame_of(a, b, c);
    ASSERT_LE(test::distance(n * (1 / test::size(n)), f.normal), 0x1p-43);
    ASSERT_LE(test::distance(base * (1 / length), f.along), 0x1p-51);
  }
}

TEST(Unfolding, HasAreaExactly) {
  const Vec3 a = {1.0, 2.0, 3.0};
  const Vec3 b = {4.0, 8.0, 12.0};
  EXPECT_FALSE(detail::has_area(a, b, {2.0, 4.0, 6.0}));
  EXPECT_FALSE(detail::has_area(a, b, a));
  EXPECT_FALSE(detail::has_area(a, a, a));
  for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    Vec3 beside = {2.0, 4.0, 6.0};
    beside.*axis = std::nextafter(beside.*axis, 0.0);
    EXPECT_TRUE(detail::has_area(a, b, beside));
  }
}

// The way out in 50 digits, of the same layout and the same weights: the first weight to reach 0.
TEST(Unfolding, FindsTheWayOut) {
  Random random(2);
  int edges[3] = {};
  const int rays = test::scaled(20000, 1000000);
  for (int i = 0; i < rays; ++i) {
    const auto [a, b, c] = thin_triangle(random, static_cast<int>(random.below(i % 4 == 0 ? 40 : 3)));
    const Unfolded t = detail::unfold(a, b, c);
    TriangleWeights from = {random.uniform(0.01, 1.0), random.uniform(0.01, 1.0),
                            i % 2 == 0 ? 0.0 : random.uniform(0.01, 1.0)};
    const double sum = from[0] + from[1] + from[2];
    from = detail::normalized({from[0] / sum, from[1] / sum, from[2] / sum});
    const double angle = random.uniform(0.0, (from[2] == 0.0 ? 1.0 : 2.0) * 3.14159);
    const Heading h = {std::cos(angle), std::sin(angle)};
    const Exit exit = detail::way_out(t, from, h);
    ASSERT_TRUE(detail::are_weights(exit.weights));
    ASSERT_TRUE(exit.weights[0] == 0.0 || exit.weights[1] == 0.0 || exit.weights[2] == 0.0);
    const Real x = t.x;
    const Real area = Real(t.length) * t.height;
    const Real rate[3] = {((x - t.length) * h.across - Real(t.height) * h.along) / area,
                          (Real(t.height) * h.along - x * h.across) / area, Real(t.length) * h.across / area};
    int first = -1;
    Real way = 0;
    for (int k = 0; k < 3; ++k) {
      if (rate[k] >= 0 || from[static_cast<std::size_t>(k)] == 0.0) continue;
      const Real here = -from[static_cast<std::size_t>(k)] / rate[k];
      if (first < 0 || here < way) {
        first = k;
        way = here;
      }
    }
    ASSERT_GE(first, 0);
    // Rates are rounded by some 2^-52 of the largest; a ray nearly along the edge that it leaves by is off by more.
    const Real largest = std::max({abs(rate[0]), abs(rate[1]), abs(rate[2])});
    const double steep = static_cast<double>(largest / abs(rate[first]));
    const double bound = 0x1p-50 * (1.0 + steep);
    for (unsigned k = 0; k < 3; ++k) {
      const Real expected = from[k] + rate[k] * way;
      ASSERT_LE(abs(expected - exit.weights[k]), bound) << i;
    }
    ASSERT_LE(relative(way, exit.length), bound);
    if (bound < 1e-6 && exit.weights[static_cast<std::size_t>(first)] == 0.0) ++edges[first];
  }
  for (const int count : edges) EXPECT_GT(count, rays / 20);
}

TEST(Unfolding, TurnsHeadings) {
  Random random(3);
  for (int i = 0; i < test::scaled(1000, 100000); ++i) {
    const auto v = thin_triangle(random, static_cast<int>(random.below(10)));
    const double angle = random.uniform(0.0, 6.28);
    const Heading h = {std::cos(angle), std::sin(angle)};
    const Frame f = detail::frame_of(v[0], v[1], v[2]);
    const Vec3 way = f.along * h.along + f.across * h.across;
    const Unfolded t = detail::unfold(v[0], v[1], v[2]);
    for (const unsigned edge : {1U, 2U}) {
      const Heading turned = detail::turned_to(t, edge, h);
      const Frame g = detail::frame_of(v[edge], v[(edge + 1) % 3], v[(edge + 2) % 3]);
      const double thin = norm(v[1] - v[0]) / norm(v[(edge + 1) % 3] - v[edge]) + t.length / t.height;
      EXPECT_NEAR(turned.along, dot(way, g.along), 1e-15 * (4 + thin));
      EXPECT_NEAR(turned.across, dot(way, g.across), 1e-15 * (4 + thin));
    }
  }
}

// Along the side, as far as its rounded angle allows: the path ends at the apex, on whichever side of it, and does not
// stay at the corner.
TEST(Unfolding, WaysAlongTheSideLeaveTheCorner) {
  Random random(4);
  for (int i = 0; i < test::scaled(1000, 100000); ++i) {
    const auto v = thin_triangle(random, static_cast<int>(random.below(4)));
    const Unfolded t = detail::unfold(v[0], v[1], v[2]);
    const double angle = detail::angle_at_base(t);
    const Exit exit = detail::way_out(t, {1.0, 0.0, 0.0}, {std::cos(angle), std::sin(angle)});
    ASSERT_EQ(exit.weights[0], 0.0);
    ASSERT_NEAR(exit.weights[2], 1.0, 1e-12);
    ASSERT_NEAR(exit.length / t.scale, norm(v[2] - v[0]), 1e-12);
  }
}

TEST(Unfolding, WaysFromCornersAndAlongEdgesAreExact) {
  const Unfolded t = detail::unfold({0, 0, 0}, {3, 0, 0}, {1, 1, 5});
  // Along the base, both ways, from its ends and from inside of it.
  EXPECT_EQ(detail::way_out(t, {1, 0, 0}, {1, 0}).weights, (TriangleWeights{0, 1, 0}));
  EXPECT_EQ(detail::way_out(t, {0, 1, 0}, {-1, 0}).weights, (TriangleWeights{1, 0, 0}));
  EXPECT_EQ(detail::way_out(t, {0.25, 0.75, 0}, {1, 0}).weights, (TriangleWeights{0, 1, 0}));
  EXPECT_EQ(detail::way_out(t, {0.25, 0.75, 0}, {-1, 0}).weights, (TriangleWeights{1, 0, 0}));
  EXPECT_EQ(detail::way_out(t, {0.25, 0.75, 0}, {1, 0}).length / t.scale, 0.75);
  // From a corner by the edge across.
  const Exit exit = detail::way_out(t, {1, 0, 0}, {std::sqrt(0.5), std::sqrt(0.5)});
  EXPECT_EQ(exit.weights[0], 0.0);
  EXPECT_GT(exit.weights[1], 0.0);
  EXPECT_GT(exit.weights[2], 0.0);
}

}  // namespace dartcast::unfold_test
