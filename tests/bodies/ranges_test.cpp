// Masses, radii and steps at the ends of what doubles can hold: refused in words, or taken without a NaN.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "dartcast/bodies.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"

namespace dartcast::body_ranges_test {

using test::cubes;
using test::expect_refused;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<Vec3> corners(const Vec3& low) {
  std::vector<Vec3> points;
  for (int k = 0; k < 8; ++k) points.push_back(low + Vec3{0.5 * (k & 1), 0.5 * (k >> 1 & 1), 0.5 * (k >> 2)});
  return points;
}

TEST(BodyRanges, MassesAndRadiiThatOverflow) {
  Environment environment(cubes(3));
  Bodies bodies(environment, {});
  for (const double mass : {1e-320, 1e-300, 1e-95, 1e95, 1e300, 0.0, -1.0, infinity, std::nan("")}) {
    BodyOptions o;
    o.mass = mass;
    const std::string value = fmt::format("{}", mass);
    expect_refused([&] { bodies.add(corners({1, 1, 1}), o); }, "mass is " + value + ": it must be between");
    o.mass = 1.0;
    o.masses.assign(8, 1.0);
    o.masses[3] = mass;
    expect_refused([&] { bodies.add(corners({1, 1, 1}), o); }, "mass of point 3 is " + value);
  }
  for (const double radius : {1e308, 1e40, -1.0, infinity, std::nan("")}) {
    BodyOptions o;
    o.radius = radius;
    expect_refused([&] { bodies.add(corners({1, 1, 1}), o); }, "radius is " + fmt::format("{}", radius));
  }
  EXPECT_EQ(bodies.size(), 0U);
}

TEST(BodyRanges, MassesAtTheEnds) {
  for (const double mass : {0x1p-297, 0x1p-100, 0x1p+100, 0x1p+300}) {
    Environment environment(cubes(3));
    BodiesOptions options;
    options.gravity = {0.0, 0.0, -9.81};
    options.collisions = BodyCollisionOptions{};
    Bodies bodies(environment, options);
    BodyOptions o;
    o.mass = mass;
    o.radius = 0.125;
    bodies.add(corners({1, 1, 1}), o);
    bodies.add(corners({1.375, 1, 1}), o);
    for (int i = 0; i < 5; ++i) bodies.step();
    for (const Vec3& x : bodies.positions()) EXPECT_TRUE(is_finite(x)) << mass;
    for (const Vec3& v : bodies.velocities()) EXPECT_TRUE(is_finite(v)) << mass;
  }
}

TEST(BodyRanges, Options) {
  Environment environment(cubes(2));
  for (const double dt : {0.0, -1.0, 1e-320, 1e-200, 1e40, infinity, std::nan("")}) {
    BodiesOptions o;
    o.dt = dt;
    expect_refused([&] { const Bodies bodies(environment, o); }, "dt is " + fmt::format("{}", dt));
  }
  BodiesOptions o;
  o.step.max_contacts = 0;
  expect_refused([&] { const Bodies bodies(environment, o); }, "max_contacts");
}

TEST(ClusterRanges, PointsThatAreNotFinite) {
  for (const double bad : {infinity, -infinity, std::nan("")}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < 8; ++i) {
        std::vector<Vec3> points = corners({1, 1, 1});
        (axis == 0 ? points[i].x : axis == 1 ? points[i].y : points[i].z) = bad;
        expect_refused([&] { overlapping_clusters(points, 0.5); }, "not finite");
      }
    }
  }
}

TEST(MovedFrom, ACatheterCannotBe) {
  static_assert(!std::is_move_constructible_v<Catheter> && !std::is_copy_constructible_v<Catheter>);
}

TEST(MovedFrom, BodiesAreEmpty) {
  Environment environment(cubes(3));
  BodiesOptions options;
  options.gravity = {0.0, 0.0, -9.81};
  options.collisions = BodyCollisionOptions{};
  BodyOptions o;
  o.radius = 0.125;
  const auto fill = [&](Bodies& bodies) {
    bodies.add(corners({1, 1, 1}), o);
    bodies.add(corners({1.375, 1, 1}), o);
    for (int i = 0; i < 5; ++i) bodies.step();
  };
  Bodies first(environment, options);
  fill(first);
  const Bodies second = std::move(first);
  // NOLINTBEGIN(bugprone-use-after-move): it is what is tested
  EXPECT_EQ(first.size(), 0U);
  EXPECT_EQ(first.particles().size(), 0U);
  EXPECT_NO_THROW(first.step());
  EXPECT_NO_THROW(first.update_after_edit());
  fill(first);
  EXPECT_EQ(first.size(), 2U);
  for (std::size_t p = 0; p < first.positions().size(); ++p)
    EXPECT_EQ(first.positions()[p], second.positions()[p]) << p;
  // NOLINTEND(bugprone-use-after-move)
}

}  // namespace dartcast::body_ranges_test
