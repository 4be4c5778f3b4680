// Surfaces themselves: what is refused and repaired, bending, location, threads, and extreme shapes and sizes.
#include "dartcast/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "support/surface_meshes.hpp"
#include "support/tier.hpp"
#include "surface/check_surface.hpp"

namespace dartcast::surface_test {

using test::gap;

std::string first_defect(MeshData mesh) {
  const MeshReport report = check_and_repair_surface(mesh);
  EXPECT_EQ(report.valid(), report.defects.empty());
  if (report.defects.empty()) return "";
  try {
    const Surface surface(mesh);
    ADD_FAILURE() << "a defect, but no exception";
  } catch (const InvalidMesh& e) {
    EXPECT_NE(std::string(e.what()).find(report.defects.front().message), std::string::npos);
  }
  return report.defects.front().kind;
}

TEST(Surfaces, AreRefusedWithAReason) {
  const MeshData good = test::cube();
  EXPECT_EQ(first_defect(good), "");
  EXPECT_EQ(first_defect({}), "empty");
  MeshData mesh = good;
  mesh.points[3].y = std::nan("");
  EXPECT_EQ(first_defect(mesh), "not_finite");
  mesh.points[3].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(first_defect(mesh), "not_finite");
  mesh.points[3].y = 1e200;
  EXPECT_EQ(first_defect(mesh), "out_of_range");
  mesh.points[3].y = 1e-200;
  EXPECT_EQ(first_defect(mesh), "flat") << "it counts as 0";
  mesh = good;
  mesh.connectivity[5] = 8;
  EXPECT_EQ(first_defect(mesh), "id_out_of_range");
  mesh = good;
  mesh.connectivity[0] = mesh.connectivity[2];
  EXPECT_EQ(first_defect(mesh), "repeated_corner");
  mesh = good;
  mesh.offsets[2] = 7;
  EXPECT_EQ(first_defect(mesh), "structure");
  mesh = good;
  mesh.free = {1, 1};
  EXPECT_EQ(first_defect(mesh), "structure");
  MeshData space;
  space.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  space.add_cell(CellType::tetrahedron, std::array<std::uint32_t, 4>{0, 1, 2, 3});
  EXPECT_EQ(first_defect(space), "structure");
  // A third face at an edge.
  mesh = good;
  mesh.points.push_back({0.5, -1.0, -1.0});
  mesh.add_cell(CellType::triangle, std::array<std::uint32_t, 3>{0, 1, 8});
  EXPECT_EQ(first_defect(mesh), "face_shared");
}

TEST(Surfaces, WithoutAreaAreRefusedExactly) {
  // On a line in no direction of the axes, to the last bit and beside it.
  const Vec3 a = {0.1, 0.2, 0.3};
  const Vec3 b = {0.4, 0.8, 1.2};
  const Vec3 c = {0.2, 0.4, 0.6};
  EXPECT_EQ(first_defect(test::surface_mesh({a, b, c}, {{0, 1, 2}})), "flat");
  for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    Vec3 beside = c;
    beside.*axis = std::nextafter(c.*axis, 1.0);
    EXPECT_EQ(first_defect(test::surface_mesh({a, b, beside}, {{0, 1, 2}})), "");
  }
  EXPECT_EQ(first_defect(test::surface_mesh({{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {3, 6, 9}}, {{0, 1, 2, 3}})), "flat");
  // A fan with a flat triangle is no division of the polygon, but others are.
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 1}, {0, 1, 1}};
  EXPECT_EQ(first_defect(test::surface_mesh(points, {{0, 1, 2, 3, 4}})), "");
}

TEST(Surfaces, AreTurnedWhereTheyCanBe) {
  const MeshData good = test::bumpy(2, 0.2, 1);
  MeshData mixed = good;
  std::size_t turned = 0;
  for (std::size_t c = 1; c < mixed.cell_count(); c += 3) {
    std::swap(mixed.connectivity[3 * c], mixed.connectivity[3 * c + 1]);
    ++turned;
  }
  MeshReport report = check_and_repair_surface(mixed);
  EXPECT_TRUE(report.valid());
  EXPECT_EQ(report.parts, 1U);
  ASSERT_EQ(report.repairs.size(), 1U);
  EXPECT_EQ(report.repairs[0].kind, "orientation");
  EXPECT_EQ(report.repairs[0].count, turned);
  const Surface surface(mixed);
  double inside = 0.0;
  for (const SimplexId t : surface.triangles())
    inside += dot(surface.normal(t), surface.corners(t)[0]) > 0.0 ? 1.0 : 0.0;
  EXPECT_EQ(inside, static_cast<double>(good.cell_count()));
  // A band with a half turn has one side.
  std::vector<Vec3> points;
  std::vector<test::Face> faces;
  for (std::uint32_t i = 0; i < 12; ++i) {
    const double t = 2.0 * std::numbers::pi * i / 12;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1.0 + s * std::cos(t / 2);
      points.push_back({r * std::cos(t), r * std::sin(t), s * std::sin(t / 2)});
    }
    const std::uint32_t j = (i + 1) % 12;
    faces.push_back(i == 11 ? test::Face{2 * i, 1, 0, 2 * i + 1} : test::Face{2 * i, 2 * j, 2 * j + 1, 2 * i + 1});
  }
  EXPECT_EQ(first_defect(test::surface_mesh(points, faces)), "not_orientable");
}

