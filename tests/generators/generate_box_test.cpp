#include <cmath>
#include <limits>
#include <numeric>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/generate_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::generate_box_test {

using test::count_not_positive;
using test::expect_conforming;

BoxOptions box(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz) {
  BoxOptions o;
  o.cells = {nx, ny, nz};
  o.size = {double(nx), double(ny), double(nz)};
  return o;
}

std::size_t blocked_count(const MeshData& mesh) {
  return static_cast<std::size_t>(std::count(mesh.free.begin(), mesh.free.end(), 0));
}

struct Kind {
  CellType type;
  std::size_t per_cube;
  std::size_t faces_per_z_side, faces_per_other_side;
};

TEST(GenerateBox, EachTypeConformsIsPositiveAndFillsTheBox) {
  for (const Kind k : {Kind{CellType::hexahedron, 1, 1, 1}, Kind{CellType::tetrahedron, 6, 2, 2},
                       Kind{CellType::prism, 2, 2, 1}, Kind{CellType::pyramid, 6, 1, 1}}) {
    SCOPED_TRACE(cell_type_names[static_cast<std::size_t>(k.type)]);
    BoxOptions o = box(4, 3, 5);
    o.type = k.type;
    const MeshData mesh = generate_box(o);
    EXPECT_EQ(mesh.cell_count(), 60 * k.per_cube);
    EXPECT_EQ(mesh.points.size(), 5U * 4 * 6 + (k.type == CellType::pyramid ? 60 : 0));
    EXPECT_TRUE(std::all_of(mesh.types.begin(), mesh.types.end(), [&](CellType t) { return t == k.type; }));
    EXPECT_TRUE(mesh.free.empty());
    EXPECT_EQ(expect_conforming(mesh), mesh.patch_tags.size());
    EXPECT_EQ(count_not_positive(mesh, mesh.points), 0U);
    EXPECT_EQ(test::volume(mesh), 60.0);
    auto sizes = test::patch_sizes(mesh);
    EXPECT_EQ(sizes["xmin"], 15 * k.faces_per_other_side);
    EXPECT_EQ(sizes["xmax"], 15 * k.faces_per_other_side);
    EXPECT_EQ(sizes["ymin"], 20 * k.faces_per_other_side);
    EXPECT_EQ(sizes["ymax"], 20 * k.faces_per_other_side);
    EXPECT_EQ(sizes["zmin"], 12 * k.faces_per_z_side);
    EXPECT_EQ(sizes["zmax"], 12 * k.faces_per_z_side);
  }
}

// The volume is linear in each coordinate, so it is least where each is at an end of its range.
TEST(GenerateBox, ASurelyValidJitterInvertsNoTetrahedron) {
  const std::array<Vec3, 4> corners = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}};
  const auto least_volume = [&](double jitter) {
    double least = 1.0;
    for (unsigned ends = 0; ends < 1U << 12U; ++ends) {
      std::array<Vec3, 4> x = corners;
      const auto shift = [&](unsigned k) { return (((ends >> k) & 1U) == 0 ? -0.5 : 0.5) * jitter; };
      for (unsigned k = 0; k < 4; ++k) x[k] += Vec3{shift(3 * k), shift(3 * k + 1), shift(3 * k + 2)};
      least = std::min(least, dot(cross(x[1] - x[0], x[2] - x[0]), x[3] - x[0]));
    }
    return least;
  };
  EXPECT_GT(least_volume(surely_valid_jitter - 1e-9), 0.0);
  EXPECT_LT(least_volume(surely_valid_jitter + 1e-3), 0.0);
}

TEST(GenerateBox, CubesHaveTheEdgeOneUnlessTheSizeIsGiven) {
  const auto top = [](const MeshData& mesh) { return mesh.points.back(); };
  EXPECT_EQ(top(generate_box({.cells = {6, 5, 4}})), (Vec3{6, 5, 4}));
  EXPECT_EQ(top(generate_box({.cells = {6, 5, 4}, .size = Vec3{1, 1, 1}})), (Vec3{1, 1, 1}));
  EXPECT_EQ(top(generate_rectangle({.cells = {6, 5}})), (Vec3{6, 5, 0}));
  EXPECT_EQ(top(generate_maze({.rooms = {2, 1}, .room_cells = 4})), (Vec3{9, 4, 0}));
  EXPECT_EQ(generate_octahedra({.cells = {3, 1, 1}}).points,
            generate_octahedra({.cells = {3, 1, 1}, .size = Vec3{3, 1, 1}}).points);
}

