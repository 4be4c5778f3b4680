// Camera paths in a straight bar: places on the spline, in the lumen, without twist.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dartcast/catheter.hpp"
#include "dartcast/error.hpp"
#include "support/catheter_scenes.hpp"

namespace dartcast::camera_path_test {

TEST(CameraPath, GoesThroughItsPointsEvenly) {
  Environment environment(test::pipe(28));
  const std::vector<Vec3> points = {
      {2.5, 2.5, 2.0}, {2.5, 2.5, 2.0}, {1.5, 2.0, 8.0}, {3.5, 3.0, 14.0}, {2.5, 2.5, 26.0}};
  const CameraPath path = camera_path(environment, points, {0.05});
  EXPECT_EQ(path.at_walls, 0U);
  EXPECT_EQ(path.cameras.back().position, points.back());
  for (const Vec3& p : points) {
    double nearest = 1e9;
    for (const Camera& c : path.cameras) nearest = std::min(nearest, norm(c.position - p));
    EXPECT_LE(nearest, 0.026);
  }
  for (std::size_t i = 1; i < path.cameras.size(); ++i) {
    const Camera& c = path.cameras[i];
    const Vec3 step = c.position - path.cameras[i - 1].position;
    if (i + 1 < path.cameras.size()) {
      EXPECT_NEAR(norm(step), 0.05, 5e-4);
    }
    EXPECT_GT(dot(step, c.direction), 0.999 * norm(step));
    EXPECT_DOUBLE_EQ(c.arc, path.cameras[i - 1].arc + norm(step));
  }
}

// Two points whose spline would leave the lumen around a bend: its cameras stay in.
TEST(CameraPath, StaysInTheLumen) {
  Environment environment(test::pipe(28));
  const std::vector<Vec3> points = {
      {1.2, 2.5, 2.0}, {1.05, 2.5, 4.0}, {1.05, 2.5, 6.0}, {3.9, 2.5, 6.5}, {1.2, 2.5, 7.0}};
  const CameraPath path = camera_path(environment, points, {0.05});
  EXPECT_GT(path.at_walls, 0U);
  for (const Camera& c : path.cameras) EXPECT_EQ(environment.locate(c.position).place, Place::free);
}

// In a plane the normal of the plane stays up.
TEST(CameraPath, DoesNotTwist) {
  Environment environment(test::pipe(28));
  std::vector<Vec3> points;
  for (int i = 0; i <= 24; ++i) points.push_back({2.5, 2.5 + std::sin(0.9 * i), 2.0 + i});
  CameraOptions o;
  o.spacing = 0.1;
  o.up = {1.0, 0.0, 0.0};
  for (const Camera& c : camera_path(environment, points, o).cameras) EXPECT_LE(norm(c.up - o.up), 1e-12);
  o.up = {0.0, 0.0, 0.0};
  for (const Camera& c : camera_path(environment, points, o).cameras) {
    EXPECT_NEAR(norm(c.up), 1.0, 1e-12);
    EXPECT_NEAR(dot(c.up, c.direction), 0.0, 1e-12);
  }
}

TEST(CameraPath, RefusesWhatIsNoPath) {
  Environment environment(test::pipe(28));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> line = {{2.5, 2.5, 2.0}, {2.5, 2.5, 8.0}};
  EXPECT_THROW(camera_path(environment, std::vector<Vec3>{}), InvalidArgument);
  EXPECT_THROW(camera_path(environment, std::vector<Vec3>{line[0], line[0]}), InvalidArgument);
  EXPECT_THROW(camera_path(environment, std::vector<Vec3>{line[0], {0.5, 0.5, 2.0}}), InvalidArgument);
  EXPECT_THROW(camera_path(environment, std::vector<Vec3>{line[0], {nan, 0.5, 2.0}}), InvalidArgument);
  EXPECT_THROW(camera_path(environment, line, {0.0}), InvalidArgument);
  EXPECT_THROW(camera_path(environment, line, {nan}), InvalidArgument);
  EXPECT_THROW(camera_path(environment, line, {1e-9}), InvalidArgument);
  EXPECT_THROW(camera_path(environment, line, {0.1, {nan, 0.0, 0.0}}), InvalidArgument);
}

}  // namespace dartcast::camera_path_test