TEST(Surfaces, CarryParticlesWhenTheyBend) {
  const MeshData mesh = test::sphere(4);
  Surface surface(mesh);
  Random random(1);
  std::vector<SurfacePlace> places;
  std::vector<Vec3> ways;
  for (int i = 0; i < 200; ++i) {
    places.push_back(test::random_place(surface, random));
    ways.push_back(test::random_vector(random) * 0.1);
  }
  std::vector<Vec3> points = mesh.points;
  for (int k = 1; k <= test::scaled(50, 500); ++k) {
    const double radius = 1.0 + 0.5 * std::sin(0.3 * k);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& p = mesh.points[i];
      points[i] = {radius * p.x, radius * p.y, radius * p.z * (1.0 + 0.2 * std::sin(0.1 * k))};
    }
    const auto before = places;
    surface.move(points, Threads{2});
    const SurfaceReport report = advance(surface, places, std::vector<Vec3>(places.size()));
    ASSERT_EQ(places, before);
    advance(surface, places, ways);
    for (const SurfacePlace& place : places) {
      // Within the sag of triangles with edges up to 0.12 below the ellipsoid.
      Vec3 p = surface.point(place) * (1.0 / radius);
      p.z /= 1.0 + 0.2 * std::sin(0.1 * k);
      ASSERT_LE(norm(p), 1.0 + 1e-15);
      ASSERT_GE(norm(p), 1.0 - 0.005);
      const auto v = surface.corners(place.triangle);
      ASSERT_LE(std::abs(dot(surface.point(place) - v[0], surface.normal(place.triangle))), 1e-15);
    }
    for (const SurfaceStep& s : report.steps) ASSERT_EQ(s.end, SurfaceEnd::arrived);
  }
}

TEST(Surfaces, RefuseAStepWithoutAContact) {
  const Surface surface(test::cube());
  SurfacePlace place = surface.place(surface.triangles().front(), {1.0, 1.0, 1.0});
  const SurfacePlace before = place;
  SurfaceOptions options;
  options.max_contacts = 0;
  EXPECT_THROW(step(surface, place, {0.1, 0.0, 0.0}, {}, options), InvalidArgument);
  EXPECT_EQ(place, before);
}

