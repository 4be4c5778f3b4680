// Cuts and carving: exact volumes of dyadic tools, tools that end inside cells, and who can enter.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "support/expectations.hpp"
#include "support/surgery_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::carve_test {

using test::Before;
using test::Dyadic;
using test::MeshKind;
using test::volume6;

class Carvings : public testing::TestWithParam<MeshKind> {
 protected:
  static CellComplex box(std::array<std::uint32_t, 3> cells) {
    return CellComplex(test::blocked_box(cells, GetParam().type, GetParam().mixed));
  }
};
INSTANTIATE_TEST_SUITE_P(Surgery, Carvings,
                         testing::Values(MeshKind{"hexahedra", CellType::hexahedron, false},
                                         MeshKind{"tetrahedra", CellType::tetrahedron, false},
                                         MeshKind{"prisms", CellType::prism, false},
                                         MeshKind{"pyramids", CellType::pyramid, false},
                                         MeshKind{"mixed", CellType::hexahedron, true}),
                         [](const auto& i) { return std::string(i.param.name); });

std::size_t count_free(const CombinatorialMap& map) {
  const std::vector<Cell> cells = map.cells();
  return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [&](Cell c) { return map.is_free(c); }));
}

// All planes of a tool against all corners.
TEST_P(Carvings, CellsNearAToolAreThoseThatNoPlaneHasOutside) {
  const CellComplex complex = box({4, 4, 4});
  Random random(2);
  const auto within = [&] {
    return Vec3{random.uniform(0.0, 4.0), random.uniform(0.0, 4.0), random.uniform(0.0, 4.0)};
  };
  for (int i = 0; i < 20; ++i) {
    const Vec3 a = within();
    const Vec3 b = within();
    const ConvexTool tools[] = {box_tool(a - Vec3{0.5, 0.25, 0.75}, a), capsule_tool(a, b, 0.3),
                                thicken(Disc{b, {0, 1, 2}, 1.0}, 0.1).front()};
    std::vector<Cell> near;
    for (const Cell c : complex.map().cells()) {
      const CellView v = complex.map().view(c);
      const auto reaches_below = [&](const Plane& plane) {
        double lowest = 1.0;
        for (std::uint16_t k = 0; k < v.shape().corner_count(); ++k)
          lowest = std::min(lowest, plane.height(complex.positions()[v.vertex(k).value]));
        return lowest < 0.0;
      };
      const auto holds = [&](const ConvexTool& tool) {
        return std::all_of(tool.planes.begin(), tool.planes.end(), reaches_below);
      };
      if (std::any_of(std::begin(tools), std::end(tools), holds)) near.push_back(c);
    }
    EXPECT_EQ(cells_near(complex, tools), near);
  }
}

TEST_P(Carvings, ALayerHasItsAreaTimesItsWidth) {
  for (const auto& [height, width] : {std::pair{1.5, 0.25}, std::pair{1.25, 1.0}, std::pair{2.0, 0.125}}) {
    CellComplex complex = box({4, 3, 3});
    const Plane plane = plane_through({0, 0, height}, {0, 0, 1});
    const auto tools = thicken(plane, width);
    ComplexEdit edit(complex);
    Carved carved = cut(edit, cells_near(complex, tools), plane, width);
    carved.opened = test::now(edit.commit(), carved.opened);
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(volume6(complex) == Dyadic(6.0 * 36));
    EXPECT_TRUE(volume6(complex, carved.opened) == Dyadic(6.0 * 12 * width));
    EXPECT_EQ(count_free(complex.map()), carved.opened.size());
    EXPECT_EQ(test::count_rooms(complex.map()), 1U);
    EXPECT_TRUE(carved.whole.empty());
  }
}

TEST_P(Carvings, ABoxInsideCells) {
  for (const Carving what : {Carving::open, Carving::remove}) {
    CellComplex complex = box({4, 4, 4});
    const ConvexTool tools[] = {box_tool({0.75, 1.25, 1.5}, {2.5, 2.75, 2.25})};
    ComplexEdit edit(complex);
    Carved carved = carve(edit, cells_near(complex, tools), tools, what);
    carved.opened = test::now(edit.commit(), carved.opened);
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    const double inside = 6.0 * 1.75 * 1.5 * 0.75;
    if (what == Carving::open) {
      EXPECT_TRUE(volume6(complex) == Dyadic(6.0 * 64));
      EXPECT_TRUE(volume6(complex, carved.opened) == Dyadic(inside));
      EXPECT_EQ(test::count_rooms(complex.map()), 1U);
      EXPECT_EQ(carved.removed, 0U);
    } else {
      EXPECT_TRUE(volume6(complex) == Dyadic(6.0 * 64 - inside));
      EXPECT_GT(carved.removed, 0U);
      EXPECT_TRUE(carved.opened.empty());
    }
  }
}

