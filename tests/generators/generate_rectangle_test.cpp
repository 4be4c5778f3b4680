#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/planar_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::generate_rectangle_test {

using test::count_not_convex;
using test::expect_conforming_in_plane;

RectangleOptions rectangle(std::uint32_t nx, std::uint32_t ny) {
  RectangleOptions o;
  o.cells = {nx, ny};
  o.size = {double(nx), double(ny)};
  return o;
}

std::array<std::size_t, 3> type_counts(const MeshData& mesh) {
  const auto count = [&](CellType t) {
    return static_cast<std::size_t>(std::count(mesh.types.begin(), mesh.types.end(), t));
  };
  return {count(CellType::triangle), count(CellType::quadrilateral), count(CellType::polygon)};
}

TEST(GenerateRectangle, EachTypeConformsIsConvexAndFillsTheRectangle) {
  for (const CellType type : {CellType::quadrilateral, CellType::triangle, CellType::polygon}) {
    SCOPED_TRACE(cell_type_names[static_cast<std::size_t>(type)]);
    RectangleOptions o = rectangle(7, 5);
    o.type = type;
    const MeshData mesh = generate_rectangle(o);
    EXPECT_TRUE(mesh.free.empty());
    EXPECT_EQ(expect_conforming_in_plane(mesh), 24U);
    EXPECT_EQ(mesh.patch_tags.size(), 24U);
    EXPECT_EQ(count_not_convex(mesh), 0U);
    EXPECT_EQ(test::area(mesh), 35.0);
    const auto [triangles, quadrilaterals, polygons] = type_counts(mesh);
    if (type == CellType::quadrilateral) EXPECT_EQ(quadrilaterals, 35U);
    if (type == CellType::triangle) EXPECT_EQ(triangles, 70U);
    // A third each of the inner points (1 to 6, 1 to 4) has i + j = 0, 1, 2 mod 3.
    if (type == CellType::polygon) EXPECT_EQ(polygons, 8U);
    EXPECT_EQ(mesh.points.size(), 48U - polygons);
  }
}

TEST(GenerateRectangle, SmallestRectangles) {
  for (const auto& [nx, ny] : {std::pair{1U, 1U}, {1U, 2U}, {2U, 1U}, {2U, 2U}, {3U, 3U}}) {
    for (const CellType type : {CellType::quadrilateral, CellType::triangle, CellType::polygon}) {
      RectangleOptions o = rectangle(nx, ny);
      o.type = type;
      const MeshData mesh = generate_rectangle(o);
      EXPECT_EQ(expect_conforming_in_plane(mesh), 2 * (nx + ny));
      EXPECT_EQ(test::area(mesh), nx * ny);
    }
  }
}

TEST(GenerateRectangle, PatchEdgesLieOnTheSideNamed) {
  const MeshData mesh = generate_rectangle(rectangle(2, 3));
  std::array<std::size_t, 4> sizes = {};
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto side = static_cast<std::size_t>(mesh.patch_tags[f] - 1);
    ++sizes.at(side);
    const double where = side % 2 == 0 ? 0.0 : std::array{2.0, 3.0}[side / 2];
    for (std::size_t i = 2 * f; i < 2 * f + 2; ++i) {
      const Vec3& p = mesh.points[mesh.patch_faces[i]];
      EXPECT_EQ(side < 2 ? p.x : p.y, where);
    }
  }
  EXPECT_EQ(sizes, (std::array<std::size_t, 4>{3, 3, 2, 2}));
  EXPECT_EQ(mesh.patch_names.at(1), "xmin");
  EXPECT_EQ(mesh.patch_names.at(4), "ymax");
}

TEST(GenerateRectangle, PointsAreLexicographicAndExactOnLattices) {
  for (const std::uint32_t n : {3U, 7U, 10U, 49U, 1000U}) {
    const MeshData mesh = generate_rectangle(rectangle(n, 2));
    std::size_t at = 0;
    for (int j = 0; j <= 2; ++j) {
      for (std::uint32_t i = 0; i <= n; ++i) EXPECT_EQ(mesh.points[at++], (Vec3{double(i), double(j), 0.0}));
    }
  }
  RectangleOptions o = rectangle(3, 3);
  o.origin = {-1, 10};
  o.size = {0.7, 0.1};
  EXPECT_EQ(generate_rectangle(o).points.back(), (Vec3{-1 + 0.7, 10 + 0.1, 0.0}));
}

