// The effect of each edit on cells that can be checked by hand, and the edits that are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "mesh/cell_types.hpp"
#include "support/edit_meshes.hpp"
#include "support/expectations.hpp"
#include "support/mixed_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::edit_test {

using Vertices = std::vector<std::uint32_t>;

// The handmade mesh (map/mixed_mesh.hpp), with cells by their number in it.
class Handmade : public testing::Test {
 protected:
  [[nodiscard]] Cell cell(std::uint32_t source) const {
    for (const Cell c : map.cells()) {
      if (map.source(c) == source) return c;
    }
    return {};
  }
  [[nodiscard]] Dart dart(std::uint32_t source, std::uint32_t from, std::uint32_t to) const {
    return find_dart(map, cell(source), Vertex(from), Vertex(to));
  }
  [[nodiscard]] CellFace face(std::uint32_t source, std::uint32_t from, std::uint32_t to) const {
    return map.face(dart(source, from, to));
  }
  void expect_valid() const {
    for (const Violation& v : check_integrity(map)) ADD_FAILURE() << v.message;
  }
  // Corners of a face from its lowest vertex.
  [[nodiscard]] Vertices corners(CellFace f) const {
    Vertices v;
    for (const std::uint16_t k : map.shape(f.cell).corners(f.face)) v.push_back(map.view(f.cell).vertex(k).value);
    return v;
  }

  CombinatorialMap map{test::mixed_mesh()};
  Transaction t{map};
};

TEST_F(Handmade, SplitEdgeReachesAllCellsAround) {
  const SplitEdge split = split_edge(t, dart(0, 1, 2));
  expect_valid();
  EXPECT_EQ(split.vertex, Vertex(21));
  std::set<std::uint32_t> sources;
  for (const Cell c : split.cells) sources.insert(map.source(c));
  EXPECT_EQ(sources, (std::set<std::uint32_t>{0, 1, 3, 6}));
  for (const Cell c : split.cells) {
    EXPECT_EQ(map.type(c), CellType::polyhedron);
    EXPECT_TRUE(find_dart(map, c, Vertex(1), split.vertex).valid());
    EXPECT_TRUE(find_dart(map, c, split.vertex, Vertex(2)).valid());
    EXPECT_FALSE(find_dart(map, c, Vertex(1), Vertex(2)).valid());
    std::size_t straight = 0;
    for (const Dart d : cell_orbit(map, {c, 0})) straight += map.flat(d).straight ? 1 : 0;
    EXPECT_EQ(straight, 2U);  // in both faces
    EXPECT_TRUE(map.flat(find_dart(map, c, split.vertex, Vertex(2))).straight);
  }
  const EditReport report = t.commit();
  ASSERT_EQ(report.created.size(), 1U);
  EXPECT_EQ(report.created[0].vertex, split.vertex);
  EXPECT_EQ(std::set<Vertex>({report.created[0].from, report.created[0].other}),
            (std::set<Vertex>{Vertex(1), Vertex(2)}));
  EXPECT_EQ(report.removed.size(), 4U);
}

TEST_F(Handmade, MergedEdgesGiveTheCellsTheirTypesBack) {
  const CombinatorialMap before = map;
  const SplitEdge split = split_edge(t, dart(0, 1, 2));
  merge_edges(t, find_dart(map, split.cells[0], split.vertex, Vertex(2)));
  expect_valid();
  for (const std::uint32_t source : {0U, 1U, 3U}) {
    Cell was{};
    for (const Cell c : before.cells()) {
      if (before.source(c) == source) was = c;
    }
    const Cell is = cell(source);
    EXPECT_EQ(map.type(is), before.type(was));
    EXPECT_EQ(&map.shape(is), &before.shape(was));
    EXPECT_TRUE(std::ranges::equal(map.view(is).vertices(), before.view(was).vertices()));
    EXPECT_FALSE(map.has_flat(is));
  }
  const EditReport report = t.commit();
  EXPECT_TRUE(report.created.empty());
  EXPECT_TRUE(report.deleted.empty());
  EXPECT_FALSE(map.is_vertex(split.vertex));
}

