// Surfaces from .stl, .obj, .ply and .off: written here by hand, and damaged.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/surface.hpp"
#include "output/mesh_report_text.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"
#include "surface/check_surface.hpp"

namespace dartcast::test::surface_files_test {

using Xyz = std::array<double, 3>;
using Loop = std::vector<Xyz>;
using Ids = std::vector<std::uint32_t>;

const std::vector<Xyz> cube_points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                      {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<Ids> cube_squares = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                       {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

std::vector<Ids> cube_triangles() {
  std::vector<Ids> out;
  for (const Ids& s : cube_squares) {
    out.push_back({s[0], s[1], s[2]});
    out.push_back({s[0], s[2], s[3]});
  }
  return out;
}

/// Each face by the coordinates of its corners, from the least one on.
std::vector<Loop> sorted_loops(std::vector<Loop> loops) {
  for (Loop& loop : loops) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  std::sort(loops.begin(), loops.end());
  return loops;
}

std::vector<Loop> loops_of(const MeshData& mesh) {
  std::vector<Loop> loops;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    Loop loop;
    for (const std::uint32_t v : mesh.cell(c)) loop.push_back({mesh.points[v].x, mesh.points[v].y, mesh.points[v].z});
    loops.push_back(loop);
  }
  return sorted_loops(loops);
}

std::vector<Loop> loops_of(const std::vector<Ids>& faces) {
  std::vector<Loop> loops;
  for (const Ids& face : faces) {
    Loop loop;
    for (const std::uint32_t v : face) loop.push_back(cube_points[v]);
    loops.push_back(loop);
  }
  return sorted_loops(loops);
}

std::string words(const Xyz& p) {
  const auto digits = [](double x) { return std::to_string(static_cast<int>(x)); };
  return digits(p[0]) + " " + digits(p[1]) + " " + digits(p[2]);
}

// --- files by hand

template <class T>
std::string bytes_of(T value, bool big = false) {
  std::string out(sizeof(T), '\0');
  std::memcpy(out.data(), &value, sizeof(T));
  if (big) std::reverse(out.begin(), out.end());
  return out;
}

std::string stl_facet(const std::array<std::string, 3>& corners) {
  std::string out = "facet normal nan -nan(ind) 0\nouter loop\n";
  for (const std::string& corner : corners) out += "vertex " + corner + "\n";
  return out + "endloop\nendfacet\n";
}

std::string stl_text() {
  std::string out = "solid cube\n";
  for (const Ids& t : cube_triangles())
    out += stl_facet({words(cube_points[t[0]]), words(cube_points[t[1]]), words(cube_points[t[2]])});
  return out + "endsolid\n";
}

std::string stl_binary(const std::string& comment, const std::vector<std::array<Xyz, 3>>& triangles) {
  std::string out = comment + std::string(80 - comment.size(), ' ');
  out += bytes_of(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) out += bytes_of(std::numeric_limits<float>::quiet_NaN());
    for (const Xyz& p : t) {
      for (const double x : p) out += bytes_of(static_cast<float>(x));
    }
    out += "ab";
  }
  return out;
}

std::string stl_binary_cube(const std::string& comment) {
  std::vector<std::array<Xyz, 3>> triangles;
  for (const Ids& t : cube_triangles()) triangles.push_back({cube_points[t[0]], cube_points[t[1]], cube_points[t[2]]});
  return stl_binary(comment, triangles);
}

std::string obj(const std::vector<Ids>& faces, const std::string& behind = "") {
  std::string out = "# a cube\nmtllib none.mtl\no cube\n";
  for (const Xyz& p : cube_points) out += "v " + words(p) + "\n";
  out += "vt 0 0\nvn 0 0 1\ns off\n";
  for (const Ids& face : faces) {
    out += "f";
    for (const std::uint32_t v : face) out += " " + std::to_string(v + 1) + behind;
    out += "\n";
  }
  return out;
}

std::string ply_header(const std::string& format, std::size_t faces, const std::string& real, const std::string& list) {
  return "ply\nformat " + format + " 1.0\ncomment end_header element\nobj_info x\nelement vertex 8\nproperty " + real +
         " x\nproperty " + real + " y\nproperty " + real + " z\nelement face " + std::to_string(faces) +
         "\nproperty list " + list + " vertex_indices\nend_header\n";
}

std::string ply_text(const std::vector<Ids>& faces) {
  std::string out = ply_header("ascii", faces.size(), "float", "uchar int");
  for (const Xyz& p : cube_points) out += words(p) + "\n";
  for (const Ids& face : faces) {
    out += std::to_string(face.size());
    for (const std::uint32_t v : face) out += " " + std::to_string(v);
    out += "\n";
  }
  return out;
}

template <class Real, class Count, class Id>
std::string ply_binary(bool big, const std::vector<Ids>& faces, const std::string& types, const std::string& list) {
  std::string out = ply_header(big ? "binary_big_endian" : "binary_little_endian", faces.size(), types, list);
  for (const Xyz& p : cube_points) {
    for (const double x : p) out += bytes_of(static_cast<Real>(x), big);
  }
  for (const Ids& face : faces) {
    out += bytes_of(static_cast<Count>(face.size()), big);
    for (const std::uint32_t v : face) out += bytes_of(static_cast<Id>(v), big);
  }
  return out;
}

std::string off(const std::vector<Ids>& faces, const std::string& header = "OFF\n", const std::string& edges = " 0",
                const std::string& behind_point = "", const std::string& behind_face = "") {
  std::string out = header + "8 " + std::to_string(faces.size()) + edges + "\n";
  for (const Xyz& p : cube_points) out += words(p) + behind_point + "\n";
  for (const Ids& face : faces) {
    out += std::to_string(face.size());
    for (const std::uint32_t v : face) out += " " + std::to_string(v);
    out += behind_face + "\n";
  }
  return out;
}

struct Sample {
  std::string name;
  std::string content;
  bool triangles = false;
};

/// A cube in each format and variant.
std::vector<Sample> cubes() {
  const std::vector<Ids> t = cube_triangles();
  const std::vector<Ids>& s = cube_squares;
  return {{"a.stl", stl_text(), true},
          {"b.stl", stl_binary_cube("made by hand"), true},
          {"c.STL", stl_binary_cube("solid, but binary"), true},
          {"d.obj", obj(s)},
          {"e.obj", obj(t, "/1/1"), true},
          {"f.obj", obj(s, "//1")},
          {"g.obj", obj(s, "/1")},
          {"h.ply", ply_text(s)},
          {"i.ply", ply_text(t), true},
          {"j.ply", ply_binary<float, std::uint8_t, std::int32_t>(false, s, "float", "uchar int")},
          {"k.ply", ply_binary<double, std::int8_t, std::uint32_t>(true, t, "float64", "int8 uint32"), true},
          {"l.ply", ply_binary<std::int16_t, std::uint32_t, std::uint8_t>(true, s, "short", "uint uint8")},
          {"m.ply", ply_binary<std::uint8_t, std::int16_t, std::int8_t>(false, s, "uchar", "int16 char")},
          {"n.ply", ply_binary<std::int8_t, std::uint16_t, std::uint16_t>(true, s, "int8", "ushort uint16")},
          {"o.ply", ply_binary<std::uint32_t, std::int32_t, std::int16_t>(true, s, "uint32", "int32 short")},
          {"p.off", off(s)},
          {"q.off", off(t, "", ""), true},
          {"r.off", off(s, "COFF\n\n# colours\n", "\t24 # edges", "  255 0 0 255", "  1.0 0 0 # red")},
          {"s.off", off(s, "STCNOFF ", " 24", " 0 0 1 1 1 1 1 0 0")}};
}

// --- the same from all

TEST(SurfaceFiles, TheSameCubeFromEveryFormat) {
  const Folder folder;
  for (const Sample& s : cubes()) {
    SCOPED_TRACE(s.name);
    const MeshFile file = read_surface(folder.file(s.name, s.content));
    EXPECT_EQ(file.report.verdict(), Verdict::accept) << report_text(file.report);
    EXPECT_FALSE(file.report.format.empty());
    EXPECT_EQ(file.report.parts, 1U);
    const bool triangles = file.mesh.types[0] == CellType::triangle;
    EXPECT_EQ(file.mesh.types[0], s.triangles ? CellType::triangle : CellType::quadrilateral);
    EXPECT_EQ(loops_of(file.mesh), loops_of(triangles ? cube_triangles() : cube_squares));
    ASSERT_EQ(file.mesh.points.size(), 8U);
    for (std::size_t i = 0; i < 8 && !s.name.ends_with(".stl") && !s.name.ends_with(".STL"); ++i)
      EXPECT_EQ(file.mesh.points[i], (Vec3{cube_points[i][0], cube_points[i][1], cube_points[i][2]}));
    EXPECT_EQ(Surface(file.mesh).triangles().size(), 12U);
  }
}

TEST(SurfaceFiles, LinesMayEndInTwoBytes) {
  const Folder folder;
  for (const Sample& s : cubes()) {
    std::string content;
    const std::size_t text = s.content.find("end_header");
    const bool binary = s.content.find("binary_") != std::string::npos;
    if (s.content.find('\0') != std::string::npos && !binary) continue;
    for (std::size_t i = 0; i < s.content.size(); ++i) {
      if (s.content[i] == '\n' && (!binary || i < text + 12)) content += '\r';
      content += s.content[i];
    }
    const MeshFile file = check_surface(folder.file(s.name, content));
    ASSERT_TRUE(file.report.valid()) << s.name << report_text(file.report);
    EXPECT_EQ(loops_of(file.mesh),
              loops_of(file.mesh.types[0] == CellType::triangle ? cube_triangles() : cube_squares));
  }
}

// --- what each format has of its own

MeshFile read(const std::string& name, const std::string& content) {
  const Folder folder;
  return read_surface(folder.file(name, content));
}

Ids corners_of(const MeshData& mesh) { return {mesh.connectivity.begin(), mesh.connectivity.end()}; }

TEST(SurfaceFiles, CornersOfStlAreJoinedWhereTheyAreExactlyEqual) {
  const MeshFile file = read("a.stl", "solid\n" + stl_facet({"5 0 0", "-0 -0.0 1", "0 1 0"}) +
                                          stl_facet({"0 +1e0 -0", "0 0 1.0", "-5 0 0"}) +
                                          stl_facet({"5.0000000000000009 0 0", "0 1 0", "7 7 7"}) + "endsolid x");
  EXPECT_EQ(corners_of(file.mesh), (Ids{0, 1, 2, 2, 1, 3, 4, 2, 5}));
  ASSERT_EQ(file.mesh.points.size(), 6U);
  EXPECT_FALSE(std::signbit(file.mesh.points[1].x) || std::signbit(file.mesh.points[1].y));
  EXPECT_EQ(file.mesh.points[3], (Vec3{-5, 0, 0}));
  EXPECT_TRUE(file.mesh.source.empty());
}

TEST(SurfaceFiles, CollapsedTrianglesOfStlAreLeftOutAndCounted) {
  const MeshFile file = read(
      "a.stl", "solid a\n" + stl_facet({"0 0 0", "1 0 0", "-0 0 0"}) + stl_facet({"0 0 0", "1 0 0", "0 1 0"}) +
                   stl_facet({"2 2 2", "2 2 2", "2 2 2"}) + stl_facet({"0 1 0", "1 0 0", "1 1 0"}) + "endsolid a\n");
  EXPECT_EQ(loops_of(file.mesh), sorted_loops({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {1, 0, 0}, {1, 1, 0}}}));
  EXPECT_EQ(file.mesh.source, (Ids{1, 3}));
  EXPECT_EQ(file.mesh.regions, (std::vector<std::int32_t>{1, 1}));
  ASSERT_EQ(file.report.repairs.size(), 1U);
  EXPECT_EQ(file.report.repairs[0].kind, "collapsed");
  EXPECT_EQ(file.report.repairs[0].count, 2U);
  EXPECT_EQ(file.report.repairs[0].first, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(file.report.verdict(), Verdict::warn);  // its borders are open
}

/// Against a table filled corner by corner.
TEST(SurfaceFiles, CornersOfStlAreNumberedByFirstAppearance) {
  std::mt19937 random(3);
  const Folder folder;
  const std::vector<double> values = {-0.0, 0.0, 1.0, -1.0, 1.5, 1e-30, -1e30};
  for (int round = 0; round < scaled(300, 20000); ++round) {
    std::vector<std::array<Xyz, 3>> triangles(1 + random() % 12);
    std::map<Xyz, std::uint32_t> number;
    Ids expected;
    for (auto& t : triangles) {
      Ids ids;
      for (Xyz& p : t) {
        for (double& x : p) x = values[random() % values.size()];
        Xyz key = p;
        for (double& x : key) x = static_cast<double>(static_cast<float>(x == 0.0 ? 0.0 : x));
        ids.push_back(number.try_emplace(key, static_cast<std::uint32_t>(number.size())).first->second);
      }
      if (std::set<std::uint32_t>(ids.begin(), ids.end()).size() == 3)
        expected.insert(expected.end(), ids.begin(), ids.end());
    }
    const MeshFile file = check_surface(folder.file("a.stl", stl_binary("x", triangles)));
    if (expected.empty()) {
      EXPECT_FALSE(file.report.valid());
      continue;
    }
    ASSERT_EQ(file.mesh.points.size(), number.size());
    for (const auto& [p, i] : number) EXPECT_EQ(file.mesh.points[i], (Vec3{p[0], p[1], p[2]}));
    const bool turned = std::any_of(file.report.repairs.begin(), file.report.repairs.end(),
                                    [](const Finding& f) { return f.kind == "orientation"; });
    if (!turned) EXPECT_EQ(corners_of(file.mesh), expected);
  }
}

TEST(SurfaceFiles, SolidsOfStlAreRegions) {
  const std::string a = stl_facet({"0 0 0", "1 0 0", "0 1 0"});
  const std::string b = stl_facet({"0 1 0", "1 0 0", "1 1 0"});
  const MeshData two = read("a.stl", "  SOLID  the wall \r\n" + a + "EndSolid\nsolid end\n" + b + "endsolid").mesh;
  EXPECT_EQ(two.regions, (std::vector<std::int32_t>{1, 2}));
  EXPECT_EQ(two.region_names, (std::map<std::int32_t, std::string>{{1, "the wall"}, {2, "end"}}));
  EXPECT_EQ(two.points.size(), 4U);
  const MeshData unnamed = read("a.stl", "solid\n" + a + b + "endsolid").mesh;
  EXPECT_TRUE(unnamed.regions.empty() && unnamed.region_names.empty());
}

TEST(SurfaceFiles, ObjCountsBackwardsToo) {
  const MeshData mesh = read("a.obj",
                             "v 0 0 0 1.0\nv 1 0 0 .5 .5 .5\nv 1 1 0\nf -3 -2//1 3/4\ng\tup per\nv 0 1 0 # here\n"
                             "f 1/1/1 \\\n -2/1/1 \\\n\\\n -1/1/1 # and here\nusemtl red\ng empty\no low\nl 1 2\np 1\n"
                             "v 0 0 1\nv 2 0 0\nv 2 1 0\nv 2 2 0\nf 2 6 7 8 3\n")
                            .mesh;
  EXPECT_EQ(corners_of(mesh), (Ids{0, 1, 2, 0, 2, 3, 1, 5, 6, 7, 2}));
  EXPECT_EQ(mesh.types, (std::vector<CellType>{CellType::triangle, CellType::triangle, CellType::polygon}));
  EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{0, 1, 3}));
  EXPECT_EQ(mesh.region_names, (std::map<std::int32_t, std::string>{{1, "up per"}, {3, "low"}}));
  EXPECT_EQ(mesh.points.size(), 8U);  // that of no face, too
}

