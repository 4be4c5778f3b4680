// Open borders and blocked faces: never passed, met where and when they are, answered as asked.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/surface.hpp"
#include "mesh/cell_types.hpp"
#include "support/surface_meshes.hpp"
#include "support/tier.hpp"

namespace dartcast::walls_test {

using test::gap;

// Which free faces hang together by edges, from the mesh alone: a particle never changes its part.
std::vector<std::uint32_t> parts_of(const MeshData& mesh) {
  std::vector<std::uint32_t> part(mesh.cell_count());
  std::iota(part.begin(), part.end(), 0U);
  const auto root = [&](std::uint32_t c) {
    while (part[c] != c) c = part[c];
    return c;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> by_edge;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c) {
    if (mesh.free[c] == 0) continue;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> e) {
      const auto [at, fresh] = by_edge.try_emplace(std::minmax(e[0], e[1]), c);
      if (!fresh) part[root(c)] = root(at->second);
    });
  }
  for (std::uint32_t c = 0; c < part.size(); ++c) part[c] = root(c);
  return part;
}

MeshData with_walls(MeshData mesh, double blocked, double removed, std::uint64_t seed) {
  MeshData out;
  out.points = mesh.points;
  Random random(seed);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    if (random.uniform() < removed) continue;
    out.add_cell(mesh.types[c], mesh.cell(c));
    out.free.push_back(random.uniform() < blocked ? 0 : 1);
  }
  return out;
}

void check_contact(const Surface& surface, const SurfaceContact& c) {
  ASSERT_TRUE(surface.contains(c.place));
  ASSERT_TRUE(surface.map().is_free(c.place.triangle.cell));
  ASSERT_EQ(c.dart.cell, c.place.triangle.cell);
  ASSERT_EQ(c.kind, c.place.kind());
  ASSERT_EQ(c.point, surface.point(c.place));
  ASSERT_GE(c.time_of_impact, 0.0);
  ASSERT_LE(c.time_of_impact, 1.0);
  const Vec3 n = surface.normal(c.place.triangle);
  for (const Vec3& v : {c.normal, c.sides[0], c.sides[1]}) {
    ASSERT_NEAR(norm(v), 1.0, 1e-14);
    ASSERT_NEAR(dot(v, n), 0.0, 1e-14);
  }
  ASSERT_NEAR(dot(c.sides[0], c.normal), dot(c.sides[1], c.normal), 1e-12);
  const auto a = surface.positions()[surface.map().origin(c.dart).value];
  if (c.kind == Kind::vertex) {
    ASSERT_EQ(c.point, a);
    return;
  }
  ASSERT_TRUE(surface.map().view(c.dart.cell).is_wall(surface.map().face(c.dart).face));
  const auto b = surface.positions()[surface.map().origin(surface.map().phi1(c.dart)).value];
  ASSERT_NEAR(gap(a, c.point) + gap(c.point, b), gap(a, b), 1e-14);
  ASSERT_NEAR(dot(c.normal, b - a), 0.0, 1e-14);
  ASSERT_GE(dot(cross(n, b - a), c.normal), 0.0);
}

AfterSurfaceContact random_answer(const SurfaceContact& c, Random& random) {
  switch (random.below(4)) {
    case 0: return {reflected(c, c.unused), true};
    case 1: return {slid(c, c.unused), true};
    case 2: return {test::random_vector(random), random.below(2) == 0};
    default: return {};
  }
}