TEST_F(Handmade, SplitFaceIsSeenFromBothSides) {
  const auto cells = split_face(t, dart(0, 1, 2), dart(0, 6, 5));
  expect_valid();
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_EQ(map.source(cells[0]), 0U);
  EXPECT_EQ(map.source(cells[1]), 1U);
  EXPECT_EQ(corners(face(0, 1, 2)), (Vertices{1, 2, 6}));
  EXPECT_EQ(corners(face(0, 6, 5)), (Vertices{1, 6, 5}));
  EXPECT_EQ(corners(face(1, 1, 6)), (Vertices{1, 6, 2}));
  EXPECT_EQ(corners(face(1, 5, 6)), (Vertices{1, 5, 6}));
  for (const Cell c : cells) {
    EXPECT_TRUE(map.flat(find_dart(map, c, Vertex(1), Vertex(6))).coplanar);
    EXPECT_TRUE(map.flat(find_dart(map, c, Vertex(6), Vertex(1))).coplanar);
  }
  merge_faces(t, dart(1, 1, 6));
  expect_valid();
  EXPECT_EQ(corners(face(0, 1, 2)), (Vertices{1, 2, 6, 5}));
  EXPECT_EQ(map.type(cell(0)), CellType::hexahedron);
  EXPECT_EQ(map.type(cell(1)), CellType::pyramid);
  EXPECT_FALSE(map.flat(dart(0, 2, 6)).coplanar);
  EXPECT_TRUE(map.flat(dart(0, 6, 5)).straight);  // may be, for all that is known here
}

TEST_F(Handmade, SplitCellGivesStandardTypes) {
  const Cell cube = cell(0);
  split_face(t, dart(0, 4, 5), dart(0, 6, 7));
  split_face(t, dart(0, 0, 3), dart(0, 2, 1));
  const Dart path[] = {dart(0, 0, 4), dart(0, 4, 6), dart(0, 6, 2), dart(0, 2, 0)};
  const auto parts = split_cell(t, path);
  expect_valid();
  EXPECT_FALSE(map.contains(cube));
  for (const Cell c : parts) {
    EXPECT_EQ(map.type(c), CellType::prism);
    EXPECT_EQ(map.source(c), 0U);
    EXPECT_FALSE(map.has_flat(c));
  }
  EXPECT_TRUE(find_dart(map, parts[0], Vertex(0), Vertex(4)).valid());
  EXPECT_EQ(map.opposite(map.face(find_dart(map, parts[0], Vertex(4), Vertex(0)))).cell, parts[1]);
  const Cell whole = merge_cells(t, map.face(find_dart(map, parts[0], Vertex(4), Vertex(0))));
  expect_valid();
  EXPECT_EQ(map.shape(whole).face_count(), 8U);
  EXPECT_TRUE(map.flat(find_dart(map, whole, Vertex(4), Vertex(6))).coplanar);
  EXPECT_TRUE(map.flat(find_dart(map, whole, Vertex(0), Vertex(4))).coplanar);
  EXPECT_FALSE(map.flat(find_dart(map, whole, Vertex(4), Vertex(5))).coplanar);
}

TEST_F(Handmade, MarkedCellsKeepTheirNumbers) {
  const Cell cube = cell(0);
  t.set_free(cube, false);
  t.set_free(cube, false);
  expect_valid();
  EXPECT_FALSE(map.is_free(cube));
  const EditReport report = t.commit();
  EXPECT_EQ(report.marked, std::vector<Cell>{cube});
  EXPECT_TRUE(report.removed.empty());
  EXPECT_TRUE(map.contains(cube));
}

TEST_F(Handmade, RemovedCellsLeaveOpenFaces) {
  const CellFace base = map.opposite(face(0, 1, 2));
  remove(t, cell(0));
  expect_valid();
  EXPECT_FALSE(map.opposite(base).valid());
  EXPECT_TRUE(map.view(base.cell).is_wall(base.face));
  const EditReport report = t.commit();
  EXPECT_EQ(report.deleted, std::vector<Vertex>{});  // 4 is a corner of cell 7, too
  EXPECT_EQ(map.cell_count(), 7U);
  remove(t, cell(7));
  EXPECT_EQ(std::set<Vertex>({Vertex(4), Vertex(18), Vertex(19), Vertex(20)}), [&] {
    const EditReport r = t.commit();
    return std::set<Vertex>(r.deleted.begin(), r.deleted.end());
  }());
}

