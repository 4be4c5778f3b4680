// Surfaces of which a few triangles cross: made here, and by others.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/scene_file.hpp"
#include "meshing/closed_surfaces.hpp"
#include "output/mesh_report_text.hpp"
#include "support/expectations.hpp"
#include "support/sample_mesh.hpp"
#include "support/shared_data.hpp"
#include "surface/triangle_pairs.hpp"

namespace dartcast::mend_crossings_test {

namespace fs = std::filesystem;

class MendCrossings : public ::testing::Test {
 protected:
  [[nodiscard]] SurfaceScene scene_of(const MeshData& mesh) const {
    write_mesh(mesh, folder_ / "lumen.off");
    SurfaceScene scene;
    scene.surfaces.push_back({"lumen", folder_ / "lumen.off"});
    return scene;
  }

  test::Folder folder_;
};

void expect_crossings(const MeshReport& report, std::initializer_list<const char*> words) {
  ASSERT_FALSE(report.valid());
  EXPECT_EQ(report.defects.front().kind, "self_intersection");
  test::expect_parts(report.defects.front().message, words);
}

double enclosed_volume(const ClosedSurfaces& all) {
  double volume = 0.0;
  for (const TriangleCorners& t : all.triangles)
    volume += dot(cross(all.points[t[0]], all.points[t[1]]), all.points[t[2]]) / 6.0;
  return volume;
}

/// The unit cube, each side n x n squares of two triangles.
MeshData cuboid_of_grids(int n) {
  std::map<std::array<int, 3>, std::uint32_t> number;
  MeshData mesh;
  const auto point = [&](const std::array<int, 3>& at) {
    const auto [found, added] = number.try_emplace(at, static_cast<std::uint32_t>(mesh.points.size()));
    if (added) mesh.points.push_back(Vec3{double(at[0]), double(at[1]), double(at[2])} * (1.0 / n));
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const auto at = [&](int u, int v) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            return point(p);
          };
          std::array<std::uint32_t, 4> q = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
          if (side == 0) std::swap(q[1], q[3]);
          mesh.add_cell(CellType::triangle, std::vector<std::uint32_t>{q[0], q[1], q[2]});
          mesh.add_cell(CellType::triangle, std::vector<std::uint32_t>{q[0], q[2], q[3]});
        }
      }
    }
  }
  return mesh;
}

// A cube whose sides are grids, with some points of the upper one pulled through the lower one.
MeshData dented(int n, int dents) {
  MeshData mesh = cuboid_of_grids(n);
  for (int k = 0; k < dents; ++k) {
    for (Vec3& x : mesh.points) {
      if (x.z == 1.0 && std::abs(x.x - (0.25 + 0.5 * k)) < 1e-9 && std::abs(x.y - 0.5) < 1e-9) x.z = -0.05;
    }
  }
  return mesh;
}

TEST_F(MendCrossings, AFewCrossingTrianglesAreReplaced) {
  for (const int dents : {1, 2}) {
    SurfaceScene scene = scene_of(dented(16, dents));
    expect_crossings(read_closed_surfaces(scene, {}).report, {"cross or touch", "repair"});
    scene.repair = true;
    const ClosedSurfaces found = read_closed_surfaces(scene, {});
    ASSERT_TRUE(found.report.valid()) << report_text(found.report);
    ASSERT_EQ(found.report.repairs.size(), 1U);
    EXPECT_EQ(found.report.repairs.front().kind, "crossings");
    test::expect_parts(found.report.repairs.front().message, {"greatest distance"});
    const std::size_t taken = found.report.repairs.front().count;
    EXPECT_GT(taken, 10U);
    test::expect_parts(report_text(found.report), {fmt::format("crossings: {} triangles, ", taken).c_str()});
    EXPECT_TRUE(crossing_pairs(found.points, found.triangles, 1).empty());
    EXPECT_NEAR(enclosed_volume(found), 1.0, 1e-12);
  }
}

// A run says how far its walls are from the surface in the file, also if its mesh was kept.
TEST_F(MendCrossings, AScenesWarningHasTheDistance) {
  (void)scene_of(dented(16, 1));
  ReadOptions options;
  options.kept_mesh = folder_ / "kept.msh";
  for (const bool again : {false, true}) {
    EXPECT_EQ(fs::exists(options.kept_mesh), again);
    Scene scene =
        parse_scene("[environment]\nmesh = { surface = 'lumen.off', repair = true }\n", folder_ / "scene.toml");
    const std::vector<Finding> warnings = load_scene_files(std::move(scene), options).warnings;
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_GT(warnings.front().count, 10U);
    test::expect_parts(warnings.front().message,
                       {"triangles, those that cross others", "greatest distance", "unit of the file"});
  }
}

