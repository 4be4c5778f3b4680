// Cells divided into their simplices, and cuts through warped cells, which need that: nothing moves, nobody is lost.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "base/random.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/remeshing.hpp"
#include "support/expectations.hpp"
#include "support/particle_checks.hpp"
#include "support/surgery_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::division_test {

using test::Before;
using test::Dyadic;
using test::volume6;

struct WarpedMesh {
  const char* name;
  CellType type;
  bool mixed;
  double largest_turn;  // at which all cells are valid
};
void PrintTo(const WarpedMesh& m, std::ostream* out) { *out << m.name; }

constexpr double edge = 4.0;

// A block that turns about z by `turn` rad per metre, of cubes or truncated octahedra.
MeshData twisted(const WarpedMesh& kind, double turn) {
  MeshData mesh;
  if (kind.type == CellType::polyhedron) {
    OctahedraOptions o;
    o.cells = {2, 2, 2};
    o.size = {edge, edge, edge};
    mesh = generate_octahedra(o);
  } else {
    BoxOptions o;
    o.cells = {4, 4, 4};
    o.size = {edge, edge, edge};
    o.type = kind.type;
    o.mixed = kind.mixed;
    mesh = generate_box(o);
  }
  for (Vec3& p : mesh.points) {
    const double angle = turn * (p.z - edge / 2);
    const Vec3 d = p - Vec3{edge / 2, edge / 2, 0.0};
    p = {edge / 2 + d.x * std::cos(angle) - d.y * std::sin(angle),
         edge / 2 + d.x * std::sin(angle) + d.y * std::cos(angle), p.z};
  }
  return mesh;
}

class Divisions : public testing::TestWithParam<WarpedMesh> {};
INSTANTIATE_TEST_SUITE_P(Surgery, Divisions,
                         testing::Values(WarpedMesh{"hexahedra", CellType::hexahedron, false, 1.6},
                                         WarpedMesh{"prisms", CellType::prism, false, 1.6},
                                         WarpedMesh{"pyramids", CellType::pyramid, false, 1.0},
                                         WarpedMesh{"mixed", CellType::hexahedron, true, 1.0},
                                         WarpedMesh{"octahedra", CellType::polyhedron, false, 1.0}),
                         [](const auto& i) { return std::string(i.param.name); });

// The triangles of walls by their corners' positions, each with its patch.
std::map<std::vector<std::array<double, 3>>, std::uint32_t> walls_of(const CellComplex& complex) {
  std::map<std::vector<std::array<double, 3>>, std::uint32_t> walls;
  const CombinatorialMap& map = complex.map();
  for (const Cell c : map.cells()) {
    const CellView v = map.view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      if (!v.is_wall(f)) continue;
      for (std::uint16_t t = 0; t < v.shape().triangle_count(f); ++t) {
        std::vector<std::array<double, 3>> corners;
        for (const std::uint16_t k : v.shape().triangle(f, t)) {
          const Vec3 x = complex.positions()[v.vertex(k).value];
          corners.push_back({x.x, x.y, x.z});
        }
        std::sort(corners.begin(), corners.end());
        walls[corners] = map.patch(CellFace{c, f}).value;
      }
    }
  }
  return walls;
}

std::map<std::uint32_t, Dyadic> volumes_of_sources(const CellComplex& complex) {
  std::map<std::uint32_t, Dyadic> volumes;
  for (const Cell c : complex.map().cells()) volumes[complex.map().source(c)] += volume6(complex, std::span(&c, 1));
  return volumes;
}

std::vector<std::array<double, 3>> corners_of(const CellComplex& complex, const ParticleState& s) {
  std::vector<std::array<double, 3>> corners;
  for (const Vec3& x : complex.corners(s.at())) corners.push_back({x.x, x.y, x.z});
  std::sort(corners.begin(), corners.end());
  return corners;
}

TEST_P(Divisions, NothingMoves) {
  Random random(11);
  for (const double turn : {0.0, 0.2, GetParam().largest_turn}) {
    SCOPED_TRACE(turn);
    MeshData mesh = twisted(GetParam(), turn);
    mesh.free.assign(mesh.cell_count(), 1);
    for (std::size_t c = 0; c < mesh.cell_count(); c += 5) mesh.free[c] = 0;
    Environment environment(mesh, Threads{1});
    Particles set;
    environment.add(set, test::random_points(300, {0.5, 0.5, 0.5}, {3.5, 3.5, 3.5}, random));
    const auto before = test::copy_of(set);
    std::vector<std::vector<std::array<double, 3>>> simplices;
    for (const ParticleState& s : before) simplices.push_back(corners_of(environment.complex(), s));
    const auto walls = walls_of(environment.complex());
    const auto volumes = volumes_of_sources(environment.complex());
    std::vector<Cell> some = environment.map().cells();
    std::erase_if(some, [&](Cell) { return random.below(3) != 0; });
    std::vector<Cell> divided;
    const ComplexEditReport report =
        environment.edit([&](ComplexEdit& e) { divided = divide_into_simplices(e, some); });
    environment.update_after_edit(set);
    test::expect_sound(environment.complex());
    EXPECT_EQ(report.boundary_shift, 0.0);
    EXPECT_TRUE(walls_of(environment.complex()) == walls);
    EXPECT_TRUE(volumes_of_sources(environment.complex()) == volumes);
    for (const Cell c : test::now(report, divided)) EXPECT_EQ(environment.map().shape(c).simplices().size(), 1U);
    ASSERT_EQ(set.size(), before.size());
    const std::set<Cell> parts(divided.begin(), divided.end());
    std::size_t in_parts = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      EXPECT_EQ(set[i].position, before[i].position);
      if (!parts.contains(set[i].cell)) continue;
      ++in_parts;
      EXPECT_EQ(corners_of(environment.complex(), set[i]), simplices[i]);
    }
    EXPECT_GT(in_parts, 20U);
    test::expect_audited(environment.complex(), set);
  }
}