TEST(GenerateRectangle, MixedRectanglesHaveAllTypesAndStayConvexAtTheLargestJitter) {
  for (std::uint64_t seed = 1; seed <= test::scaled(20U, 500U); ++seed) {
    RectangleOptions o = rectangle(11, 8);
    o.mixed = true;
    o.seed = seed;
    o.jitter = largest_polygon_jitter;
    const MeshData mesh = generate_rectangle(o);
    EXPECT_EQ(expect_conforming_in_plane(mesh), 38U);
    EXPECT_EQ(count_not_convex(mesh), 0U);
    EXPECT_NEAR(test::area(mesh), 88.0, 1e-12);
    const auto counts = type_counts(mesh);
    for (const std::size_t n : counts) EXPECT_GE(n, 3U);
  }
}

TEST(GenerateRectangle, SquaresStayConvexAtTheLargestJitter) {
  for (const CellType type : {CellType::quadrilateral, CellType::triangle}) {
    RectangleOptions o = rectangle(40, 50);
    o.type = type;
    o.jitter = largest_square_jitter;
    EXPECT_EQ(count_not_convex(generate_rectangle(o)), 0U);
  }
}

// Determinants are linear in each coordinate, so that they are smallest where all are at an end of their range.
TEST(GenerateRectangle, TheBoundsOnJitterHoldInTheWorstCase) {
  const auto smallest_turn = [](const std::array<Vec3, 3>& p, double jitter) {
    double smallest = 1e300;
    for (unsigned ends = 0; ends < 64; ++ends) {
      std::array<Vec3, 3> q = p;
      for (unsigned k = 0; k < 3; ++k) {
        q[k].x += (((ends >> (2 * k)) & 1U) == 0 ? -0.5 : 0.5) * jitter;
        q[k].y += (((ends >> (2 * k + 1)) & 1U) == 0 ? -0.5 : 0.5) * jitter;
      }
      smallest = std::min(smallest, cross(q[1] - q[0], q[2] - q[0]).z);
    }
    return smallest;
  };
  const std::array<Vec3, 6> hexagon = {{{-1, -1}, {0, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 0}}};
  for (std::size_t k = 0; k < 6; ++k) {
    const std::array<Vec3, 3> corner = {hexagon[k], hexagon[(k + 1) % 6], hexagon[(k + 2) % 6]};
    EXPECT_GT(smallest_turn(corner, largest_polygon_jitter), 1.0 - 3.0 * largest_polygon_jitter - 1e-12);
  }
  EXPECT_NEAR(smallest_turn({{{1, 1}, {0, 1}, {-1, 0}}}, largest_polygon_jitter), 0.1, 1e-12);
  EXPECT_NEAR(smallest_turn({{{0, 0}, {1, 0}, {0, 1}}}, largest_square_jitter), 0.1, 1e-12);
}

TEST(GenerateRectangle, JitterMovesInnerPointsOnlyAndStaysInBounds) {
  RectangleOptions o = rectangle(6, 7);
  o.size = {12, 7};
  const MeshData plain = generate_rectangle(o);
  o.jitter = 0.4;
  const MeshData moved = generate_rectangle(o);
  std::size_t count = 0;
  double furthest = 0;
  for (std::size_t i = 0; i < plain.points.size(); ++i) {
    const Vec3 p = plain.points[i], d = moved.points[i] - p;
    const bool boundary = p.x == 0 || p.x == 12 || p.y == 0 || p.y == 7;
    EXPECT_TRUE(!boundary || d == Vec3{});
    count += d == Vec3{} ? 0 : 1;
    furthest = std::max({furthest, std::abs(d.x / 2), std::abs(d.y)});
  }
  EXPECT_EQ(count, 5U * 6);
  EXPECT_LE(furthest, 0.2 + 1e-12);
  EXPECT_GT(furthest, 0.19);
}

