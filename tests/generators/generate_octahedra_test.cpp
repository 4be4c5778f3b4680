#include <limits>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "support/dyadic.hpp"
#include "support/generate_checks.hpp"

namespace dartcast::generate_octahedra_test {

OctahedraOptions block(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz) {
  OctahedraOptions o;
  o.cells = {nx, ny, nz};
  o.size = {4.0 * nx, 4.0 * ny, 4.0 * nz};
  return o;
}

TEST(GenerateOctahedra, OneCubeHoldsTwoThatShareAHexagon) {
  const MeshData mesh = generate_octahedra(block(1, 1, 1));
  ASSERT_EQ(mesh.cell_count(), 2U);
  EXPECT_EQ(mesh.points.size(), 24U + 24 - 6);
  EXPECT_EQ(mesh.types[0], CellType::polyhedron);
  std::map<std::size_t, int> corners;
  for_each_face(mesh, 0, [&](std::span<const std::uint32_t> f) { ++corners[f.size()]; });
  EXPECT_EQ(corners, (std::map<std::size_t, int>{{4, 6}, {6, 8}}));
  EXPECT_EQ(test::expect_conforming(mesh), 26U);
  EXPECT_EQ(mesh.patch_tags.size(), 26U);
}

TEST(GenerateOctahedra, BlocksConformArePositiveAndHaveTheRightVolume) {
  const MeshData mesh = generate_octahedra(block(3, 4, 2));
  EXPECT_EQ(mesh.cell_count(), 48U);
  EXPECT_EQ(test::expect_conforming(mesh), mesh.patch_tags.size());
  EXPECT_EQ(test::count_not_positive(mesh, mesh.points), 0U);
  EXPECT_EQ(test::volume(mesh), 48 * 32.0);
  EXPECT_EQ(test::patch_sizes(mesh).at("boundary"), mesh.patch_tags.size());
}

TEST(GenerateOctahedra, FacesAreExactlyPlane) {
  OctahedraOptions o = block(2, 2, 2);
  o.origin = {-3, 0.5, 1024};
  o.size = {1, 2, 6};
  const MeshData mesh = generate_octahedra(o);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> f) {
      for (std::size_t i = 3; i < f.size(); ++i) {
        EXPECT_EQ(test::exact_sign(mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]], mesh.points[f[i]]), 0);
      }
    });
  }
  const auto [low, high] =
      std::minmax_element(mesh.points.begin(), mesh.points.end(), [](auto& a, auto& b) { return a.z < b.z; });
  EXPECT_EQ(low->z, 1024);
  EXPECT_EQ(high->z, 1024 + 6 + 1.5);
}

TEST(GenerateOctahedra, BlockedLayerAndShare) {
  OctahedraOptions o = block(4, 5, 6);
  o.blocked_layer = true;
  MeshData mesh = generate_octahedra(o);
  // An octahedron is free if all of its 14 neighbours are in the block: it is not in the first or last layers of its
  // kind.
  const auto free_count = [&] { return std::count(mesh.free.begin(), mesh.free.end(), 1); };
  EXPECT_EQ(free_count(), 2 * 2 * 3 * 4);
  const auto faces = test::all_faces(mesh);
  for (const auto& [face, cells] : faces) {
    EXPECT_TRUE(faces.contains(test::reversed(face)) || mesh.free[cells[0]] == 0);
  }
  o.blocked_share = 0.25;
  mesh = generate_octahedra(o);
  EXPECT_EQ(free_count(), 36);
}

TEST(GenerateOctahedra, RefusesWhatItCannotBuild) {
  const auto refuses = [](auto&& change, const char* text) {
    OctahedraOptions o = block(2, 2, 2);
    change(o);
    try {
      generate_octahedra(o);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InvalidArgument& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  refuses([](OctahedraOptions& o) { o.cells[2] = 0; }, "no cells");
  refuses([](OctahedraOptions& o) { o.cells = {4294967295U, 4294967295U, 2}; }, "536870911");
  refuses([](OctahedraOptions& o) { o.size->y = std::numeric_limits<double>::quiet_NaN(); }, "finite");
  refuses([](OctahedraOptions& o) { o.size->y = -1; }, "positive");
  refuses([](OctahedraOptions& o) { o.blocked_share = -0.1; }, "blocked_share");
}

}  // namespace dartcast::generate_octahedra_test
