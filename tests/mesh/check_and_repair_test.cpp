// Every kind of finding, made on purpose, one at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "dartcast/mesh_check.hpp"
#include "mesh/cell_types.hpp"
#include "mesh/conformity.hpp"
#include "support/findings.hpp"
#include "support/meshes.hpp"
#include "support/mixed_mesh.hpp"

namespace dartcast::inspect_test {

using test::add;
using test::kinds;
using test::Kinds;

/// A row of n unit cubes along x, as hexahedra.
MeshData row(std::uint32_t n) {
  MeshData mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (const auto& [y, z] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      mesh.points.push_back({static_cast<double>(i), y, z});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 4 * i;
    add(mesh, CellType::hexahedron, {a, a + 4, a + 5, a + 1, a + 3, a + 7, a + 6, a + 2});
  }
  return mesh;
}

MeshData one_of(CellType type) {
  MeshData mesh = row(1);
  mesh.types.clear();
  mesh.offsets = {0};
  const std::vector<std::uint32_t> hexahedron = mesh.connectivity;
  mesh.connectivity.clear();
  const auto h = [&](std::size_t k) { return hexahedron[k]; };
  switch (type) {
    case CellType::tetrahedron: add(mesh, type, {h(0), h(1), h(3), h(4)}); break;
    case CellType::hexahedron: add(mesh, type, hexahedron); break;
    case CellType::prism: add(mesh, type, {h(0), h(1), h(3), h(4), h(5), h(7)}); break;
    case CellType::pyramid: add(mesh, type, {h(0), h(1), h(2), h(3), h(4)}); break;
    case CellType::polyhedron: {
      std::vector<std::uint32_t> stream = {6};
      for (const auto& face : standard_faces(CellType::hexahedron)) {
        stream.push_back(4);
        for (const std::uint8_t k : face) stream.push_back(h(k));
      }
      add(mesh, type, stream);
      break;
    }
    case CellType::triangle:
    case CellType::quadrilateral:
    case CellType::polygon: break;
  }
  return mesh;
}

constexpr CellType all_types[] = {CellType::tetrahedron, CellType::hexahedron, CellType::prism, CellType::pyramid,
                                  CellType::polyhedron};

TEST(Inspect, GoodCellsAreAccepted) {
  for (const CellType type : all_types) {
    MeshData mesh = one_of(type);
    const auto before = mesh.connectivity;
    const MeshReport report = check_and_repair(mesh);
    EXPECT_TRUE(report.valid()) << static_cast<int>(type);
    EXPECT_TRUE(report.warnings.empty());
    EXPECT_EQ(report.cells, (Kinds{{std::string(cell_type_names[static_cast<std::size_t>(type)]), 1}}));
    EXPECT_EQ(report.parts, 1U);
    Kinds repairs = kinds(report.repairs);
    repairs.erase("unused_points");
    EXPECT_TRUE(repairs.empty());
    if (report.repairs.empty()) {
      EXPECT_EQ(mesh.connectivity, before);
    }
  }
}

/// The faces of cell 0, each from its smallest corner on, run backwards if asked.
std::set<std::vector<std::uint32_t>> faces_of(const MeshData& mesh, bool backwards) {
  std::set<std::vector<std::uint32_t>> faces;
  for_each_face(mesh, 0, [&](std::span<const std::uint32_t> face) {
    std::vector<std::uint32_t> f(face.begin(), face.end());
    if (backwards) std::reverse(f.begin(), f.end());
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    faces.insert(f);
  });
  return faces;
}

TEST(Inspect, CellsInsideOutAreMirrored) {
  for (const CellType type : all_types) {
    MeshData mesh = one_of(type);
    check_and_repair(mesh);  // drops unused points
    for (Vec3& p : mesh.points) p.x = -p.x;
    const auto expected = faces_of(mesh, true);
    const MeshReport report = check_and_repair(mesh);
    EXPECT_TRUE(report.valid());
    EXPECT_EQ(kinds(report.repairs), (Kinds{{"orientation", 1}})) << static_cast<int>(type);
    EXPECT_EQ(faces_of(mesh, false), expected) << static_cast<int>(type);
    EXPECT_EQ(check_and_repair(mesh).verdict(), Verdict::accept);
  }
}

TEST(Inspect, FlatCellsAreRefused) {
  for (const CellType type : all_types) {
    MeshData mesh = one_of(type);
    for (Vec3& p : mesh.points) p.z = 0.5 * p.x + p.y;
    EXPECT_EQ(kinds(check_and_repair(mesh).defects)["flat"], 1U) << static_cast<int>(type);
  }
}

TEST(Inspect, FlatByOneUlpIsNotFlat) {
  MeshData mesh;
  mesh.points = {{0.1, 0.1, 0.1}, {0.3, 0.1, 0.1}, {0.1, 0.3, 0.1}, {0.2, 0.2, std::nextafter(0.1, 1.0)}};
  add(mesh, CellType::tetrahedron, {0, 1, 2, 3});
  EXPECT_EQ(check_and_repair(mesh).verdict(), Verdict::accept);
}

TEST(Inspect, CornersInAWrongOrderAreInverted) {
  MeshData mesh = row(1);
  std::swap(mesh.connectivity[2], mesh.connectivity[3]);  // as in a voxel
  std::swap(mesh.connectivity[6], mesh.connectivity[7]);
  EXPECT_EQ(kinds(check_and_repair(mesh).defects)["inverted"], 1U);
}

TEST(Inspect, UnusedPointsAreDroppedWithTheirData) {
  MeshData mesh = row(2);
  mesh.points.insert(mesh.points.begin() + 3, Vec3{9, 9, std::numeric_limits<double>::quiet_NaN()});
  for (std::uint32_t& v : mesh.connectivity) v += v >= 3 ? 1 : 0;
  mesh.add_patch_face(std::vector<std::uint32_t>{0, 1, 2, 4}, 5);
  DataArray data{"x", 2, {}};
  for (int p = 0; p < 13; ++p) data.values.insert(data.values.end(), {1.0 * p, -1.0 * p});
  mesh.point_data = {data};
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(report.verdict(), Verdict::repair);
  EXPECT_EQ(kinds(report.repairs), (Kinds{{"unused_points", 1}}));
  EXPECT_EQ(report.repairs[0].first, std::vector<std::size_t>{3});
  EXPECT_EQ(report.points, 12U);
  EXPECT_EQ(mesh.points, row(2).points);
  EXPECT_EQ(mesh.connectivity, row(2).connectivity);
  EXPECT_EQ(mesh.patch_faces, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.point_data[0].values.size(), 24U);
  EXPECT_EQ(mesh.point_data[0].values[6], 4.0);
  EXPECT_EQ(mesh.point_data[0].values[7], -4.0);
}

TEST(Inspect, IdsOutOfRange) {
  MeshData mesh = row(3);
  mesh.connectivity[8] = 16;
  mesh.source = {10, 11, 12};
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(kinds(report.defects), (Kinds{{"id_out_of_range", 1}}));
  EXPECT_EQ(report.defects[0].first, std::vector<std::size_t>{11});
  MeshData patch = row(1);
  patch.add_patch_face(std::vector<std::uint32_t>{0, 1, 0xffffffffU}, 1);
  EXPECT_EQ(kinds(check_and_repair(patch).defects), (Kinds{{"id_out_of_range", 1}}));
}

TEST(Inspect, RepeatedCorners) {
  MeshData mesh = row(3);
  mesh.connectivity[9] = mesh.connectivity[8];
  EXPECT_EQ(kinds(check_and_repair(mesh).defects), (Kinds{{"repeated_corner", 1}}));
}

TEST(Inspect, CoordinatesThatAreNoNumbersOrOutOfRange) {
  MeshData mesh = row(1);
  mesh.points[1].y = std::numeric_limits<double>::quiet_NaN();
  mesh.points[2].z = -std::numeric_limits<double>::infinity();
  mesh.points[3].z = 1e200;
  mesh.points[4].x = 1e-200;
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(kinds(report.defects), (Kinds{{"not_finite", 2}, {"out_of_range", 1}})) << "what is small counts as 0";
  EXPECT_EQ(report.defects[0].first, (std::vector<std::size_t>{1, 2}));
}

TEST(Inspect, ArraysThatDoNotFit) {
  const auto refused = [](auto&& change) {
    MeshData mesh = row(2);
    change(mesh);
    return kinds(check_and_repair(mesh).defects);
  };
  EXPECT_EQ(refused([](MeshData& m) { m.offsets.back() += 1; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.offsets = {}; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.offsets[1] = 99; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.offsets[1] = 7; }), (Kinds{{"structure", 2}}));
  EXPECT_EQ(refused([](MeshData& m) { m.regions = {1}; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.free = {1, 1, 1}; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.patch_offsets = {0, 4}; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.point_data = {{"a", 1, {1.0}}}; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.cell_data = {{"a", 0, {}}}; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m.types[0] = test::no_cell_type; }), (Kinds{{"structure", 1}}));
  EXPECT_EQ(refused([](MeshData& m) { m = {}; }), (Kinds{{"empty", 1}}));
}

TEST(Inspect, FacesSharedByThreeCells) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0.2, 0.2, 2}};
  add(mesh, CellType::tetrahedron, {0, 1, 2, 3});
  add(mesh, CellType::tetrahedron, {0, 2, 1, 4});
  add(mesh, CellType::tetrahedron, {0, 1, 2, 5});
  EXPECT_EQ(kinds(check_and_repair(mesh).defects), (Kinds{{"face_shared", 1}}));
}