TEST_P(Carvings, ADiscEndsInsideCells) {
  Random random(3);
  for (int i = 0; i < std::max(1, test::scaled(2, 60)); ++i) {
    SCOPED_TRACE(i);
    CellComplex complex = box({4, 4, 4});
    Disc disc;
    disc.centre = {random.uniform(1.5, 2.5), random.uniform(1.5, 2.5), random.uniform(1.5, 2.5)};
    disc.normal = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
    disc.radius = random.uniform(0.5, 1.4);
    disc.sides = 3 + random.below(12);
    const double width = random.uniform(0.01, 0.2);
    const auto tools = thicken(disc, width);
    ComplexEdit edit(complex);
    CarveOptions options;
    options.snap = i % 2 == 0 ? SectionOptions::min_snap : options.snap;
    Carved carved = cut(edit, cells_near(complex, tools), disc, width, options);
    carved.opened = test::now(edit.commit(), carved.opened);
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(test::near(volume6(complex), Dyadic(6.0 * 64), 1e-10));
    const double polygon = disc.sides * disc.radius * disc.radius * std::sin(2.0 * std::numbers::pi / disc.sides) / 2;
    const double off = i % 2 == 0 ? 1e-7 : 6.0 * polygon * width * 0.1;
    EXPECT_TRUE(test::near(volume6(complex, carved.opened), Dyadic(6.0 * polygon * width), off));
    EXPECT_EQ(test::count_rooms(complex.map()), 1U);
  }
}

TEST_P(Carvings, CutsThatCross) {
  Random random(4);
  for (int i = 0; i < std::max(1, test::scaled(1, 40)); ++i) {
    SCOPED_TRACE(i);
    CellComplex complex = box({3, 3, 3});
    for (int k = 0; k < 3; ++k) {
      const Plane plane =
          plane_through({random.uniform(1.0, 2.0), random.uniform(1.0, 2.0), random.uniform(1.0, 2.0)},
                        {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)});
      const auto tools = thicken(plane, 0.05);
      const Dyadic free = [&] {
        std::vector<Cell> cells = complex.map().cells();
        std::erase_if(cells, [&](Cell c) { return !complex.map().is_free(c); });
        return volume6(complex, cells);
      }();
      ComplexEdit edit(complex);
      Carved carved = cut(edit, cells_near(complex, tools), plane, 0.05);
      carved.opened = test::now(edit.commit(), carved.opened);
      test::expect_sound(complex);
      ASSERT_FALSE(HasFatalFailure());
      EXPECT_TRUE(test::near(volume6(complex), Dyadic(6.0 * 27), 1e-9));
      EXPECT_TRUE(Dyadic() < volume6(complex, carved.opened));
      std::vector<Cell> cells = complex.map().cells();
      std::erase_if(cells, [&](Cell c) { return !complex.map().is_free(c); });
      // Walls of earlier cuts, bent by their snap, are split anew.
      EXPECT_TRUE(test::near(volume6(complex, cells), free + volume6(complex, carved.opened), 6.0 * 40 * 0.05 / 128));
    }
  }
}

TEST_P(Carvings, ABallAndACapsule) {
  std::vector<Vec3> ends = {{1.3, 2.4, 2.2}};
  if (GetParam().type == CellType::prism || test::full_tier()) ends.push_back({2.0, 2.1, 1.9});  // a ball
  for (const Vec3& b : ends) {
    CellComplex complex = box({4, 4, 4});
    const Vec3 a = {2.0, 2.1, 1.9};
    const double r = 0.8;
    const ConvexTool tools[] = {capsule_tool(a, b, r)};
    ComplexEdit edit(complex);
    const Carved carved =
        carve(edit, cells_near(complex, tools), tools, Carving::open, {false, SectionOptions::min_snap});
    edit.commit();
    test::expect_sound(complex);
    ASSERT_FALSE(HasFatalFailure());
    const double length = norm(b - a);
    const auto capsule = [&](double radius) {
      return 6.0 * std::numbers::pi * radius * radius * (length + radius * 4 / 3);
    };
    const Dyadic volume = volume6(complex, carved.opened);
    EXPECT_TRUE(Dyadic(capsule(r)) < volume);
    EXPECT_TRUE(volume < Dyadic(capsule(1.13 * r)));
    EXPECT_TRUE(test::near(volume6(complex), Dyadic(6.0 * 64), 1e-10));
    EXPECT_EQ(test::count_rooms(complex.map()), 1U);
  }
}

