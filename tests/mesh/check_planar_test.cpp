// Every kind of finding in meshes of the plane, made on purpose, one at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/random.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_check.hpp"
#include "mesh/faces.hpp"
#include "mesh/orientation.hpp"
#include "support/findings.hpp"
#include "support/meshes.hpp"
#include "support/mixed_mesh.hpp"
#include "support/planar_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::inspect_planar_test {

using test::add;
using test::kinds;
using test::Kinds;

void add_edge(MeshData& mesh, std::uint32_t a, std::uint32_t b, std::int32_t tag) {
  mesh.add_patch_face(std::array{a, b}, tag);
}

/// A unit square, and a triangle to its right.
MeshData house() {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, .5, 0}};
  add(mesh, CellType::quadrilateral, {0, 1, 2, 3});
  add(mesh, CellType::triangle, {1, 4, 2});
  add_edge(mesh, 0, 1, 5);
  return mesh;
}

/// One polygon of all points.
MeshData polygon(std::vector<Vec3> points) {
  MeshData mesh;
  mesh.points = std::move(points);
  std::vector<std::uint32_t> corners(mesh.points.size());
  std::iota(corners.begin(), corners.end(), 0U);
  add(mesh, CellType::polygon, corners);
  return mesh;
}

TEST(InspectPlanar, GoodCellsAreAccepted) {
  MeshData mesh = house();
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(report.verdict(), Verdict::accept);
  EXPECT_EQ(report.dimension, 2);
  EXPECT_EQ(report.parts, 1U);
  EXPECT_EQ(report.cells, (Kinds{{"quadrilateral", 1}, {"triangle", 1}}));
  EXPECT_EQ(mesh.connectivity, house().connectivity);
  EXPECT_EQ(mesh.patch_faces, house().patch_faces);
}

TEST(InspectPlanar, GeneratedMeshesAreAcceptedAsTheyAre) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RectangleOptions o;
    o.cells = {9, 7};
    o.size = {1.0, 1.0};
    o.mixed = true;
    o.jitter = 0.3;
    o.seed = seed;
    const MeshData before = generate_rectangle(o);
    MeshData mesh = before;
    const MeshReport report = check_and_repair(mesh);
    EXPECT_EQ(report.verdict(), Verdict::accept);
    EXPECT_EQ(report.parts, 1U);
    EXPECT_EQ(mesh.points, before.points);
    EXPECT_EQ(mesh.connectivity, before.connectivity);
    EXPECT_EQ(mesh.patch_faces, before.patch_faces);
  }
}

TEST(InspectPlanar, PointsAreMovedToThePlane) {
  MeshData mesh = house();
  for (Vec3& p : mesh.points) p.z = -2.5;
  mesh.points.push_back({0, 0, 7});  // unused: its z does not matter
  const MeshReport report = check_and_repair(mesh);
  ASSERT_EQ(kinds(report.repairs), (Kinds{{"unused_points", 1}, {"plane", 5}}));
  EXPECT_NE(report.repairs.back().message.find("z = -2.5"), std::string::npos);
  EXPECT_EQ(mesh.points, house().points);
  MeshData negative_zero = house();
  for (Vec3& p : negative_zero.points) p.z = -0.0;
  EXPECT_EQ(check_and_repair(negative_zero).verdict(), Verdict::accept);
  EXPECT_FALSE(std::signbit(negative_zero.points[0].z));
}

TEST(InspectPlanar, SurfacesInSpaceAreRefused) {
  MeshData mesh = house();
  mesh.points[4].z = 1e-90;
  const MeshReport report = check_and_repair(mesh);
  ASSERT_EQ(kinds(report.defects), (Kinds{{"no_volume", 2}}));
  EXPECT_NE(report.defects[0].message.find("a surface in space"), std::string::npos);
}

