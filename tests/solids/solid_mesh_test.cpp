// Meshes of solids: where they come from, what is refused, and the elements that own corners and sides.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "dartcast/error.hpp"
#include "solids/elements.hpp"
#include "support/closed_surfaces.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"

namespace dartcast::solid_mesh_test {

TEST(SolidMesh, TakesTheBoundaryOfCells) {
  const SolidMesh solid = solid_of_cells(test::cubes(3, CellType::tetrahedron));
  EXPECT_EQ(solid.points.size(), 56U);  // of 64, 8 are inside
  EXPECT_EQ(solid.triangles.size(), 108U);
  EXPECT_EQ(solid_of_cells(test::cubes(3)).triangles.size(), 108U);
  EXPECT_NO_THROW(check(solid));
  EXPECT_THROW(solid_of_cells(generate_rectangle({})), InvalidMesh);
  MeshData broken = test::cubes(1);
  broken.connectivity[0] = 99;
  EXPECT_THROW(solid_of_cells(broken), InvalidMesh);
}

TEST(SolidMesh, TakesSurfacesAndLines) {
  MeshData quad;
  quad.points = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::array<std::uint32_t, 4> corners = {1, 2, 3, 4};
  quad.add_cell(CellType::quadrilateral, corners);
  const SolidMesh surface = solid_of_surface(quad);
  EXPECT_EQ(surface.points.size(), 4U);
  ASSERT_EQ(surface.triangles.size(), 2U);
  EXPECT_EQ(surface.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(surface.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  const SolidMesh line = test::rod(4, 1.0);
  EXPECT_EQ(line.edges.size(), 3U);
  EXPECT_EQ(solid_of_polyline(std::vector<Vec3>{{1, 2, 3}}).edges.size(), 0U);
}

TEST(SolidMesh, NamesTheFirstDefect) {
  const auto message = [](const SolidMesh& mesh) -> std::string {
    try {
      check(mesh);
    } catch (const InvalidMesh& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message({}), "solid: it has no points; give one or more");
  EXPECT_EQ(message({{{0, 0, 0}, {1, 0, NAN}}, {}, {}}),
            "solid: point 1 is not finite or outside the exact range; give coordinates of at most 2^300");
  EXPECT_EQ(message({{{0, 0, 0}, {1, 0, 0}}, {{0, 1}, {1, 2}}, {}}),
            "solid: edge 1 has the point 2, but there are 2; give points that exist");
  EXPECT_EQ(message({{{0, 0, 0}, {1, 0, 0}}, {}, {{0, 1, 0}}}),
            "solid: triangle 0 has the point 0 twice; leave it out");
}

// Each corner and each side has one owner, whatever is listed twice or shared.
TEST(SolidElements, OwnEachCornerAndSideOnce) {
  SolidMesh mesh = test::ball(1.0, 1);
  mesh.triangles.push_back(mesh.triangles[5]);
  std::swap(mesh.triangles.back()[0], mesh.triangles.back()[1]);
  mesh.points.insert(mesh.points.end(), {{5, 0, 0}, {6, 0, 0}, {7, 0, 0}});
  const std::array<std::uint32_t, 2> free_edge = {42, 43};
  mesh.edges = {free_edge, {43, 42}, {mesh.triangles[0][0], mesh.triangles[0][1]}};
  std::map<std::uint32_t, int> corners;
  std::map<std::set<std::uint32_t>, int> sides;
  std::array<int, 4> kinds{};
  for (const SolidElement& e : elements_of(mesh)) {
    ++kinds[e.count];
    for (unsigned i = 0; i < e.count; ++i) corners[e.vertex[i]] += (e.own_corners >> i) & 1U;
    for (unsigned i = 0; i < side_count(e); ++i)
      sides[{e.vertex[i], e.vertex[(i + 1) % e.count]}] += (e.own_sides >> i) & 1U;
  }
  EXPECT_EQ(kinds, (std::array<int, 4>{0, 1, 1, 80}));
  EXPECT_EQ(corners.size(), 45U);
  EXPECT_EQ(sides.size(), 121U);
  for (const auto& [corner, owners] : corners) EXPECT_EQ(owners, 1) << corner;
  for (const auto& [side, owners] : sides) EXPECT_EQ(owners, 1) << *side.begin();
}

}  // namespace dartcast::solid_mesh_test