// Cells 1 and 3 apart and together again.
TEST_F(Handmade, WhatIsUnsewnCanBeSewn) {
  const CombinatorialMap before = map;
  unsew(t, face(1, 1, 2));
  expect_valid();
  EXPECT_FALSE(map.opposite(face(1, 1, 2)).valid());
  const EditReport apart = t.commit();
  EXPECT_EQ(apart.created.size(), 3U);  // cell 3 hung on that face alone
  Vertices from;
  for (const CreatedVertex& v : apart.created) {
    EXPECT_EQ(v.from, v.other);
    from.push_back(v.from.value);
  }
  std::sort(from.begin(), from.end());
  EXPECT_EQ(from, (Vertices{1, 2, 8}));
  const auto name = [&](std::uint32_t v) {
    return std::find_if(apart.created.begin(), apart.created.end(), [&](const auto& b) { return b.from.value == v; })
        ->vertex.value;
  };
  EXPECT_TRUE(dart(1, 1, 2).valid());
  EXPECT_TRUE(dart(3, name(2), name(1)).valid());

  sew(t, dart(3, name(2), name(1)), dart(1, 1, 2));
  expect_valid();
  const EditReport together = t.commit();
  EXPECT_EQ(together.merged.size(), 3U);
  EXPECT_EQ(together.deleted.size(), 3U);
  for (const MergedVertex& i : together.merged) EXPECT_LT(i.merged_into, i.gone);
  EXPECT_EQ(map.opposite(face(1, 1, 2)).cell, cell(3));
  for (const Cell c : before.cells())
    EXPECT_TRUE(std::ranges::equal(before.view(c).vertices(), map.view(cell(before.source(c))).vertices()));
}

TEST_F(Handmade, ImpossibleEditsSayWhy) {
  const CombinatorialMap before = map;
  const auto said = [&](const test::Call& act) {
    const std::string text = test::refusal(act);
    EXPECT_TRUE(map == before) << text;
    return text;
  };
  const Dart none{Cell(0, 77), 0};
  const Dart beyond{cell(0), 24};
  for (const Dart& d : {none, beyond, Dart{}}) {
    test::expect_parts(said([&] { split_edge(t, d); }), {"invalid", "no such dart"});
    test::expect_parts(said([&] { split_face(t, d, d); }), {"invalid", "no such dart"});
    test::expect_parts(said([&] { merge_faces(t, d); }), {"invalid", "no such dart"});
    test::expect_parts(said([&] { merge_edges(t, d); }), {"invalid", "no such dart"});
    test::expect_parts(said([&] { sew(t, d, dart(0, 0, 1)); }), {"invalid", "no such dart"});
    test::expect_parts(said([&] { split_cell(t, std::vector<Dart>{d, d, d}); }), {"invalid", "no such dart"});
    test::expect_parts(said([&] { remove(t, Cell(0, 77)); }), {"invalid", "not there"});
    test::expect_parts(said([&] { t.set_free(Cell(0, 77), true); }), {"invalid", "no such cell"});
  }
  test::expect_parts(said([&] { unsew(t, {cell(0), 6}); }), {"invalid", "no such face"});
  test::expect_parts(said([&] { merge_cells(t, {Cell(3, 9), 0}); }), {"invalid", "no such face"});

  test::expect_parts(said([&] { split_face(t, dart(0, 1, 2), dart(0, 2, 6)); }), {"refused", "cell 0", "side by side"});
  test::expect_parts(said([&] { split_face(t, dart(0, 1, 2), dart(0, 1, 2)); }), {"refused", "cell 0", "side by side"});
  test::expect_parts(said([&] { split_face(t, dart(0, 1, 2), dart(0, 4, 5)); }),
                     {"refused", "cell 0", "different faces"});

  const auto path = [&](std::initializer_list<std::uint32_t> v) {
    std::vector<Dart> darts;
    for (auto i = v.begin(); i + 1 != v.end(); ++i) darts.push_back(dart(0, *i, *(i + 1)));
    return darts;
  };
  test::expect_parts(said([&] { split_cell(t, path({1, 2, 1})); }), {"invalid", "three darts"});
  test::expect_parts(said([&] { split_cell(t, path({1, 2, 6, 5, 1})); }), {"refused", "cell 0", "three faces"});
  test::expect_parts(said([&] { split_cell(t, path({1, 2, 6, 5})); }), {"refused", "cell 0", "gap"});
  test::expect_parts(said([&] { split_cell(t, path({0, 1, 2, 6, 2, 3, 0})); }), {"refused", "cell 0", "twice"});
  test::expect_parts(said([&] {
                       split_cell(t, std::vector{dart(0, 1, 2), dart(1, 2, 8), dart(1, 8, 1)});
                     }),
                     {"invalid", "leaves the cell"});

  test::expect_parts(said([&] { merge_cells(t, face(0, 0, 4)); }), {"refused", "cell 0", "boundary"});
  test::expect_parts(said([&] { unsew(t, face(0, 0, 4)); }), {"refused", "cell 0", "boundary"});
  test::expect_parts(said([&] { merge_faces(t, dart(0, 1, 2)); }), {"refused", "cell 0", "more than two faces"});
  test::expect_parts(said([&] { merge_faces(t, dart(7, 4, 18)); }), {"refused", "cell 7", "fewer than four faces"});
  test::expect_parts(said([&] { merge_edges(t, dart(0, 1, 2)); }), {"refused", "more than two edges"});
  test::expect_parts(said([&] { sew(t, dart(0, 1, 2), dart(0, 4, 5)); }), {"refused", "sewn already"});
  test::expect_parts(said([&] { sew(t, dart(0, 4, 5), dart(0, 5, 4)); }), {"refused", "cell 0"});
  test::expect_parts(said([&] { sew(t, dart(0, 4, 5), dart(7, 4, 18)); }), {"refused", "cell 0", "number of corners"});
}