TEST(Inspect, CellsOnTheSameSideOfAFace) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.2, 2}};
  add(mesh, CellType::tetrahedron, {0, 1, 2, 3});
  add(mesh, CellType::tetrahedron, {0, 1, 2, 4});
  EXPECT_EQ(kinds(check_and_repair(mesh).defects), (Kinds{{"same_side", 1}}));
  MeshData twice = one_of(CellType::polyhedron);
  const auto stream = twice.connectivity;
  add(twice, CellType::polyhedron, stream);
  EXPECT_EQ(kinds(check_and_repair(twice).defects), (Kinds{{"same_side", 6}}));
}

TEST(Inspect, OneFaceInTwoOrders) {
  // Two pyramids on one square, whose corners the second gives crosswise.
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5, .5, 1}, {.5, .5, -1}};
  add(mesh, CellType::pyramid, {0, 1, 2, 3, 4});
  add(mesh, CellType::pyramid, {0, 2, 1, 3, 5});
  EXPECT_EQ(kinds(check_and_repair(mesh).defects)["face_order"], 1U);
}

TEST(Inspect, PolyhedraMustBeClosed) {
  MeshData mesh = one_of(CellType::polyhedron);
  std::reverse(mesh.connectivity.begin() + 7, mesh.connectivity.begin() + 11);
  const MeshReport turned = check_and_repair(mesh);
  EXPECT_TRUE(turned.valid());
  EXPECT_EQ(kinds(turned.repairs), (Kinds{{"polyhedron_faces", 1}}));

  MeshData open = one_of(CellType::polyhedron);
  open.connectivity.resize(26);
  open.connectivity[0] = 5;
  open.offsets.back() = 26;
  EXPECT_EQ(kinds(check_and_repair(open).defects), (Kinds{{"polyhedron", 1}}));

  // Two tetrahedra that share an edge only, as one cell: that edge is used four times.
  MeshData pinched;
  pinched.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  std::vector<std::uint32_t> faces = {8};
  for (const auto& t : {std::array{0U, 1U, 2U, 3U}, std::array{0U, 1U, 4U, 5U}}) {
    for (const auto& face : standard_faces(CellType::tetrahedron)) {
      faces.push_back(3);
      for (const std::uint8_t k : face) faces.push_back(t[k]);
    }
  }
  add(pinched, CellType::polyhedron, faces);
  EXPECT_EQ(kinds(check_and_repair(pinched).defects), (Kinds{{"polyhedron", 1}}));

  MeshData stream = one_of(CellType::polyhedron);
  stream.connectivity[1] = 40;
  EXPECT_EQ(kinds(check_and_repair(stream).defects), (Kinds{{"polyhedron", 1}}));
  stream.connectivity[1] = 0xffffffffU;
  EXPECT_EQ(kinds(check_and_repair(stream).defects), (Kinds{{"polyhedron", 1}}));
  stream.connectivity[0] = 0xffffffffU;
  EXPECT_EQ(kinds(check_and_repair(stream).defects), (Kinds{{"polyhedron", 1}}));
}

