// Variants of .vtu files that VTK 9.1 does not read, or that not every writer makes.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "output/mesh_report_text.hpp"
#include "support/expectations.hpp"
#include "support/same_mesh.hpp"
#include "support/sample_mesh.hpp"
#include "support/shared_data.hpp"
#include "support/vtk_files.hpp"

namespace dartcast::test::vtu_variants_test {

using Numbers = std::vector<double>;

/// A hexahedron and a polyhedron on it; `faces`: the arrays of the latter's faces.
std::string on_cube(XmlData how, const std::vector<std::pair<std::string, Numbers>>& faces) {
  XmlArrays arrays(how);
  std::string out =
      "<VTKFile type=\"UnstructuredGrid\" version=\"2.3\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n"
      "<UnstructuredGrid><Piece NumberOfPoints=\"9\" NumberOfCells=\"2\">\n<Points>\n";
  out += arrays.add("Float64", "Name=\"Points\" NumberOfComponents=\"3\"",
                    {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0.5, 0.5, 2});
  out += "</Points>\n<Cells>\n";
  out += arrays.add("Int64", "Name=\"connectivity\"", {0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8});
  out += arrays.add("Int64", "Name=\"offsets\"", {8, 13}) + arrays.add("UInt8", "Name=\"types\"", {12, 42});
  for (const auto& [name, values] : faces) out += arrays.add("Int64", "Name=\"" + name + "\"", values);
  return out + "</Cells>\n</Piece></UnstructuredGrid>\n" + arrays.appended() + "</VTKFile>\n";
}

const std::vector<std::pair<std::string, Numbers>> old_faces = {
    {"faces", {5, 4, 4, 7, 6, 5, 3, 4, 5, 8, 3, 5, 6, 8, 3, 6, 7, 8, 3, 7, 4, 8}}, {"faceoffsets", {-1, 22}}};

std::vector<std::pair<std::string, Numbers>> new_faces() {
  return {{"face_connectivity", {4, 7, 6, 5, 4, 5, 8, 5, 6, 8, 6, 7, 8, 7, 4, 8}},
          {"face_offsets", {4, 7, 10, 13, 16}},
          {"polyhedron_to_faces", {0, 1, 2, 3, 4}},
          {"polyhedron_offsets", {0, 5}}};
}

MeshFile read(const std::string& content) {
  const Folder folder;
  return read_mesh(folder.file("a.vtu", content));
}

TEST(VtuVariants, FacesOfPolyhedraInEitherLayout) {
  for (const XmlData how : xml_data_kinds()) {
    const MeshFile old_file = read(on_cube(how, old_faces));
    const MeshFile new_file = read(on_cube(how, new_faces()));
    ASSERT_TRUE(old_file.report.valid()) << report_text(old_file.report);
    ASSERT_TRUE(new_file.report.valid()) << report_text(new_file.report);
    EXPECT_EQ(new_file.mesh.types, (std::vector<CellType>{CellType::hexahedron, CellType::polyhedron}));
    expect_same(new_file.mesh, old_file.mesh);
  }
  NEED_DATA("the same mesh in two versions of VTK's format");
  const auto folder = data_folder() / "regressions/turn3/vtk";
  expect_same(read_valid_mesh(folder / "new_2.3.vtu").mesh, read_valid_mesh(folder / "old_2.2.vtu").mesh);
}

TEST(VtuVariants, FacesThatAreNotRight) {
  const auto refusal = [](std::size_t array, Numbers values) {
    auto faces = new_faces();
    faces[array].second = std::move(values);
    const MeshFile file = read(on_cube(XmlData::ascii, faces));
    return file.report.valid() ? std::string("accepted") : file.report.defects[0].message;
  };
  expect_parts(refusal(1, {4, 7, 10, 13, 17}), {"face_connectivity", "16 numbers"});
  expect_parts(refusal(1, {4, 7, 6, 13, 16}), {"face_offsets", "ascend"});
  expect_parts(refusal(2, {0, 1, 2, 3, 5}), {"polyhedron_to_faces", "5 is no face"});
  expect_parts(refusal(2, {0, 1, 2, 3, -1}), {"polyhedron_to_faces", "-1 is no face"});
  expect_parts(refusal(2, {0, 0, 0, 3, 4}), {"more than two polyhedra"});
  expect_parts(refusal(3, {0, 6}), {"polyhedron_to_faces", "5 numbers"});
  expect_parts(refusal(3, {0}), {"polyhedron_offsets", "1 numbers"});
  expect_parts(refusal(3, {5, 5}), {"cell 0 has faces", "no polyhedron"});
  for (std::size_t missing = 0; missing < 4; ++missing) {
    auto faces = new_faces();
    faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(missing));
    EXPECT_FALSE(read(on_cube(XmlData::ascii, faces)).report.valid()) << missing;
  }
}

