// Meshes made by others: counts from the list that comes with them, verdicts from their table of what is right.
#include "support/shared_data.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "dartcast/mesh_files.hpp"
#include "mesh/faces.hpp"
#include "output/mesh_report_text.hpp"
#include "support/same_mesh.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::test::shared_data_test {

using Counts = std::map<std::string, std::size_t>;

struct Expected {
  const char* file;
  std::size_t points;  // those that cells use
  Counts cells;
};

std::vector<Expected> volumes() {
  const char* t = "tetrahedron";
  const char* h = "hexahedron";
  const char* w = "prism";
  const char* p = "pyramid";
  return {{"volumes/petsc/hybrid_3d_cube.msh", 91, {{t, 117}, {w, 60}}},
          {"volumes/petsc/hybrid_hexwedge.msh", 224, {{w, 18}, {h, 84}}},
          {"volumes/petsc/hybrid_tetwedge.msh", 120, {{t, 99}, {w, 99}}},
          {"volumes/petsc/pyr_tet.msh", 62, {{t, 186}, {p, 24}}},
          {"volumes/petsc/gmsh-3d-ascii.msh2", 131, {{t, 364}}},
          {"volumes/petsc/gmsh-3d-binary.msh2", 131, {{t, 364}}},
          {"volumes/petsc/gmsh-3d-ascii.msh4", 131, {{t, 364}}},
          {"volumes/petsc/gmsh-3d-ascii-64.msh", 131, {{t, 364}}},
          {"volumes/petsc/gmsh-3d-binary-64.msh", 131, {{t, 364}}},
          {"volumes/petsc/mesh-3d-box-innersphere.msh", 150, {{t, 577}}},
          {"volumes/mfem/beam-wedge.vtk", 27, {{w, 8}}},
          {"volumes/mfem/beam-hex.vtk", 36, {{h, 8}}},
          {"volumes/mfem/escher.vtk", 26, {{t, 42}}},
          {"volumes/mfem/nested_cubes.msh", 138, {{t, 520}}},
          {"volumes/mfem/periodic-cube.msh", 125, {{h, 64}}},
          {"volumes/sfepy/elbow.mesh", 1823, {{t, 8161}}},
          {"volumes/sfepy/cylinder.vtk", 354, {{t, 1348}}},
          {"volumes/sfepy/acoustics_mesh3d.mesh", 5272, {{h, 4380}}},
          {"volumes/sfepy/perfusion_micro3d.mesh", 3728, {{t, 18161}}},
          {"volumes/sfepy/bridge3d.vtk", 875, {{h, 576}}},
          {"volumes/sfepy/unit_ball.mesh", 362, {{t, 1110}}},
          {"volumes/sfepy/cube_medium_tetra.mesh", 448, {{t, 1782}}},
          {"volumes/sfepy/cut-cylinder.vtk", 1147, {{t, 3279}}},
          {"volumes/sfepy/multi_material_cylinder_plate.vtk", 2101, {{t, 10440}}},
          {"volumes/sfepy/wheelset.vtk", 5457, {{t, 21934}}},
          {"volumes/sfepy/matrix_fiber.mesh", 2421, {{h, 1952}}},
          {"volumes/sfepy/msh_tetra.msh", 66, {{t, 127}}},
          {"volumes/sofa/liver.msh", 181, {{t, 596}}},
          {"volumes/sofa/liver2.msh", 507, {{t, 1493}}},
          {"volumes/sofa/volumetricTongue.vtu", 2238, {{t, 10980}}},
          {"volumes/sofa/cylinder_Hexa.msh", 5740, {{h, 4920}}},
          {"volumes/sofa/torus_low_res.msh", 264, {{t, 862}}},
          {"volumes/sofa/nine_hexa.msh", 32, {{h, 9}}},
          {"volumes/sofa/A.vtk", 413, {{t, 1116}}},
          {"derived/aneurysm3d.box.msh", 4615, {{t, 26022}}},
          {"derived/aneurysm3d.lumen.msh", 3969, {{t, 13260}}},
          {"derived/femur.lumen.msh", 7037, {{t, 31542}}}};
}

struct ExpectedPlanar {
  const char* file;
  std::size_t points, triangles, quadrilaterals, boundary_edges;
};

