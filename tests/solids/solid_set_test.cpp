// Refusals of a set of solids: places that are not free, and calls that break its rules.
#include <gtest/gtest.h>

#include <cmath>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"

namespace dartcast::solid_set_test {

using test::ball;
using test::moved;

// Cubes with the one in the middle blocked: from 2 to 3 along each axis.
MeshData with_obstacle() {
  MeshData mesh = test::cubes(5);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[62] = 0;
  return mesh;
}

TEST(SolidSet, AddsOnlyWhereThereIsRoom) {
  Environment environment(with_obstacle());
  SolidSet solids(environment);
  const auto refusal = [&](const SolidMesh& mesh) { return solids.add(mesh).refusal; };
  EXPECT_EQ(refusal(moved(ball(0.4), {2.5, 2.5, 2.5})), SolidRefusal::vertex_not_free);
  EXPECT_EQ(refusal(moved(ball(0.4), {0.1, 2.5, 2.5})), SolidRefusal::vertex_not_free);
  EXPECT_EQ(refusal(solid_of_polyline(std::vector<Vec3>{{1.5, 2.5, 2.5}, {3.5, 2.5, 2.5}})), SolidRefusal::meets_wall);
  EXPECT_EQ(refusal(solid_of_polyline(std::vector<Vec3>{{1.5, 2.0, 2.5}, {3.5, 2.0, 2.5}})), SolidRefusal::meets_wall);
  EXPECT_EQ(refusal(moved(ball(1.5), {2.5, 2.5, 2.5})), SolidRefusal::encloses_wall);
  EXPECT_EQ(solids.size(), 0U);
  EXPECT_TRUE(solids.positions().empty());

  SolidMesh open = moved(ball(1.5), {2.5, 2.5, 2.5});
  open.triangles.pop_back();
  const SolidPlacement first = solids.add(open);
  EXPECT_EQ(first.refusal, SolidRefusal::none) << "an open surface encloses nothing";
  EXPECT_EQ(first.solid, 0U);
  const SolidPlacement second = solids.add(moved(ball(0.4), {1.0, 1.0, 1.0}));
  EXPECT_EQ(second.solid, 1U);
  EXPECT_EQ(solids.size(), 2U);
  EXPECT_EQ(solids.first_vertices()[1], 12U);
  EXPECT_EQ(solids.positions().size(), 24U);
  EXPECT_EQ(solids.audit().checked, 39U);
  EXPECT_EQ(solids.audit().failed, 0U);
}

TEST(SolidSet, SaysWhichPartIsRefused) {
  Environment environment(with_obstacle());
  SolidSet solids(environment);
  const std::vector<Vec3> line = {{0.5, 2.5, 2.5}, {1.5, 2.5, 2.5}, {3.5, 2.5, 2.5}};
  const SolidPlacement result = solids.add(solid_of_polyline(line));
  EXPECT_EQ(result.refusal, SolidRefusal::meets_wall);
  EXPECT_EQ(result.count, 2);
  EXPECT_EQ(result.vertices[0], 1U);
  EXPECT_EQ(result.vertices[1], 2U);
}

TEST(SolidSet, RefusesFlatCells) {
  Environment environment(test::cubes(4));
  std::vector<Vec3> flat(environment.positions().begin(), environment.positions().end());
  for (Vec3& p : flat) p.z = p.z == 2.0 ? 1.0 : p.z;  // the second layer
  environment.move(flat);
  SolidSet solids(environment);
  const auto line = [](double from, double to) {
    return solid_of_polyline(std::vector<Vec3>{{1.5, 1.5, from}, {1.5, 1.5, to}});
  };
  EXPECT_EQ(solids.add(line(0.5, 2.5)).refusal, SolidRefusal::cell_not_positive);
  EXPECT_EQ(solids.add(line(1.5, 2.5)).refusal, SolidRefusal::none);
}

TEST(SolidSet, RefusesThePlane) {
  Environment plane(generate_rectangle({}));
  EXPECT_THROW(SolidSet{plane}, InvalidArgument);
}

// Every refusal leaves the set as it was.
TEST(SolidSet, RefusesBadCallsAndStaysAsItWas) {
  Environment environment(with_obstacle());
  SolidSet solids(environment);
  solids.add(moved(ball(0.4), {1.0, 1.0, 1.0}));
  const std::vector<Vec3> before(solids.positions().begin(), solids.positions().end());
  const std::vector<Vec3> walls(environment.positions().begin(), environment.positions().end());
  std::vector<Vec3> bad = before;
  bad[3].y = NAN;
  EXPECT_THROW(solids.advance(bad), InvalidArgument);
  bad[3].y = 0x1p301;
  EXPECT_THROW(solids.advance(bad), InvalidArgument);
  EXPECT_THROW(solids.advance(std::span<const Vec3>(before).first(11)), InvalidArgument);
  EXPECT_THROW(solids.advance(before, {.iterations = 0}), InvalidArgument);
  EXPECT_THROW(solids.advance(before, {.separation = -1.0}), InvalidArgument);
  EXPECT_THROW(solids.advance(before, {.separation = NAN}), InvalidArgument);
  EXPECT_THROW(solids.move_with(before, std::span<const Vec3>(walls).first(5)), InvalidArgument);
  EXPECT_THROW(solids.set_inverse_masses(std::vector<double>(11, 1.0)), InvalidArgument);
  EXPECT_THROW(solids.set_inverse_masses(std::vector<double>(12, -1.0)), InvalidArgument);
  EXPECT_THROW(solids.set_inverse_masses(std::vector<double>(12, INFINITY)), InvalidArgument);
  EXPECT_THROW(solids.add({}), InvalidMesh);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), solids.positions().begin(), solids.positions().end()));
  EXPECT_EQ(solids.size(), 1U);

  environment.move(walls);  // without the solids
  EXPECT_THROW(solids.advance(before), InvalidArgument);
  EXPECT_THROW(solids.move_with(before, walls), InvalidArgument);
  EXPECT_THROW(solids.add(moved(ball(0.4), {1.0, 1.0, 1.0})), InvalidArgument);
}

}  // namespace dartcast::solid_set_test
