// Surfaces made by others: read as the list that comes with them says.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "dartcast/surface.hpp"
#include "formats/parsed_surface.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"

namespace dartcast::test::surface_data_test {

/// As the list that comes with them says; and the verdict.
struct Known {
  const char* file;
  std::size_t points, triangles, squares, polygons, open_edges, parts;
  const char* found = "";
};

std::vector<Known> known_surfaces() {
  return {{"surfaces/sofa/aneurysm3D_1.off", 7095, 14186, 0, 0, 0, 1},
          {"surfaces/sofa/liver.obj", 181, 274, 0, 0, 0, 1},
          {"surfaces/beamadapter/aneurysm3d_surface.obj", 3204, 6404, 0, 0, 0, 1},
          {"surfaces/beamadapter/carotids.stl", 1164, 2289, 0, 0, 41, 1},
          {"surfaces/cgal/femur.off", 3897, 7798, 0, 0, 0, 1},
          {"surfaces/cgal/bones.off", 2154, 4204, 0, 0, 0, 26},
          {"surfaces/cgal/cow.off", 2904, 5804, 0, 0, 0, 1},
          {"surfaces/cgal/elephant.off", 2775, 5558, 0, 0, 0, 1},
          {"surfaces/cgal/knot1.off", 3200, 6400, 0, 0, 0, 1},
          {"surfaces/cgal/hand.off", 1197, 2390, 0, 0, 0, 1},
          {"surfaces/cgal/anchor.off", 519, 1050, 0, 0, 0, 1},
          {"surfaces/cgal/mpi.off", 90, 13, 12, 27, 0, 1, "not_convex 19"},
          {"surfaces/cgal/double-torus-example.off", 231, 0, 202, 18, 0, 1, "not_convex 4"},
          {"surfaces/cgal/P.off", 26, 2, 21, 2, 0, 1},
          {"surfaces/cgal/3torus.off", 19, 0, 23, 0, 0, 1},
          {"surfaces/cgal/cube-shuffled.off", 8, 12, 0, 0, 0, 1, "orientation 7"},
          {"surfaces/cgal/degtri_sliding.off", 8, 8, 0, 0, 6, 1, "flat 4"},
          {"surfaces/cgal/quads_to_stitch.off", 20, 0, 8, 0, 20, 2},
          {"surfaces/cgal/tetra_intersected_by_triangle.off", 7, 5, 0, 0, 3, 2},
          {"surfaces/cgal/elephant-with-holes.off", 2798, 4463, 0, 0, 1353, 1},
          {"surfaces/cgal/quint_tris.off", 12, 20, 0, 0, 0, 1},
          {"motion/cloth_ball92.ply", 46598, 92230, 0, 0, 960, 2},
          {"motion/cloth_ball93.ply", 46598, 92230, 0, 0, 960, 2},
          {"motion/thick-cloth_t0.ply", 233, 404, 0, 0, 56, 2},
          {"motion/thick-cloth_t1.ply", 233, 404, 0, 0, 56, 2},
          {"motion/two-cubes-far.ply", 262, 480, 0, 0, 0, 2},
          {"motion/two-cubes-close.ply", 262, 480, 0, 0, 0, 2},
          {"motion/two-cubes-intersecting.ply", 262, 480, 0, 0, 0, 2}};
}

std::size_t open_edges(const MeshData& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto face = mesh.cell(c);
    for (std::size_t k = 0; k < face.size(); ++k) ++uses[std::minmax(face[k], face[(k + 1) % face.size()])];
  }
  return static_cast<std::size_t>(
      std::count_if(uses.begin(), uses.end(), [](const auto& edge) { return edge.second == 1; }));
}

/// Kinds and numbers of repairs and defects.
std::string found_in(const MeshReport& report) {
  std::string out;
  for (const auto* list : {&report.repairs, &report.defects}) {
    for (const Finding& f : *list) out += (out.empty() ? "" : ", ") + f.kind + " " + std::to_string(f.count);
  }
  return out;
}

TEST(SurfaceData, SurfacesMadeByOthersAreReadAsTheirListSays) {
  NEED_DATA("surfaces made by others");
  const std::filesystem::path folder = data_folder();
  for (const Known& known : known_surfaces()) {
    if (repeats_smaller_ones(known.points)) continue;
    SCOPED_TRACE(known.file);
    const MeshFile file = check_surface(folder / known.file);
    EXPECT_EQ(file.mesh.points.size(), known.points);
    const MeshData as_written = parse_surface(folder / known.file, 0).mesh;
    const auto count = [&](CellType type) {
      return static_cast<std::size_t>(std::count(as_written.types.begin(), as_written.types.end(), type));
    };
    EXPECT_EQ(count(CellType::triangle), known.triangles);
    EXPECT_EQ(count(CellType::quadrilateral), known.squares);
    EXPECT_EQ(count(CellType::polygon), known.polygons);
    EXPECT_EQ(open_edges(file.mesh), known.open_edges);
    const auto& warnings = file.report.warnings;
    const auto open =
        std::find_if(warnings.begin(), warnings.end(), [](const Finding& f) { return f.kind == "open_border"; });
    if (file.report.valid()) EXPECT_EQ(open == warnings.end() ? 0 : open->count, known.open_edges);
    EXPECT_EQ(found_in(file.report), known.found);
    EXPECT_EQ(file.report.parts, known.parts);
    if (file.report.valid()) EXPECT_EQ(Surface(file.mesh).positions().size(), known.points);
  }
}

TEST(SurfaceData, NoSurfaceMadeByOthersIsForgotten) {
  NEED_DATA("surfaces made by others");
  const std::filesystem::path folder = data_folder();
  std::set<std::string> listed;
  for (const Known& known : known_surfaces()) listed.insert(known.file);
  for (const char* part : {"surfaces", "motion"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / part)) {
      const std::string name = std::filesystem::relative(entry.path(), folder).generic_string();
      if (entry.is_regular_file()) EXPECT_EQ(listed.count(name), 1U) << name;
    }
  }
}

TEST(SurfaceData, AMotionInTwoFilesMovesTheSurface) {
  NEED_DATA("surfaces made by others");
  const std::filesystem::path folder = data_folder();
  Surface surface(read_surface(folder / "motion/thick-cloth_t0.ply").mesh);
  const std::vector<Vec3> next = read_surface(folder / "motion/thick-cloth_t1.ply").mesh.points;
  surface.move(next);
  EXPECT_TRUE(std::equal(next.begin(), next.end(), surface.positions().begin(), surface.positions().end()));
}

}  // namespace dartcast::test::surface_data_test