/// Two cubes side by side, without common points; the second moved by `shift` in y.
MeshData loose_pair(double shift) {
  MeshData mesh = row(1);
  const MeshData other = row(1);
  for (const Vec3& p : other.points) mesh.points.push_back(p + Vec3{1.0, shift, 0.0});
  std::vector<std::uint32_t> corners(other.connectivity);
  for (std::uint32_t& v : corners) v += 8;
  mesh.add_cell(CellType::hexahedron, corners);
  return mesh;
}

TEST(Inspect, RepeatedPointsAreAWarning) {
  MeshData mesh = loose_pair(0.0);
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(report.verdict(), Verdict::warn);
  EXPECT_EQ(kinds(report.warnings), (Kinds{{"repeated_points", 4}, {"non_conforming", 2}}));
  EXPECT_EQ(report.parts, 2U);
}

TEST(Inspect, FacesThatLieAgainstEachOther) {
  MeshData shifted = loose_pair(0.25);
  EXPECT_EQ(kinds(check_and_repair(shifted).warnings), (Kinds{{"non_conforming", 2}}));
  MeshData beyond = loose_pair(1.5);
  EXPECT_EQ(check_and_repair(beyond).verdict(), Verdict::accept);
  MeshData barely = loose_pair(std::nextafter(1.0, 0.0));
  EXPECT_EQ(kinds(check_and_repair(barely).warnings)["non_conforming"], 2U);
  MeshData edge = loose_pair(1.0);  // only an edge in common: no area
  EXPECT_EQ(kinds(check_and_repair(edge).warnings).count("non_conforming"), 0U);
}

