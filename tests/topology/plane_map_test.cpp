// Maps of the plane: polygons that are sewn along edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast::plane_map_test {

MeshData rectangle(int kind) {
  RectangleOptions o;
  o.cells = {9, 7};
  o.size = {9, 7};
  o.blocked_share = 0.2;
  if (kind == 0) o.type = CellType::triangle;
  o.mixed = kind == 2;
  return generate_rectangle(o);
}

class PlaneMaps : public testing::TestWithParam<int> {};

TEST_P(PlaneMaps, AreIntact) {
  const CombinatorialMap map(rectangle(GetParam()));
  EXPECT_EQ(map.dimension(), 2U);
  for (const Violation& v : check_integrity(map)) ADD_FAILURE() << v.message;
}

TEST_P(PlaneMaps, AreSewnAsTheMeshSays) {
  const MeshData mesh = rectangle(GetParam());
  const CombinatorialMap map(mesh);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;  // as cells run along them
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> e) { edges.emplace(e[0], e[1]); });
  std::size_t darts = 0;
  for (const Cell c : map.cells()) {
    EXPECT_EQ(map.type(c), mesh.types[map.source(c)]);
    for (std::uint16_t d = 0; d < map.shape(c).dart_count(); ++d, ++darts) {
      const std::uint32_t from = map.origin({c, d}).value;
      const std::uint32_t to = map.origin(map.phi1({c, d})).value;
      EXPECT_TRUE(edges.contains({from, to}));
      const Dart other = map.phi2({c, d});
      EXPECT_EQ(other.valid(), edges.contains({to, from}));
      if (!other.valid()) continue;
      EXPECT_EQ(map.origin(other).value, to);
    }
  }
  EXPECT_EQ(darts, edges.size());
}