/// As the list says, apart from Exodus files, which are not read.
std::vector<ExpectedPlanar> planar_files() {
  return {{"planar/petsc/hybrid_triquad.msh", 48, 39, 16, 23},
          {"planar/petsc/square_quad.msh", 250, 0, 196, 106},
          {"planar/mfem/star.vtk", 31, 0, 20, 20},
          {"planar/mfem/square-disc.vtk", 101, 154, 0, 48},
          {"planar/mfem/compass.msh", 13, 8, 4, 8},
          {"planar/sfepy/square_triquad.mesh", 470, 458, 200, 80},
          {"planar/sfepy/osteonT1_11.mesh", 1228, 2292, 0, 162},
          {"planar/sfepy/channels_symm944t.mesh", 510, 944, 0, 74}};
}

TEST(SharedData, EveryPlanarMeshLoadsAndSurvivesARoundTrip) {
  NEED_DATA("meshes made by others");
  const Folder folder;
  for (const ExpectedPlanar& expected : planar_files()) {
    SCOPED_TRACE(expected.file);
    const MeshFile original = read_mesh(data_folder() / expected.file);
    const MeshReport& report = original.report;
    EXPECT_LE(static_cast<int>(report.verdict()), static_cast<int>(Verdict::repair)) << report_text(report);
    for (const Finding& repair : report.repairs) EXPECT_EQ(repair.kind, "unused_points");
    EXPECT_EQ(report.dimension, 2);
    EXPECT_EQ(report.points, expected.points);
    EXPECT_EQ(report.parts, 1U);
    Counts cells;
    if (expected.triangles > 0) cells["triangle"] = expected.triangles;
    if (expected.quadrilaterals > 0) cells["quadrilateral"] = expected.quadrilaterals;
    EXPECT_EQ(report.cells, cells);
    EXPECT_EQ(match_faces(original.mesh).boundary.size(), expected.boundary_edges);
    for (const char* name : {"a.vtu", "a.vtk", "a.msh", "a.msh4", "a.mesh"}) {
      write_mesh(original.mesh, folder / name);
      const MeshFile copy = read_mesh(folder / name);
      EXPECT_EQ(copy.report.verdict(), Verdict::accept) << name << "\n" << report_text(copy.report);
      expect_same(copy.mesh, original.mesh);
    }
  }
}

TEST(SharedData, NoPlanarMeshIsForgotten) {
  NEED_DATA("meshes made by others");
  std::set<std::string> listed;
  for (const ExpectedPlanar& expected : planar_files()) listed.insert(expected.file);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder() / "planar")) {
    if (!entry.is_regular_file()) continue;
    if (entry.path().extension() == ".exo") {
      EXPECT_EQ(read_mesh(entry.path()).report.verdict(), Verdict::refuse) << entry.path();
      continue;
    }
    EXPECT_EQ(listed.count(std::filesystem::relative(entry.path(), data_folder()).generic_string()), 1U)
        << entry.path();
  }
}

TEST(SharedData, PatchesOfPlanarMeshesAreTheirNamedLines) {
  NEED_DATA("meshes made by others");
  const MeshData square = read_mesh(data_folder() / "planar/petsc/square_quad.msh").mesh;
  EXPECT_EQ(square.patch_names,
            (std::map<std::int32_t, std::string>{{2, "bottom"}, {3, "rightside"}, {4, "top"}, {5, "leftside"}}));
  std::map<std::int32_t, std::size_t> edges;
  for (const std::int32_t tag : square.patch_tags) ++edges[tag];
  EXPECT_EQ(edges, (std::map<std::int32_t, std::size_t>{{2, 49}, {3, 4}, {4, 49}, {5, 4}}));
}

TEST(SharedData, EveryVolumeLoadsWithoutAWarning) {
  NEED_DATA("meshes made by others");
  for (const Expected& expected : volumes()) {
    const MeshReport report = read_mesh(data_folder() / expected.file).report;
    EXPECT_LE(static_cast<int>(report.verdict()), static_cast<int>(Verdict::repair)) << report_text(report);
    EXPECT_EQ(report.points, expected.points) << expected.file;
    EXPECT_EQ(report.cells, expected.cells) << expected.file;
    for (const Finding& repair : report.repairs) EXPECT_EQ(repair.kind, "unused_points") << expected.file;
  }
}