TEST(SurfaceWalls, AreNeverPassed) {
  std::size_t steps = 0;
  std::size_t contacts = 0;
  std::size_t at_vertices = 0;
  const int scenes = 4;
  for (int scene = 0; scene < scenes; ++scene) {
    const auto seed = static_cast<std::uint64_t>(scene + 1);
    const MeshData mesh = with_walls(scene == 3 ? test::castle() : test::bumpy(3, 0.3, seed), scene == 0 ? 0.0 : 0.3,
                                     scene == 1 ? 0.0 : 0.15, seed);
    const Surface surface(mesh);
    const auto part = parts_of(mesh);
    Random random(seed);
    std::vector<SurfaceContact> met;
    std::vector<SurfaceCrossing> crossings;
    for (int i = 0; i < 50; ++i) {
      SurfacePlace place = test::random_place(surface, random);
      const std::uint32_t home = part[surface.map().source(place.triangle.cell)];
      for (int k = 0; k < test::scaled(500, 20000); ++k) {
        met.clear();
        crossings.clear();
        // On the lattice along its edges, half of the time: through vertices.
        Vec3 way = test::random_vector(random) * (k % 5 == 0 ? 3.0 : 0.3);
        if (scene == 3 && k % 2 == 0) way = {random.below(3) - 1.0, random.below(3) - 1.0, random.below(3) - 1.0};
        const auto answer = [&](const SurfaceContact& c) { return random_answer(c, random); };
        const SurfaceStep step = dartcast::step(surface, place, way, answer, {}, {&met, &crossings});
        ASSERT_TRUE(surface.contains(place));
        ASSERT_TRUE(surface.map().is_free(place.triangle.cell));
        ASSERT_EQ(part[surface.map().source(place.triangle.cell)], home);
        ASSERT_TRUE(step.end == SurfaceEnd::arrived || step.end == SurfaceEnd::stopped);
        ASSERT_EQ(met.size(), step.contacts);
        for (const SurfaceContact& c : met) {
          ASSERT_NO_FATAL_FAILURE(check_contact(surface, c));
          at_vertices += c.kind == Kind::vertex ? 1 : 0;
        }
        for (std::size_t m = 1; m < met.size(); ++m) ASSERT_LE(met[m - 1].time_of_impact, met[m].time_of_impact);
        for (const SurfaceCrossing& c : crossings) ASSERT_EQ(part[surface.map().source(c.place.triangle.cell)], home);
        contacts += met.size();
        ++steps;
      }
    }
  }
  EXPECT_GT(contacts, steps / 10);
  EXPECT_GT(at_vertices, steps / 1000);
}

// A sheet of two by three in space.
struct Sheet {
  explicit Sheet(std::uint64_t seed, CellType type = CellType::triangle) {
    Random random(seed);
    RectangleOptions o;
    o.cells = {5, 7};
    o.size = {2.0, 3.0};
    o.type = type;
    o.jitter = 0.25;
    o.seed = seed;
    motion = test::random_motion(random);
    MeshData mesh = generate_rectangle(o);
    for (Vec3& p : mesh.points) p = motion(p);
    surface = Surface(mesh);
  }
  // Coordinates in the sheet's own axes.
  [[nodiscard]] Vec3 local(const Vec3& p) const {
    const Vec3 d = p - motion.shift;
    return {dot(d, motion.axes[0]), dot(d, motion.axes[1]), dot(d, motion.axes[2])};
  }
  test::Motion motion{};
  Surface surface{test::cube()};
};

// The distance that a light ray between mirrors at 0 and size shows.
double folded(double x, double size) {
  const double turn = x - 2.0 * size * std::floor(x / (2.0 * size));
  return turn <= size ? turn : 2.0 * size - turn;
}

TEST(SurfaceWalls, MirrorAsInABox) {
  int contacts = 0;
  const int seeds = std::max(2, test::scaled(10, 100));
  for (int seed = 1; seed <= seeds; ++seed) {
    const Sheet sheet(static_cast<std::uint64_t>(seed));
    Random random(static_cast<std::uint64_t>(seed));
    SurfacePlace place = test::random_place(sheet.surface, random);
    const Vec3 start = sheet.local(sheet.surface.point(place));
    const Vec3 way = {random.uniform(-20, 20), random.uniform(-20, 20), 0.0};
    SurfaceOptions options;
    options.max_contacts = 1000;
    const SurfaceStep step = dartcast::step(
        sheet.surface, place, sheet.motion.turned(way),
        [](const SurfaceContact& c) {
          return AfterSurfaceContact{reflected(c, c.unused), true};
        },
        options);
    ASSERT_EQ(step.end, SurfaceEnd::arrived);
    contacts += static_cast<int>(step.contacts);
    const Vec3 end = sheet.local(sheet.surface.point(place));
    EXPECT_NEAR(end.x, folded(start.x + way.x, 2.0), 1e-12);
    EXPECT_NEAR(end.y, folded(start.y + way.y, 3.0), 1e-12);
    EXPECT_NEAR(step.length, norm(way), 1e-12);
  }
  EXPECT_GT(contacts, 5 * seeds);
}