/// Turns a mesh so that its planes are no coordinate planes any more, and its points are rounded.
void turn(MeshData& mesh) {
  for (Vec3& p : mesh.points) {
    p = {0.36 * p.x + 0.48 * p.y - 0.8 * p.z, -0.8 * p.x + 0.6 * p.y, 0.48 * p.x + 0.64 * p.y + 0.6 * p.z};
  }
}

TEST(Inspect, FacesThatLieAgainstEachOtherAfterRounding) {
  MeshData shifted = loose_pair(0.25);
  turn(shifted);
  EXPECT_EQ(kinds(check_and_repair(shifted).warnings), (Kinds{{"non_conforming", 2}}));
  MeshData apart = loose_pair(0.25);
  for (std::size_t p = 8; p < 16; ++p) apart.points[p].x += 1e-6;
  turn(apart);
  EXPECT_EQ(check_and_repair(apart).verdict(), Verdict::accept);
}

TEST(Inspect, DiagonalsThatDisagree) {
  // A square of two triangles, cut one way below and the other way above, flat or warped.
  for (const double warp : {0.0, 0.1}) {
    MeshData mesh;
    mesh.points = {{0, 0, 0}, {1, 0, warp}, {1, 1, 0}, {0, 1, warp}, {.5, .5, 1}, {.5, .5, -1}};
    add(mesh, CellType::tetrahedron, {0, 1, 3, 4});
    add(mesh, CellType::tetrahedron, {1, 2, 3, 4});
    add(mesh, CellType::pyramid, {0, 3, 2, 1, 5});
    EXPECT_EQ(kinds(check_and_repair(mesh).warnings)["non_conforming"], 3U) << warp;
  }
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5, .5, 1}, {.5, .5, -1}};
  add(mesh, CellType::tetrahedron, {0, 1, 2, 4});
  add(mesh, CellType::tetrahedron, {0, 2, 3, 4});
  add(mesh, CellType::tetrahedron, {1, 0, 3, 5});
  add(mesh, CellType::tetrahedron, {2, 1, 3, 5});
  EXPECT_EQ(kinds(check_and_repair(mesh).warnings)["non_conforming"], 4U);
}

TEST(Inspect, BoundariesThatAreMuchInOnePlaneAreFine) {
  MeshData mesh = row(200);
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(report.verdict(), Verdict::accept);
  EXPECT_EQ(report.cells.at("hexahedron"), 200U);
}

