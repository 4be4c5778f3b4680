// A surface that follows its samples: affine maps are followed, and what is not affine is near it.
#include "bodies/carried_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/random.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "support/closed_surfaces.hpp"
#include "support/random_vectors.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"

namespace dartcast::carried_surface_test {

using test::random_vector;

struct AffineMap {
  std::array<Vec3, 3> rows;
  Vec3 offset;

  [[nodiscard]] Vec3 operator()(const Vec3& x) const {
    return Vec3{dot(rows[0], x), dot(rows[1], x), dot(rows[2], x)} + offset;
  }
};

void expect_follows(const std::vector<Vec3>& vertices, const std::vector<Vec3>& samples, double size, double within) {
  const CarriedSurface carried(vertices, samples);
  Random random(6);
  std::vector<Vec3> moved(samples.size());
  std::vector<Vec3> found(vertices.size());
  const auto expect_mapped = [&](const AffineMap& map, double scale) {
    for (std::size_t i = 0; i < samples.size(); ++i) moved[i] = map(samples[i]);
    carried.positions(moved, found);
    for (std::size_t v = 0; v < vertices.size(); ++v) ASSERT_LE(norm(found[v] - map(vertices[v])), within * scale) << v;
  };
  expect_mapped({{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {}}, size);
  for (int i = 0; i < std::max(1, test::scaled(20, 1000)); ++i) {
    const AffineMap map = {{random_vector(random, 2), random_vector(random, 2), random_vector(random, 2)},
                           random_vector(random, 10 * size)};
    expect_mapped(map, 20 * size);
  }
}

TEST(CarriedSurface, FollowsAffineMaps) {
  for (const MeshData& mesh : {test::torus(1.0, 0.4), test::cuboid({0, 0, 0}, {2, 1, 1})}) {
    for (const double spacing : {0.1, 0.3}) {
      const std::vector<Vec3> samples = sample_solid(mesh, {spacing}).points;
      expect_follows(mesh.points, samples, 1.0, 1e-13);
      EXPECT_LE(CarriedSurface(mesh.points, samples).amplification(), 8.0);
    }
  }
}

TEST(CarriedSurface, FollowsFromSamplesOfTheSurfaceAlone) {
  const MeshData mesh = test::torus(1.0, 0.4);
  expect_follows(mesh.points, sample_surface(mesh, {0.2}), 1.0, 1e-12);
  expect_follows(mesh.points, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0, 1e-12);
}

// A sample that moves takes only the surface near it along.
TEST(CarriedSurface, IsLocal) {
  const MeshData mesh = test::torus(1.0, 0.4);
  std::vector<Vec3> samples = sample_solid(mesh, {0.2}).points;
  const CarriedSurface carried(mesh.points, samples);
  const Vec3 place = samples[0];
  samples[0] += {0.1, 0.0, 0.0};
  std::vector<Vec3> found(mesh.points.size());
  carried.positions(samples, found);
  double farthest = 0.0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    EXPECT_LE(norm(found[v] - mesh.points[v]), 0.8 + 1e-12);
    if (norm(mesh.points[v] - place) > 1.0) {
      EXPECT_LE(norm(found[v] - mesh.points[v]), 1e-12);
    }
    farthest = std::max(farthest, norm(found[v] - mesh.points[v]));
  }
  EXPECT_GT(farthest, 1e-3);
}

TEST(CarriedSurface, IsTheSameForAnyThreads) {
  const MeshData mesh = test::torus(1.0, 0.4, 60, 30);
  std::vector<Vec3> samples = sample_solid(mesh, {0.15}).points;
  const CarriedSurface carried(mesh.points, samples);
  for (Vec3& x : samples) x += {0.1 * x.y * x.y, 0.2 * x.x * x.z, 0.0};
  std::vector<Vec3> one(mesh.points.size());
  std::vector<Vec3> other(mesh.points.size());
  carried.positions(samples, one, {1});
  for (const unsigned threads : {2U, 5U}) {
    carried.positions(samples, other, {threads});
    EXPECT_EQ(one, other);
  }
}

TEST(CarriedSurface, RefusesWhatDoesNotSpanSpace) {
  const std::vector<Vec3> vertices = {{0.3, 0.3, 0.1}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(CarriedSurface(vertices, std::vector<Vec3>{}), InvalidArgument);
  EXPECT_THROW(CarriedSurface(vertices, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), InvalidArgument);
  std::vector<Vec3> plane;
  for (int i = 0; i < 25; ++i) plane.push_back({0.37 * (i % 5), 0.21 * (i / 5), 0.1 * (i % 5) + 0.3 * (i / 5)});
  EXPECT_THROW(CarriedSurface(vertices, plane), InvalidArgument);
  EXPECT_THROW(CarriedSurface(vertices, std::vector<Vec3>(9, {1, 2, 3})), InvalidArgument);
  EXPECT_THROW(CarriedSurface(std::vector<Vec3>{{nan, 0, 0}}, plane), InvalidArgument);
  plane[3].y = nan;
  EXPECT_THROW(CarriedSurface(vertices, plane), InvalidArgument);
  const std::vector<Vec3> samples = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const CarriedSurface carried(vertices, samples);
  std::vector<Vec3> out(2);
  EXPECT_THROW(carried.positions(samples, out), InvalidArgument);
}

TEST(CarriedSurface, OfALiver) {
  NEED_DATA("a liver's surface that follows affine maps");
  const MeshData mesh = read_surface(test::data_folder() / "surfaces/sofa/liver.obj").mesh;
  double size = 0.0;
  for (const Vec3& p : mesh.points) size = std::max(size, norm(p));
  expect_follows(mesh.points, sample_solid(mesh, {size / 10}).points, size, 1e-12);
}

}  // namespace dartcast::carried_surface_test