TEST(SurfaceWalls, SlideAlongBordersIntoTheCorner) {
  for (int seed = 1; seed <= std::max(2, test::scaled(20, 100)); ++seed) {
    const Sheet sheet(static_cast<std::uint64_t>(seed), seed % 2 == 0 ? CellType::triangle : CellType::quadrilateral);
    Random random(static_cast<std::uint64_t>(seed));
    const auto slide = [](const SurfaceContact& c) { return AfterSurfaceContact{slid(c, c.unused), true}; };
    SurfacePlace place = test::random_place(sheet.surface, random);
    const Vec3 start = sheet.local(sheet.surface.point(place));
    // To the side y = 3, and along it: its vertices stop nothing.
    const Vec3 way = {2.0 - start.x - 0.01, 3.5 - start.y, 0.0};
    dartcast::step(sheet.surface, place, sheet.motion.turned(way), slide);
    const Vec3 end = sheet.local(sheet.surface.point(place));
    EXPECT_NEAR(end.x, 1.99, 1e-12);
    EXPECT_NEAR(end.y, 3.0, 1e-12);
    EXPECT_EQ(place.kind(), Kind::edge);
    const SurfaceStep last = dartcast::step(sheet.surface, place, sheet.motion.turned({1.0, 0.0, 0.0}), slide);
    EXPECT_LE(last.length, 0.011);
    EXPECT_NEAR(gap(sheet.local(sheet.surface.point(place)), {2.0, 3.0, 0.0}), 0.0, 1e-12);
  }
}

// A disc of 40 triangles around its centre: a wall that bends inwards all around.
TEST(SurfaceWalls, SlideAroundABowl) {
  std::vector<Vec3> points = {{0.0, 0.0, 0.3}};
  std::vector<test::Face> faces;
  const std::uint32_t n = 40;
  for (std::uint32_t i = 0; i < n; ++i) {
    points.push_back({std::cos(2 * std::numbers::pi * i / n), std::sin(2 * std::numbers::pi * i / n), 0.0});
    faces.push_back({0, i + 1, (i + 1) % n + 1});
  }
  const Surface surface(test::surface_mesh(points, faces));
  SurfacePlace place = surface.place(test::triangle_of(surface, 0), {0.5, 0.25, 0.25});
  SurfaceOptions options;
  options.max_contacts = 200;
  double kept = 1.0;
  std::vector<SurfaceContact> contacts;
  const auto slide = [&](const SurfaceContact& c) { return AfterSurfaceContact{slid(c, c.unused), true}; };
  const SurfaceStep step = dartcast::step(surface, place, {0.2, 20.0, 0.0}, slide, options, {&contacts, nullptr});
  EXPECT_EQ(step.end, SurfaceEnd::arrived);
  EXPECT_EQ(place.kind(), Kind::edge);
  EXPECT_GT(contacts.size(), 20U);
  // At each corner the rest is projected on the next edge. After a corner it goes all the way to the next.
  for (std::size_t i = 2; i < contacts.size(); ++i) {
    kept = norm(contacts[i].displacement) / (norm(contacts[i - 1].unused));
    EXPECT_NEAR(kept, std::cos(2 * std::numbers::pi / n), 0.01);
    EXPECT_EQ(contacts[i].kind, Kind::vertex);
    EXPECT_NEAR(gap(contacts[i].point, contacts[i - 1].point), gap(points[1], points[2]), 1e-12);
  }
}