TEST_F(MendCrossings, SurfacesThatCrossAsAWholeAreNotRepaired) {
  MeshData two = cuboid_of_grids(4);
  const MeshData other = cuboid_of_grids(4);
  const auto first = static_cast<std::uint32_t>(two.points.size());
  for (const Vec3& x : other.points) two.points.push_back(x + Vec3{0.4, 0.3, 0.1});
  for (std::size_t c = 0; c < other.cell_count(); ++c) {
    const auto t = other.cell(c);
    two.add_cell(CellType::triangle, std::vector<std::uint32_t>{t[0] + first, t[1] + first, t[2] + first});
  }
  SurfaceScene scene = scene_of(two);
  scene.repair = true;
  expect_crossings(read_closed_surfaces(scene, {}).report, {"does not help"});
}

// The lower and the upper half of a cube, with two points at each place where they meet, as some programs write patches.
TEST_F(MendCrossings, CracksAreClosed) {
  MeshData halves = cuboid_of_grids(4);
  std::map<std::uint32_t, std::uint32_t> own;
  for (std::size_t c = 0; c < halves.cell_count(); ++c) {
    const std::span<std::uint32_t> corners(&halves.connectivity[3 * c], 3);
    double height = 0.0;
    for (const std::uint32_t p : corners) height += halves.points[p].z / 3.0;
    if (height < 0.5) continue;
    for (std::uint32_t& p : corners) {
      if (halves.points[p].z != 0.5) continue;
      const auto [found, added] = own.try_emplace(p, static_cast<std::uint32_t>(halves.points.size()));
      if (added) halves.points.push_back(halves.points[p]);
      p = found->second;
    }
  }
  ASSERT_EQ(own.size(), 16U);
  SurfaceScene scene = scene_of(halves);
  const MeshReport open = read_closed_surfaces(scene, {}).report;
  ASSERT_FALSE(open.valid());
  EXPECT_EQ(open.defects.front().kind, "open");
  scene.repair = true;
  const ClosedSurfaces found = read_closed_surfaces(scene, {});
  ASSERT_TRUE(found.report.valid()) << report_text(found.report);
  test::expect_parts(report_text(found.report), {"16 points of borders", "joined"});
  EXPECT_EQ(found.points.size(), halves.points.size() - 16);
  EXPECT_NEAR(enclosed_volume(found), 1.0, 1e-12);
}

// Surfaces of others, some of which have crossings: they become closed ones without, or are refused. Those of the vessels,
// the cow and the elephant, which has cracks and 106 holes, are mended, and stay within 3% of their size of what they were.
TEST_F(MendCrossings, CrossingsInSurfacesOfOthers) {
  NEED_DATA("surfaces of others");
  std::size_t repaired = 0;
  for (const auto& entry : fs::recursive_directory_iterator(test::data_folder() / "surfaces")) {
    if (!is_surface_file(entry.path())) continue;
    SurfaceScene scene;
    scene.surfaces.push_back({"lumen", entry.path()});
    scene.cap = true;
    scene.cap_tolerance = 10.0;
    if (read_closed_surfaces(scene, {}).report.valid()) continue;
    scene.repair = true;
    const ClosedSurfaces found = read_closed_surfaces(scene, {});
    if (!found.report.valid()) continue;
    ++repaired;
    Vec3 low = found.points[0], high = low;
    for (const Vec3& x : found.points) {
      low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
      high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
    EXPECT_TRUE(crossing_pairs(found.points, found.triangles, 1).empty()) << entry.path();
    for (const Finding& r : found.report.repairs) {
      if (r.kind != "crossings") continue;
      EXPECT_LT(std::stod(r.message.substr(r.message.rfind(" is ") + 4)), 0.03 * norm(high - low)) << entry.path();
      std::cout << entry.path().filename() << ": " << r.count << ' ' << r.message << '\n';
    }
  }
  EXPECT_GE(repaired, 3U);
}

}  // namespace dartcast::mend_crossings_test
