#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_selection.hpp"

namespace dartcast::test::patches_test {

std::map<std::int32_t, std::size_t> counts(const MeshData& mesh) {
  std::map<std::int32_t, std::size_t> out;
  for (const std::int32_t tag : mesh.patch_tags) ++out[tag];
  return out;
}

/// Sets of corners of each patch: what they hold, whatever their numbers.
std::set<std::set<std::vector<std::uint32_t>>> content(const MeshData& mesh) {
  std::map<std::int32_t, std::set<std::vector<std::uint32_t>>> by_tag;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    std::vector<std::uint32_t> corners(mesh.patch_face(f).begin(), mesh.patch_face(f).end());
    std::sort(corners.begin(), corners.end());
    by_tag[mesh.patch_tags[f]].insert(corners);
  }
  std::set<std::set<std::vector<std::uint32_t>>> out;
  for (const auto& entry : by_tag) out.insert(entry.second);
  return out;
}

MeshData box(std::array<std::uint32_t, 3> cells, CellType type = CellType::hexahedron, bool layer = false) {
  BoxOptions options;
  options.cells = cells;
  options.size = {static_cast<double>(cells[0]), static_cast<double>(cells[1]), static_cast<double>(cells[2])};
  options.type = type;
  options.blocked_layer = layer;
  return generate_box(options);
}

TEST(Patches, ABoxHasSixSidesWhateverItsCells) {
  for (const CellType type : {CellType::tetrahedron, CellType::hexahedron, CellType::prism, CellType::pyramid}) {
    const MeshData given = box({3, 2, 4}, type);
    MeshData mesh = given;
    divide_walls(mesh, 30.0);
    EXPECT_EQ(content(mesh), content(given));
    EXPECT_EQ(mesh.patch_names.size(), 6U);
    EXPECT_EQ(mesh.patch_names.at(1), "patch1");
    EXPECT_TRUE(check_and_repair(mesh).warnings.empty());
    divide_walls(mesh, 90.5);
    EXPECT_EQ(counts(mesh).size(), 1U);
    divide_walls(mesh, 89.5);
    EXPECT_EQ(counts(mesh).size(), 6U);
  }
}

// A prism of n sides turns by 360 / n degrees at each of its edges along the axis.
TEST(Patches, TheAngleIsThatBetweenNormals) {
  for (const int n : {5, 8, 12, 40}) {
    MeshData mesh;
    mesh.points = {{0, 0, 0}, {0, 0, 1}};
    for (int k = 0; k < n; ++k) {
      const double a = 2.0 * std::numbers::pi * k / n;
      mesh.points.push_back({std::cos(a), std::sin(a), 0});
      mesh.points.push_back({std::cos(a), std::sin(a), 1});
    }
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(n); ++k) {
      const std::uint32_t a = 2 + 2 * k;
      const std::uint32_t b = 2 + 2 * ((k + 1) % static_cast<std::uint32_t>(n));
      mesh.add_cell(CellType::prism, std::vector<std::uint32_t>{0, a, b, 1, a + 1, b + 1});
    }
    ASSERT_TRUE(check_and_repair(mesh).valid());
    divide_walls(mesh, 360.0 / n + 0.01);
    EXPECT_EQ(counts(mesh).size(), 3U) << n;
    divide_walls(mesh, 360.0 / n - 0.01);
    EXPECT_EQ(counts(mesh).size(), 2U + static_cast<std::size_t>(n)) << n;
  }
}

// Walls between free and blocked cells are divided; the outside of blocked cells is none of them.
TEST(Patches, WallsInsideTheMeshCount) {
  MeshData mesh = box({4, 4, 5}, CellType::tetrahedron, true);
  divide_walls(mesh, 30.0);
  EXPECT_EQ(counts(mesh), (std::map<std::int32_t, std::size_t>{{1, 8}, {2, 12}, {3, 12}, {4, 12}, {5, 12}, {6, 8}}));
  for (const std::uint32_t v : mesh.patch_faces) {
    const Vec3& x = mesh.points[v];
    EXPECT_TRUE(x.x >= 1 && x.x <= 3 && x.y >= 1 && x.y <= 3 && x.z >= 1 && x.z <= 4);
  }
}

// Numbers follow the cells of the file, not the points, the sizes or the places.
TEST(Patches, NumbersFollowTheCells) {
  MeshData mesh = box({1, 1, 3});
  divide_walls(mesh, 30.0);
  std::vector<std::uint32_t> first(mesh.patch_face(0).begin(), mesh.patch_face(0).end());
  EXPECT_EQ(mesh.patch_tags[0], 1);
  MeshData turned = mesh;
  turned.source = {9, 5, 2};  // the last cell is the first in the file
  divide_walls(turned, 30.0);
  const auto above = turned.patch_face(0);
  EXPECT_TRUE(std::any_of(above.begin(), above.end(), [&](std::uint32_t v) { return turned.points[v].z == 3.0; }));
  EXPECT_EQ(content(turned), content(mesh));
}

TEST(Patches, AnEdgeOfFourWallsDividesThem) {
  MeshData mesh = box({2, 2, 1});
  mesh.free = {1, 0, 0, 1};
  divide_walls(mesh, 180.0);
  EXPECT_EQ(counts(mesh), (std::map<std::int32_t, std::size_t>{{1, 6}, {2, 6}}));
}

TEST(Patches, AVesselHasItsEndsAndItsWall) {
  const MeshData given = generate_vessel({});
  MeshData mesh = given;
  divide_walls(mesh, 60.0);
  std::vector<std::string> ends = {"inlet", "outlet_left", "outlet_right"};
  MeshData named = given;
  select_patches(named, ends);
  const auto all = content(mesh);
  for (const auto& end : content(named)) EXPECT_EQ(all.count(end), 1U);
}

TEST(Patches, EdgesInThePlane) {
  RectangleOptions options;
  options.cells = {4, 3};
  options.size = {1.0, 1.0};
  const MeshData given = generate_rectangle(options);
  MeshData mesh = given;
  divide_walls(mesh, 30.0);
  EXPECT_EQ(content(mesh), content(given));
  divide_walls(mesh, 91.0);
  EXPECT_EQ(counts(mesh).size(), 1U);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[5] = 0;
  divide_walls(mesh, 30.0);
  EXPECT_EQ(counts(mesh).size(), 8U);
}

TEST(Patches, SizesDoNotMatter) {
  for (const double scale : {1e-80, 1e80}) {
    MeshData mesh = box({2, 2, 2}, CellType::tetrahedron);
    for (Vec3& x : mesh.points) x *= scale;
    divide_walls(mesh, 30.0);
    EXPECT_EQ(counts(mesh).size(), 6U);
  }
}

TEST(Patches, SelectedByNameOrTag) {
  MeshData mesh = box({1, 1, 1});
  mesh.patch_names.erase(mesh.patch_tags[0]);
  const std::string tag = std::to_string(mesh.patch_tags[0]);
  mesh.patch_source = {4, 5, 6, 7, 8, 9};
  MeshData chosen = mesh;
  select_patches(chosen, std::vector<std::string>{tag, "zmax"});
  EXPECT_EQ(chosen.patch_tags.size(), 2U);
  EXPECT_EQ(chosen.patch_source.size(), 2U);
  EXPECT_EQ(chosen.patch_source[0], 4U);
  EXPECT_THROW(select_patches(mesh, std::vector<std::string>{"inlet"}), InvalidMesh);
  EXPECT_EQ(mesh.patch_tags.size(), 6U);
}

}  // namespace dartcast::test::patches_test