TEST(InspectPlanar, ClockwiseCellsAreTurned) {
  MeshData mesh = house();
  std::reverse(mesh.connectivity.begin(), mesh.connectivity.begin() + 4);
  add(mesh, CellType::polygon, {2, 5, 6, 3});
  mesh.points.insert(mesh.points.end(), {{1, 2, 0}, {0, 2, 0}});
  std::reverse(mesh.connectivity.begin() + 7, mesh.connectivity.end());
  const MeshReport report = check_and_repair(mesh);
  ASSERT_EQ(kinds(report.repairs), (Kinds{{"orientation", 2}}));
  EXPECT_EQ(report.repairs[0].first, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(report.verdict(), Verdict::repair);
  EXPECT_EQ(test::area(mesh), 2.5);
}

TEST(InspectPlanar, FlatCells) {
  MeshData mesh = house();
  mesh.points[4] = {1, 3, 0};
  EXPECT_EQ(kinds(check_and_repair(mesh).defects)["flat"], 1U);
  mesh.points[4] = {std::nextafter(1.0, 2.0), 3, 0};
  EXPECT_EQ(kinds(check_and_repair(mesh).defects).count("flat"), 0U);
  MeshData line = polygon({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {1.5, 1.5, 0}});
  EXPECT_EQ(kinds(check_and_repair(line).defects), (Kinds{{"flat", 1}}));
}

TEST(InspectPlanar, CellsThatAreNotConvex) {
  const auto defects = [](std::vector<Vec3> points) {
    MeshData mesh = polygon(points);
    const Kinds found = kinds(check_and_repair(mesh).defects);
    // The other way around it is as bad.
    std::reverse(points.begin(), points.end());
    MeshData reversed = polygon(points);
    EXPECT_EQ(kinds(check_and_repair(reversed).defects), found);
    return found;
  };
  const Kinds none, inverted = {{"inverted", 1}};
  EXPECT_EQ(defects({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}), none);
  EXPECT_EQ(defects({{0, 0, 0}, {2, 0, 0}, {1, .5, 0}, {0, 2, 0}}), inverted);                      // a dent
  EXPECT_EQ(defects({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}}), inverted);                       // crossed
  EXPECT_EQ(defects({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 1, 0}}), none);     // straight corners
  EXPECT_EQ(defects({{0, 0, 0}, {3, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}}), inverted);            // to and fro
  EXPECT_EQ(defects({{0, 0, 0}, {3, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}), inverted);            // a spike
  EXPECT_EQ(defects({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 2, 0}, {0, 2, 0}}), inverted);            // no length
  EXPECT_EQ(defects({{2, 0, 0}, {-1, 1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}})["inverted"], 1U);  // a star
  EXPECT_EQ(defects({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}),
            inverted);  // twice around
}

/// Weakly convex and counterclockwise, slowly: every corner on the left of or on each edge's line, and the area that of
/// the hull, which a polygon that goes around twice exceeds. Integers: exact.
bool is_weakly_convex(const std::vector<Vec3>& p) {
  const std::size_t n = p.size();
  double twice_area = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 &a = p[i], &b = p[(i + 1) % n];
    if (a == b) return false;
    for (const Vec3& c : p) {
      if (cross(b - a, c - a).z < 0) return false;
    }
    twice_area += cross(a, b).z;
  }
  if (twice_area <= 0) return false;
  double perimeter_turns = 0;  // exterior angles, in radians: 2 pi where it goes around once
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 u = p[(i + 1) % n] - p[i], v = p[(i + 2) % n] - p[(i + 1) % n];
    perimeter_turns += std::atan2(cross(u, v).z, dot(u, v));
  }
  return perimeter_turns < 7.0;
}

