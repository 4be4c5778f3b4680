#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/remeshing.hpp"
#include "editing/kernel_point.hpp"
#include "editing/region.hpp"
#include "support/astray.hpp"
#include "support/edit_meshes.hpp"
#include "support/expectations.hpp"
#include "support/remesh_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::repair_test {

using test::volume6;

using test::displace;
using test::free_volume6;
using test::inner_vertices;
using test::invalid_cells;
using test::random_displacement;
using test::walls;

// Whether a point is found from which the surface of the cells around some corner of the cell is seen from the inside:
// by trying.
bool seen_by_trying(const CellComplex& complex, Cell c, Random& random) {
  const CombinatorialMap& map = complex.map();
  const auto position = [&](Vertex v) { return complex.positions()[v.value]; };
  const auto corners = map.view(c).vertices().first(map.shape(c).corner_count());
  for (const std::uint32_t v : corners) {
    const detail::Star star = detail::star_of(map, c, Vertex(v), 64);
    const auto surface = detail::surface_of(map, star.cells);
    if (star.too_large || !detail::bounds_solid(surface)) continue;
    const auto triangles = detail::fans_of(surface, position);
    for (int i = 0; i < 100; ++i) {
      Vec3 x;
      double sum = 0.0;
      for (int k = 0; k < 4; ++k) {
        const double weight = random.uniform();
        x += triangles[random.below(static_cast<std::uint32_t>(triangles.size()))].a * weight;
        sum += weight;
      }
      if (detail::all_positive(x * (1.0 / sum), triangles)) return true;
    }
  }
  return false;
}

std::vector<test::EditMesh> box_meshes() {
  return {{"tetrahedra", [] { return test::edit_box(CellType::tetrahedron); }},
          {"hexahedra", [] { return test::edit_box(CellType::hexahedron); }},
          {"prisms", [] { return test::edit_box(CellType::prism); }},
          {"pyramids", [] { return test::edit_box(CellType::pyramid); }},
          {"mixed", [] { return test::edit_box(CellType::hexahedron, true); }},
          {"octahedra", [] {
             OctahedraOptions o;
             o.cells = {3, 2, 2};
             o.size = {1.0, 1.0, 1.0};
             return generate_octahedra(o);
           }}};
}

std::vector<test::EditMesh> all_meshes() {
  std::vector<test::EditMesh> all = box_meshes();
  for (const test::EditMesh& m : test::planar_edit_meshes()) all.push_back(m);
  return all;
}

class RepairOn : public testing::TestWithParam<test::EditMesh> {};
class RepairAmong : public testing::TestWithParam<test::EditMesh> {};

// One vertex with cells of one kind around it: whatever happened to it, its place is among them.
TEST_P(RepairOn, MendsOneVertexOutOfPlace) {
  Random random(3);
  std::size_t repaired = 0;
  for (int i = 0; i < std::max(1, test::scaled(6, 1000)); ++i) {
    CellComplex complex(GetParam().make());
    const auto inner = inner_vertices(complex.map());
    ASSERT_FALSE(inner.empty());
    const auto walls_before = walls(complex);
    const test::Dyadic free_before = free_volume6(complex);
    const test::Dyadic before = volume6(complex);
    const Vertex v = inner[random.below(static_cast<std::uint32_t>(inner.size()))];
    displace(complex, {{v, random_displacement(random, 1.5, complex.map().dimension())}});
    const auto bad = invalid_cells(complex);
    ComplexEdit edit(complex);
    const RepairReport report = repair(edit, bad);
    EXPECT_TRUE(report.left.empty());
    edit.commit();
    test::expect_sound(complex);
    EXPECT_EQ(walls(complex), walls_before);
    EXPECT_TRUE(free_volume6(complex) == free_before);
    EXPECT_TRUE(volume6(complex) == before);
    repaired += bad.size();
  }
  EXPECT_GT(repaired, test::sanitized() ? 0U : 10U);
}

