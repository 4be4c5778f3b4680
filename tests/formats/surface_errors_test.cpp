// Files of surfaces that are wrong: the message says where and why.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "support/sample_mesh.hpp"
#include "support/surface_files.hpp"

namespace dartcast::test::surface_errors_test {

std::string error_of(const std::string& name, const std::string& content) {
  const Folder folder;
  const std::filesystem::path path = folder.file(name, content);
  try {
    read_surface(path);
  } catch (const InvalidMesh& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find(path.string() + ": "), 0U) << message;
    return message.substr(std::min(message.size(), path.string().size() + 2));
  }
  return "accepted";
}

std::string at_byte(std::size_t byte) { return "byte " + std::to_string(byte) + ": "; }

struct Wrong {
  std::string name, content, error;
};

std::vector<Wrong> wrong_stl() {
  const std::string facet = stl_facet({"0 0 0", "1 0 0", "0 1 0"});
  const std::string cut = stl_binary_cube("solid x").substr(0, 300);
  return {
      {"a.txt", "x", "end in '.txt' are not supported; supported are .stl, .obj, .ply"},
      {"a.stl", "", "the file is empty"},
      {"a.stl", "foo", "too short for .stl"},
      {"a.stl", cut, "byte 80: 12 triangles are announced, of 684 bytes in all, but the file has 300"},
      {"a.stl", stl_binary("x", {{Xyz{0, 0, 0}, Xyz{1, 0, 0}, Xyz{0, 1e39, 0}}}), "byte 134: a coordinate is not"},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loup", "line 3: 'loop' should stand here"},
      {"a.stl", "solid\n" + facet, "line 9: the file ends where 'facet' should stand; it is truncated"},
      {"a.stl", "solid\nendsolid\n", "the file has no faces"},
      {"a.stl", "solid\n" + stl_facet({"0 0 0", "1 0 nan", "0 1 0"}) + "endsolid", "line 6: a coordinate is not a fin"},
      {"a.stl", "solid\n" + facet + facet + facet + "endsolid", "edges of three faces or more"},
      {"a.stl", "solid\n" + stl_facet({"0 0 0", "1 0 0", "2 0 0"}) + "endsolid",
       "remove them, or move their corners (1"}};
}

std::vector<Wrong> wrong_obj() {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  std::string round = "f";
  for (int i = 1; i <= 1001; ++i) round += " " + std::to_string(i);
  return {{"a.obj", "v 0 0\nv 1 0 0", "line 1: the line ends where a coordinate should stand"},
          {"a.obj", "v 0 0 # 0\n", "line 1: the line ends where a coordinate should stand"},
          {"a.obj", "\nv 0 1e999 0\n", "line 2: a coordinate is not a finite number"},
          {"a.obj", "v 0 zero 0\n", "line 1: 'zero' is not a number"},
          {"a.obj", three + "f 1 2 3\nf\n", "line 5: a face of 0 corners"},
          {"a.obj", three + "f 1 2\n", "the file has no faces"},
          {"a.obj", three + round + "\n", "line 4: a face of 1001 corners"},
          {"a.obj", three + "f 1 2 x\n", "line 4: a corner should be written as v, v/vt"},
          {"a.obj", three + "f 1 2 0\n", "line 4: a corner is 0"},
          {"a.obj", three + "f 1 2 -4\n", "line 4: corner -4 of a face, but only 3 vertices"},
          {"a.obj", three + "f 1 2 3\nf 1 2 4\n", "name points which do not exist (1 in all, the first: 1)"},
          {"a.obj", three + "f 1 2 3\nf 1 2 4294967297\n", "name points which do not exist (1 in all, the first: 1)"},
          {"a.obj", three + "f 1 2 99999999999999999999\n", "line 4: a corner should be written"},
          {"a.obj", three + "f 1 2 2\n", "name a point twice"},
          {"a.obj", three, "the file has no faces"}};
}

