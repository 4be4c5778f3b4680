// The triangles of walls: by Gauss's theorem they enclose the free volume.
#include <gtest/gtest.h>

#include <algorithm>

#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/walls.hpp"

namespace dartcast::wall_triangles_test {

// By normals that are outward: clockwise as seen from inside.
double enclosed(const Environment& environment) {
  const WallTriangles walls = wall_triangles(environment.complex());
  const std::vector<Vec3> x = walls.points(environment.positions());
  double volume = 0.0;
  for (const auto& [a, b, c] : walls.triangles) volume += dot(x[a], cross(x[b], x[c])) / 6.0;
  return volume;
}

TEST(WallTriangles, EncloseTheFreeVolume) {
  BoxOptions box;
  box.cells = {4, 3, 3};
  box.size = {4.0, 3.0, 3.0};
  box.mixed = true;
  box.blocked_layer = true;
  Environment environment(generate_box(box));
  EXPECT_NEAR(enclosed(environment), 2.0, 1e-12);
  const std::uint64_t version = environment.edit_count();
  const WallTriangles walls = wall_triangles(environment.complex());
  ASSERT_EQ(walls.faces.size(), walls.triangles.size());
  EXPECT_TRUE(std::is_sorted(walls.vertices.begin(), walls.vertices.end()));
  for (const CellFace f : walls.faces)
    EXPECT_TRUE(environment.map().is_free(f.cell) && environment.map().view(f.cell).is_wall(f.face));

  const std::vector<Cell> cells = environment.map().cells();
  environment.edit([&](ComplexEdit& edit) {
    for (const Cell c : cells) edit.topology().set_free(c, true);
  });
  EXPECT_NE(environment.edit_count(), version);
  EXPECT_NEAR(enclosed(environment), 36.0, 1e-12);
}

TEST(WallTriangles, AreSidesInThePlane) {
  Environment environment(generate_rectangle({.cells = {3, 2}}));
  const WallTriangles walls = wall_triangles(environment.complex());
  const std::vector<Vec3> x = walls.points(environment.positions());
  double length = 0.0;
  for (const auto& [a, b, c] : walls.triangles) {
    EXPECT_EQ(b, c);
    length += norm(x[b] - x[a]);
  }
  EXPECT_EQ(walls.triangles.size(), 10U);
  EXPECT_NEAR(length, 10.0, 1e-12);
}

}  // namespace dartcast::wall_triangles_test
