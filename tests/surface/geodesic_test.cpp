// Paths on polyhedra against an independent trace with 50 digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dartcast/surface.hpp"
#include "support/geodesic_oracle.hpp"
#include "support/surface_meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::geodesic_test {

struct Sample {
  std::string name;
  MeshData (*make)(std::uint64_t seed);
};

// Quadrilaterals whose corners are in no plane, pentagons among them.
MeshData warped(std::uint64_t seed) {
  RectangleOptions o;
  o.cells = {9, 9};
  o.size = {3.0, 3.0};
  o.mixed = true;
  o.seed = seed;
  MeshData mesh = generate_rectangle(o);
  Random random(seed);
  for (Vec3& p : mesh.points) p.z = 0.3 * std::sin(3.0 * p.x + p.y) + 0.1 * random.uniform();
  return mesh;
}

const Sample samples[] = {
    {"cube", [](std::uint64_t) { return test::cube(); }},
    {"tetrahedron", [](std::uint64_t) { return test::tetrahedron(); }},
    {"octahedron", [](std::uint64_t) { return test::sphere(0); }},
    {"hull", [](std::uint64_t seed) { return test::random_hull(14, seed); }},
    {"bumps", [](std::uint64_t seed) { return test::bumpy(2, 0.15, seed); }},
    {"crags", [](std::uint64_t seed) { return test::bumpy(2, 0.6, seed); }},
    {"warped", warped},
};

class Geodesics : public testing::TestWithParam<Sample> {};

TEST_P(Geodesics, AgreeWithFiftyDigits) {
  int compared = 0;
  int crossings = 0;
  const int seeds = std::max(1, test::scaled(3, 100));
  for (int seed = 1; seed <= seeds; ++seed) {
    const MeshData mesh = GetParam().make(static_cast<std::uint64_t>(seed));
    const Surface surface(mesh);
    const test::GeodesicOracle oracle(mesh);
    Random random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < 60; ++i) {
      SurfacePlace place = test::random_place(surface, random);
      const Vec3 displacement = test::random_vector(random) * (i % 3 == 0 ? 20.0 : 2.0);
      const auto corners = surface.vertices(place.triangle);
      const auto path =
          oracle.trace({corners[0].value, corners[1].value, corners[2].value}, place.weights, displacement);
      const SurfaceStep step = dartcast::step(surface, place, displacement);
      if (step.end == SurfaceEnd::stopped) EXPECT_TRUE(path.left);
      // A direction is off by some 2^-53 in each triangle, and that error grows with the way.
      const double bound = 0x1p-53 * 8.0 * (10.0 + step.crossings) * (1.0 + step.length);
      if (path.clearance < 1000 * bound) continue;  // the two may pass a vertex on different sides
      ++compared;
      crossings += path.crossings;
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", path " << i);
      ASSERT_EQ(static_cast<int>(step.crossings), path.crossings);
      ASSERT_EQ(step.end == SurfaceEnd::stopped, path.left);
      ASSERT_LE(test::distance(path.end, surface.point(place)), bound);
      ASSERT_LE(test::distance(path.direction, step.direction), bound);
    }
  }
  EXPECT_GT(compared, 50 * seeds);
  EXPECT_GT(crossings, 4 * compared);
}

INSTANTIATE_TEST_SUITE_P(On, Geodesics, testing::ValuesIn(samples), [](const auto& i) { return i.param.name; });

}  // namespace dartcast::geodesic_test