// A blocked square in the middle of a sheet, met in its corner: what looks past it goes past it.
TEST(SurfaceWalls, CornersOfBlockedFacesStopAndLetGo) {
  RectangleOptions o;
  o.cells = {3, 3};
  o.size = {3.0, 3.0};
  MeshData mesh = generate_rectangle(o);
  mesh.free.assign(9, 1);
  mesh.free[4] = 0;
  const Surface surface(mesh);
  const auto run = [&](const Vec3& p, Vec3 way, const SurfaceContactCallback& respond,
                       std::vector<SurfaceContact>& contacts) {
    SurfacePlace place;
    for (const SimplexId t : surface.triangles()) {
      const auto x = surface.corners(t);
      const double det = cross(x[1] - x[0], x[2] - x[0]).z;
      const double a = cross(x[1] - p, x[2] - p).z / det;
      const double b = cross(x[2] - p, x[0] - p).z / det;
      if (a >= 0.0 && b >= 0.0 && a + b <= 1.0) place = surface.place(t, {a, b, 1.0 - a - b});
    }
    contacts.clear();
    dartcast::step(surface, place, way, respond, {}, {&contacts, nullptr});
    return surface.point(place);
  };
  std::vector<SurfaceContact> contacts;
  // Along the edges from the left, exactly at the corner (1, 1).
  const Vec3 left = {0.5, 1.0, 0.0};
  const Vec3 end = run(left, {1.0, 0.0, 0.0}, {}, contacts);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].kind, Kind::vertex);
  EXPECT_EQ(contacts[0].time_of_impact, 0.5);
  EXPECT_EQ(end, (Vec3{1.0, 1.0, 0.0}));
  EXPECT_LE(gap(contacts[0].normal, Vec3{-1.0, -1.0, 0.0} * std::sqrt(0.5)), 1e-15);
  const auto mirror = [](const SurfaceContact& c) { return AfterSurfaceContact{reflected(c, c.unused), true}; };
  const auto slide = [](const SurfaceContact& c) { return AfterSurfaceContact{slid(c, c.unused), true}; };
  EXPECT_LE(gap(run(left, {1.0, 0.0, 0.0}, mirror, contacts), {1.0, 0.5, 0.0}), 1e-15);
  EXPECT_LE(gap(run(left, {1.0, 0.0, 0.0}, slide, contacts), {1.25, 0.75, 0.0}), 1e-15);
  // To the left along the lower side, and straight on behind its end.
  const Vec3 below = {1.5, 0.75, 0.0};
  EXPECT_LE(gap(run(below, {-1.0, 1.0, 0.0}, slide, contacts), {0.5, 1.0, 0.0}), 1e-15);
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_EQ(contacts[1].kind, Kind::vertex);
  // Up against the side: it stops there, or comes back.
  EXPECT_EQ(run(below, {0.0, 0.5, 0.0}, {}, contacts), (Vec3{1.5, 1.0, 0.0}));
  EXPECT_EQ(contacts.at(0).time_of_impact, 0.5);
  EXPECT_LE(gap(contacts.at(0).unused, {0.0, 0.25, 0.0}), 1e-15);
  EXPECT_LE(gap(run(below, {0.0, 0.5, 0.0}, mirror, contacts), below), 1e-15);
  // A step that ends exactly on the wall meets it.
  EXPECT_EQ(run({1.75, 2.25, 0.0}, {0.0, -0.25, 0.0}, {}, contacts), (Vec3{1.75, 2.0, 0.0}));
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].time_of_impact, 1.0);
}

TEST(SurfaceWalls, AtRestNothingIsMet) {
  const Sheet sheet(1);
  SurfacePlace place;
  for (const SimplexId t : sheet.surface.triangles()) {
    for (unsigned edge = 0; edge < 3; ++edge) {
      if (!sheet.surface.across(t, edge).wall) continue;
      std::array<double, 3> w = {0.5, 0.5, 0.5};
      w[edge] = 0.0;
      place = sheet.surface.place(t, w);
    }
  }
  const SurfacePlace before = place;
  const SurfaceStep step = dartcast::step(sheet.surface, place, {});
  EXPECT_EQ(step.contacts, 0U);
  EXPECT_EQ(step.end, SurfaceEnd::arrived);
  EXPECT_EQ(place, before);
  // Normal to the surface is no way either, up to rounding.
  const SurfaceStep up = dartcast::step(sheet.surface, place, sheet.surface.normal(place.triangle));
  EXPECT_LE(up.length, 1e-15);
}