TEST_F(Handmade, RefusalsThatTakeSomeEditsToMeet) {
  // A triangle at a vertex with two edges.
  const SplitEdge split = split_edge(t, dart(7, 18, 19));
  const Cell tetrahedron = split.cells[0];
  const Dart corner = find_dart(map, tetrahedron, split.vertex, Vertex(19));
  // Cut the corner off again: the triangle (18, new, 19) hangs on two edges.
  split_face(t, map.phi_1(corner), map.phi1(corner));
  expect_valid();
  test::expect_parts(test::refusal([&] { merge_edges(t, find_dart(map, cell(7), split.vertex, Vertex(19))); }),
                     {"refused", "cell 7", "triangle"});
  t.roll_back();

  // A free cell and a blocked one.
  t.set_free(cell(1), false);
  test::expect_parts(test::refusal([&] { merge_cells(t, face(0, 1, 2)); }), {"refused", "cell 0", "free"});
  t.roll_back();

  // Cells that share two faces.
  split_face(t, dart(0, 1, 2), dart(0, 6, 5));
  test::expect_parts(test::refusal([&] { merge_cells(t, face(0, 1, 2)); }),
                     {"refused", "cell 0", "more than one face"});
  t.roll_back();

  // A cell with one vertex twice: two faces of neighbours, one vertex in common, sewn askew.
  test::expect_parts(test::refusal([&] { sew(t, dart(3, 9, 8), dart(1, 2, 8)); }), {"refused"});
  EXPECT_EQ(t.commit().removed.size(), 0U);
}