TEST(SharedData, NoVolumeIsForgotten) {
  NEED_DATA("meshes made by others");
  std::set<std::string> listed;
  for (const Expected& expected : volumes()) listed.insert(expected.file);
  for (const char* folder : {"volumes", "derived"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder() / folder)) {
      const std::string ending = entry.path().extension().string();
      const bool ours = ending == ".vtu" || ending == ".vtk" || ending.substr(0, 4) == ".msh" || ending == ".mesh";
      if (!entry.is_regular_file() || !ours) continue;
      if (slurp(entry.path()).substr(0, 5) == "MFEM ") {
        EXPECT_EQ(read_mesh(entry.path()).report.verdict(), Verdict::refuse) << entry.path();
        continue;
      }
      EXPECT_EQ(listed.count(std::filesystem::relative(entry.path(), data_folder()).generic_string()), 1U)
          << entry.path();
    }
  }
}

/// Files that were misread once, and counts of what they hold: of points, cells, regions and patches.
TEST(SharedData, FilesThatWereMisreadAreReadRight) {
  NEED_DATA("files of turn 3");
  struct Right {
    const char* file;
    std::size_t points;
    Counts cells, regions, patches;
  };
  const Counts halves = {{"lumen", 100}, {"tissue", 100}};
  const std::vector<Right> files = {
      {"gmsh/parts41.msh", 78, {{"tetrahedron", 200}}, halves, {{"inlet", 14}, {"outlet", 14}}},
      {"gmsh/groups22.msh",
       78,
       {{"tetrahedron", 200}},
       {{"grain", 100}, {"phase", 100}},
       {{"hull", 140}, {"inlet", 14}}},
      {"gmsh/par22.msh", 78, {{"tetrahedron", 200}}, halves, {{"inlet", 14}, {"outlet", 14}}},
      {"medit/words_in_text.mesh", 5, {{"triangle", 4}}, {{"7", 4}}, {{"11", 1}, {"12", 1}, {"13", 1}, {"14", 1}}},
      {"vtk/new_2.3.vtu", 12, {{"hexahedron", 1}, {"polyhedron", 1}}, {}, {}},
      {"vtk/plain.pvtu", 20, {{"hexahedron", 4}}, {}, {}},
      {"vtk/ghost.pvtu", 20, {{"hexahedron", 4}}, {}, {}},
      {"vtk/two_pieces.vtu", 20, {{"hexahedron", 4}}, {}, {}},
      {"vtk/wedge_pyramid_as_hex.vtu", 11, {{"hexahedron", 1}, {"prism", 1}, {"pyramid", 1}}, {}, {}},
      {"vtk/app_b64sep_u32_le.vtu", 5, {{"tetrahedron", 2}}, {}, {}},
      {"processor_cyclic/case", 20, {{"hexahedron", 4}}, {}, {{"left", 1}, {"right", 1}, {"walls", 16}}},
      {"field_macros/case/0", 12, {{"hexahedron", 2}}, {}, {}}};
  const std::filesystem::path folder = data_folder() / "regressions" / "turn3";
  for (const Right& right : files) {
    const MeshFile file = read_mesh(folder / right.file);
    SCOPED_TRACE(report_text(file.report));
    ASSERT_TRUE(file.report.valid());
    EXPECT_EQ(file.report.points, right.points);
    EXPECT_EQ(file.report.parts, 1U);
    EXPECT_EQ(file.report.cells, right.cells);
    if (!right.regions.empty()) EXPECT_EQ(file.report.regions, right.regions);
    Counts patches;
    for (const std::int32_t tag : file.mesh.patch_tags) {
      const auto name = file.mesh.patch_names.find(tag);
      ++patches[name == file.mesh.patch_names.end() ? std::to_string(tag) : name->second];
    }
    if (!right.patches.empty()) EXPECT_EQ(patches, right.patches);
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder / "surfaces")) {
    const MeshFile file = check_surface(entry.path());
    EXPECT_TRUE(file.report.valid() && file.report.points == 8 && file.mesh.cell_count() == 12)
        << report_text(file.report);
  }
  EXPECT_TRUE(read_mesh(folder / "simvascular" / "good").report.valid());
  EXPECT_FALSE(read_mesh(folder / "simvascular" / "swapped_ids").report.valid());
}

