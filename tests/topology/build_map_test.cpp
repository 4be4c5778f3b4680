// Meshes that make no map: each is refused by a text that names the cells.
#include <gtest/gtest.h>

#include <string>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "support/expectations.hpp"
#include "support/mixed_mesh.hpp"

namespace dartcast::build_test {

std::string refusal(const MeshData& mesh) {
  return test::error_text([&] { const CombinatorialMap map(mesh); });
}

MeshData three_on_a_face() {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {1, 1, 1}};
  for (const std::uint32_t top : {3U, 4U, 5U}) test::add_tetrahedron(mesh, {0, 1, 2, top});
  mesh.source = {17, 23, 42};
  return mesh;
}

TEST(MapBuild, AFaceOfThreeCellsIsRefused) {
  test::expect_parts(refusal(three_on_a_face()), {"17", "23", "42", "share one face", "at most two"});
}

TEST(MapBuild, TwoCellsOnOneSideAreRefused) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  test::add_tetrahedron(mesh, {0, 1, 2, 3});
  test::add_tetrahedron(mesh, {0, 1, 2, 4});
  mesh.source = {5, 6};
  test::expect_parts(refusal(mesh), {"5", "6", "same side"});
}

MeshData polyhedron(std::vector<std::uint32_t> faces) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 5, 5}};
  test::add_tetrahedron(mesh, {0, 1, 2, 3});
  mesh.add_cell(CellType::polyhedron, faces);
  mesh.source = {8, 99};
  return mesh;
}

TEST(MapBuild, APolyhedronThatDoesNotCloseIsRefused) {
  test::expect_parts(refusal(polyhedron({3, 3, 0, 2, 1, 3, 0, 1, 4, 3, 1, 2, 4})), {"cell 99", "do not close"});
  test::expect_parts(refusal(polyhedron({4, 3, 0, 2, 1, 3, 0, 1, 4, 3, 1, 2, 4, 3, 0, 2, 4})), {"cell 99", "same way"});
  test::expect_parts(refusal(polyhedron({4, 3, 0, 2, 1, 3, 0, 1, 4, 3, 1, 2, 4, 3, 2, 0, 0})),
                     {"cell 99", "distinct corners"});
}

TEST(MapBuild, CellsAndVerticesAreCounted) {
  const CombinatorialMap map(test::mixed_mesh());
  EXPECT_EQ(map.cell_count(), 8U);
  EXPECT_EQ(map.cell_count(0), 4U);
  EXPECT_EQ(map.cell_count(CombinatorialMap::general_pool), 1U);
  EXPECT_EQ(map.vertex_count(), 21U);
}

}  // namespace dartcast::build_test