// A cell that is as large as a cell can be, beside one that is not.
TEST(Edits, LimitsLeaveTheMapAsItIs) {
  MeshData mesh;
  const std::uint32_t n = 4095;
  mesh.points.resize(n + 2);
  Vertices cone = {n + 1, n};
  for (std::uint32_t i = 0; i < n; ++i) cone.push_back(n - 1 - i);
  for (std::uint32_t i = 0; i < n; ++i) cone.insert(cone.end(), {3, i, (i + 1) % n, n});
  mesh.add_cell(CellType::polyhedron, cone);
  mesh.add_cell(CellType::tetrahedron, Vertices{0, 1, n, n + 1});
  CombinatorialMap map(mesh);
  ASSERT_TRUE(check_integrity(map).empty());
  Transaction t(map);
  const auto split = [&] {
    for (const Cell c : map.cells()) {
      if (map.source(c) == 0) split_edge(t, {c, 0});
    }
  };
  split();  // 16382 darts
  const CombinatorialMap before = map;
  test::expect_parts(test::refusal(split), {"refused", "cell 0", "16383 darts"});
  EXPECT_TRUE(map == before);
}

// Between the layers of a box: the faces part one after another, the vertices where the last one goes.
TEST(Edits, CutsOpenWhereTheLastFaceGoes) {
  BoxOptions o;
  o.cells = {3, 3, 2};
  o.size = {1.0, 1.0, 1.0};
  CombinatorialMap map(generate_box(o));
  Transaction t(map);
  std::size_t created = 0;
  for (std::uint32_t i = 0; i < 9; ++i) {
    Cell below{};
    for (const Cell c : map.cells()) {
      if (map.source(c) == i) below = c;
    }
    CellFace between{};
    for (std::uint16_t f = 0; f < 6; ++f) {
      const CellFace other = map.opposite({below, f});
      if (other.valid() && map.source(other.cell) == i + 9) between = {below, f};
    }
    ASSERT_TRUE(between.valid());
    unsew(t, between);
    const EditReport report = t.commit();
    created += report.created.size();
    if (i == 0) EXPECT_EQ(report.created.size(), 1U);  // the corner of the box
    if (i == 8) EXPECT_EQ(report.created.size(), 9U - 2U - 2U - 1U);
    EXPECT_TRUE(check_integrity(map).empty());
  }
  EXPECT_EQ(created, 16U);
  EXPECT_EQ(map.cell_count(1), 18U);
}

// A face inside: both sides are open, no vertex is parted; around its edges the crack must stay open.
TEST(Edits, ACrackInsideStaysOpenWhenItsRimIsSplit) {
  BoxOptions o;
  o.cells = {3, 3, 2};
  o.size = {1.0, 1.0, 1.0};
  CombinatorialMap map(generate_box(o));
  Transaction t(map);
  const auto find = [&](std::uint32_t source) {
    for (const Cell c : map.cells()) {
      if (map.source(c) == source) return c;
    }
    return Cell{};
  };
  const auto open_faces = [&](Cell c) {
    std::vector<CellFace> open;
    for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f) {
      if (!map.opposite({c, f}).valid()) open.push_back({c, f});
    }
    return open;
  };
  // Cells 4 and 13 lie in the middle, one above the other.
  for (std::uint16_t f = 0; f < 6; ++f) {
    if (map.opposite({find(4), f}).cell == find(13)) {
      unsew(t, {find(4), f});
      break;
    }
  }
  EXPECT_TRUE(t.commit().created.empty());
  for (const std::uint32_t source : {4U, 13U}) EXPECT_EQ(open_faces(find(source)).size(), 2U);
  const auto top = [&] {
    for (const CellFace f : open_faces(find(4))) {
      for (const CellFace g : open_faces(find(13))) {
        const auto vertices = [&](CellFace x) {
          std::set<std::uint32_t> v;
          for (const std::uint16_t k : map.shape(x.cell).corners(x.face)) v.insert(map.view(x.cell).vertex(k).value);
          return v;
        };
        if (vertices(f) == vertices(g)) return std::pair{f, g};
      }
    }
    return std::pair{CellFace{}, CellFace{}};
  };
  ASSERT_TRUE(top().first.valid());
  const CellFace rim = top().first;
  split_edge(t, {rim.cell, map.shape(rim.cell).first_dart(rim.face)});
  EXPECT_TRUE(check_integrity(map).empty());
  ASSERT_TRUE(top().first.valid());
  EXPECT_EQ(map.shape(top().first.cell).degree(top().first.face), 5U);
  EXPECT_FALSE(map.opposite(top().first).valid());
  // And it can be closed again.
  const auto [f, g] = top();
  const Dart a{f.cell, map.shape(f.cell).first_dart(f.face)};
  sew(t, a, find_dart(map, g.cell, map.origin(map.phi1(a)), map.origin(a)));
  EXPECT_TRUE(check_integrity(map).empty());
  EXPECT_TRUE(t.commit().merged.empty());
}