TEST(Inspect, PinchedBoundaries) {
  MeshData edge = row(1);
  // A second cube that shares the edge x = 1, y = 1 only.
  edge.points.insert(edge.points.end(), {{2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {2, 1, 1}, {2, 2, 1}, {1, 2, 1}});
  add(edge, CellType::hexahedron, {5, 8, 9, 10, 6, 11, 12, 13});
  EXPECT_EQ(kinds(check_and_repair(edge).warnings), (Kinds{{"boundary_edges", 1}}));

  // A ring of four tetrahedra-like prisms would be long; a bent row whose ends share one point is enough.
  MeshData point = row(5);
  for (Vec3& p : point.points) {
    const double angle = p.x * 2.0 * 3.14159265358979 / 5.5;
    p = {(3.0 + p.y) * std::cos(angle), (3.0 + p.y) * std::sin(angle), p.z};
  }
  for (std::uint32_t& v : point.connectivity) v = v == 20 ? 0 : v;
  const MeshReport report = check_and_repair(point);
  EXPECT_EQ(kinds(report.warnings), (Kinds{{"boundary_points", 1}}));
}

TEST(Inspect, PartsThatTouchInAPointAreFine) {
  MeshData mesh = row(1);
  mesh.points.insert(mesh.points.end(), {{2, 1, 1}, {1, 2, 1}, {1, 1, 2}});
  add(mesh, CellType::tetrahedron, {6, 8, 9, 10});
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(report.verdict(), Verdict::accept);
  EXPECT_EQ(report.parts, 2U);
}

TEST(Inspect, PatchFacesThatAreNoFacesAreDropped) {
  MeshData mesh = row(2);
  mesh.add_patch_face(std::vector<std::uint32_t>{0, 1, 2, 3}, 1);
  mesh.add_patch_face(std::vector<std::uint32_t>{0, 1, 2}, 2);
  mesh.add_patch_face(std::vector<std::uint32_t>{6, 7, 4, 5}, 3);  // between the two cells
  mesh.add_patch_face(std::vector<std::uint32_t>{0, 1, 2, 3}, 4);  // a face in two groups
  const MeshReport report = check_and_repair(mesh);
  EXPECT_EQ(kinds(report.warnings), (Kinds{{"patch_faces", 1}}));
  EXPECT_EQ(mesh.patch_tags, (std::vector<std::int32_t>{1, 3, 4}));
  EXPECT_EQ(mesh.patch_offsets, (std::vector<std::size_t>{0, 4, 8, 12}));
}

TEST(Inspect, RegionsAreCounted) {
  MeshData mesh = row(3);
  mesh.regions = {7, 8, 7};
  mesh.region_names = {{7, "lumen"}};
  EXPECT_EQ(check_and_repair(mesh).regions, (Kinds{{"lumen", 2}, {"8", 1}}));
}

/// An independent, slow count of the boundary: each face's set of corners in a map.
TEST(MatchFaces, AgreesWithAMap) {
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    // Random sets of corners: all sorts of matches.
    MeshData mesh;
    mesh.points.resize(7);
    for (int c = 0; c < 12; ++c) {
      std::vector<std::uint32_t> corners(7);
      std::iota(corners.begin(), corners.end(), 0U);
      std::shuffle(corners.begin(), corners.end(), random);
      const CellType type = all_types[random() % 4 == 0 ? 0 : (random() % 2 == 0 ? 2 : 3)];
      corners.resize(corner_count(type));
      mesh.add_cell(type, corners);
    }
    std::map<std::vector<std::uint32_t>, int> uses;
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
        std::vector<std::uint32_t> key(face.begin(), face.end());
        std::sort(key.begin(), key.end());
        ++uses[key];
      });
    }
    std::size_t single = 0;
    std::size_t crowded = 0;
    for (const auto& [key, n] : uses) {
      single += n == 1 ? 1 : 0;
      crowded += n > 2 ? 1 : 0;
    }
    const FaceMatch match = match_faces(mesh);
    EXPECT_EQ(match.boundary.size(), single);
    EXPECT_EQ(match.crowded.size(), crowded);
    for (std::size_t f = 0; f < match.boundary.size(); ++f) {
      std::vector<std::uint32_t> key(match.boundary.face(f).begin(), match.boundary.face(f).end());
      std::sort(key.begin(), key.end());
      EXPECT_EQ(uses[key], 1);
    }
  }
}

}  // namespace dartcast::inspect_test