TEST(GenerateBox, PatchFacesLieOnTheSideNamed) {
  BoxOptions o = box(2, 3, 4);
  o.mixed = true;
  const MeshData mesh = generate_box(o);
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const auto side = static_cast<std::size_t>(mesh.patch_tags[f] - 1);
    const double where = side % 2 == 0 ? 0.0 : double(o.cells[side / 2]);
    for (std::size_t i = mesh.patch_offsets[f]; i < mesh.patch_offsets[f + 1]; ++i) {
      const Vec3& p = mesh.points[mesh.patch_faces[i]];
      EXPECT_EQ((std::array{p.x, p.y, p.z}[side / 2]), where);
    }
  }
  EXPECT_EQ(mesh.patch_names.at(1), "xmin");
  EXPECT_EQ(mesh.patch_names.at(6), "zmax");
}

TEST(GenerateBox, PointsAreLexicographicAndExactOnLattices) {
  for (const std::uint32_t n : {3U, 7U, 10U, 49U, 1000U}) {
    const MeshData mesh = generate_box(box(n, 1, 2));
    std::size_t at = 0;
    for (int k = 0; k <= 2; ++k) {
      for (int j = 0; j <= 1; ++j) {
        for (std::uint32_t i = 0; i <= n; ++i) EXPECT_EQ(mesh.points[at++], (Vec3{double(i), double(j), double(k)}));
      }
    }
  }
  BoxOptions o = box(3, 3, 3);
  o.origin = {-1, 10, 0.5};
  o.size = {0.7, 0.1, 0.3};
  EXPECT_EQ(generate_box(o).points.back(), o.origin + *o.size);
}

TEST(GenerateBox, MixedBoxesHaveAllTypesAndConform) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    BoxOptions o = box(4, 5, 3);
    o.mixed = true;
    o.seed = seed;
    o.jitter = 0.1;
    const MeshData mesh = generate_box(o);
    EXPECT_EQ(expect_conforming(mesh), mesh.patch_tags.size());
    EXPECT_EQ(count_not_positive(mesh, mesh.points), 0U);
    EXPECT_NEAR(test::volume(mesh), 60.0, 1e-12);
  }
  BoxOptions o = box(10, 10, 10);
  o.mixed = true;
  const MeshData mesh = generate_box(o);
  for (const CellType t : {CellType::tetrahedron, CellType::hexahedron, CellType::prism, CellType::pyramid}) {
    EXPECT_GE(std::count(mesh.types.begin(), mesh.types.end(), t), 5) << static_cast<int>(t);
  }
}

TEST(GenerateBox, JitterMovesInnerPointsOnlyAndStaysInBounds) {
  BoxOptions o = box(6, 7, 8);
  o.size = {12, 7, 4};
  const MeshData plain = generate_box(o);
  o.jitter = 0.4;
  const MeshData warped = generate_box(o);
  const auto edge = Vec3{2, 1, 0.5};
  std::size_t moved = 0;
  double furthest = 0;
  for (std::size_t i = 0; i < plain.points.size(); ++i) {
    const Vec3 p = plain.points[i], d = warped.points[i] - p;
    const bool boundary = p.x == 0 || p.x == 12 || p.y == 0 || p.y == 7 || p.z == 0 || p.z == 4;
    EXPECT_TRUE(!boundary || d == Vec3{});
    moved += d == Vec3{} ? 0 : 1;
    furthest = std::max({furthest, std::abs(d.x / edge.x), std::abs(d.y / edge.y), std::abs(d.z / edge.z)});
  }
  EXPECT_EQ(moved, 5U * 6 * 7);
  EXPECT_LE(furthest, 0.2 + 1e-12);
  EXPECT_GT(furthest, 0.19);
  EXPECT_EQ(count_not_positive(warped, warped.points), 0U);
}

TEST(GenerateBox, BlockedLayerAndShare) {
  BoxOptions o = box(6, 7, 8);
  o.blocked_layer = true;
  MeshData mesh = generate_box(o);
  EXPECT_EQ(blocked_count(mesh), 6U * 7 * 8 - 4 * 5 * 6);
  EXPECT_EQ(mesh.free[0], 0);
  EXPECT_EQ(mesh.free[1 + 6 * (1 + 7 * 1)], 1);

  o.blocked_share = 0.1;
  mesh = generate_box(o);
  EXPECT_EQ(blocked_count(mesh), 6U * 7 * 8 - 4 * 5 * 6 + 12);
  EXPECT_EQ(mesh.free, generate_box(o).free);
  o.seed = 2;
  EXPECT_NE(mesh.free, generate_box(o).free);

  o.blocked_layer = false;
  o.blocked_share = 1.0;
  EXPECT_EQ(blocked_count(generate_box(o)), 6U * 7 * 8);
}

