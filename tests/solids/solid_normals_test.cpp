// Normals of contacts where rounding leaves the parts none, and at the ends of the range of numbers.
#include <gtest/gtest.h>

#include <cmath>

#include "dartcast/solids.hpp"
#include "support/meshes.hpp"

namespace dartcast::solid_normals_test {

// A block from 1 to 2 along each axis, of a length unit.
MeshData block_of(double unit) {
  MeshData mesh = test::cubes(4);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[21] = 0;
  for (Vec3& p : mesh.points) p *= unit;
  return mesh;
}

// An edge one unit in the last place beside a parallel edge of the block. Their nearest points are rounded to one place.
TEST(SolidNormals, EdgesThatLieOnEachOtherToRoundingHaveOne) {
  const double x = std::nextafter(1.7, 0.0);
  for (const auto& [a, b, way] : {std::array{0x1.25ea0e06c49abp+1, 0x1.2cf655695823ap+1, 0x1.e4e05b69904cdp-3},
                                  std::array{0x1.46bd2bc11a104p+1, 0x1.2e953db127a57p+0, 0x1.2701ea1c94f39p-1}}) {
    Environment environment(block_of(1.7), Threads{1});
    SolidSet solids(environment);
    const std::vector<Vec3> line = {{x, a, 1.7}, {x, b, 1.7}};
    ASSERT_EQ(solids.add(solid_of_polyline(line)).refusal, SolidRefusal::none);
    const std::vector<Vec3> to = {line[0] + Vec3{way, 0.0, 0.0}, line[1] + Vec3{way, 0.0, 0.0}};
    const SolidStep& step = solids.advance(to, {.rounds = 1});
    bool parallel = false;
    for (const SolidContact& c : step.contacts) {
      parallel = parallel || c.kind == SolidContactKind::edge_edge;
      EXPECT_NEAR(norm(c.normal), 1.0, 1e-15) << static_cast<int>(c.kind);
      EXPECT_LE(c.normal.x, 0.0);
      EXPECT_LE(c.normal.z, 0.0);
    }
    EXPECT_TRUE(parallel);
    EXPECT_EQ(solids.audit().failed, 0U);
  }
}

// Whatever the unit of length is.
TEST(SolidNormals, AreThoseOfAnyUnit) {
  const auto step = [](double unit, unsigned rounds) {
    Environment environment(block_of(unit), Threads{1});
    SolidSet solids(environment);
    std::vector<Vec3> line = {{0.5, 1.3, 1.2}, {0.6, 1.9, 1.4}, {0.9, 2.4, 2.3}, {2.1, 2.3, 2.2}};
    for (Vec3& x : line) x *= unit;
    EXPECT_EQ(solids.add(solid_of_polyline(line)).refusal, SolidRefusal::none);
    std::vector<Vec3> to = line;
    for (Vec3& x : to) x += Vec3{0.6, 0.1, -0.5} * unit;
    std::vector<Vec3> all;
    for (const SolidContact& c : solids.advance(to, {.rounds = rounds}).contacts)
      all.insert(all.end(), {c.normal, c.point * (1.0 / unit), c.wall_point * (1.0 / unit)});
    return all;
  };
  for (const unsigned rounds : {0U, 4U}) {
    const std::vector<Vec3> one = step(1.0, rounds);
    EXPECT_FALSE(one.empty());
    for (const int exponent : {-280, -140, 140, 280}) {
      const std::vector<Vec3> other = step(std::ldexp(1.0, exponent), rounds);
      ASSERT_EQ(other.size(), one.size()) << exponent;
      for (std::size_t i = 0; i < one.size(); ++i) EXPECT_LT(norm(other[i] - one[i]), 1e-8) << exponent;
    }
  }
}

}  // namespace dartcast::solid_normals_test