// Several, whose surroundings overlap: what is mended is right, what is not is named and as it was.
TEST_P(RepairOn, MendsOrLeaves) {
  Random random(4);
  std::size_t mended = 0;
  std::size_t left = 0;
  for (int i = 0; i < std::max(1, test::scaled(6, 2000)); ++i) {
    CellComplex complex(GetParam().make());
    { ComplexEdit counts(complex); }
    const auto inner = inner_vertices(complex.map());
    std::vector<std::pair<Vertex, Vec3>> moves;
    for (std::uint32_t k = 1 + random.below(6); k > 0; --k) {
      const bool any = random.below(4) == 0;
      const auto all = static_cast<std::uint32_t>(complex.point_count());
      const auto number = static_cast<std::uint32_t>(inner.size());
      moves.emplace_back(any ? Vertex(random.below(all)) : inner[random.below(number)],
                         random_displacement(random, 1.0, complex.map().dimension()));
    }
    displace(complex, moves);
    const auto walls_before = walls(complex);
    const test::Dyadic free_before = free_volume6(complex);
    const test::Dyadic before = volume6(complex);
    const CombinatorialMap map_before = complex.map();
    const auto bad = invalid_cells(complex);
    ComplexEdit edit(complex);
    const RepairReport report = repair(edit, bad);
    if (report.mended.empty()) EXPECT_TRUE(complex.map() == map_before);
    edit.commit();
    EXPECT_TRUE(check_integrity(complex.map(), 1).empty());
    EXPECT_EQ(walls(complex), walls_before);
    EXPECT_TRUE(free_volume6(complex) == free_before);
    EXPECT_TRUE(volume6(complex) == before);
    std::vector<Cell> still = invalid_cells(complex);
    std::vector<Cell> named;
    for (const LeftCell& c : report.left) {
      named.push_back(c.cell);
      EXPECT_NE(c.reason.find(std::to_string(c.source)), std::string::npos);
      EXPECT_TRUE(std::find(bad.begin(), bad.end(), c.cell) != bad.end());
      EXPECT_FALSE(seen_by_trying(complex, c.cell, random));
    }
    std::sort(still.begin(), still.end());
    std::sort(named.begin(), named.end());
    EXPECT_EQ(still, named);
    mended += report.mended.size();
    left += report.left.size();
  }
  RecordProperty("mended", static_cast<int>(mended));
  RecordProperty("left", static_cast<int>(left));
}

// With cells that were subdivided among others that were not: faces that may be straight, points of faces and cells.
TEST_P(RepairAmong, MendsNextToSubdivided) {
  Random random(5);
  std::size_t mended = 0;
  std::size_t left = 0;
  for (int i = 0; i < std::max(1, test::scaled(6, 1000)); ++i) {
    CellComplex complex(GetParam().make());
    for (int k = 0; k < 4; ++k) {
      const auto cells = complex.map().cells();
      ComplexEdit edit(complex);
      subdivide(edit, cells[random.below(static_cast<std::uint32_t>(cells.size()))]);
      edit.commit();
    }
    const auto inner = inner_vertices(complex.map());
    std::vector<std::pair<Vertex, Vec3>> moves;
    for (int k = 0; k < 4; ++k)
      moves.emplace_back(inner[random.below(static_cast<std::uint32_t>(inner.size()))],
                         random_displacement(random, 0.7));
    displace(complex, moves);
    const auto walls_before = walls(complex);
    ComplexEdit edit(complex);
    const RepairReport report = repair(edit, invalid_cells(complex));
    edit.commit();
    EXPECT_TRUE(check_integrity(complex.map(), 1).empty());
    EXPECT_EQ(walls(complex), walls_before);
    EXPECT_EQ(invalid_cells(complex).size(), report.left.size());
    mended += report.mended.size();
    left += report.left.size();
  }
  if (!test::sanitized()) EXPECT_GT(mended, 2 * left);
  RecordProperty("mended", static_cast<int>(mended));
  RecordProperty("left", static_cast<int>(left));
}

std::string name_of(const testing::TestParamInfo<test::EditMesh>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Meshes, RepairOn, testing::ValuesIn(all_meshes()), name_of);
INSTANTIATE_TEST_SUITE_P(Meshes, RepairAmong, testing::ValuesIn(box_meshes()), name_of);

MeshData grid(std::uint32_t n) {
  BoxOptions o;
  o.cells = {n, n, n};
  o.size = {1.0 * n, 1.0 * n, 1.0 * n};
  return generate_box(o);
}

Vertex grid_vertex(std::uint32_t n, std::uint32_t i, std::uint32_t j, std::uint32_t k) {
  return Vertex(i + (n + 1) * (j + (n + 1) * k));
}

TEST(Repair, PassesOverWhatIsValid) {
  CellComplex complex(grid(3));
  { ComplexEdit counts(complex); }
  const CombinatorialMap before = complex.map();
  ComplexEdit edit(complex);
  const RepairReport report = repair(edit, complex.map().cells());
  EXPECT_TRUE(report.mended.empty());
  EXPECT_TRUE(report.left.empty());
  EXPECT_TRUE(complex.map() == before);
  EXPECT_TRUE(edit.commit().map.added.empty());
}

// A little beyond a face: the vertex goes back among its cells, which stay hexahedra.
TEST(Repair, MovesAVertexBack) {
  CellComplex complex(grid(4));
  displace(complex, {{grid_vertex(4, 2, 2, 2), {1.5, 0.0, 0.0}}});
  ComplexEdit edit(complex);
  const RepairReport report = repair(edit, invalid_cells(complex));
  ASSERT_EQ(report.mended.size(), 1U);
  EXPECT_EQ(report.mended[0].how, Mending::moved);
  EXPECT_EQ(report.mended[0].sources.size(), 8U);
  const ComplexEditReport done = edit.commit();
  ASSERT_EQ(done.placed.size(), 1U);
  EXPECT_LT(norm(complex.positions()[done.placed[0].vertex.value] - Vec3{2.0, 2.0, 2.0}), 0.75);
  EXPECT_EQ(complex.map().cell_count(static_cast<std::uint32_t>(CellType::hexahedron)), 64U);
}