std::vector<Wrong> wrong_ply() {
  const std::string ply = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string list = "property list uchar int vertex_indices\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string ply3 = ply + "element vertex 3\n" + xyz + "element face 1\n" + list + "end_header\n" + points;
  std::string bad_binary = ply_binary<float, std::uint8_t, std::int32_t>(false, cube_squares, "float", "uchar int");
  const std::size_t data = bad_binary.find("end_header\n") + 11;
  std::string no_corners = bad_binary;
  no_corners[data + 96] = '\0';
  bad_binary.replace(data + 4, 4, bytes_of(std::numeric_limits<float>::infinity()));
  return {
      {"a.ply", "plyx", "line 1: 'ply' should stand here"},
      {"a.ply", "ply\nformat binary 1.0\n", "line 2: the format should be ascii, binary_little_endian or"},
      {"a.ply", "ply\nformat ascii 2.0\n", "line 2: only version 1.0"},
      {"a.ply", ply + "property int x\n", "line 3: a property stands before the first element"},
      {"a.ply", ply + "element vertex 3\nproperty real x\n", "line 4: an unknown type; char"},
      {"a.ply", ply + "element vertex 3\nelement vertex 3\n", "line 4: a second element of this name"},
      {"a.ply", ply + "element vertex 3\nproperty int x\nproperty int x\n", "line 5: a second property of this name"},
      {"a.ply", ply + "element vertex 3\nproperty int x\nend_header\n", "line 5: the element vertex should have"},
      {"a.ply", ply + "element face 3\n" + list + "end_header\n", "line 5: there is no element vertex"},
      {"a.ply", ply + "element vertex 1\n" + xyz + "end_header\n0 0 0\n", "line 7: there is no element face; clouds"},
      {"a.ply", ply + "element face 1\nproperty list float int vertex_indices\n",
       "line 4: the length of a list should"},
      {"a.ply", ply + "element face 1\nproperty list uchar float vertex_indices\n",
       "line 4: corners of faces should be"},
      {"a.ply", ply + "elephant\n", "line 3: 'element', 'property', 'comment' or 'end_header' should stand here"},
      {"a.ply", ply3, "line 13: the file ends where a number of corners should stand"},
      {"a.ply", ply3 + "3 0 1\n", "line 14: the file ends where a corner should stand"},
      {"a.ply", ply3 + "3 0 1 2 5\n", "line 13: the file goes on behind its last element"},
      {"a.ply", ply3 + "3 0 1 2.5\n", "line 13: '2.5' is not a whole number"},
      {"a.ply", ply3 + "3 0 1 -1\n", "name points which do not exist (1 in all, the first: 0)"},
      {"a.ply", ply3 + "-3 0 1 2\n", "line 13: a face of -3 corners"},
      {"a.ply", ply3 + "1001 0 1 2\n", "line 13: a face of 1001 corners"},
      {"a.ply", ply3 + "2 0 1\n", "the file has no faces"},
      {"a.ply", bad_binary, at_byte(data + 12) + "a coordinate is not a finite number"},
      {"a.ply", no_corners, at_byte(data + 97) + "a face of 0 corners"},
      {"a.ply", bad_binary.substr(0, bad_binary.size() - 90), "a coordinate is not a finite number"},
      {"a.ply", ply3 + "3 0 1 4294967298\n", "do not exist (1 in all, the first: 0)"},
      {"a.ply",
       ply3.substr(0, ply3.find("end_header")) + "element x 1\nproperty list char char n\nend_header\n" + points +
           "3 0 1 2\n-1\n",
       "line 16: a list of -1 numbers"}};
}

std::vector<Wrong> wrong_off() {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  return {{"a.off", "4OFF\n", "line 1: only OFF with vertices of three coordinates"},
          {"a.off", "OFF BINARY\n", "line 1: binary OFF is not supported"},
          {"a.off", "OOF\n8 6 0\n", "line 1: 'OOF' is not a whole number"},
          {"a.off", "OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 3: the line ends too early"},
          {"a.off", "OFF\n3 1 0\n" + points + "3 0 1\n2\n", "line 6: the line ends too early"},
          {"a.off", "OFF\n3 1 0\n" + points + "3 0 1 2\n3 0 1 2\n", "line 7: the file goes on behind its last face"},
          {"a.off", "OFF\n3 1 0\n" + points + "3 0 1 3\n", "name points which do not exist (1 in all, the first: 0)"},
          {"a.off", "OFF\n3 1 0\n" + points + "3 0 1 4294967298\n", "do not exist (1 in all, the first: 0)"},
          {"a.off", "OFF\n3 100000000000 0\n" + points + "3 0 1 2\n", "line 2: 100000000000 faces are announced, but"},
          {"a.off", "OFF\n3 1 0\n" + points + "2 0 1\n", "the file has no faces"},
          {"a.off", "OFF\n3 0 0\n" + points, "the file has no faces"},
          {"a.off", "OFF\n3 1 0\n0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n", "line 4: a coordinate is not a finite number"}};
}

TEST(SurfaceErrors, ErrorsSayWhereAndWhat) {
  for (const auto& files : {wrong_stl(), wrong_obj(), wrong_ply(), wrong_off()}) {
    for (const Wrong& w : files)
      EXPECT_NE(error_of(w.name, w.content).find(w.error), std::string::npos)
          << w.content.substr(0, 200) << "\nshould be refused with: " << w.error
          << "\nbut was: " << error_of(w.name, w.content);
  }
  EXPECT_THROW(read_surface("/nowhere/a.stl"), InvalidMesh);
}

}  // namespace dartcast::test::surface_errors_test
