// Maps of the plane: polygons that are sewn along edges.
#include <gtest/gtest.h>

#include <set>

#include "dartcast/base/error.hpp"
#include "dartcast/map/integrity.hpp"
#include "dartcast/map/map.hpp"
#include "dartcast/map/orbits.hpp"
#include "dartcast/map/transaction.hpp"
#include "dartcast/mesh/cell_types.hpp"
#include "dartcast/mesh/generate_rectangle.hpp"

namespace dartcast {
namespace {

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
  const Map map(rectangle(GetParam()));
  EXPECT_EQ(map.dimension(), 2U);
  for (const Violation& v : check_integrity(map)) ADD_FAILURE() << v.message;
}

TEST_P(PlaneMaps, AreSewnAsTheMeshSays) {
  const MeshData mesh = rectangle(GetParam());
  const Map map(mesh);
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
  const Map map(mesh);
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
  const Map map(rectangle(2));
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
  EXPECT_THROW(Map{mesh}, InvalidMesh) << "the same cell twice";
  mesh = rectangle(1);
  mesh.add_cell(CellType::tetrahedron, first);
  EXPECT_THROW(Map{mesh}, InvalidMesh) << "a cell of space";
  Map map(rectangle(1));
  EXPECT_THROW(Transaction{map}, InvalidArgument);
}

}  // namespace
}  // namespace dartcast
