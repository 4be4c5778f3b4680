// Meshes of solids: where they come from, what is refused, and the elements that own corners and sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/surface.hpp"
#include "solids/elements.hpp"
#include "support/closed_surfaces.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"
#include "surface/check_surface.hpp"
#include "surface/triangle_pairs.hpp"

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

// A prism over a C, with any corner the lowest, on any axis and in both senses: its triangles cover it once.
TEST(SolidMesh, FacesThatAreNotConvexAreCoveredOnce) {
  const std::vector<std::array<double, 2>> c = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {3, 2}, {3, 3}, {0, 3}};
  const auto n = static_cast<std::uint32_t>(c.size());
  for (std::uint32_t shift = 0; shift < 6 * n; ++shift) {
    SCOPED_TRACE(shift);
    const unsigned axis = shift / n % 3;
    const bool turned = shift / n >= 3;
    MeshData prism;
    for (const double z : {0.0, 1.0}) {
      for (std::uint32_t i = 0; i < n; ++i) {
        const auto& [x, y] = c[(i + shift) % n];
        prism.points.push_back(axis == 0 ? Vec3{x, y, z} : axis == 1 ? Vec3{z, x, y} : Vec3{y, z, x});
      }
    }
    std::vector<std::uint32_t> low, high;
    for (std::uint32_t i = 0; i < n; ++i) {
      low.push_back(n - 1 - i);
      high.push_back(n + i);
      std::array<std::uint32_t, 4> side = {i, (i + 1) % n, n + (i + 1) % n, n + i};
      if (turned) std::reverse(side.begin(), side.end());
      prism.add_cell(CellType::quadrilateral, side);
    }
    for (auto* cap : {&low, &high}) {
      if (turned) std::reverse(cap->begin(), cap->end());
      prism.add_cell(CellType::polygon, *cap);
    }
    const SolidMesh solid = solid_of_surface(prism);
    double area = 0.0;
    for (const auto& t : solid.triangles) {
      const auto at = [&](unsigned k) { return solid.points[t[k]]; };
      area += 0.5 * norm(cross(at(1) - at(0), at(2) - at(0)));
    }
    EXPECT_EQ(area, 7.0 + 7.0 + 16.0);
    EXPECT_TRUE(crossing_pairs(solid.points, solid.triangles, 1).empty());
    MeshData repaired = prism;
    repaired.regions.assign(prism.cell_count(), 1);
    repaired.regions.back() = 2;
    const MeshReport report = check_and_repair_surface(repaired);
    EXPECT_LE(report.verdict(), Verdict::repair);
    EXPECT_EQ(repaired.source.back(), n + 1);
    EXPECT_EQ(std::count(repaired.regions.begin(), repaired.regions.end(), 2), n - 2);
    const Surface surface(prism);
    EXPECT_EQ(surface.triangles().size(), solid.triangles.size());
  }
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