TEST(SharedData, DefectiveFilesGetTheRightVerdict) {
  NEED_DATA("meshes made by others");
  std::ifstream table(data_folder() / "EXPECTED.csv");
  std::string line;
  std::getline(table, line);
  int files = 0;
  while (std::getline(table, line)) {
    const std::size_t first = line.find(',');
    const std::string file = line.substr(0, first);
    const std::string allowed = "|" + line.substr(first + 1, line.find(',', first + 1) - first - 1) + "|";
    const MeshReport report = read_mesh(data_folder() / file).report;
    const std::string verdict = "|" + std::string(verdict_name(report.verdict())) + "|";
    EXPECT_NE(allowed.find(verdict), std::string::npos) << line << "\n" << report_text(report);
    ++files;
  }
  EXPECT_GE(files, 21);
}

/// Each list of findings as kind: count.
std::map<std::string, std::size_t> kinds(const std::vector<Finding>& findings) {
  std::map<std::string, std::size_t> out;
  for (const Finding& f : findings) out[f.kind] = f.count;
  return out;
}

TEST(SharedData, DefectsAreCountedAsTheListSays) {
  NEED_DATA("meshes made by others");
  const auto report = [](const char* file) { return read_mesh(data_folder() / "defective" / file).report; };
  EXPECT_EQ(kinds(report("sfepy/elbow2.mesh").repairs), (Counts{{"orientation", 8161}}));
  EXPECT_EQ(kinds(report("sfepy/matrix_fiber_rand.vtk").repairs), (Counts{{"orientation", 97}}));
  EXPECT_EQ(kinds(report("sofa/6_tetra_bad.msh").repairs), (Counts{{"orientation", 1}}));
  EXPECT_EQ(kinds(report("sofa/SimpleBeamHexa.msh").repairs), (Counts{{"orientation", 3}}));
  EXPECT_EQ(kinds(report("sfepy/helmholtz_apartment.vtk").repairs), (Counts{{"orientation", 524}}));
  EXPECT_EQ(report("sofa/6_tetra_bad.msh").parts, 6U);
  EXPECT_EQ(report("sfepy/beam_t42.mesh").parts, 2U);
  EXPECT_EQ(report("sfepy/beam_h5t12.mesh").parts, 6U);
  EXPECT_EQ(kinds(report("sfepy/beam_t42.mesh").warnings)["boundary_edges"], 22U);
  EXPECT_EQ(kinds(report("sfepy/beam_h5t12.mesh").warnings)["boundary_edges"], 20U);
  EXPECT_EQ(kinds(report("sfepy/beam_t42.mesh").warnings).count("non_conforming"), 1U);
  EXPECT_EQ(kinds(report("sfepy/beam_h5t12.mesh").warnings).count("non_conforming"), 1U);
  EXPECT_EQ(kinds(report("sofa/Ossicles.vtu").warnings)["boundary_edges"], 18U);
  EXPECT_EQ(kinds(report("sofa/Armadillo_Tetra_4406.vtu").warnings), (Counts{{"boundary_points", 1}}));
  EXPECT_EQ(report("sfepy/hanging_nodes.mesh").dimension, 2);
  EXPECT_EQ(kinds(report("sfepy/hanging_nodes.mesh").warnings).count("non_conforming"), 1U);
}

TEST(SharedData, EveryVolumeSurvivesARoundTrip) {
  NEED_DATA("meshes made by others");
  const Folder folder;
  for (const Expected& expected : volumes()) {
    if (repeats_smaller_ones(expected.points)) continue;
    const MeshFile original = read_mesh(data_folder() / expected.file);
    for (const char* name : {"a.vtu", "a.vtk", "a.msh", "a.msh4", "a.mesh"}) {
      write_mesh(original.mesh, folder / name);
      const MeshFile copy = read_mesh(folder / name);
      EXPECT_EQ(copy.report.verdict(), Verdict::accept) << expected.file << " " << name << "\n"
                                                        << report_text(copy.report);
      EXPECT_TRUE(copy.mesh.points == original.mesh.points) << expected.file << " " << name;
      EXPECT_EQ(copy.report.cells, original.report.cells) << expected.file << " " << name;
      EXPECT_EQ(copy.mesh.patch_tags.size(), original.mesh.patch_tags.size()) << expected.file << " " << name;
    }
  }
}

}  // namespace dartcast::test::shared_data_test
