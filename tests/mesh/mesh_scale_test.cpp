// Bounds and edges of meshes whose edges are known, and of parts against the whole.
#include "mesh/mesh_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dartcast/generators.hpp"

namespace dartcast::test::mesh_scale_test {

TEST(MeshScale, CountsEachEdgeOfACellOnce) {
  const MeshScale box =
      mesh_scale(generate_box({.cells = {4, 2, 1}, .origin = {1.0, 0.0, -1.0}, .size = Vec3{8.0, 2.0, 0.5}}));
  EXPECT_EQ(box.edge_count, 8U * 12U);
  EXPECT_EQ(box.low, (Vec3{1.0, 0.0, -1.0}));
  EXPECT_EQ(box.high, (Vec3{9.0, 2.0, -0.5}));
  EXPECT_EQ(box.size(), 8.0);
  EXPECT_EQ(box.smallest_edge, 0.5);
  EXPECT_DOUBLE_EQ(box.mean_edge(), (2.0 + 1.0 + 0.5) / 3.0);
  MeshData tetrahedron;
  tetrahedron.points = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0, 0, 12}, {9, 9, 9}};  // the last one belongs to no cell
  tetrahedron.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
  const MeshScale one = mesh_scale(tetrahedron);
  EXPECT_EQ(one.edge_count, 6U);
  EXPECT_EQ(one.high, (Vec3{3.0, 4.0, 12.0}));
  EXPECT_DOUBLE_EQ(one.mean_edge(), (3.0 + 4.0 + 12.0 + 5.0 + std::hypot(3.0, 12.0) + std::hypot(4.0, 12.0)) / 6.0);
}

TEST(MeshScale, HasNoSizeWithoutCells) {
  EXPECT_EQ(mesh_scale({}).size(), 0.0);
  EXPECT_EQ(mesh_scale({}).mean_edge(), 0.0);
}

TEST(MeshScale, OfThePlaneHasTheEdgesOfItsPolygons) {
  const MeshScale squares = mesh_scale(generate_rectangle({.cells = {3, 2}, .size = std::array{6.0, 2.0}}));
  EXPECT_EQ(squares.edge_count, 24U);
  EXPECT_EQ(squares.smallest_edge, 1.0);
  EXPECT_EQ(squares.mean_edge(), 1.5);
}

TEST(MeshScale, OfPartsAddsUpToThatOfTheWhole) {
  const MeshData mesh = generate_box({.cells = {7, 8, 9}, .size = Vec3{7.0, 8.0, 9.0}, .mixed = true, .jitter = 0.7});
  std::vector<std::uint32_t> parts(mesh.cell_count());
  for (std::size_t c = 0; c < parts.size(); ++c) parts[c] = static_cast<std::uint32_t>(c * c % 5);
  MeshScale sum;
  for (const std::uint32_t part : {3U, 0U, 4U, 2U, 1U}) sum += mesh_scale(mesh, {2}, parts, part);
  const MeshScale whole = mesh_scale(mesh, {1});
  EXPECT_EQ(sum.edge_count, whole.edge_count);
  EXPECT_EQ(sum.mean_edge(), whole.mean_edge());
  EXPECT_EQ(sum.smallest_edge, whole.smallest_edge);
  EXPECT_EQ(sum.low, whole.low);
  EXPECT_EQ(sum.high, whole.high);
}

}  // namespace dartcast::test::mesh_scale_test