// A path that bends: each part has its area times the width, up to the corners.
TEST_P(Carvings, ThePathOfABlade) {
  CellComplex complex = box({5, 4, 3});
  BladePath path;
  for (const auto& [x, y] : {std::pair{0.7, 1.1}, std::pair{2.2, 1.3}, std::pair{3.1, 2.4}, std::pair{4.3, 2.6}})
    path.places.push_back({Vec3{x, y, 0.8}, Vec3{x, y, 2.3}});
  const double width = 0.06;
  const auto tools = thicken(path, width);
  EXPECT_EQ(tools.size(), 3U);
  ComplexEdit edit(complex);
  Carved carved = cut(edit, cells_near(complex, tools), path, width, {false, SectionOptions::min_snap});
  carved.opened = test::now(edit.commit(), carved.opened);
  test::expect_sound(complex);
  ASSERT_FALSE(HasFatalFailure());
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < path.places.size(); ++i) length += norm(path.places[i + 1][0] - path.places[i][0]);
  EXPECT_TRUE(test::near(volume6(complex, carved.opened), Dyadic(6.0 * length * 1.5 * width), 1e-7));
  EXPECT_TRUE(test::near(volume6(complex), Dyadic(6.0 * 60), 1e-10));
  EXPECT_EQ(test::count_rooms(complex.map()), 1U);
}

TEST_P(Carvings, ABladeThatTwistsAndPivots) {
  CellComplex complex = box({5, 4, 4});
  BladePath path;
  path.places = {{Vec3{1.0, 2.0, 0.6}, Vec3{1.1, 2.1, 3.1}},
                 {Vec3{2.0, 2.2, 0.7}, Vec3{2.3, 2.9, 3.2}},
                 {Vec3{2.9, 2.0, 0.7}, Vec3{2.3, 2.9, 3.2}},
                 {Vec3{3.9, 2.1, 0.8}, Vec3{3.3, 2.4, 3.1}}};
  const double width = 0.05;
  const auto tools = thicken(path, width);
  EXPECT_EQ(tools.size(), 5U);
  ComplexEdit edit(complex);
  Carved carved = cut(edit, cells_near(complex, tools), path, width);
  carved.opened = test::now(edit.commit(), carved.opened);
  test::expect_sound(complex);
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(test::count_rooms(complex.map()), 1U);
  EXPECT_TRUE(test::near(volume6(complex), Dyadic(6.0 * 80), 1e-10));
}

TEST(Carving, TakesWholeCells) {
  for (const Carving what : {Carving::open, Carving::remove}) {
    CellComplex complex(test::blocked_box({4, 4, 4}));
    const ConvexTool tools[] = {box_tool({0.75, 1.25, 1.75}, {2.75, 2.75, 2.25})};
    ComplexEdit edit(complex);
    Carved carved = carve(edit, cells_near(complex, tools), tools, what, {true});
    const ComplexEditReport report = edit.commit();
    test::expect_sound(complex);
    // Middles at 1.5 and 2.5 along x, at 1.5 and 2.5 along y; none at 1.75 to 2.25 along z.
    EXPECT_TRUE(carved.opened.empty());
    EXPECT_EQ(carved.removed, 0U);
    EXPECT_TRUE(report.placed.empty());

    const ConvexTool higher[] = {box_tool({0.75, 1.25, 1.75}, {2.75, 2.75, 2.75})};
    ComplexEdit again(complex);
    const Carved taken = carve(again, cells_near(complex, higher), higher, what, {true});
    again.commit();
    test::expect_sound(complex);
    EXPECT_EQ(taken.opened.size() + taken.removed, 4U);
    EXPECT_EQ(complex.map().cell_count(), what == Carving::open ? 64U : 60U);
  }
}