TEST(InspectPlanar, ConvexityOfRandomPolygonsAgreesWithASlowTest) {
  Random random(11);
  std::size_t convex = 0, mirrored = 0;
  const auto rounds = test::scaled(200000U, 5000000U);
  for (std::uint32_t round = 0; round < rounds; ++round) {
    std::vector<Vec3> points(3 + random.below(4));
    const std::uint32_t grid = 2 + random.below(3);
    for (Vec3& p : points) p = {double(random.below(grid)), double(random.below(grid)), 0.0};
    MeshData mesh = polygon(points);
    std::vector<Vec3> reversed(points.rbegin(), points.rend());
    const Orientation found = orient_cell(mesh, 0);
    if (is_weakly_convex(points)) {
      ++convex;
      EXPECT_EQ(found, Orientation::positive);
    } else if (is_weakly_convex(reversed)) {
      ++mirrored;
      EXPECT_EQ(found, Orientation::mirrored);
      EXPECT_EQ(mesh.connectivity[0], 0U);
      EXPECT_EQ(mesh.connectivity[1], points.size() - 1);
    } else {
      EXPECT_TRUE(found == Orientation::inverted || found == Orientation::flat);
    }
  }
  EXPECT_GT(convex, rounds / 100);
  EXPECT_GT(mirrored, rounds / 100);
}