// A Steiner point becomes a vertex that data follow by the point's weights.
TEST(Division, AVertexTakesThePlaceOfASteinerPoint) {
  CellComplex complex(twisted({"octahedra", CellType::polyhedron, false, 1.0}, 1.0));
  ASSERT_GT(complex.steiner_point_count(), 0U);
  std::vector<Vec3> moved(complex.positions().begin(), complex.positions().end());
  const auto affine = [](const Vec3& x) { return Vec3{1.0 + 2.0 * x.x - x.y, 3.0 * x.z - x.x, x.y + 0.5 * x.z}; };
  for (Vec3& x : moved) x = affine(x);
  const std::vector<Cell> cells = complex.map().cells();
  ComplexEdit edit(complex);
  divide_into_simplices(edit, std::span(cells).first(4));
  const ComplexEditReport report = edit.commit();
  test::expect_sound(complex);
  ASSERT_FALSE(report.placed.empty());
  update_after_edit(report, complex.positions().size(), moved);
  for (const PlacedVertex& p : report.placed) {
    EXPECT_GT(p.of.size(), 3U);
    EXPECT_LT(norm(moved[p.vertex.value] - affine(complex.positions()[p.vertex.value])), 1e-12);
  }
}

TEST(Division, RefusesWithoutAChange) {
  CellComplex complex(twisted({"hexahedra", CellType::hexahedron, false, 1.6}, 0.1));
  { ComplexEdit first(complex); }
  const Before before(complex);
  ComplexEdit edit(complex);
  const std::vector<Cell> cells = complex.map().cells();
  EXPECT_TRUE(divide_into_simplices(edit, {}).empty());
  const Cell none[] = {Cell(1, 999)};
  test::expect_refused([&] { divide_into_simplices(edit, none); }, "no such cell");
  before.expect_unchanged();
  split_by_plane(edit, std::span(cells).first(1), plane_through({0.5, 0.5, 0.4}, {1, 0, 0}));
  const std::vector<Cell> added = edit.topology().added();  // with neighbours that will need a Steiner point
  test::expect_parts(test::refusal([&] { divide_into_simplices(edit, added); }), {"refused", "not positive"});
}

struct Tally {
  int made = 0, refused = 0;
  std::string last;
};

// Cuts by planes, discs and boxes through a twisted block with particles in it.
Tally cut_at_random(const WarpedMesh& kind, double turn, int count, std::uint64_t seed) {
  Tally tally;
  Random random(seed);
  const auto place = [&] { return Vec3{random.uniform(1, 3), random.uniform(1, 3), random.uniform(1, 3)}; };
  const auto direction = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
  const auto on_lattice = [&] {  // a disc of radius 1 then has sides close to the cells' faces
    const auto whole = [&] { return 1.0 + random.below(3); };
    return Vec3{whole(), whole(), whole() - 0.5};
  };
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE(i);
    MeshData mesh = twisted(kind, turn);
    mesh.free.assign(mesh.cell_count(), i % 3 == 1 ? 1 : 0);
    for (std::size_t c = 0; c < mesh.cell_count(); c += 2) mesh.free[c] = 1;
    Environment environment(mesh, Threads{1});
    Particles set;
    environment.add(set, test::random_points(200, {0.5, 0.5, 0.5}, {3.5, 3.5, 3.5}, random));
    const Dyadic whole = volume6(environment.complex());
    { ComplexEdit first(const_cast<CellComplex&>(environment.complex())); }
    const Before before(environment.complex());
    std::vector<ConvexTool> tools;
    const bool aligned = i / 3 % 2 == 1;
    const Vec3 a = aligned ? on_lattice() : place();
    const Vec3 normal = aligned ? Vec3{1.0, 0.0, 0.0} : direction();
    if (i % 3 == 0) tools = thicken(Disc{a, normal, aligned ? 1.0 : random.uniform(0.5, 1.4)}, 0.25);
    if (i % 3 == 1) tools = thicken(plane_through(a, normal), 0.1);
    if (i % 3 == 2) tools = {box_tool(a - Vec3{0.6, 0.7, 0.8}, a)};
    ComplexEditReport report;
    try {
      report = environment.edit([&](ComplexEdit& e) {
        const std::vector<Cell> near = cells_near(environment.complex(), tools);
        if (i % 3 == 1)
          split_by_plane(e, near, tools[0].planes[0]);
        else
          carve(e, near, tools, Carving::open);
      });
    } catch (const EditRefused& e) {
      ++tally.refused;
      tally.last = e.what();
      before.expect_unchanged();
      continue;
    }
    ++tally.made;
    environment.update_after_edit(set);
    test::expect_sound(environment.complex());
    test::expect_audited(environment.complex(), set);
    const double area = 6 * edge * edge * 2;
    EXPECT_TRUE(test::near(volume6(environment.complex()), whole, 6 * area * report.boundary_shift + 1e-12));
  }
  return tally;
}

TEST_P(Divisions, CutsThroughWarpedCells) {
  std::vector<double> turns = {0.025, 0.05, GetParam().largest_turn};
  if (test::full_tier()) turns.insert(turns.end(), {0.01, 0.1, 0.15, 0.2, 0.5, 1.0});
  for (const double turn : turns) {
    SCOPED_TRACE(turn);
    const Tally tally = cut_at_random(GetParam(), turn, test::scaled(12, 100), 5);
    EXPECT_EQ(tally.refused, 0) << tally.last;
  }
}

}  // namespace dartcast::division_test
