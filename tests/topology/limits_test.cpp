// Numbers that are packed into few bits: each is right up to its limit, and refused beyond (docs/limits.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/mesh_check.hpp"
#include "support/expectations.hpp"
#include "topology/draft_cuts.hpp"
#include "topology/exit_table.hpp"

namespace dartcast::limits_test {

using Numbers = std::vector<std::uint32_t>;

void add_tetrahedron(MeshData& mesh) {
  mesh.points.insert(mesh.points.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  mesh.add_cell(CellType::tetrahedron, Numbers{0, 1, 2, 3});
}

// Points on a circle.
MeshData circle(std::uint32_t n) {
  MeshData mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const SineCosine at = sine_cosine_of_turns(double(i) / n);
    mesh.points.push_back({at.cosine, at.sine, 0.0});
  }
  return mesh;
}

MeshData polygon(std::uint32_t n) {
  MeshData mesh = circle(n);
  Numbers corners(n);
  std::iota(corners.begin(), corners.end(), 0U);
  mesh.add_cell(CellType::polygon, corners);
  return mesh;
}

// A cone over a polygon has four darts for each of the polygon's corners.
MeshData cone(std::uint32_t n) {
  MeshData mesh = circle(n);
  mesh.points.push_back({0.0, 0.0, 1.0});
  Numbers faces = {n + 1, n};
  for (std::uint32_t i = n; i-- > 0;) faces.push_back(i);
  for (std::uint32_t i = 0; i < n; ++i) faces.insert(faces.end(), {3, i, (i + 1) % n, n});
  mesh.add_cell(CellType::polyhedron, faces);
  return mesh;
}

void make_map(const MeshData& mesh) { const CombinatorialMap map(mesh); }

// The only cell of a mesh, from a draft.
void make_by_draft(const MeshData& mesh) {
  CellDraft draft;
  const auto cell = mesh.cell(0);
  if (mesh.types[0] == CellType::polygon) {
    for (std::size_t i = 0; i < cell.size(); ++i)
      draft.faces.push_back({{{Vertex(cell[i])}, {Vertex(cell[(i + 1) % cell.size()])}}, {}, {}, {}, {}});
  } else {
    for (std::size_t at = 1; at < cell.size(); at += cell[at] + 1) {
      DraftFace& face = draft.faces.emplace_back();
      for (const std::uint32_t v : cell.subspan(at + 1, cell[at])) face.corners.push_back({Vertex(v)});
    }
  }
  MeshData other;  // of the same points
  other.points = mesh.points;
  if (mesh.dimension() == 2)
    other.add_cell(CellType::triangle, Numbers{0, 1, 2});
  else
    other.add_cell(CellType::tetrahedron, Numbers{0, 1, 2, 3});
  CombinatorialMap map(other);
  Transaction t(map);
  t.replace({}, {&draft, 1});
}

void check_mesh(MeshData mesh) {
  const MeshReport report = check_and_repair(mesh);
  if (!report.defects.empty()) throw InvalidMesh(report.defects.front().message);
}

// So many patches, and a second group of the first one's name.
void make_patches(std::uint32_t n) {
  MeshData mesh;
  add_tetrahedron(mesh);
  for (std::uint32_t i = 0; i < n; ++i) mesh.patch_order.push_back(static_cast<std::int32_t>(i));
  mesh.patch_order.push_back(-1);
  mesh.patch_names[-1] = "0";
  mesh.add_patch_face(Numbers{0, 1, 2}, static_cast<std::int32_t>(n) - 1);
  mesh.add_patch_face(Numbers{0, 1, 3}, -1);
  const CombinatorialMap map(mesh);
  std::set<std::uint16_t> seen;
  for (std::uint16_t f = 0; f < 4; ++f) seen.insert(map.patch(CellFace{map.cells()[0], f}).value);
  EXPECT_EQ(seen, (std::set<std::uint16_t>{0, 1, static_cast<std::uint16_t>(n)}));
}

// Faces are cut one by one, from four fewer than so many on.
void cut_faces(std::uint32_t n) {
  CellDraft draft;
  draft.source = 17;
  draft.faces.resize(n - 4);
  for (std::uint16_t f = 0; f < 4; ++f) {
    for (std::uint32_t v = 0; v < 4; ++v) draft.faces[f].corners.push_back({Vertex(v)});
    detail::cut_face(draft, f, Vertex(0), Vertex(2));
  }
  EXPECT_EQ(draft.faces.size(), n);
  EXPECT_EQ(draft.faces.back().corners.size(), 3U);
}

struct Limit {
  const char* name;
  void (*make)(std::uint32_t);
  std::uint32_t most;
  std::uint32_t beyond;
  const char* words;  // of the error
};
void PrintTo(const Limit& limit, std::ostream* out) { *out << limit.name; }

class PackedNumbers : public testing::TestWithParam<Limit> {};

constexpr const char* too_many_darts = "16383 darts";
const Limit all_limits[] = {
    {"DartsOfAPolyhedron", [](std::uint32_t n) { make_map(cone(n)); }, 4095, 4096, too_many_darts},
    {"DartsOfADraft", [](std::uint32_t n) { make_by_draft(cone(n)); }, 4095, 4096, too_many_darts},
    {"EdgesOfAPolygon", [](std::uint32_t n) { make_map(polygon(n)); }, 16383, 16384, too_many_darts},
    {"EdgesOfAPlanarDraft", [](std::uint32_t n) { make_by_draft(polygon(n)); }, 16383, 16384, too_many_darts},
    {"EdgesBeyond16Bits", [](std::uint32_t n) { make_map(polygon(n)); }, 3, 65540, too_many_darts},
    {"CornersInAFile", [](std::uint32_t n) { check_mesh(cone(n)); }, 999, 1000, "more than 1000 faces or corners"},
    {"CornersOfAPolygonInAFile", [](std::uint32_t n) { check_mesh(polygon(n)); }, 1000, 1001, "more than 1000"},
    {"Patches", make_patches, 65535, 65536, "more than 65535 patches"},
    {"FacesWhileCutting", cut_faces, 65535, 65536, "cell 17 would have more than 65535 faces"}};

INSTANTIATE_TEST_SUITE_P(Limits, PackedNumbers, testing::ValuesIn(all_limits), testing::PrintToStringParamName());

TEST_P(PackedNumbers, AreRightAtTheirLimitAndRefusedBeyond) {
  const Limit& limit = GetParam();
  EXPECT_EQ(test::error_text([&] { limit.make(limit.most); }), "");
  test::expect_parts(test::error_text([&] { limit.make(limit.beyond); }), {limit.words});
}

// Faces that do not close, more than numbers of 16 bits name.
TEST(Limits, FacesBeyond16BitsAreRefused) {
  MeshData mesh;
  add_tetrahedron(mesh);
  const std::uint32_t n = 65540;
  Numbers faces = {n};
  for (std::uint32_t i = 0; i < n; ++i) faces.insert(faces.end(), {3, 0, 1, 2});
  mesh.add_cell(CellType::polyhedron, faces);
  test::expect_parts(test::error_text([&] { make_map(mesh); }), {"cell 1", too_many_darts});
}

// A record of a standard cell has three bits for the number that its neighbour gives to their face.
void expect_sewn(const CombinatorialMap& map, Cell large, std::uint16_t face) {
  const CellFace here{large, face};
  const CellFace there = map.opposite(here);
  ASSERT_TRUE(there.valid());
  EXPECT_NE(there.cell.pool(), CombinatorialMap::general_pool);
  EXPECT_EQ(map.opposite(there), here);
  EXPECT_TRUE(check_integrity(map).empty());
}

// The same after the cell beyond the face, then the large one, were replaced.
void expect_sewn_after_edits(CombinatorialMap& map, std::uint16_t face) {
  Cell large(CombinatorialMap::general_pool, 0);
  expect_sewn(map, large, face);
  Transaction t(map);
  const auto replace = [&](Cell c) {
    const CellDraft draft = draft_of(map, c);
    return t.replace({&c, 1}, {&draft, 1})[0];
  };
  replace(map.opposite({large, face}).cell);
  expect_sewn(map, large, face);
  large = replace(large);
  expect_sewn(map, large, face);
  t.commit();
  expect_sewn(map, large, face);
}

// A prism over a polygon. Its side at corners 0 and 1 of the polygon is the face with the number `face`, and a
// hexahedron lies behind it.
MeshData prism_and_hexahedron(std::uint32_t n, std::uint32_t face) {
  MeshData mesh;
  mesh.points.resize(2 * n + 4);
  std::vector<Numbers> faces(2);
  for (std::uint32_t i = n; i-- > 0;) faces[0].push_back(i);
  for (std::uint32_t i = 0; i < n; ++i) faces[1].push_back(n + i);
  for (std::uint32_t i = 1; i < n; ++i) faces.push_back({i, (i + 1) % n, (i + 1) % n + n, i + n});
  faces.insert(faces.begin() + face, {0, 1, n + 1, n});
  Numbers stream = {n + 2};
  for (const Numbers& corners : faces) {
    stream.push_back(static_cast<std::uint32_t>(corners.size()));
    stream.insert(stream.end(), corners.begin(), corners.end());
  }
  mesh.add_cell(CellType::polyhedron, stream);
  mesh.add_cell(CellType::hexahedron, Numbers{0, 1, n + 1, n, 2 * n, 2 * n + 1, 2 * n + 2, 2 * n + 3});
  return mesh;
}

TEST(Limits, NeighboursNumberTheirFaceWithMoreThanThreeBits) {
  for (const std::uint32_t face : {0U, 6U, 7U, 8U, 255U, 256U, 2731U}) {  // 16380 darts
    CombinatorialMap map(prism_and_hexahedron(2730, face));
    SCOPED_TRACE(face);
    expect_sewn_after_edits(map, static_cast<std::uint16_t>(face));
  }
}

TEST(Limits, NeighboursNumberTheirEdgeWithMoreThanThreeBits) {
  for (const std::uint32_t edge : {0U, 6U, 7U, 8U, 255U, 256U, 16381U}) {
    MeshData mesh = polygon(16383);
    mesh.points.resize(mesh.points.size() + 2);
    mesh.add_cell(CellType::quadrilateral, Numbers{edge + 1, edge, 16383, 16384});
    CombinatorialMap map(mesh);
    SCOPED_TRACE(edge);
    expect_sewn_after_edits(map, static_cast<std::uint16_t>(edge));
  }
}

TEST(Limits, DraftsNamePatchesThatThereAre) {
  MeshData mesh;
  add_tetrahedron(mesh);
  mesh.add_patch_face(Numbers{0, 1, 2}, 5);
  CombinatorialMap map(mesh);
  Transaction t(map);
  const CombinatorialMap before = map;
  const Cell cells[] = {map.cells()[0]};
  CellDraft draft = draft_of(map, cells[0]);
  draft.faces[1].patch = Patch{2};
  test::expect_parts(test::refusal([&] { t.replace(cells, {&draft, 1}); }), {"invalid", "no patch 2"});
  EXPECT_TRUE(map == before);
  draft.faces[1].patch = Patch{1};
  EXPECT_EQ(test::refusal([&] { t.replace(cells, {&draft, 1}); }), "done");
}

// A pyramid over a polygon, whose tip is the apex.
ShapeKey cone_key(std::uint16_t n, bool base_has_point, bool sides_have_points) {
  ShapeKey key;
  key.corner_count = static_cast<std::uint16_t>(n + 1);
  key.apex = n;
  key.faces.resize(1);
  key.faces[0].has_point = base_has_point;
  for (std::uint16_t i = 0; i < n; ++i) {
    key.faces[0].corners.push_back(static_cast<std::uint16_t>(n - 1 - i));
    key.faces.push_back({{i, static_cast<std::uint16_t>((i + 1) % n), n}, sides_have_points});
  }
  return key;
}

TEST(Limits, ShapesNameTheirCornersAlone) {
  const auto refusal = [](auto&& alter) {
    ShapeKey key = cone_key(5, true, false);
    alter(key);
    return test::refusal([&] { const Shape shape(key); });
  };
  EXPECT_EQ(refusal([](ShapeKey& key) { key.apex = 5; }), "done");
  test::expect_parts(refusal([](ShapeKey& key) { key.apex = 6; }), {"invalid", "apex"});
  test::expect_parts(refusal([](ShapeKey& key) { key.corner_count = 7; }), {"invalid", "in none of its faces"});
  test::expect_parts(refusal([](ShapeKey& key) { key.corner_count = 65535; }), {"invalid", "in none of its faces"});
}

// The ways out of every simplex lead where its shape says.
void expect_exits(const Shape& shape) {
  const detail::ExitTable& table = shape.exits();
  ASSERT_FALSE(table.empty());
  const auto expect_entry = [&](unsigned face, unsigned place, const Across& at) {
    const detail::SimplexEntry entry = table.entry(face, place);
    ASSERT_EQ(entry.row(), 4U * at.index + at.place);
    ASSERT_EQ(entry.apex, shape.simplices()[at.index].vertex[at.place]);
  };
  for (std::uint16_t s = 0; s < shape.simplices().size(); ++s) {
    for (std::uint16_t facet = 0; facet < 4; ++facet) {
      expect_entry(0, 4U * s + facet, {s, facet});
      const Across across = shape.simplices()[s].across[facet];
      const detail::SimplexExit exit = table.exits_of(s)[facet];
      ASSERT_EQ(exit.outer != 0, across.outer());
      if (across.outer())
        ASSERT_EQ(exit.word, 2U + shape.point_count() + across.face());
      else
        expect_entry(0, exit.place, across);
    }
  }
  for (std::uint16_t face = 0; face < shape.face_count(); ++face) {
    for (std::uint16_t t = 0; t < shape.triangle_count(face); ++t) expect_entry(1U + face, t, shape.entry(face, t));
  }
}

TEST(Limits, TablesOfExitsHaveShapesOfAtMost4095Simplices) {
  const Shape most(cone_key(4095, true, false));
  ASSERT_EQ(most.simplices().size(), detail::ExitTable::max_simplices);
  expect_exits(most);
  ShapeKey more = cone_key(2049, false, false);
  more.has_point = true;
  const Shape beyond(more);
  ASSERT_EQ(beyond.simplices().size(), detail::ExitTable::max_simplices + 1);
  EXPECT_TRUE(beyond.exits().empty());
}

// One more than the largest number of a star; each number below it must be used.
std::size_t star_count(const Shape& shape) {
  std::vector<bool> used(0x10000);
  for (std::uint16_t s = 0; s < shape.simplices().size(); ++s) {
    for (const unsigned corners : {1U, 2U, 3U, 4U, 5U, 6U, 8U, 9U, 10U, 12U})
      used[shape.stars().star(s, corners)] = true;
  }
  const auto last = std::find(used.begin(), used.end(), false);
  EXPECT_EQ(std::find(last, used.end(), true), used.end());
  return static_cast<std::size_t>(last - used.begin());
}

// Stars by Euler's formula. The shapes have the most triangles: all faces have Steiner points.
TEST(Limits, NumbersOfStarsFit) {
  constexpr std::size_t triangles = 16380;
  ShapeKey key = cone_key(4095, true, true);
  key.has_point = true;
  const Shape ball(key);
  ASSERT_EQ(ball.simplices().size(), triangles);
  EXPECT_EQ(star_count(ball), 3 * triangles / 2 + 2 * (triangles / 2 + 2) + 1);
  EXPECT_TRUE(ball.stars().one_each());
  // Tetrahedra that meet in the Steiner point of the cell alone have more.
  constexpr std::uint16_t count = triangles / 12;
  ShapeKey parts;
  parts.corner_count = 4 * count;
  parts.has_point = true;
  for (std::uint16_t i = 0; i < count; ++i) {
    const auto v = [i](unsigned k) { return static_cast<std::uint16_t>(4 * i + k); };
    for (const auto& [a, b, c] : {std::array{0U, 2U, 1U}, {0U, 1U, 3U}, {1U, 2U, 3U}, {0U, 3U, 2U}})
      parts.faces.push_back({{v(a), v(b), v(c)}, true});
  }
  const Shape several(parts);
  ASSERT_EQ(several.simplices().size(), triangles);
  EXPECT_EQ(star_count(several), count * (18U + 8U + 8U + 1U));
  EXPECT_FALSE(several.stars().one_each());
}

}  // namespace dartcast::limits_test