TEST(GenerateBox, CellsOfACubeAreBlockedTogether) {
  BoxOptions o = box(5, 5, 5);
  o.type = CellType::tetrahedron;
  o.blocked_share = 0.5;
  const MeshData mesh = generate_box(o);
  EXPECT_EQ(blocked_count(mesh), 6U * 63);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) EXPECT_EQ(mesh.free[c], mesh.free[c - c % 6]);
}

TEST(GenerateBox, BlockedShareTreatsAllCubesAlike) {
  BoxOptions o = box(4, 4, 4);
  o.blocked_share = 0.25;
  const unsigned count = test::sanitized() ? 400 : 4000;
  std::vector<int> times(64, 0);
  for (o.seed = 0; o.seed < count; ++o.seed) {
    const MeshData mesh = generate_box(o);
    for (std::size_t c = 0; c < 64; ++c) times[c] += 1 - mesh.free[c];
  }
  // Binomial: five standard deviations either way.
  for (const int t : times) EXPECT_NEAR(t, count * 0.25, 5.0 * std::sqrt(count * 0.25 * 0.75));
}

// The numbers that this seed gave on the first machine: they must be the same on every other.
TEST(GenerateBox, RandomBitsAreTheSameEverywhere) {
  BoxOptions o = box(3, 3, 3);
  o.seed = 12345;
  o.jitter = 0.5;
  o.blocked_share = 0.5;
  const MeshData mesh = generate_box(o);
  EXPECT_EQ(mesh.points[1 + 4 * (1 + 4 * 1)], (Vec3{0x1.2773563a3f584p+0, 0x1.3c859d043c1aap+0, 0x1.121e4aeb6bd42p+0}));
  EXPECT_EQ(std::accumulate(mesh.free.begin(), mesh.free.end(), 0U, [](unsigned h, unsigned f) { return 2 * h + f; }),
            73013875U);
}

TEST(GenerateBox, TheBarIsThePapers) {
  const MeshData mesh = generate_bar();
  EXPECT_EQ(mesh.cell_count(), 700U);
  EXPECT_EQ(mesh.cell_count() - blocked_count(mesh), 3U * 3 * 26);
  EXPECT_EQ(mesh.points.back(), (Vec3{5, 5, 28}));
  EXPECT_EQ(expect_conforming(mesh), 2U * (25 + 140 + 140));
}

TEST(GenerateBox, RefusesWhatItCannotBuild) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto refuses = [](auto&& change, const char* text) {
    BoxOptions o = box(2, 2, 2);
    change(o);
    try {
      generate_box(o);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InvalidArgument& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  refuses([](BoxOptions& o) { o.cells[1] = 0; }, "no cells");
  refuses([](BoxOptions& o) { o.cells = {1U << 15U, 1U << 14U, 1}; }, "536870911");
  refuses([](BoxOptions& o) { o.cells = {4294967295U, 4294967295U, 4294967295U}; }, "536870911");
  refuses([](BoxOptions& o) { o.cells = {89478486, 1, 1}, o.type = CellType::tetrahedron; }, "536870911");
  refuses([](BoxOptions& o) { o.size->y = nan; }, "finite");
  refuses([](BoxOptions& o) { o.origin.z = inf; }, "finite");
  refuses([](BoxOptions& o) { o.origin.x = o.size->x = 1.5e308; }, "finite");
  refuses([](BoxOptions& o) { o.size->x = 0; }, "positive");
  refuses([](BoxOptions& o) { o.size->x = -1; }, "positive");
  refuses([](BoxOptions& o) { o.blocked_share = 1.5; }, "blocked_share");
  refuses([](BoxOptions& o) { o.blocked_share = nan; }, "blocked_share");
  refuses([](BoxOptions& o) { o.jitter = nan; }, "jitter");
  refuses([](BoxOptions& o) { o.type = CellType::polyhedron; }, "polyhedra");
}

}  // namespace dartcast::generate_box_test