TEST(InspectPlanar, StructureOfCells) {
  const auto refused = [](auto&& change) {
    MeshData mesh = house();
    change(mesh);
    return kinds(check_and_repair(mesh).defects);
  };
  EXPECT_EQ(refused([](MeshData& m) { add(m, CellType::polygon, {0, 1}); }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { add(m, CellType::polygon, {}); }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { add(m, CellType::polygon, std::vector<std::uint32_t>(1001, 0)); }),
            (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { add(m, CellType::triangle, {0, 1, 2, 3}); }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { add(m, CellType::tetrahedron, {0, 1, 2, 3}); }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.types[1] = test::no_cell_type; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.connectivity[6] = 5; }), (Kinds{{"id_out_of_range", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.connectivity[6] = 1; }), (Kinds{{"repeated_corner", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { add(m, CellType::polygon, {0, 1, 2, 1}); }), (Kinds{{"repeated_corner", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.add_patch_face(std::array{0U, 1U, 2U}, 1); }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { add_edge(m, 0, 9, 1); }), (Kinds{{"id_out_of_range", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { add_edge(m, 2, 2, 1); }), (Kinds{{"repeated_corner", 1}}));
  EXPECT_EQ(refused([](MeshData& m) {
              m.types.clear();
              m.offsets = {0};
              m.connectivity.clear();
            }),
            (Kinds{{"empty", 1}}));
}

TEST(InspectPlanar, CoordinatesThatAreNoNumbersOrOutOfRange) {
  MeshData mesh = house();
  mesh.points[0].y = std::numeric_limits<double>::quiet_NaN();
  mesh.points[1].z = std::numeric_limits<double>::infinity();
  mesh.points[2].x = 1e200;
  EXPECT_EQ(kinds(check_and_repair(mesh).defects), (Kinds{{"not_finite", 2}, {"out_of_range", 1}}));
}

TEST(InspectPlanar, EdgesOfTooManyCellsOrOneSide) {
  MeshData crowded = house();
  crowded.points.push_back({1.5, .5, 0});
  add(crowded, CellType::triangle, {1, 5, 2});
  EXPECT_EQ(kinds(check_and_repair(crowded).defects), (Kinds{{"face_shared", 1}}));
  MeshData same_side = house();
  same_side.points[4] = {.5, .5, 0};  // the triangle, turned, lies in the square
  EXPECT_EQ(kinds(check_and_repair(same_side).defects), (Kinds{{"same_side", 1}}));
  MeshData twice = house();
  add(twice, CellType::quadrilateral, {2, 3, 0, 1});
  EXPECT_EQ(kinds(check_and_repair(twice).defects), (Kinds{{"face_shared", 1}, {"same_side", 3}}));
}

TEST(InspectPlanar, UnusedPointsAndStrayEdgesAreDropped) {
  MeshData mesh = house();
  mesh.points.insert(mesh.points.begin() + 1, {9, 9, 9});
  for (std::uint32_t& v : mesh.connectivity) v += v >= 1 ? 1 : 0;
  mesh.patch_faces = {0, 2};
  add(mesh, CellType::polygon, {4, 3, 6, 7});
  mesh.points.insert(mesh.points.end(), {{1, 2, 0}, {0, 2, 0}});
  add_edge(mesh, 0, 3, 6);  // a diagonal
  add_edge(mesh, 1, 2, 7);  // of an unused point
  add_edge(mesh, 3, 2, 8);  // between two cells
  add_edge(mesh, 7, 4, 9);
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(kinds(report.repairs), (Kinds{{"unused_points", 1}}));
  EXPECT_EQ(kinds(report.warnings), (Kinds{{"patch_faces", 2}}));
  EXPECT_EQ(mesh.patch_tags, (std::vector<std::int32_t>{5, 8, 9}));
  EXPECT_EQ(mesh.patch_faces, (std::vector<std::uint32_t>{0, 1, 2, 1, 6, 3}));
  EXPECT_EQ(mesh.connectivity, (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 4, 2, 3, 2, 5, 6}));
}

/// A square above two that share its lower edge; the middle point at `at`.
MeshData hanging(const Vec3& at) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, at, {0, -1, 0}, {1, -1, 0}, {2, -1, 0}};
  add(mesh, CellType::quadrilateral, {0, 1, 2, 3});
  add(mesh, CellType::quadrilateral, {5, 6, 4, 0});
  add(mesh, CellType::quadrilateral, {6, 7, 1, 4});
  return mesh;
}

TEST(InspectPlanar, HangingPoints) {
  MeshData mesh = hanging({1, 0, 0});
  const MeshReport report = check_and_repair(mesh);
  ASSERT_EQ(kinds(report.warnings), (Kinds{{"non_conforming", 3}}));
  EXPECT_EQ(report.warnings[0].first, (std::vector<std::size_t>{0, 1, 2}));
  // As a corner of the square it hangs no more.
  mesh = hanging({1, 0, 0});
  MeshData joined;
  joined.points = mesh.points;
  add(joined, CellType::polygon, {0, 4, 1, 2, 3});
  add(joined, CellType::quadrilateral, {5, 6, 4, 0});
  add(joined, CellType::quadrilateral, {6, 7, 1, 4});
  EXPECT_EQ(check_and_repair(joined).verdict(), Verdict::accept);
  // Off the line by the smallest step there is a gap.
  MeshData apart = hanging({1, -0x1p-60, 0});
  EXPECT_EQ(check_and_repair(apart).verdict(), Verdict::accept);
}

// A triangle below the square that touches its lower edge with a corner, the first or the last of it along x.
TEST(InspectPlanar, APointInsideAnEdge) {
  for (const double left : {0.0, 0.75}) {
    MeshData mesh = house();
    mesh.points.insert(mesh.points.end(), {{.5, 0, 0}, {left, -1, 0}, {left + 0.25, -1, 0}});
    add(mesh, CellType::triangle, {5, 6, 7});
    const MeshReport report = check_and_repair(mesh);
    ASSERT_EQ(kinds(report.warnings), (Kinds{{"non_conforming", 1}}));
    EXPECT_EQ(report.warnings[0].first, std::vector<std::size_t>{0});
    EXPECT_EQ(report.parts, 2U);
  }
}

TEST(InspectPlanar, SeamsOfDoubledPoints) {
  MeshData mesh = house();
  mesh.points.insert(mesh.points.end(), {mesh.points[1], mesh.points[2]});
  mesh.connectivity[4] = 5;
  mesh.connectivity[6] = 6;
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(kinds(report.warnings), (Kinds{{"repeated_points", 2}, {"non_conforming", 2}}));
  EXPECT_EQ(report.parts, 2U);
  // In one line but apart, or with an end in common, edges are no seam.
  MeshData ends = house();
  ends.points.insert(ends.points.end(), {{-1, 0, 0}, {-3, 0, 0}, {-2, 0, 0}, {-1, 1, 0}, {-2, 1, 0}, {-3, 1, 0}});
  add(ends, CellType::quadrilateral, {6, 7, 9, 10});
  add(ends, CellType::quadrilateral, {7, 5, 8, 9});
  EXPECT_EQ(check_and_repair(ends).verdict(), Verdict::accept);
}

TEST(InspectPlanar, PinchedBoundaries) {
  // Four squares around a hole, of which two touch in a point.
  MeshData mesh;
  for (int j = 0; j <= 3; ++j) {
    for (int i = 0; i <= 3; ++i) mesh.points.push_back({double(i), double(j), 0});
  }
  const auto square = [&](std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = i + 4 * j;
    add(mesh, CellType::quadrilateral, {a, a + 1, a + 5, a + 4});
  };
  for (const auto& [i, j] : {std::pair{0U, 0U}, {1U, 0U}, {2U, 0U}, {0U, 1U}, {0U, 2U}, {1U, 2U}, {2U, 1U}})
    square(i, j);
  const MeshReport report = check_and_repair(mesh);  // (2, 2) is not there: (1, 2) and (2, 1) touch in a point
  ASSERT_EQ(kinds(report.warnings), (Kinds{{"boundary_points", 1}}));
  EXPECT_EQ(report.warnings[0].first, std::vector<std::size_t>{10});
  // Two parts that touch in a point are fine.
  MeshData parts;
  parts.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  add(parts, CellType::triangle, {0, 1, 2});
  add(parts, CellType::triangle, {0, 3, 4});
  const MeshReport fine = check_and_repair(parts);
  EXPECT_EQ(fine.verdict(), Verdict::accept);
  EXPECT_EQ(fine.parts, 2U);
}

TEST(InspectPlanar, RegionsAreCounted) {
  MeshData mesh = house();
  mesh.regions = {7, 8};
  mesh.region_names = {{7, "lumen"}};
  EXPECT_EQ(check_and_repair(mesh).regions, (Kinds{{"lumen", 1}, {"8", 1}}));
}

/// An independent, slow count: each edge's two corners in a map.
TEST(MatchFacesPlanar, AgreesWithAMap) {
  Random random(3);
  for (int round = 0; round < 100; ++round) {
    MeshData mesh;
    mesh.points.resize(8);
    for (int c = 0; c < 8; ++c) {
      std::vector<std::uint32_t> corners(8);
      std::iota(corners.begin(), corners.end(), 0U);
      for (std::uint32_t n = 8; n > 1; --n) std::swap(corners[n - 1], corners[random.below(n)]);
      corners.resize(3 + random.below(4));
      mesh.add_cell(corners.size() == 3 ? CellType::triangle : CellType::polygon, corners);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<bool>> uses;
    for (const auto& [edge, cells] : test::directed_edges(mesh)) {
      for (std::size_t k = 0; k < cells.size(); ++k)
        uses[std::minmax(edge.first, edge.second)].push_back(edge.first < edge.second);
    }
    std::size_t single = 0, same_side = 0, crowded = 0;
    for (const auto& [edge, forward] : uses) {
      single += forward.size() == 1 ? 1 : 0;
      same_side += forward.size() == 2 && forward[0] == forward[1] ? 1 : 0;
      crowded += forward.size() > 2 ? 1 : 0;
    }
    const FaceMatch match = match_faces(mesh);
    EXPECT_EQ(match.boundary.size(), single);
    EXPECT_EQ(match.same_side.size(), same_side);
    EXPECT_EQ(match.crowded.size(), crowded);
    EXPECT_TRUE(match.twisted.empty());
    const auto edges = test::directed_edges(mesh);
    for (std::size_t f = 0; f < match.boundary.size(); ++f) {
      const auto edge = match.boundary.face(f);
      ASSERT_EQ(edge.size(), 2U);
      EXPECT_EQ(edges.at({edge[0], edge[1]}), std::vector<std::size_t>{match.boundary.cells[f]});
    }
  }
}

}  // namespace dartcast::inspect_planar_test
