// Surfaces in .vtp files, and folders of SimVascular, whose patches they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "output/mesh_report_text.hpp"
#include "support/expectations.hpp"
#include "support/mutants.hpp"
#include "support/same_mesh.hpp"
#include "support/sample_mesh.hpp"
#include "support/simvascular_case.hpp"
#include "support/surface_files.hpp"
#include "support/tier.hpp"
#include "support/vtp_text.hpp"
#include "surface/check_surface.hpp"

namespace dartcast::test::vtp_surface_test {

std::vector<Vec3> corners_of_cube() {
  std::vector<Vec3> points;
  for (const Xyz& p : cube_points) points.push_back({p[0], p[1], p[2]});
  return points;
}

std::string cube_vtp(const std::string& at_cells = "") {
  return vtp_text(corners_of_cube(), cube_squares, "", at_cells);
}

TEST(VtpSurface, FacesAndGroups) {
  const Folder folder;
  const MeshFile plain = check_surface(folder.file("a.vtp", cube_vtp()));
  EXPECT_EQ(plain.report.verdict(), Verdict::accept) << report_text(plain.report);
  EXPECT_EQ(plain.report.format, "VTK XML (.vtp)");
  EXPECT_EQ(plain.mesh.points, corners_of_cube());
  EXPECT_EQ(plain.mesh.cell_count(), 6U);
  EXPECT_TRUE(plain.mesh.regions.empty());
  for (const char* name : {"patch", "region", "ModelFaceID"}) {
    const MeshFile file = check_surface(folder.file("a.vtp", cube_vtp(vtp_array(name, {7, 7, 0, 8, 8, 8}))));
    ASSERT_TRUE(file.report.valid()) << report_text(file.report);
    std::vector<std::string> names;
    for (const std::int32_t tag : file.mesh.regions) names.push_back(tag == 0 ? "" : file.mesh.region_names.at(tag));
    EXPECT_EQ(names, (std::vector<std::string>{"7", "7", "", "8", "8", "8"}));
  }
}

TEST(VtpSurface, FilesThatAreNotRight) {
  const Folder folder;
  const auto refused = [&](const std::string& content) {
    const MeshFile file = check_surface(folder.file("a.vtp", content));
    EXPECT_FALSE(file.report.valid()) << content;
  };
  refused("");
  refused("<VTKFile/>");
  refused("no xml");
  std::string far = cube_vtp();
  far.replace(far.find("0 3 2 1"), 1, "9");
  refused(far);
  refused(cube_vtp(vtp_array("patch", {1, 2})));
  refused(cube_vtp().substr(0, 600));
}

TEST(VtpSurface, MutantsGetAVerdict) {
  const Folder folder;
  const std::string whole = cube_vtp(vtp_array("patch", {7, 7, 0, 8, 8, 8}));
  Mutants mutants(29);
  const int rounds = scaled(20000, 200000);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    MeshFile file = check_surface(folder.file("a.vtp", mutants.damaged(whole)));
    if (!file.report.valid()) {
      ASSERT_FALSE(file.report.defects[0].message.empty()) << round;
      continue;
    }
    ++accepted;
    const MeshReport again = check_and_repair_surface(file.mesh);
    ASSERT_TRUE(again.valid() && again.repairs.empty()) << round << "\n" << report_text(again);
  }
  EXPECT_GT(accepted, rounds / 100);
}

// SimVascular.

MeshData tetrahedra() {
  BoxOptions options;
  options.cells = {3, 2, 2};
  options.size = {1.0, 1.0, 1.0};
  options.type = CellType::tetrahedron;
  return generate_box(options);
}

TEST(SimVascular, SurfacesNameThePatches) {
  for (const bool with_ids : {true, false}) {
    const Folder folder;
    const SimVascularCase made = write_simvascular_case(folder / "mesh-complete", tetrahedra(), with_ids);
    const MeshFile file = read_mesh(folder / "mesh-complete");
    EXPECT_EQ(file.report.verdict(), Verdict::accept) << report_text(file.report);
    EXPECT_EQ(file.report.format, "SimVascular");
    EXPECT_EQ(file.mesh.points, made.mesh.points);
    EXPECT_EQ(file.mesh.connectivity, made.mesh.connectivity);
    std::map<std::string, std::set<std::set<std::uint32_t>>> patches;
    for (std::size_t f = 0; f < file.mesh.patch_tags.size(); ++f)
      patches[file.mesh.patch_names.at(file.mesh.patch_tags[f])].insert(
          {file.mesh.patch_face(f).begin(), file.mesh.patch_face(f).end()});
    EXPECT_EQ(patches, made.patches);
    EXPECT_EQ(patches.size(), 6U);
  }
}

TEST(SimVascular, NumbersAndPlacesAgreeAndAFaceHasOnePatch) {
  const Folder folder;
  write_simvascular_case(folder / "case", tetrahedra(), true);
  const std::filesystem::path surfaces = folder / "case" / "mesh-surfaces";
  const std::string whole = slurp(surfaces / "xmin.vtp");
  std::filesystem::copy_file(surfaces / "xmin.vtp", surfaces / "z_copy.vtp");
  expect_parts(report_text(read_mesh(folder / "case").report), {"z_copy.vtp", "face 0 is in xmin.vtp, too"});
  std::filesystem::remove(surfaces / "z_copy.vtp");
  // The first two numbers change places.
  const std::size_t ids = whole.find('>', whole.find("GlobalNodeID")) + 1;
  std::istringstream in(whole.substr(ids));
  std::string a, b;
  in >> a >> b;
  std::string swapped = whole;
  swapped.replace(ids, swapped.find(b, ids + a.size()) + b.size() - ids, b + " " + a);
  write_bytes(surfaces / "xmin.vtp", swapped);
  expect_parts(report_text(read_mesh(folder / "case").report), {"xmin.vtp", "GlobalNodeID", "another point"});
}

TEST(SimVascular, FoldersThatAreNotRight) {
  const Folder folder;
  (void)write_simvascular_case(folder / "a", tetrahedra(), true);
  write_bytes(folder / "a/mesh-surfaces/far.vtp", vtp_text({{9, 9, 9}, {9, 9, 8}, {9, 8, 9}}, {{0, 1, 2}}));
  expect_parts(read_mesh(folder / "a").report.defects.at(0).message, {"far.vtp", "face 0", "does not have"});
  write_bytes(folder / "a/mesh-surfaces/far.vtp", "<VTKFile/>");
  expect_parts(read_mesh(folder / "a").report.defects.at(0).message, {"far.vtp"});
  write_bytes(folder / "a/mesh-complete.mesh.vtu", "nothing");
  expect_parts(read_mesh(folder / "a").report.defects.at(0).message, {"mesh-complete.mesh.vtu"});
}

}  // namespace dartcast::test::vtp_surface_test