TEST(SurfaceFiles, ObjCommentsThatEndInABackslashEndThere) {
  EXPECT_EQ(read("a.obj", "# C:\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib C:\\\nf 1 2 3\n").mesh.cell_count(), 1U);
}

TEST(SurfaceFiles, PlyPassesOverWhatItDoesNotKnow) {
  const std::string head =
      "element camera 1\nproperty list uchar float f\nproperty double d\nelement vertex 3\nproperty float nx\n"
      "property double z\nproperty list ushort short tags\nproperty double x\nproperty uchar red\nproperty double y\n"
      "element nothing 1000000000000\nelement face 1\nproperty list uchar uint loops\nproperty list uchar uint "
      "vertex_index\nproperty float quality\nelement tail 2\nproperty char c\nend_header\n";
  const std::string text = "ply\nformat ascii 1.0\n" + head +
                           "2 1 1.5 7\n0.5 3 2 9 9 1 255 2\n0.5 6 0 4 255 5\n0.5 10 1 8 7\n255 8\n2 9 9 3 2 1 0 nan\n"
                           "1 1";
  const std::vector<Vec3> points = {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
  const auto expect_points = [&](const MeshData& mesh) {
    EXPECT_TRUE(mesh.points == points);
    EXPECT_EQ(corners_of(mesh), (Ids{2, 1, 0}));
  };
  expect_points(read("a.ply", text).mesh);
  for (const bool big : {false, true}) {
    std::string binary = "ply\nformat binary_" + std::string(big ? "big" : "little") + "_endian 1.0\n" + head;
    const auto put = [&](auto value) { binary += bytes_of(value, big); };
    put(std::uint8_t{1});
    put(1.0F);
    put(2.0);
    for (std::size_t i = 0; i < 3; ++i) {
      put(0.5F);
      put(points[i].z);
      put(static_cast<std::uint16_t>(i));
      for (std::size_t k = 0; k < i; ++k) put(std::int16_t{-1});
      put(points[i].x);
      put(std::uint8_t{255});
      put(points[i].y);
    }
    put(std::uint8_t{1});
    put(std::uint32_t{77});
    put(std::uint8_t{3});
    for (const std::uint32_t v : {2U, 1U, 0U}) put(v);
    put(std::numeric_limits<float>::quiet_NaN());
    put('x');
    put('y');
    expect_points(read("a.ply", binary).mesh);
  }
}

template <class T>
void expect_ply_type(const std::string& type, T least, T greatest) {
  const Folder folder;
  for (const bool big : {false, true}) {
    std::string content = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                          "_endian 1.0\nelement vertex 3\nproperty " + type + " x\nproperty " + type + " y\nproperty " +
                          type + " z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n";
    for (const T x : {least, T(1), T(0), greatest, T(0), T(1), T(1), greatest, least}) content += bytes_of(x, big);
    const MeshData mesh = read_surface(folder.file("a.ply", content + std::string("\3\0\1\2", 4))).mesh;
    EXPECT_EQ(mesh.points[0], (Vec3{static_cast<double>(least), 1, 0})) << type;
    EXPECT_EQ(mesh.points[1], (Vec3{static_cast<double>(greatest), 0, 1})) << type;
    EXPECT_EQ(mesh.points[2], (Vec3{1, static_cast<double>(greatest), static_cast<double>(least)})) << type;
  }
}

TEST(SurfaceFiles, EveryTypeOfPlyIsReadToItsEnds) {
  const auto whole = [](const std::string& type, auto zero) {
    using Limits = std::numeric_limits<decltype(zero)>;
    expect_ply_type(type, Limits::min(), Limits::max());
  };
  for (const char* type : {"char", "int8"}) whole(type, std::int8_t{});
  for (const char* type : {"uchar", "uint8"}) whole(type, std::uint8_t{});
  for (const char* type : {"short", "int16"}) whole(type, std::int16_t{});
  for (const char* type : {"ushort", "uint16"}) whole(type, std::uint16_t{});
  for (const char* type : {"int", "int32"}) whole(type, std::int32_t{});
  for (const char* type : {"uint", "uint32"}) whole(type, std::uint32_t{});
  for (const char* type : {"float", "float32"}) expect_ply_type(type, -0.1F, 3.4e38F);
  for (const char* type : {"double", "float64"}) expect_ply_type(type, -0.1, 1e88 / 3.0);
}

// --- errors

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

std::vector<Wrong> wrong_files() {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string facet = stl_facet({"0 0 0", "1 0 0", "0 1 0"});
  const std::string cut = stl_binary_cube("solid x").substr(0, 300);
  const std::string ply = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string list = "property list uchar int vertex_indices\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string ply3 = ply + "element vertex 3\n" + xyz + "element face 1\n" + list + "end_header\n" + points;
  std::string bad_binary = ply_binary<float, std::uint8_t, std::int32_t>(false, cube_squares, "float", "uchar int");
  std::string round = "f";
  for (int i = 1; i <= 1001; ++i) round += " " + std::to_string(i);
  const std::size_t data = bad_binary.find("end_header\n") + 11;
  std::string no_corners = bad_binary;
  no_corners[data + 96] = '\0';
  bad_binary.replace(data + 4, 4, bytes_of(std::numeric_limits<float>::infinity()));
  return {
      {"a.txt", "x", "end in '.txt' are not supported; supported are .stl, .obj, .ply and .off"},
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
       "remove them, or move their corners (1"},
      {"a.obj", "v 0 0\nv 1 0 0", "line 1: the line ends where a coordinate should stand"},
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
      {"a.obj", three, "the file has no faces"},
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
      {"a.off", "4OFF\n", "line 1: only OFF with vertices of three coordinates"},
      {"a.off", "OFF BINARY\n", "line 1: binary OFF is not supported"},
      {"a.off", "OOF\n8 6 0\n", "line 1: 'OOF' is not a whole number"},
      {"a.off", "OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 3: the line ends too early"},
      {"a.off", "OFF\n3 1 0\n" + points + "3 0 1\n2\n", "line 6: the line ends too early"},
      {"a.off", "OFF\n3 1 0\n" + points + "3 0 1 2\n3 0 1 2\n", "line 7: the file goes on behind its last face"},
      {"a.off", "OFF\n3 1 0\n" + points + "3 0 1 3\n", "name points which do not exist (1 in all, the first: 0)"},
      {"a.off", "OFF\n3 1 0\n" + points + "3 0 1 4294967298\n", "do not exist (1 in all, the first: 0)"},
      {"a.off", "OFF\n3 100000000000 0\n" + points + "3 0 1 2\n", "line 2: 100000000000 faces are announced, but"},
      {"a.ply", ply3 + "3 0 1 4294967298\n", "do not exist (1 in all, the first: 0)"},
      {"a.ply",
       ply3.substr(0, ply3.find("end_header")) + "element x 1\nproperty list char char n\nend_header\n" + points +
           "3 0 1 2\n-1\n",
       "line 16: a list of -1 numbers"},
      {"a.off", "OFF\n3 1 0\n" + points + "2 0 1\n", "the file has no faces"},
      {"a.off", "OFF\n3 0 0\n" + points, "the file has no faces"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n", "line 4: a coordinate is not a finite number"}};
}

TEST(SurfaceFiles, ErrorsSayWhereAndWhat) {
  for (const Wrong& w : wrong_files())
    EXPECT_NE(error_of(w.name, w.content).find(w.error), std::string::npos)
        << w.content.substr(0, 200) << "\nshould be refused with: " << w.error
        << "\nbut was: " << error_of(w.name, w.content);
  EXPECT_THROW(read_surface("/nowhere/a.stl"), InvalidMesh);
}

// --- damaged files

/// Whatever is accepted is a surface, and stays one.
bool expect_surface_or_error(const Folder& folder, const std::string& name, const std::string& content,
                             const std::string& how) {
  MeshFile file = check_surface(folder.file(name, content));
  if (!file.report.valid()) {
    EXPECT_FALSE(file.report.defects[0].message.empty()) << name << ", " << how;
    return false;
  }
  const MeshReport again = check_and_repair_surface(file.mesh);
  EXPECT_TRUE(again.valid() && again.repairs.empty()) << name << ", " << how << "\n" << report_text(again);
  EXPECT_NO_THROW(Surface(file.mesh)) << name << ", " << how;
  return true;
}

TEST(SurfaceFiles, TruncatedAnywhere) {
  const Folder folder;
  for (const Sample& s : cubes()) {
    const std::size_t whole = s.content.find_last_not_of(" \r\n");
    // Behind its last number a file may lack the rest of the line.
    const std::size_t needed = s.name == "r.off" ? s.content.rfind("  1.0") : whole;
    for (std::size_t n = 0; n < needed; ++n) {
      const bool accepted =
          expect_surface_or_error(folder, s.name, s.content.substr(0, n), "cut at " + std::to_string(n));
      EXPECT_FALSE(accepted && !s.name.ends_with(".obj")) << s.name << " cut at " << n;  // .obj has no end
    }
  }
}

TEST(SurfaceFiles, BytesChanged) {
  std::mt19937 random(7);
  const Folder folder;
  const std::vector<Sample> all = cubes();
  const int rounds = scaled(20000, 400000);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    const Sample& s = all[random() % all.size()];
    std::string content = s.content;
    for (auto k = 1 + random() % 3; k > 0; --k) content[random() % content.size()] = static_cast<char>(random());
    accepted += expect_surface_or_error(folder, s.name, content, "round " + std::to_string(round)) ? 1 : 0;
  }
  EXPECT_GT(accepted, rounds / 100);  // comments, normals and the like
  EXPECT_LT(accepted, rounds);
}

TEST(SurfaceFiles, NumbersReplaced) {
  const Folder folder;
  const std::vector<std::string> numbers = {
      "-1", "3", "1e400", "nan", "-inf", "4294967295", "1000000000", "9223372036854775807", "-9223372036854775808",
      "x"};
  for (const Sample& s : cubes()) {
    for (std::size_t at = 1; at < s.content.size(); ++at) {
      const auto digit = [](char c) { return c >= '0' && c <= '9'; };
      if (!digit(s.content[at]) || digit(s.content[at - 1]) || (test::sanitized() && at % 8 != 0)) continue;
      const std::size_t end = std::min(s.content.find_first_not_of("0123456789.", at), s.content.size());
      for (const std::string& number : numbers)
        expect_surface_or_error(folder, s.name, s.content.substr(0, at) + number + s.content.substr(end), number);
    }
  }
}

TEST(SurfaceFiles, HugeCountsTakeNoMemory) {
  const Folder folder;
  const std::string big = "1000000000000000000";
  const std::string ply = "format ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\n";
  const std::string list = "property list uint uint vertex_indices\nend_header\n";
  const std::vector<Sample> bombs = {
      {"a.stl", std::string(80, ' ') + std::string(4, '\xff')},
      {"a.off", "OFF\n" + big + " 1 0\n"},
      {"a.off", "OFF\n1 " + big + " 0\n0 0 0\n"},
      {"a.off", "OFF\n1 1 0\n0 0 0\n" + big + "\n"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex " + big +
                    "\nproperty int x\nproperty int y\nproperty int z\n"
                    "element face 1\n" +
                    list + "0 0 0\n"},
      {"a.ply", "ply\n" + ply + "element face " + big + "\n" + list + "0 0 0\n"},
      {"a.ply", "ply\n" + ply + "element face 1\n" + list + "0 0 0\n" + big + "\n"},
      {"a.ply", "ply\n" + ply + "element x " + big + "\nelement face " + big + "\n" + list + "0 0 0\n"},
      {"a.ply", "ply\n" + ply + "property list uint double n\nelement face 1\n" + list + "0 0 0 4000000000\n"},
      {"a.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint double n\nproperty char x\n"
       "property char y\nproperty char z\nelement face 1\n" +
           list + std::string(40, '\xff')},
      {"a.obj", "v 0 0 0\nf 1 2 " + big + "\n"}};
  for (const Sample& bomb : bombs)
    EXPECT_FALSE(expect_surface_or_error(folder, bomb.name, bomb.content, "bomb")) << bomb.content;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  if (!test::sanitized()) EXPECT_LT(usage.ru_maxrss, 600 * 1024) << "kilobytes";
}

}  // namespace dartcast::test::surface_files_test