/// The same file with the header of each array in a run of base64 of its own.
std::string with_headers_apart(bool inline_data, bool short_header) {
  std::string appended;
  const auto array = [&](const std::string& attributes, const Bytes& data) {
    Bytes head;
    short_header ? head.number(static_cast<std::uint32_t>(data.out.size()))
                 : head.number(static_cast<std::uint64_t>(data.out.size()));
    const std::string text = base64(head.out) + base64(data.out);
    const std::string tag = "<DataArray " + attributes;
    if (inline_data) return tag + " format=\"binary\">\n  " + text + "\n</DataArray>\n";
    appended += text;
    return tag + " format=\"appended\" offset=\"" + std::to_string(appended.size() - text.size()) + "\"/>\n";
  };
  Bytes points, corners, ends, types;
  for (const float x : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F}) points.number(x);
  for (const std::int32_t v : {0, 1, 2, 3}) corners.number(v);
  ends.number(std::int32_t{4});
  types.number(std::uint8_t{10});
  std::string out = std::string("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" header_type=\"") +
                    (short_header ? "UInt32" : "UInt64") +
                    "\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points>" +
                    array("type=\"Float32\" NumberOfComponents=\"3\"", points) + "</Points>\n<Cells>" +
                    array("type=\"Int32\" Name=\"connectivity\"", corners);
  out += array("type=\"Int32\" Name=\"offsets\"", ends) + array("type=\"UInt8\" Name=\"types\"", types) +
         "</Cells></Piece></UnstructuredGrid>\n";
  if (!inline_data) out += "<AppendedData encoding=\"base64\">\n_" + appended + "\n</AppendedData>\n";
  return out + "</VTKFile>\n";
}

TEST(VtuVariants, HeadersEncodedApartFromTheData) {
  for (const bool inline_data : {false, true}) {
    for (const bool short_header : {false, true}) {
      const std::string whole = with_headers_apart(inline_data, short_header);
      const MeshFile file = read(whole);
      ASSERT_EQ(file.report.verdict(), Verdict::accept) << report_text(file.report);
      EXPECT_EQ(file.mesh.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
      EXPECT_EQ(file.mesh.connectivity, (std::vector<std::uint32_t>{0, 1, 2, 3}));
    }
  }
  NEED_DATA("a file of another writer");
  EXPECT_TRUE(read_mesh(data_folder() / "regressions/turn3/vtk/app_b64sep_u32_le.vtu").report.valid());
}

TEST(VtuVariants, CompressorsThatAreNotReadAreNamed) {
  std::string content = on_cube(XmlData::appended_raw, old_faces);
  content.replace(content.find(" header_type"), 0, " compressor=\"vtkLZMADataCompressor\"");
  expect_parts(read(content).report.defects.at(0).message, {"vtkLZMADataCompressor", "vtkZLibDataCompressor"});
}

TEST(VtuVariants, XmlThatCouldMeanSomethingElse) {
  const std::string whole = on_cube(XmlData::ascii, old_faces);
  const std::string entity = "<!DOCTYPE VTKFile [<!ENTITY a \"1 2 3\">]>\n" + whole;
  expect_parts(read(entity).report.defects.at(0).message, {"line 1", "document type"});
  std::string open = whole;
  open.replace(open.find("</Points>"), 9, "</Point>");
  expect_parts(read(open).report.defects.at(0).message, {"line 5", "mismatched tag"});
  std::string deep;
  for (int i = 0; i < 1000; ++i) deep += "<a>";
  expect_parts(read(deep).report.defects.at(0).message, {"line 1"});
  expect_parts(read("<VTKFile type=\"UnstructuredGrid\" version=\"4.0\"/>").report.defects.at(0).message,
               {"line 1", "version", "4.0"});
}

}  // namespace dartcast::test::vtu_variants_test
