// Patches from the cell arrays of VTK's files, and runs whose inlets and outlets they are.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "output/mesh_report_text.hpp"
#include "scene/scene_mesh.hpp"
#include "support/same_mesh.hpp"
#include "support/vtk_files.hpp"

namespace dartcast::test::patch_files_test {

using Names = std::map<std::int32_t, std::string>;

/// Two cubes of free and one kind, then all boundary quadrilaterals, one triangle that is no cell's face, and arrays.
struct BoundaryFile {
  std::vector<std::vector<double>> faces = {{0, 2, 3, 1}, {8, 9, 11, 10}, {0, 1, 5, 4}, {4, 5, 9, 8}};
  std::string array_type = "Int32";
  std::vector<double> values;  ///< of the faces; characters where the type is String
  std::string array = "ModelFaceID";

  [[nodiscard]] std::string vtu(XmlData how) const {
    std::string text = cubes_vtu(how);
    XmlArrays arrays(how);
    std::vector<double> points;
    for (int x = 0; x <= 2; ++x) {
      for (int k = 0; k < 4; ++k)
        points.insert(points.end(), {static_cast<double>(x), k > 1 ? 1.0 : 0.0, k % 2 == 1 ? 1.0 : 0.0});
    }
    std::vector<double> corners = {0, 4, 6, 2, 1, 5, 7, 3, 4, 8, 10, 6, 5, 9, 11, 7};
    std::vector<double> ends = {8, 16};
    std::vector<double> types = {12, 12};
    for (const auto& face : faces) {
      corners.insert(corners.end(), face.begin(), face.end());
      ends.push_back(static_cast<double>(corners.size()));
      types.push_back(face.size() == 3 ? 5 : 9);
    }
    std::vector<double> all = array_type == "String" ? std::vector<double>{0, 0} : std::vector<double>{7, 7};
    all.insert(all.end(), values.begin(), values.end());
    const std::string grid =
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n"
        "<UnstructuredGrid>\n" +
        fmt::format("<Piece NumberOfPoints=\"12\" NumberOfCells=\"{}\">\n<CellData>\n", types.size()) +
        arrays.add(array_type, "Name=\"" + array + "\"", all) + "</CellData>\n<Points>\n" +
        arrays.add("Float64", "NumberOfComponents=\"3\"", points) + "</Points>\n<Cells>\n" +
        arrays.add("Int64", "Name=\"connectivity\"", corners) + arrays.add("Int64", "Name=\"offsets\"", ends) +
        arrays.add("UInt8", "Name=\"types\"", types) + "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
    return grid + arrays.appended() + "</VTKFile>\n";
  }
};

/// The same as a legacy file; `array` is the whole section of the array.
std::string boundary_vtk(bool binary, const std::string& array) {
  auto sections = cubes_vtk_sections(binary);
  const auto integers = [&](const std::vector<int>& values) {
    if (!binary) return fmt::format("{}\n", fmt::join(values, " "));
    Bytes bytes(true);
    for (const int x : values) bytes.number(static_cast<std::int32_t>(x));
    return bytes.out + "\n";
  };
  return sections[0] + sections[2] + "CELLS 4 28\n" +
         integers({8, 0, 4, 6, 2, 1, 5, 7, 3, 8, 4, 8, 10, 6, 5, 9, 11, 7, 4, 0, 2, 3, 1, 4, 8, 9, 11, 10}) +
         "CELL_TYPES 4\n" + integers({12, 12, 9, 9}) + "CELL_DATA 4\n" + array;
}

class PatchFiles : public testing::Test {
 protected:
  MeshFile read(const std::string& name, const std::string& content, const std::string& array = "") {
    return read_mesh(folder_.file(name, content), {array});
  }
  std::string refusal(const std::string& name, const std::string& content, const std::string& array) {
    const MeshReport report = read(name, content, array).report;
    return report.valid() ? "accepted" : report.defects[0].message;
  }
  Folder folder_;
};

TEST_F(PatchFiles, WholeNumbersAtBoundaryCells) {
  BoundaryFile file;
  file.values = {2, 3, 1, 0};
  for (const XmlData how : xml_data_kinds()) {
    for (const std::string type : {"Int32", "Int64", "UInt8", "Float64"}) {
      file.array_type = type;
      const MeshFile read_back = read("a.vtu", file.vtu(how), "ModelFaceID");
      EXPECT_EQ(read_back.report.verdict(), Verdict::accept) << report_text(read_back.report);
      EXPECT_EQ(faces_of(read_back.mesh), (Faces{{2, {0, 2, 3, 1}}, {3, {8, 9, 11, 10}}, {1, {0, 1, 5, 4}}}));
      EXPECT_EQ(read_back.mesh.patch_source, (std::vector<std::uint32_t>{2, 3, 4}));
      EXPECT_TRUE(read_back.mesh.patch_names.empty());
      EXPECT_TRUE(read("a.vtu", file.vtu(how)).mesh.patch_tags.empty());
    }
  }
}

TEST_F(PatchFiles, AnArrayNamedPatchIsTakenUnasked) {
  BoundaryFile file;
  file.array = "patch";
  file.values = {2, 3, 2, 3};
  EXPECT_EQ(read("a.vtu", file.vtu(XmlData::ascii)).mesh.patch_tags, (std::vector<std::int32_t>{2, 3, 2, 3}));
  const std::string array = "SCALARS patch int 1\nLOOKUP_TABLE default\n0 0 5 6\n";
  EXPECT_EQ(read("a.vtk", boundary_vtk(false, array)).mesh.patch_tags, (std::vector<std::int32_t>{5, 6}));
  // Another array may be asked for, with `patch` in the file.
  EXPECT_EQ(read("a.vtk", boundary_vtk(false, array + "SCALARS id int 1\nLOOKUP_TABLE default\n1 1 8 9\n"), "id")
                .mesh.patch_tags,
            (std::vector<std::int32_t>{8, 9}));
}

TEST_F(PatchFiles, TextsAtBoundaryCells) {
  BoundaryFile file;
  file.array = "patch";
  file.array_type = "String";
  file.values = characters({"outlet", "inlet & <more>", "outlet", ""});
  for (const XmlData how : xml_data_kinds()) {
    const MeshFile read_back = read("a.vtu", file.vtu(how));
    EXPECT_EQ(read_back.report.verdict(), Verdict::accept) << report_text(read_back.report);
    EXPECT_EQ(read_back.mesh.patch_tags, (std::vector<std::int32_t>{1, 2, 1}));
    EXPECT_EQ(read_back.mesh.patch_names, (Names{{1, "outlet"}, {2, "inlet & <more>"}}));
    EXPECT_EQ(read("a.vtu", file.vtu(how), "patch").mesh.patch_names, read_back.mesh.patch_names);
  }
  file.values = characters({"a", "b", "c"});
  EXPECT_NE(refusal("a.vtu", file.vtu(XmlData::ascii), "").find("array 'patch': it has 5 texts, where 6 should stand"),
            std::string::npos);
}

TEST_F(PatchFiles, TextsInLegacyFiles) {
  const std::string text =
      "FIELD FieldData 2\npatch 1 4 string\na\nb\nmain%20outlet\ninlet\nheat 1 4 double\n1 2 3 4\n";
  const MeshFile ascii = read("a.vtk", boundary_vtk(false, text));
  EXPECT_EQ(ascii.mesh.patch_names, (Names{{1, "main outlet"}, {2, "inlet"}})) << report_text(ascii.report);
  // In binary each text stands behind its length: of 1, 2, 4 or 8 bytes, by its two highest bits.
  const std::string name(300, 'x');
  const std::string lengths = std::string("\xc1") + "a" + std::string("\x80\x01", 2) + "b" +
                              std::string("\x81\x2c", 2) + name + std::string("\x40\0\0\x05", 4) + "inlet";
  const std::string binary =
      "FIELD FieldData 2\npatch 1 4 string\n" + lengths + "\nheat 1 4 int\n" + std::string(16, '\0') + "\n";
  const MeshFile read_back = read("a.vtk", boundary_vtk(true, binary));
  EXPECT_EQ(read_back.mesh.patch_names, (Names{{1, name}, {2, "inlet"}})) << report_text(read_back.report);
  EXPECT_EQ(read_back.mesh.cell_data.size(), 1U);
  const std::string whole = boundary_vtk(true, binary);
  for (std::size_t n = whole.find("patch"); n < whole.size() - 30; n += 3) (void)read("a.vtk", whole.substr(0, n));
  for (std::size_t at = whole.find("string"); at < whole.size(); ++at) {
    std::string damaged = whole;
    for (const char byte : {'\0', '\x3f', '\x7f', '\xbf', '\xff'}) {
      damaged[at] = byte;
      (void)read("a.vtk", damaged);
    }
  }
  for (const std::string name_in_file : {"%", "%4", "%zz", "%00", ""})
    (void)read("a.vtk", boundary_vtk(false, "FIELD f 1\npatch 1 4 string\na\nb\n" + name_in_file + "\nc\n"));
}

TEST_F(PatchFiles, ArraysThatCannotBeUsedAreRefusedInWords) {
  BoundaryFile file;
  file.values = {2, 3, 1, 0};
  const std::string whole = file.vtu(XmlData::ascii);
  EXPECT_NE(
      refusal("a.vtu", whole, "FaceID").find("'FaceID': there is no such array; the cell arrays are: ModelFaceID"),
      std::string::npos)
      << refusal("a.vtu", whole, "FaceID");
  file.array_type = "Float64";
  file.values = {2.5, 3, 1, 0};
  EXPECT_NE(refusal("a.vtu", file.vtu(XmlData::ascii), "ModelFaceID").find("whole numbers"), std::string::npos);
  file.faces.clear();
  file.values.clear();
  EXPECT_NE(refusal("a.vtu", file.vtu(XmlData::ascii), "ModelFaceID").find("angle = 30"), std::string::npos);
  EXPECT_NE(refusal("a.mesh", "MeshVersionFormatted 2\n", "ModelFaceID").find(".vtu and .vtk"), std::string::npos);
}

TEST_F(PatchFiles, ABoundaryCellThatIsNoCellsFaceIsAWarningWithItsNumber) {
  BoundaryFile file;
  file.faces = {{0, 2, 3, 1}, {0, 2, 3}, {8, 9, 11, 10}, {0, 4, 10, 6}};
  file.values = {2, 3, 1, 4};
  const MeshFile read_back = read("a.vtu", file.vtu(XmlData::ascii), "ModelFaceID");
  ASSERT_EQ(read_back.report.warnings.size(), 1U) << report_text(read_back.report);
  EXPECT_EQ(read_back.report.warnings[0].kind, "patch_faces");
  EXPECT_EQ(read_back.report.warnings[0].first, (std::vector<std::size_t>{3, 5}));
  EXPECT_EQ(read_back.mesh.patch_tags, (std::vector<std::int32_t>{2, 1}));
  EXPECT_EQ(read_back.mesh.patch_source, (std::vector<std::uint32_t>{2, 4}));
}

// Lines are the boundary cells of the plane.
TEST_F(PatchFiles, LinesInThePlane) {
  const std::string vtk =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 1 1 0 0 1 0\n"
      "CELLS 4 14\n4 0 1 2 3\n2 0 1\n2 1 2\n2 0 2\nCELL_TYPES 4\n9\n3\n3\n3\nCELL_DATA 4\n"
      "SCALARS side int 1\nLOOKUP_TABLE default\n0 4 5 6\n";
  const MeshFile file = read("a.vtk", vtk, "side");
  EXPECT_EQ(faces_of(file.mesh), (Faces{{4, {0, 1}}, {5, {1, 2}}}));
  ASSERT_EQ(file.report.warnings.size(), 1U);
  EXPECT_EQ(file.report.warnings[0].first, std::vector<std::size_t>{3});
}

// Written patches read back, twice over, whatever other arrays the mesh has.
TEST_F(PatchFiles, WrittenPatchesReadBack) {
  for (MeshData mesh : {sample_mesh(), planar_mesh()}) {
    mesh.cell_data = {{"patch", 1, {9, 9, 9, 9}}, {"region", 1, {5, 5, 5, 5}}};
    for (const std::string name : {"a.vtu", "a.vtk"}) {
      write_mesh(mesh, folder_ / name);
      MeshFile file = read_mesh(folder_ / name);
      expect_same(file.mesh, mesh);
      EXPECT_EQ(file.mesh.cell_data.size(), 1U);  // region
      if (name == "a.vtu") EXPECT_EQ(file.mesh.patch_names, mesh.patch_names);
      write_mesh(file.mesh, folder_ / name);
      expect_same(read_mesh(folder_ / name).mesh, mesh);
      const MeshFile by_name = read_mesh(folder_ / name, {"patch"});
      EXPECT_EQ(by_name.mesh.patch_tags, mesh.patch_tags);
      if (name == "a.vtu") EXPECT_EQ(by_name.mesh.patch_names, mesh.patch_names);
    }
    // A cell array of this name that says something of cells is kept, and does not undo the patches of `region`.
    mesh.patch_faces.clear();
    mesh.patch_offsets = {0};
    mesh.patch_tags.clear();
    write_mesh(mesh, folder_ / "b.vtu");
    EXPECT_EQ(read_mesh(folder_ / "b.vtu").mesh.cell_data.size(), 2U);
  }
}

/// A vessel as SimVascular writes it: tetrahedra, and the triangles of its faces with their numbers in ModelFaceID: 1
/// the wall, 2 the inlet below, 3 the outlet above.
std::string vessel_vtu(bool faces) {
  BoxOptions options;
  options.cells = {3, 3, 8};
  options.size = {0.003, 0.003, 0.008};
  options.type = CellType::tetrahedron;
  MeshData mesh = generate_box(options);
  for (std::int32_t& tag : mesh.patch_tags)
    tag = mesh.patch_names.at(tag) == "zmin" ? 2 : (mesh.patch_names.at(tag) == "zmax" ? 3 : 1);
  if (!faces) mesh.patch_tags.clear();
  std::vector<double> corners(mesh.connectivity.begin(), mesh.connectivity.end());
  std::vector<double> ends(mesh.offsets.begin() + 1, mesh.offsets.end());
  std::vector<double> types(mesh.cell_count(), 10.0);
  std::vector<double> tags(mesh.cell_count(), 0.0);
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    corners.insert(corners.end(), mesh.patch_face(f).begin(), mesh.patch_face(f).end());
    ends.push_back(static_cast<double>(corners.size()));
    types.push_back(5.0);
    tags.push_back(mesh.patch_tags[f]);
  }
  std::vector<double> points;
  for (const Vec3& p : mesh.points) points.insert(points.end(), {p.x, p.y, p.z});
  XmlArrays arrays(XmlData::appended_raw);
  const std::string grid =
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n"
      "<UnstructuredGrid>\n" +
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<PointData/>\n<CellData>\n", mesh.points.size(),
                  types.size()) +
      arrays.add("Int32", "Name=\"ModelFaceID\"", tags) + "</CellData>\n<Points>\n" +
      arrays.add("Float64", "Name=\"Points\" NumberOfComponents=\"3\"", points) + "</Points>\n<Cells>\n" +
      arrays.add("Int64", "Name=\"connectivity\"", corners) + arrays.add("Int64", "Name=\"offsets\"", ends) +
      arrays.add("UInt8", "Name=\"types\"", types) + "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
  return grid + arrays.appended() + "</VTKFile>\n";
}