std::map<std::string, std::size_t> faces_by_patch(const CombinatorialMap& map) {
  std::map<std::string, std::size_t> count;
  for (const Cell c : map.cells()) {
    for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f)
      ++count[map.patch_names()[map.patch(CellFace{c, f}).value]];
  }
  return count;
}

TEST(Edits, PatchesFollow) {
  BoxOptions o;
  o.cells = {2, 1, 1};
  o.size = {1.0, 1.0, 1.0};
  CombinatorialMap map(generate_box(o));
  Transaction t(map);
  const auto on = [&](std::string_view name) {
    for (const Cell c : map.cells()) {
      for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f) {
        if (map.patch(CellFace{c, f}) == map.patch(name)) return CellFace{c, f};
      }
    }
    return CellFace{};
  };
  const auto first = [&](CellFace f) { return Dart{f.cell, map.shape(f.cell).first_dart(f.face)}; };
  const auto before = faces_by_patch(map);
  const Dart d = first(on("zmax"));
  split_face(t, d, map.phi1(map.phi1(d)));
  auto split = before;
  ++split["zmax"];
  EXPECT_EQ(faces_by_patch(map), split);
  split_edge(t, first(on("zmax")));
  EXPECT_EQ(faces_by_patch(map), split);

  // Faces of two patches become one of the first's; one without a patch takes the other's.
  const Dart across = first(on("xmin"));
  const Patch second = map.patch(map.face(map.phi2(across)));
  EXPECT_NE(second, map.patch("xmin"));
  merge_faces(t, across);
  auto merged = split;
  --merged[map.patch_names()[second.value]];
  EXPECT_EQ(faces_by_patch(map), merged);
  t.roll_back();
  EXPECT_EQ(faces_by_patch(map), before);

  // Two boxes side by side become one; then apart; the sides keep their names.
  for (std::uint16_t f = 0; f < 6; ++f) {
    if (map.opposite({map.cells()[0], f}).valid()) {
      merge_cells(t, {map.cells()[0], f});
      break;
    }
  }
  auto whole = before;
  whole[""] -= 2;
  if (whole[""] == 0) whole.erase("");
  EXPECT_EQ(faces_by_patch(map), whole);
  EXPECT_EQ(check_integrity(map).size(), 0U);
}