TEST(GenerateRectangle, BlockedShare) {
  RectangleOptions o = rectangle(10, 10);
  o.blocked_share = 0.25;
  const MeshData mesh = generate_rectangle(o);
  EXPECT_EQ(std::count(mesh.free.begin(), mesh.free.end(), 0), 25);
  EXPECT_EQ(mesh.free, generate_rectangle(o).free);
  o.seed = 2;
  EXPECT_NE(mesh.free, generate_rectangle(o).free);
}

// The area blocked is that of the squares whatever the cells are: none is merged across.
TEST(GenerateRectangle, HexagonsAreMergedFromSquaresOfOneMark) {
  RectangleOptions o = rectangle(20, 20);
  o.mixed = true;
  o.blocked_share = 0.3;
  MeshData mesh = generate_rectangle(o);
  EXPECT_EQ(expect_conforming_in_plane(mesh), 80U);
  MeshData blocked;
  blocked.points = mesh.points;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.free[c] == 0) blocked.add_cell(mesh.types[c], mesh.cell(c));
  }
  EXPECT_EQ(test::area(blocked), 120.0);
  EXPECT_GT(type_counts(mesh)[2], 0U);
}

// The numbers that this seed gave on the first machine: they must be the same on every other.
TEST(GenerateRectangle, RandomBitsAreTheSameEverywhere) {
  RectangleOptions o = rectangle(6, 6);
  o.seed = 12345;
  o.jitter = 0.25;
  o.blocked_share = 0.5;
  o.mixed = true;
  const MeshData mesh = generate_rectangle(o);
  EXPECT_EQ(mesh.points[8], (Vec3{0x1.13b9ab1d1fac2p+0, 0x1.1e42ce821e0d5p+0, 0.0}));
  EXPECT_EQ(std::accumulate(mesh.connectivity.begin(), mesh.connectivity.end(), 0U,
                            [](unsigned h, unsigned v) { return 31 * h + v; }),
            1047468264U);
}

TEST(GenerateRectangle, RefusesWhatItCannotBuild) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto refuses = [](auto&& change, const char* text) {
    RectangleOptions o = rectangle(2, 2);
    change(o);
    try {
      generate_rectangle(o);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InvalidArgument& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  refuses([](RectangleOptions& o) { o.cells[1] = 0; }, "no cells");
  refuses([](RectangleOptions& o) { o.cells = {1U << 15U, 1U << 14U}; }, "536870911");
  refuses([](RectangleOptions& o) { o.cells = {4294967295U, 4294967295U}; }, "536870911");
  refuses([](RectangleOptions& o) { o.cells = {1U << 28U, 1}, o.type = CellType::triangle; }, "536870911");
  refuses([](RectangleOptions& o) { o.size->at(1) = nan; }, "finite");
  refuses([](RectangleOptions& o) { o.origin[0] = inf; }, "finite");
  refuses([](RectangleOptions& o) { o.origin[0] = o.size->at(0) = 1.5e308; }, "finite");
  refuses([](RectangleOptions& o) { o.size->at(0) = 0; }, "positive");
  refuses([](RectangleOptions& o) { o.size->at(1) = -1; }, "positive");
  refuses([](RectangleOptions& o) { o.blocked_share = 1.5; }, "blocked_share");
  refuses([](RectangleOptions& o) { o.blocked_share = nan; }, "blocked_share");
  refuses([](RectangleOptions& o) { o.jitter = nan; }, "jitter");
  refuses([](RectangleOptions& o) { o.jitter = 0.46; }, "jitter");
  refuses([](RectangleOptions& o) { o.jitter = 0.31, o.mixed = true; }, "jitter");
  refuses([](RectangleOptions& o) { o.jitter = 0.31, o.type = CellType::polygon; }, "jitter");
  refuses([](RectangleOptions& o) { o.type = CellType::hexahedron; }, "space");
}

}  // namespace dartcast::generate_rectangle_test