TEST(Carving, SplitsNoFreeCells) {
  MeshData mesh = test::blocked_box({4, 4, 4});
  for (std::size_t c = 0; c < mesh.cell_count(); c += 2) mesh.free[c] = 1;
  CellComplex complex(mesh);
  const auto tools = thicken(plane_through({2, 2, 1.4}, {0.1, 0.2, 1.0}), 0.1);
  ComplexEdit edit(complex);
  Carved carved = carve(edit, cells_near(complex, tools), tools, Carving::open);
  carved.opened = test::now(edit.commit(), carved.opened);
  test::expect_sound(complex);
  EXPECT_EQ(count_free(complex.map()), 32 + carved.opened.size());
}

TEST(Carving, FindsCellsNearByWalking) {
  const CellComplex complex(test::blocked_box({9, 9, 9}));
  const ConvexTool tools[] = {capsule_tool({2.2, 3.1, 4.5}, {6.0, 6.2, 4.1}, 0.7)};
  std::vector<Cell> all = cells_near(complex, tools);
  std::vector<Cell> walked = cells_near(complex, tools, all.front());
  std::sort(all.begin(), all.end());
  std::sort(walked.begin(), walked.end());
  EXPECT_EQ(all, walked);
  EXPECT_GT(all.size(), 20U);
  EXPECT_LT(all.size(), 200U);
  EXPECT_TRUE(cells_near(complex, tools, complex.map().cells().front()).empty());
}

TEST(Carving, CostsWhatIsNearTheTool) {
  for (const std::uint32_t n : {6U, 24U}) {
    CellComplex complex(test::blocked_box({n, n, n}));
    const ConvexTool tools[] = {box_tool({2.25, 2.25, 2.25}, {3.75, 3.75, 3.75})};
    ComplexEdit edit(complex);
    carve(edit, cells_near(complex, tools), tools, Carving::open);
    const ComplexEditReport report = edit.commit();
    EXPECT_EQ(report.map.removed.size(), 32U) << n;  // 8 cells, and those at their 24 outer faces
  }
}

TEST(Carving, RefusesWithoutAChange) {
  CellComplex complex(test::blocked_box({3, 3, 3}));
  { ComplexEdit first(complex); }
  const Before before(complex);
  ComplexEdit edit(complex);
  const std::vector<Cell> cells = complex.map().cells();
  const Plane plane = plane_through({1.4, 1.4, 1.4}, {1, 2, 3});
  const auto expect = [&](auto act, std::initializer_list<const char*> parts) {
    test::expect_parts(test::refusal(act), parts);
  };
  expect([&] { cut(edit, cells, plane, 0.0); }, {"invalid", "width"});
  expect([&] { cut(edit, cells, plane, NAN); }, {"invalid", "width"});
  expect([&] { cut(edit, cells, plane, 0.1, {false, -1.0}); }, {"invalid", "snap"});
  expect([&] { cut(edit, cells, Disc{{}, {}, 1.0}, 0.1); }, {"invalid", "normal"});
  expect([&] { cut(edit, cells, Disc{{}, {0, 0, 1}, -1.0}, 0.1); }, {"invalid", "radius"});
  expect([&] { cut(edit, cells, Disc{{}, {0, 0, 1}, 1.0, 2}, 0.1); }, {"invalid", "3 to 1000"});
  expect([&] { cut(edit, cells, BladePath{}, 0.1); }, {"invalid", "two places"});
  const Vec3 a = {0, 0, 0};
  const Vec3 b = {0, 0, 1};
  const Vec3 c = {1, 0, 0};
  const Vec3 d = {1, 0, 1};
  expect([&] { cut(edit, cells, BladePath{{{a, b}, {a, b}}}, 0.1); }, {"invalid", "two places"});
  expect([&] { cut(edit, cells, BladePath{{{a, a}, {c, d}}}, 0.1); }, {"invalid", "ends apart"});
  expect(
      [&] {
        cut(edit, cells, BladePath{{{a, b}, {c, d}, {a + 0.2 * c, b + 0.2 * c}}}, 0.1);
      },
      {"invalid", "back onto itself"});
  expect([&] { box_tool({0, 0, 0}, {1, 0, 1}); }, {"invalid", "box"});
  expect([&] { capsule_tool(a, b, 0.0); }, {"invalid", "radius"});
  expect([&] { cells_near(complex, {}, Cell(1, 99)); }, {"invalid", "no such cell"});
  std::vector<Cell> twice = cells;
  twice.push_back(cells[3]);
  expect([&] { cut(edit, twice, plane, 0.1); }, {"invalid", "cell 3", "twice"});
  before.expect_unchanged();
}

}  // namespace dartcast::carve_test
