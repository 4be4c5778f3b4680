// Surfaces that are read with a warning: short faces, repeated points, open borders, pinched points.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "support/sample_mesh.hpp"
#include "support/surface_files.hpp"

namespace dartcast::test::surface_warnings_test {

// Edges and vertices are written as faces of two corners and one.
TEST(SurfaceWarnings, FacesOfTwoCornersAreLeftOutWithAWarning) {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  for (const auto& [name, content] : std::vector<std::pair<std::string, std::string>>{
           {"a.obj", v + "f 1 2\nf 1 3 2\nf 3//1 4//1\nf 4\nf 1 2 4\n"},
           {"a.off", "OFF\n4 5 0\n" + points + "2 0 1\n3 0 2 1\n2 2 3\n1 3\n3 0 1 3\n"},
           {"a.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
            "z\nelement face 5\nproperty list uchar int vertex_indices\nend_header\n" +
                points + "2 0 1\n3 0 2 1\n2 2 3\n1 3\n3 0 1 3\n"}}) {
    const MeshFile file = read(name, content);
    ASSERT_FALSE(file.report.warnings.empty()) << name;
    EXPECT_EQ(file.report.warnings[0].kind, "short_faces");
    EXPECT_EQ(file.report.warnings[0].count, 3U);
    EXPECT_EQ(file.report.warnings[0].first, (std::vector<std::size_t>{0, 2, 3}));
    EXPECT_EQ(file.mesh.source, (Ids{1, 4}));
    EXPECT_EQ(file.mesh.connectivity, (Ids{0, 2, 1, 0, 1, 3}));
  }
}

/// Kinds, numbers and places of the warnings.
std::string warnings_of(const std::string& content) {
  std::string out;
  for (const Finding& f : read("a.off", content).report.warnings) {
    out += f.kind + " " + std::to_string(f.count) + ":";
    for (const std::size_t place : f.first) out += " " + std::to_string(place);
    out += "; ";
  }
  return out;
}

TEST(SurfaceWarnings, SurfacesGetTheWarningsOfVolumes) {
  const std::string closed = "OFF\n5 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
  EXPECT_EQ(warnings_of(closed), "");  // the fifth point is no corner of a face
  const std::string sheet = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
  EXPECT_EQ(warnings_of(sheet), "open_border 4: 0 0 1 2; ");
  const std::string seam = "OFF\n6 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n-0 0 0\n1 1 0\n3 0 1 2\n3 4 5 3\n";
  EXPECT_EQ(warnings_of(seam), "repeated_points 2: 4 5; open_border 6: 0 0 1 3 3 4; ");
  const std::string touch = "OFF\n5 2 0\n0 0 0\n1 0 0\n0 1 0\n-1 0 0\n0 -1 0\n3 0 1 2\n3 0 3 4\n";
  EXPECT_EQ(warnings_of(touch), "open_border 6: 0 0 0 0 1 3; pinched_points 1: 0; ");
  // Two closed surfaces that share a point, and three of them.
  std::string twins = "OFF\n10 12 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n-1 0 0\n0 -1 0\n0 0 -1\n1 1 9\n2 1 9\n1 2 9\n";
  for (const auto& [a, b, c] : {std::array{1, 2, 3}, std::array{4, 6, 5}, std::array{7, 8, 9}}) {
    for (const auto& [x, y, z] : {std::array{0, b, a}, std::array{0, a, c}, std::array{a, b, c}, std::array{b, 0, c}})
      twins += "3 " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  }
  EXPECT_EQ(warnings_of(twins), "pinched_points 1: 0; ");
}

}  // namespace dartcast::test::surface_warnings_test