std::string vessel_scene(const std::string& patches, const std::string& inlet, const std::string& outlet) {
  return "[environment]\nmesh = 'vessel.vtu'\npatches = " + patches + "\n[[particles]]\ninlet = '" + inlet +
         "'\nrate = 2000\nvelocity = [0, 0, 0.1]\n[motion]\ndt = 1e-3\nsteps = 200\n[contact.patch." + outlet +
         "]\nresponse = 'escape'\n";
}

TEST_F(PatchFiles, ParticlesEnterAndLeaveAVesselOfNumberedFaces) {
  (void)folder_.file("vessel.vtu", vessel_vtu(true));
  const Scene scene = parse_scene(vessel_scene("{ array = 'ModelFaceID' }", "2", "3"), folder_ / "vessel.toml");
  const Summary summary = run_scene(scene, {});
  EXPECT_EQ(summary.totals.injected, 400U);
  EXPECT_GT(summary.totals.escaped, 200U);
  EXPECT_EQ(summary.lost, 0U);
  const auto outlet = std::find(summary.patch_names.begin(), summary.patch_names.end(), "3");
  ASSERT_NE(outlet, summary.patch_names.end());
  EXPECT_EQ(summary.totals.contacts_by_patch[static_cast<std::size_t>(outlet - summary.patch_names.begin())],
            summary.totals.escaped);
}