// Two cubes, their common face fanned from vertex 12, the first coned from vertex 13.
TEST(Edits, FacePointsStayWhereTheFaceDoes) {
  BoxOptions o;
  o.cells = {2, 1, 1};
  o.size = {1.0, 1.0, 1.0};
  const MeshData mesh = generate_box(o);
  const CombinatorialMap plain(mesh);
  SteinerPoints points;
  std::uint16_t sides[2] = {6, 6};
  for (std::uint32_t c = 0; c < 2; ++c) {
    std::uint16_t f = 0;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> corners) {
      const Vertices v(corners.begin(), corners.end());
      if (std::all_of(v.begin(), v.end(), [](std::uint32_t x) { return x % 3 == 1; })) sides[c] = f;
      ++f;
    });
    points.of_faces.push_back({c, sides[c], Vertex(12)});
    points.of_cells.emplace_back(c, Vertex(13 + c));
  }
  CombinatorialMap map(mesh, points);
  ASSERT_TRUE(check_integrity(map).empty());
  Transaction t(map);
  const auto with_point = [&] {
    std::size_t count = 0;
    for (const Cell c : map.cells()) {
      for (std::uint16_t f = 0; f < map.shape(c).face_count(); ++f) count += map.point({c, f}) == Vertex(12) ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(with_point(), 2U);

  // An edge away from the face: the first cell loses its own point.
  split_edge(t, find_dart(map, map.cells()[0], Vertex(0), Vertex(3)));
  EXPECT_TRUE(check_integrity(map).empty());
  EXPECT_EQ(with_point(), 2U);
  EXPECT_EQ(t.commit().deleted, std::vector<Vertex>{Vertex(13)});

  // An edge of the face: both cells and the face do.
  const Cell first = map.cells()[0];
  split_edge(t, find_dart(map, first, Vertex(1), Vertex(4)).valid() ? find_dart(map, first, Vertex(1), Vertex(4))
                                                                    : find_dart(map, first, Vertex(4), Vertex(1)));
  EXPECT_TRUE(check_integrity(map).empty());
  EXPECT_EQ(with_point(), 0U);
  const EditReport report = t.commit();
  EXPECT_EQ(std::set<Vertex>(report.deleted.begin(), report.deleted.end()), (std::set<Vertex>{Vertex(12), Vertex(14)}));
}

// How the layer above gives points to cells that need them: by their own drafts.
TEST(Edits, TouchedCellsTakePointsByTheirOwnDrafts) {
  CombinatorialMap map(test::edit_box(CellType::hexahedron, false, 2));
  Transaction t(map);
  const Vertex middle(13);  // of the box
  const SplitEdge split = split_edge(t, [&] {
    for (const Cell c : map.cells()) {
      for (const Dart d : cell_orbit(map, {c, 0})) {
        if (map.origin(d) == middle) return d;
      }
    }
    return Dart{};
  }());
  EXPECT_EQ(split.cells.size(), 4U);
  std::map<Vertices, Vertex> point;  // by the face's corners
  std::vector<CellDraft> drafts;
  for (const Cell c : split.cells) {
    CellDraft draft = draft_of(map, c);
    draft.point = t.add_vertex(split.vertex, split.vertex);
    for (DraftFace& face : draft.faces) {
      if (std::none_of(face.corners.begin(), face.corners.end(), [](const auto& k) { return k.straight; })) continue;
      Vertices key;
      for (const DraftCorner& k : face.corners) key.push_back(k.vertex.value);
      std::sort(key.begin(), key.end());
      auto& p = point[key];
      if (!p.valid()) p = t.add_vertex(split.vertex, split.vertex);
      face.point = p;
    }
    drafts.push_back(std::move(draft));
  }
  EXPECT_EQ(point.size(), 4U);
  const auto cells = t.replace(split.cells, drafts);
  EXPECT_TRUE(check_integrity(map).empty());
  for (const Cell c : cells) {
    EXPECT_EQ(map.shape(c).point_count(), map.shape(c).corner_count() + 3U);
    EXPECT_TRUE(map.has_flat(c));
    EXPECT_GT(map.shape(c).simplices().size(), 12U);
  }
  EXPECT_EQ(t.commit().created.size(), 9U);
}

// The number of touched cells does not depend on the size of the scene: the same around the cube in its middle.
TEST(Edits, TouchAsManyCellsInAnyScene) {
  const auto touched = [](CellType type, std::uint32_t size) {
    CombinatorialMap map(test::edit_box(type, false, size));
    Transaction t(map);
    const std::uint32_t per_cube = static_cast<std::uint32_t>(map.cell_count()) / (size * size * size);
    const std::uint32_t first = per_cube * (size / 2) * (1 + size + size * size);
    std::vector<std::size_t> counts;
    for (std::uint32_t i = first; i < first + per_cube; ++i) {
      const Cell c(static_cast<std::uint32_t>(type), i);
      for (const Dart d : cell_orbit(map, {c, 0})) {
        const Transaction::Savepoint none = t.savepoint();
        counts.push_back(split_edge(t, d).cells.size());
        t.roll_back();
        counts.push_back(unsew(t, map.face(d)).size());
        t.roll_back();
        remove(t, c);
        const Transaction::Savepoint mark = t.savepoint();
        counts.insert(counts.end(), {mark.words, mark.removed, mark.added});
        t.roll_back(none);
      }
    }
    return counts;
  };
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron})
    EXPECT_EQ(touched(type, 6), touched(type, 8 + test::scaled(12U, 52U)));
}

}  // namespace dartcast::edit_test