TEST(SurfaceWalls, StopWhoStartsAtABorderVertexOutwards) {
  const Sheet sheet(4);
  int corners = 0;
  for (const SimplexId t : sheet.surface.triangles()) {
    for (unsigned k = 0; k < 3; ++k) {
      const Vec3 x = sheet.local(sheet.surface.corners(t)[k]);
      const bool at_corner = gap(x, {0.0, 0.0, 0.0}) < 1e-9;
      const bool at_side = std::abs(x.x) < 1e-9 && x.y > 0.1 && x.y < 2.9;
      if (!at_corner && !at_side) continue;
      ++corners;
      std::array<double, 3> w = {};
      w[k] = 1.0;
      const SurfacePlace start = sheet.surface.place(t, w);
      for (const Vec3& way : {Vec3{-1.0, 0.1, 0.0}, Vec3{-0.1, 0.0, 0.0}, Vec3{-1.0, -1.0, 0.0}}) {
        SurfacePlace place = start;
        std::vector<SurfaceContact> contacts;
        const Vec3 turned = sheet.motion.turned(way);
        dartcast::step(sheet.surface, place, turned, {}, {}, {&contacts, nullptr});
        EXPECT_EQ(place, start);
        ASSERT_EQ(contacts.size(), 1U);
        EXPECT_EQ(contacts[0].kind, Kind::vertex);
        EXPECT_EQ(contacts[0].time_of_impact, 0.0);
        EXPECT_LE(gap(contacts[0].unused, turned), 1e-14);
      }
      SurfacePlace place = start;
      EXPECT_EQ(dartcast::step(sheet.surface, place, sheet.motion.turned({0.1, 0.05, 0.0})).contacts, 0U);
      EXPECT_LE(gap(sheet.local(sheet.surface.point(place)), x + Vec3{0.1, 0.05, 0.0}), 1e-14);
    }
  }
  EXPECT_GT(corners, 3);
}

TEST(SurfaceWalls, AreThereAtOnce) {
  Surface surface(test::cube());
  // On the edge between faces 0 (bottom) and 2 (front), as a place of the bottom.
  SurfacePlace place;
  for (const SimplexId t : surface.triangles()) {
    if (surface.map().source(t.cell) != 0) continue;
    for (unsigned e = 0; e < 3; ++e) {
      const AcrossEdge across = surface.across(t, e);
      if (!across.face.valid() || surface.map().source(across.triangle.cell) != 2) continue;
      std::array<double, 3> w = {0.25, 0.75, 0.5};
      w[e] = 0.0;
      place = surface.place(t, w);
    }
  }
  ASSERT_EQ(place.kind(), Kind::edge);
  const Cell bottom = place.triangle.cell;
  const Vec3 point = surface.point(place);
  surface.set_free(bottom, false);
  // It is on the front, too: there it goes on, and not back.
  SurfacePlace moved = place;
  EXPECT_EQ(dartcast::step(surface, moved, {0.1, 0.0, 0.0}).end, SurfaceEnd::arrived);
  EXPECT_EQ(surface.map().source(moved.triangle.cell), 2U);
  EXPECT_LE(gap(surface.point(moved), point + Vec3{0.1, 0.0, 0.0}), 1e-15);
  // Inside of a blocked face it is held.
  SurfacePlace inside = surface.place({bottom, 0}, {1.0, 1.0, 1.0});
  const SurfacePlace before = inside;
  EXPECT_EQ(dartcast::step(surface, inside, {0.1, 0.0, 0.0}).end, SurfaceEnd::held);
  EXPECT_EQ(inside, before);
  surface.set_free(bottom, true);
  EXPECT_EQ(dartcast::step(surface, inside, {0.1, 0.0, 0.0}).end, SurfaceEnd::arrived);
  EXPECT_NE(inside, before);
  EXPECT_THROW(surface.set_free(Cell(4, 77), true), InvalidArgument);
}

TEST(SurfaceWalls, AtAVertexOfABlockedFaceAFreeOneTakesOver) {
  Surface surface(test::cube());
  const SimplexId t = test::triangle_of(surface, 0);
  SurfacePlace place = surface.place(t, {1.0, 0.0, 0.0});
  const Vec3 point = surface.point(place);
  surface.set_free(t.cell, false);
  const SurfaceStep step = dartcast::step(surface, place, {0.0, 0.0, 0.5});
  EXPECT_NE(step.end, SurfaceEnd::held);
  EXPECT_TRUE(surface.map().is_free(place.triangle.cell));
  EXPECT_LE(gap(surface.point(place), point + Vec3{0.0, 0.0, step.length}), 1e-15);
}