TEST_P(PlaneMaps, OrbitsAreVerticesEdgesAndFaces) {
  const MeshData mesh = rectangle(GetParam());
  const CombinatorialMap map(mesh);
  std::vector<std::size_t> cells_at(mesh.points.size(), 0);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> e) { ++cells_at[e[0]]; });
  for (const Cell c : map.cells()) {
    for (std::uint16_t n = 0; n < map.shape(c).dart_count(); ++n) {
      const Dart d = {c, n};
      const auto around = vertex_orbit(map, d);
      for (const Dart x : around) EXPECT_EQ(map.origin(x), map.origin(d));
      EXPECT_EQ(around.size(), cells_at[map.origin(d).value]);
      EXPECT_EQ(edge_orbit(map, d).size(), map.phi2(d).valid() ? 2U : 1U);
      EXPECT_EQ(face_orbit(map, d).size(), map.shape(c).dart_count());
      EXPECT_EQ(cell_orbit(map, d).size(), map.shape(c).dart_count());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, PlaneMaps, testing::Values(0, 1, 2));

TEST(PlaneMap, OneShapeServesAllPolygonsOfSoManyCorners) {
  const CombinatorialMap map(rectangle(2));
  EXPECT_EQ(map.shapes().size(), 3U);
  for (const Cell c : map.cells()) {
    const Shape& s = map.shape(c);
    EXPECT_EQ(s.dimension(), 2U);
    EXPECT_EQ(s.simplices().size(), s.corner_count() - 2U);
    for (const std::uint32_t v : map.view(c).vertices()) EXPECT_LE(map.view(c).vertices()[0], v);
  }
}

// Across an inner side is the next triangle of the fan, across an outer one the polygon's edge.
TEST(PlaneMap, FansAreConnected) {
  for (const bool with_point : {false, true}) {
    for (std::uint16_t n = 3; n < 9; ++n) {
      ShapeKey key;
      key.corner_count = n;
      key.has_point = with_point;
      for (std::uint16_t k = 0; k < n; ++k) key.faces.push_back({{k, static_cast<std::uint16_t>((k + 1) % n)}, false});
      const Shape shape(key);
      ASSERT_EQ(shape.simplices().size(), with_point ? n : n - 2U);
      std::size_t outer = 0;
      for (std::uint16_t s = 0; s < shape.simplices().size(); ++s) {
        for (std::uint16_t f = 0; f < 3; ++f) {
          const auto& v = shape.simplices()[s].vertex;
          const std::set<std::uint16_t> ends = {v[(f + 1) % 3], v[(f + 2) % 3]};
          const Across across = shape.simplices()[s].across[f];
          if (across.outer()) {
            ++outer;
            const auto corners = shape.corners(across.face());
            EXPECT_EQ(ends, (std::set<std::uint16_t>{corners[0], corners[1]}));
            EXPECT_EQ(shape.entry(across.face(), 0), (Across{s, f}));
            continue;
          }
          const auto& w = shape.simplices()[across.index].vertex;
          EXPECT_EQ(ends, (std::set<std::uint16_t>{w[(across.place + 1U) % 3U], w[(across.place + 2U) % 3U]}));
          EXPECT_EQ(shape.simplices()[across.index].across[across.place], (Across{s, f}));
        }
      }
      EXPECT_EQ(outer, n);
    }
  }
}

TEST(PlaneMap, RefusesWhatIsNone) {
  MeshData mesh = rectangle(1);
  const std::vector<std::uint32_t> first(mesh.cell(0).begin(), mesh.cell(0).end());
  mesh.add_cell(CellType::quadrilateral, first);
  EXPECT_THROW(CombinatorialMap{mesh}, InvalidMesh) << "the same cell twice";
  mesh = rectangle(1);
  mesh.add_cell(CellType::tetrahedron, first);
  EXPECT_THROW(CombinatorialMap{mesh}, InvalidMesh) << "a cell of space";
}

// Two squares side by side; the sides have patches.
class TwoSquares : public testing::Test {
 protected:
  static MeshData mesh() {
    RectangleOptions o;
    o.cells = {2, 1};
    o.size = {1.0, 1.0};
    return generate_rectangle(o);
  }
  void expect_valid() const {
    for (const Violation& v : check_integrity(map)) ADD_FAILURE() << v.message;
  }

  CombinatorialMap map{mesh()};
  Transaction t{map};
  Cell left = map.cells()[0];
  Cell right = map.cells()[1];
};

TEST_F(TwoSquares, AnEdgeIsSplitInBothAndMergedAgain) {
  const CombinatorialMap before = map;
  const Dart d = find_dart(map, left, Vertex(1), Vertex(4));
  ASSERT_EQ(map.phi2(d).cell, right);
  const SplitEdge split = split_edge(t, d);
  expect_valid();
  ASSERT_EQ(split.cells.size(), 2U);
  for (const Cell c : split.cells) {
    EXPECT_EQ(map.type(c), CellType::polygon);
    EXPECT_EQ(map.shape(c).face_count(), 5U);
    const bool first = map.source(c) == 0;
    const Dart out = find_dart(map, c, split.vertex, Vertex(first ? 4 : 1));
    ASSERT_TRUE(out.valid());
    EXPECT_TRUE(map.flat(out).straight);
    EXPECT_NE(map.phi2(out).cell, c);
    EXPECT_EQ(map.phi2(map.phi2(out)), out);
    EXPECT_FALSE(map.flat(map.phi1(out)).straight);
  }
  merge_edges(t, find_dart(map, split.cells[0], split.vertex, Vertex(4)));
  expect_valid();
  const EditReport report = t.commit();
  ASSERT_EQ(report.added.size(), 2U);
  for (const Cell c : report.added) {
    EXPECT_EQ(map.type(c), CellType::quadrilateral);
    EXPECT_FALSE(map.has_flat(c));
    const Cell old = map.source(c) == 0 ? left : right;
    EXPECT_TRUE(std::ranges::equal(map.view(c).vertices(), before.view(old).vertices()));
    for (std::uint16_t f = 0; f < 4; ++f) EXPECT_EQ(map.patch(CellFace{c, f}), before.patch(CellFace{old, f}));
  }
  EXPECT_FALSE(map.is_vertex(split.vertex));
}

TEST_F(TwoSquares, PatchesFollowSplitsAndMerges) {
  const Dart bottom = find_dart(map, left, Vertex(0), Vertex(1));
  const Patch patch = map.patch(map.face(bottom));
  EXPECT_NE(patch, Patch{});
  const SplitEdge split = split_edge(t, bottom);
  const Cell c = split.cells[0];
  EXPECT_EQ(map.patch(map.face(find_dart(map, c, Vertex(0), split.vertex))), patch);
  EXPECT_EQ(map.patch(map.face(find_dart(map, c, split.vertex, Vertex(1)))), patch);
  const auto parts = split_face(t, find_dart(map, c, split.vertex, Vertex(1)), find_dart(map, c, Vertex(3), Vertex(0)));
  expect_valid();
  EXPECT_EQ(map.shape(parts[0]).face_count(), 4U) << "with the first dart";
  EXPECT_EQ(map.type(parts[1]), CellType::triangle);
  EXPECT_EQ(map.patch(map.face(find_dart(map, parts[0], Vertex(3), split.vertex))), Patch{});
  EXPECT_FALSE(map.has_flat(parts[0]) || map.has_flat(parts[1])) << "the vertex is a corner of both now";
  const Cell whole = merge_faces(t, find_dart(map, parts[0], Vertex(3), split.vertex))[0];
  EXPECT_TRUE(map.flat(find_dart(map, whole, split.vertex, Vertex(1))).straight) << "for all that is known here";
  EXPECT_EQ(map.patch(map.face(find_dart(map, merge_edges(t, find_dart(map, whole, split.vertex, Vertex(1)))[0],
                                         Vertex(0), Vertex(1)))),
            patch);
  expect_valid();
}

TEST_F(TwoSquares, EdgesAreSewnTheOtherWayAroundOrNotAtAll) {
  unsew(t, map.face(find_dart(map, left, Vertex(1), Vertex(4))));
  expect_valid();
  t.commit();
  CellDraft draft = draft_of(map, map.cells()[0]);
  const Cell other = map.cells()[1];
  DraftFace& edge = draft.faces[0];
  for (std::uint16_t f = 0; f < 4; ++f) {
    const CellView v = map.view(other);
    edge.corners[0].vertex = v.vertex(v.shape().corners(f)[0]);
    edge.corners[1].vertex = v.vertex(v.shape().corners(f)[1]);
    edge.across.face = {other, f};
    draft.faces[3].corners[1] = edge.corners[0];
    draft.faces[1].corners[0] = edge.corners[1];
    const Cell cells[] = {map.cells()[0]};
    EXPECT_THROW(t.replace(cells, {&draft, 1}), EditRefused) << "both run the same way";
  }
}

TEST_F(TwoSquares, WhatWouldBeNoMapIsRefused) {
  const CombinatorialMap before = map;
  const Dart d = find_dart(map, left, Vertex(1), Vertex(4));
  EXPECT_THROW(split_face(t, d, map.phi1(d)), EditRefused) << "side by side";
  EXPECT_THROW(split_face(t, d, map.phi2(d)), EditRefused) << "of two polygons";
  EXPECT_THROW(merge_edges(t, d), EditRefused) << "three edges at the vertex";
  EXPECT_THROW(merge_faces(t, map.phi1(d)), EditRefused) << "on the boundary";
  EXPECT_THROW(sew(t, d, map.phi1(d)), EditRefused) << "sewn already";
  EXPECT_THROW(split_cell(t, std::vector<Dart>{d, d, d}), InvalidArgument);
  t.set_free(right, false);
  EXPECT_THROW(merge_faces(t, d), EditRefused) << "a free and a blocked one";
  t.roll_back();
  EXPECT_EQ(map, before);
}

}  // namespace dartcast::plane_map_test