// Two neighbours that swapped places: no single one can be moved back, nor is the surface around one good.
TEST(Repair, CutsWhereTwoAreOutOfPlace) {
  CellComplex complex(grid(5));
  const test::Dyadic before = volume6(complex);
  displace(complex, {{grid_vertex(5, 2, 2, 2), {1.75, 0.25, 0.0}}, {grid_vertex(5, 3, 2, 2), {-1.75, 0.0, 0.25}}});
  ComplexEdit edit(complex);
  const RepairReport report = repair(edit, invalid_cells(complex));
  EXPECT_TRUE(report.left.empty());
  ASSERT_FALSE(report.mended.empty());
  EXPECT_TRUE(
      std::any_of(report.mended.begin(), report.mended.end(), [](const auto& r) { return r.how == Mending::cut; }));
  for (const MendedRegion& region : report.mended) {
    std::set<std::uint32_t> sources;
    for (const Cell c : region.cells) sources.insert(complex.map().source(c));
    EXPECT_EQ(std::vector<std::uint32_t>(sources.begin(), sources.end()), region.sources);
    EXPECT_LE(region.sources.size(), 12U);  // those around the two
  }
  const ComplexEditReport done = edit.commit();
  for (const PlacedVertex& p : done.placed) {
    EXPECT_GT(p.of.size(), 20U);  // goes along with all around it
    EXPECT_EQ(p.offset, Vec3{});
  }
  test::expect_sound(complex);
  EXPECT_TRUE(volume6(complex) == before);
}

std::vector<MendedRegion> repaired(CellComplex& complex) {
  ComplexEdit edit(complex);
  RepairReport report = repair(edit, invalid_cells(complex));
  EXPECT_TRUE(report.left.empty());
  edit.commit();
  test::expect_sound(complex);
  return std::move(report.mended);
}

// The four corners of a face on the wrong side of each other: the cells around all four are enough.
TEST(Repair, CutsTheCellsAroundSeveral) {
  CellComplex complex(grid(7));
  displace(complex, {{grid_vertex(7, 3, 3, 3), {2.5, 0.25, 0.25}},
                     {grid_vertex(7, 4, 3, 3), {0.25, 2.5, -0.25}},
                     {grid_vertex(7, 4, 4, 3), {-2.5, 0.25, 0.25}},
                     {grid_vertex(7, 3, 4, 3), {0.25, -2.5, -0.25}}});
  for (const MendedRegion& region : repaired(complex)) EXPECT_LE(region.sources.size(), 18U);
}

TEST(Repair, TakesNoLargerRegionsThanAllowed) {
  CellComplex complex(grid(5));
  { ComplexEdit counts(complex); }
  displace(complex, {{grid_vertex(5, 2, 2, 2), {1.75, 0.25, 0.0}}, {grid_vertex(5, 3, 2, 2), {-1.75, 0.0, 0.25}}});
  const CombinatorialMap before = complex.map();
  const auto bad = invalid_cells(complex);
  ComplexEdit edit(complex);
  const RepairReport report = repair(edit, bad, {.max_cells = 3});
  EXPECT_TRUE(report.mended.empty());
  ASSERT_EQ(report.left.size(), bad.size());
  test::expect_parts(report.left[0].reason, {"at most 3 cells"});
  EXPECT_TRUE(complex.map() == before);
}

TEST(Repair, LeavesWhatHasNoInside) {
  CellComplex complex(grid(3));
  { ComplexEdit counts(complex); }
  displace(complex, {{grid_vertex(3, 0, 0, 0), {1.5, 0.0, 0.0}}});  // the boundary itself is inverted there
  const CombinatorialMap before = complex.map();
  const auto bad = invalid_cells(complex);
  ASSERT_FALSE(bad.empty());
  ComplexEdit edit(complex);
  const RepairReport report = repair(edit, bad);
  EXPECT_TRUE(report.mended.empty());
  ASSERT_EQ(report.left.size(), bad.size());
  test::expect_parts(report.left[0].reason, {"cell 0 stays as it is", "at most 64 cells"});
  EXPECT_TRUE(complex.map() == before);
  EXPECT_TRUE(edit.commit().map.added.empty());
  EXPECT_TRUE(complex.map() == before);
}

TEST(Repair, RefusesCellsThatAreNotThere) {
  CellComplex complex(grid(3));
  ComplexEdit edit(complex);
  const Cell cells[] = {Cell(1, 77)};
  EXPECT_THROW(repair(edit, cells), InvalidArgument);
}

}  // namespace dartcast::repair_test