TEST(SurfaceWalls, LongStepsStopAtTheLimitAndGoOn) {
  const Surface surface(test::bumpy(3, 0.2, 7));
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    SurfacePlace once = test::random_place(surface, random);
    SurfacePlace pieces = once;
    const Vec3 way = test::random_vector(random) * 5.0;
    const SurfaceStep whole = dartcast::step(surface, once, way);
    ASSERT_EQ(whole.end, SurfaceEnd::arrived);
    SurfaceOptions few;
    few.max_crossings = 3;
    Vec3 left = way;
    double length = 0.0;
    int rounds = 0;
    SurfaceStep step;
    do {
      step = dartcast::step(surface, pieces, left, {}, few);
      left = step.remaining;
      length += step.length;
      ASSERT_LE(step.crossings, 3U);
      ASSERT_LT(++rounds, 1000);
    } while (step.end == SurfaceEnd::limit);
    ASSERT_EQ(step.end, SurfaceEnd::arrived);
    EXPECT_NEAR(length, whole.length, 1e-12);
    EXPECT_LE(gap(surface.point(pieces), surface.point(once)), 1e-10);
  }
}

TEST(SurfaceWalls, StopAfterSoManyContacts) {
  const Sheet sheet(3);
  Random random(3);
  SurfacePlace place = test::random_place(sheet.surface, random);
  SurfaceOptions options;
  options.max_contacts = 5;
  const auto mirror = [](const SurfaceContact& c) { return AfterSurfaceContact{reflected(c, c.unused), true}; };
  const Vec3 way = sheet.motion.turned({100.0, 37.0, 0.0});
  const SurfaceStep step = dartcast::step(sheet.surface, place, way, mirror, options);
  EXPECT_EQ(step.contacts, 5U);
  EXPECT_EQ(step.end, SurfaceEnd::stopped);
  EXPECT_NEAR(step.length + norm(step.remaining), norm(way), 1e-12);
}

TEST(SurfaceWalls, AnswerVectors) {
  SurfaceContact wall;
  wall.normal = {0.0, 1.0, 0.0};
  wall.sides = {Vec3{1.0, 0.0, 0.0}, Vec3{-1.0, 0.0, 0.0}};
  EXPECT_EQ(reflected(wall, {3.0, -2.0, 0.0}), (Vec3{3.0, 2.0, 0.0}));
  EXPECT_EQ(reflected(wall, {3.0, -2.0, 0.0}, 0.25), (Vec3{3.0, 0.5, 0.0}));
  EXPECT_EQ(reflected(wall, {3.0, 2.0, 0.0}, 0.25), (Vec3{3.0, 2.0, 0.0}));
  EXPECT_EQ(slid(wall, {3.0, -2.0, 0.0}), (Vec3{3.0, 0.0, 0.0}));
  EXPECT_EQ(slid(wall, {-3.0, -2.0, 0.0}), (Vec3{-3.0, 0.0, 0.0}));
  EXPECT_EQ(slid(wall, {-3.0, 2.0, 0.0}), (Vec3{-3.0, 2.0, 0.0}));
  // A corner of 60 degrees, open upwards: what does not point into it ends there, or runs along a side.
  wall.kind = Kind::vertex;
  wall.sides = {Vec3{0.5, std::sqrt(0.75), 0.0}, Vec3{-0.5, std::sqrt(0.75), 0.0}};
  EXPECT_EQ(slid(wall, {0.1, 1.0, 0.0}), (Vec3{0.1, 1.0, 0.0}));
  EXPECT_EQ(slid(wall, {0.1, -1.0, 0.0}), Vec3{});
  EXPECT_LE(gap(slid(wall, {1.0, 0.0, 0.0}), wall.sides[0] * 0.5), 1e-15);
}

TEST(SurfaceWalls, BadAnswersChangeNothing) {
  const Sheet sheet(2);
  Random random(2);
  std::vector<SurfacePlace> places(3, test::random_place(sheet.surface, random));
  const auto before = places;
  const std::vector<Vec3> ways(3, sheet.motion.turned({10.0, 0.0, 0.0}));
  const auto nan = [](const SurfaceContact&) { return AfterSurfaceContact{{std::nan(""), 0.0, 0.0}, false}; };
  EXPECT_THROW(advance(sheet.surface, places, ways, nan), InvalidArgument);
  EXPECT_EQ(places, before);
  const auto failing = [](const SurfaceContact& c) -> AfterSurfaceContact {
    if (c.particle == 1) throw std::runtime_error("no");
    return {};
  };
  EXPECT_THROW(advance(sheet.surface, places, ways, failing), std::runtime_error);
  EXPECT_EQ(places, before);
}

}  // namespace dartcast::walls_test