TEST(Surfaces, RefuseMovesThatCannotBe) {
  const MeshData mesh = test::cube();
  Surface surface(mesh);
  std::vector<Vec3> points = mesh.points;
  points.pop_back();
  EXPECT_THROW(surface.move(points), InvalidArgument);
  points = mesh.points;
  points[2].x = std::nan("");
  EXPECT_THROW(surface.move(points), InvalidArgument);
  points = mesh.points;
  points[7] = points[6];
  try {
    surface.move(points);
    ADD_FAILURE();
  } catch (const InvalidMesh& e) {
    // Corner 7 on corner 6: faces 1, 3 and 5 have it, but the fan of 5 from corner 1 keeps its area.
    EXPECT_NE(std::string(e.what()).find("2 faces"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("the first: 1, 3"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(std::equal(mesh.points.begin(), mesh.points.end(), surface.positions().begin()));
}

TEST(Surfaces, LocateTheNearestPlace) {
  Random random(4);
  for (int seed = 1; seed <= 4; ++seed) {
    const Surface surface(seed == 4 ? test::castle() : test::bumpy(2, 0.4, static_cast<std::uint64_t>(seed)));
    const SurfaceLocator locator(surface);
    for (int i = 0; i < test::scaled(200, 5000); ++i) {
      Vec3 x = test::random_vector(random) * (i % 10 == 0 ? 100.0 : 1.5);
      if (seed == 4) x = {random.below(9) - 2.0, random.below(9) - 2.0, random.below(9) - 2.0};  // ties
      const SurfaceLocation found = locator.nearest(surface, x);
      SurfaceLocation best;
      best.distance = std::numeric_limits<double>::infinity();
      std::uint32_t best_face = 0;
      for (const SimplexId t : surface.triangles()) {
        const SurfaceLocation here = nearest_in_triangle(surface, t, x);
        const std::uint32_t face = surface.map().source(t.cell);
        const bool before = face < best_face || (face == best_face && t < best.place.triangle);
        if (here.distance < best.distance || (here.distance == best.distance && before)) {
          best = here;
          best_face = face;
        }
      }
      ASSERT_EQ(found.place, best.place);
      ASSERT_EQ(found.distance, best.distance);
      ASSERT_DOUBLE_EQ(found.distance, gap(surface.point(found.place), x));
    }
    EXPECT_THROW(static_cast<void>(locator.nearest(surface, {std::nan(""), 0, 0})), InvalidArgument);
  }
}

TEST(Surfaces, LocateFeetOnTriangles) {
  Random random(6);
  for (int i = 0; i < test::scaled(2000, 100000); ++i) {
    const Surface surface(test::surface_mesh(
        {test::random_vector(random), test::random_vector(random), test::random_vector(random)}, {{0, 1, 2}}));
    const SimplexId t = surface.triangles()[0];
    const Vec3 x = test::random_vector(random) * 2.0;
    const SurfaceLocation found = nearest_in_triangle(surface, t, x);
    // Nothing is nearer: not a step along the surface, from there.
    for (int k = 0; k < 10; ++k) {
      SurfacePlace near = found.place;
      dartcast::step(surface, near, test::random_vector(random) * (k < 5 ? 0.01 : 0.5));
      ASSERT_GE(gap(surface.point(near), x), found.distance * (1.0 - 1e-14));
    }
  }
}

TEST(Surfaces, GiveTheSameBitsForAnyThreads) {
  MeshData mesh = test::bumpy(3, 0.3, 2);
  Random random(2);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) mesh.free.push_back(random.uniform() < 0.2 ? 0 : 1);
  const Surface surface(mesh);
  std::vector<SurfacePlace> start;
  std::vector<Vec3> ways;
  for (int i = 0; i < 3000; ++i) {
    start.push_back(test::random_place(surface, random));
    ways.push_back(test::random_vector(random));
  }
  const auto mirror = [](const SurfaceContact& c) { return AfterSurfaceContact{reflected(c, c.unused, 0.7), true}; };
  const auto run = [&](unsigned threads, std::vector<SurfacePlace>& places) {
    places = start;
    return advance(surface, places, ways, mirror, {}, Threads{threads});
  };
  std::vector<SurfacePlace> one;
  const SurfaceReport first = run(1, one);
  EXPECT_GT(first.contacts.size(), 1000U);
  for (const unsigned threads : {2U, 3U, 8U}) {
    std::vector<SurfacePlace> many;
    const SurfaceReport report = run(threads, many);
    ASSERT_EQ(many, one);
    ASSERT_EQ(report.contacts.size(), first.contacts.size());
    for (std::size_t i = 0; i < report.contacts.size(); ++i) {
      ASSERT_EQ(report.contacts[i].particle, first.contacts[i].particle);
      ASSERT_EQ(report.contacts[i].time_of_impact, first.contacts[i].time_of_impact);
      ASSERT_EQ(report.contacts[i].place, first.contacts[i].place);
    }
    for (std::size_t i = 0; i < report.steps.size(); ++i)
      ASSERT_EQ(report.steps[i].direction, first.steps[i].direction);
  }
}

// All in powers of two: sizes at both ends of the range give the same bits.
TEST(Surfaces, MayBeOfAnySize) {
  const MeshData mesh = test::castle();
  const Surface unit(mesh);
  for (const double scale : {0x1p-290, 0x1p+290}) {
    MeshData scaled = mesh;
    for (Vec3& p : scaled.points) p *= scale;
    const Surface surface(scaled);
    Random random(1);
    for (int i = 0; i < 200; ++i) {
      SurfacePlace a = test::random_place(unit, random);
      SurfacePlace b = a;
      const Vec3 way = test::random_vector(random) * 5.0;
      const SurfaceStep one = dartcast::step(unit, a, way);
      const SurfaceStep other = dartcast::step(surface, b, way * scale);
      ASSERT_EQ(a, b);
      ASSERT_EQ(one.direction, other.direction);
      ASSERT_EQ(one.length * scale, other.length);
      ASSERT_EQ(one.crossings, other.crossings);
    }
  }
}

// Triangles as thin as doubles allow, and points at all distances: whatever they do, particles stay on them.
TEST(Surfaces, MayBeHostile) {
  Random random(9);
  std::uint64_t crossings = 0;
  for (int scene = 0; scene < test::scaled(100, 5000); ++scene) {
    MeshData mesh = test::sphere(1);
    for (Vec3& p : mesh.points) {
      const double size =
          std::ldexp(1.0, static_cast<int>(random.below(scene % 2 == 0 ? 580 : 60)) - (scene % 2 == 0 ? 290 : 30));
      p = test::random_vector(random) * size;
      if (scene % 3 == 0) p.z *= 0x1p-50;
      if (scene % 5 == 0)
        p = {1.0 + 0x1p-52 * random.below(8), 1.0 + 0x1p-52 * random.below(8), 1.0 + 0x1p-52 * random.below(8)};
    }
    if (!check_and_repair_surface(mesh).valid()) continue;
    const Surface surface(mesh);
    SurfaceOptions options;
    options.max_crossings = 60;
    for (int i = 0; i < 10; ++i) {
      SurfacePlace place = test::random_place(surface, random);
      for (int k = 0; k < 20; ++k) {
        const double size = std::ldexp(1.0, static_cast<int>(random.below(590)) - 295);
        const auto v = surface.corners(place.triangle);
        const Vec3 way = k % 2 == 0 ? test::random_vector(random) * size : (v[k % 3] - v[(k + 1) % 3]) * 0.7;
        const SurfaceStep step = dartcast::step(surface, place, way, {}, options);
        ASSERT_TRUE(surface.contains(place));
        ASSERT_TRUE(step.end == SurfaceEnd::arrived || step.end == SurfaceEnd::limit);
        ASSERT_TRUE(std::isfinite(step.length));
        ASSERT_TRUE(is_finite(step.direction));
        ASSERT_TRUE(is_finite(surface.point(place)));
        crossings += step.crossings;
      }
    }
  }
  EXPECT_GT(crossings, 100U);
}

TEST(Surfaces, RefuseWrongArguments) {
  const Surface surface(test::cube());
  const SimplexId t = surface.triangles()[0];
  EXPECT_THROW(static_cast<void>(surface.place(t, {0.0, 0.0, 0.0})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(surface.place(t, {1.0, -0.1, 0.0})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(surface.place(t, {1.0, std::nan(""), 0.0})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(surface.place({t.cell, 2}, {1.0, 1.0, 1.0})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(surface.place({Cell(0, 0), 0}, {1.0, 1.0, 1.0})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(surface.place({}, {1.0, 1.0, 1.0})), InvalidArgument);
  SurfacePlace place = surface.place(t, {1e300, 1e300, 2e300});
  EXPECT_EQ(place.weights, (std::array<double, 3>{0.25, 0.25, 0.5}));
  for (const double bad : {std::nan(""), HUGE_VAL, 1e100}) {
    EXPECT_THROW(step(surface, place, {0.0, bad, 0.0}), InvalidArgument);
  }
  SurfacePlace broken = place;
  broken.weights[0] = 0.3;
  EXPECT_THROW(step(surface, broken, {0.1, 0.0, 0.0}), InvalidArgument);
  broken.weights[0] = std::nan("");
  EXPECT_THROW(step(surface, broken, {0.1, 0.0, 0.0}), InvalidArgument);
  std::vector<SurfacePlace> places = {place, broken};
  EXPECT_THROW(advance(surface, places, std::vector<Vec3>(1)), InvalidArgument);
  try {
    advance(surface, places, std::vector<Vec3>(2));
    ADD_FAILURE();
  } catch (const InvalidArgument& e) {
    EXPECT_NE(std::string(e.what()).find("particle 1"), std::string::npos);
  }
}

TEST(Surfaces, HaveOnePointForAPlaceFromBothSides) {
  Random random(3);
  const Surface surface(test::bumpy(2, 0.4, 3));
  for (const SimplexId t : surface.triangles()) {
    for (unsigned e = 0; e < 3; ++e) {
      const AcrossEdge across = surface.across(t, e);
      for (const double s : {0.5, random.uniform(0.01, 0.99)}) {
        SurfacePlace here = surface.place(t, {1.0, 1.0, 1.0});
        SurfacePlace there = surface.place(across.triangle, {1.0, 1.0, 1.0});
        here.weights = {};
        here.weights[(e + 1) % 3] = s;
        here.weights[(e + 2) % 3] = 1.0 - s;
        there.weights = {};
        there.weights[(across.edge + 1) % 3] = 1.0 - s;
        there.weights[(across.edge + 2) % 3] = s;
        ASSERT_EQ(surface.point(here), surface.point(there));
      }
      const AcrossEdge back = surface.across(across.triangle, across.edge);
      ASSERT_EQ(back.triangle, t);
      ASSERT_EQ(back.edge, e);
    }
  }
}

}  // namespace dartcast::surface_test