// The same vessel without its triangles: sharp edges divide its walls.
TEST_F(PatchFiles, ParticlesEnterAndLeaveAVesselDividedByAngle) {
  (void)folder_.file("vessel.vtu", vessel_vtu(false));
  const Scene whole = parse_scene(vessel_scene("{ angle = 30 }", "patch1", "patch2"), folder_ / "vessel.toml");
  const MeshData mesh = load_scene_mesh(whole.environment).mesh;
  ASSERT_EQ(mesh.patch_names.size(), 6U);
  std::string inlet;
  std::string outlet;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    double sum = 0.0;
    for (const std::uint32_t v : mesh.patch_face(f)) sum += mesh.points[v].z;
    if (sum == 0.0) inlet = mesh.patch_names.at(mesh.patch_tags[f]);
    if (sum == 3 * 0.008) outlet = mesh.patch_names.at(mesh.patch_tags[f]);
  }
  const Scene scene = parse_scene(vessel_scene("{ angle = 30 }", inlet, outlet), folder_ / "vessel.toml");
  const Summary summary = run_scene(scene, {});
  EXPECT_EQ(summary.totals.injected, 400U);
  EXPECT_GT(summary.totals.escaped, 200U);
  EXPECT_EQ(summary.lost, 0U);
}

TEST_F(PatchFiles, KeysOfPatchesAreChecked) {
  const auto message = [&](const std::string& environment) {
    try {
      (void)parse_scene("[environment]\n" + environment, folder_ / "a.toml");
      return std::string("accepted");
    } catch (const Error& e) {
      return std::string(e.what());
    }
  };
  EXPECT_EQ(message("mesh = 'a.vtu'\npatches = { array = 'a' }"), "accepted");
  EXPECT_EQ(message("generator = 'box'\npatches = { angle = 20 }"), "accepted");
  for (const std::string patches : {"{ }", "{ array = 'a', angle = 30 }", "{ angle = 200 }", "{ angle = 'a' }",
                                    "{ array = 3 }", "{ arrays = 'a' }", "7"})
    EXPECT_NE(message("mesh = 'a.vtu'\npatches = " + patches).find("a.toml:3:"), std::string::npos)
        << message("mesh = 'a.vtu'\npatches = " + patches);
  EXPECT_NE(message("generator = 'box'\npatches = { array = 'a' }").find("mesh = \"FILE\""), std::string::npos);
}

}  // namespace dartcast::test::patch_files_test
