// Surfaces from .stl, .obj, .ply and .off, written by hand.
#include "support/surface_files.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/surface.hpp"
#include "output/mesh_report_text.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"
#include "surface/check_surface.hpp"

namespace dartcast::test::surface_files_test {

TEST(SurfaceFiles, TheSameCubeFromEveryFormat) {
  const Folder folder;
  for (const SurfaceSample& s : cube_files()) {
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

TEST(SurfaceFiles, WrittenSurfacesAreReadBack) {
  const Folder folder;
  MeshData cube = read_surface(folder.file("cube.off",
                                           [] {
                                             for (const SurfaceSample& s : cube_files()) {
                                               if (s.name.ends_with(".off") && s.triangles) return s.content;
                                             }
                                             return std::string();
                                           }()))
                      .mesh;
  for (std::size_t i = 0; i < cube.points.size(); ++i)
    cube.points[i] = cube.points[i] * (1.0 / 3.0) + Vec3{0.1, 1e-9, 7e5};
  cube.regions.assign(cube.cell_count(), 1);
  cube.regions[0] = cube.regions[1] = 2;
  cube.region_names = {{1, "wall"}, {2, "end"}};
  for (const std::string& ending : surface_endings()) {
    SCOPED_TRACE(ending);
    const auto path = folder / ("out" + ending);
    write_mesh(cube, path);
    const MeshFile back = read_surface(path);
    EXPECT_EQ(back.report.verdict(), Verdict::accept) << report_text(back.report);
    ASSERT_EQ(back.mesh.cell_count(), cube.cell_count());
    const auto places = [](const MeshData& mesh) {
      std::multiset<std::array<double, 3>> all;
      for (const std::uint32_t p : mesh.connectivity)
        all.insert({mesh.points[p].x, mesh.points[p].y, mesh.points[p].z});
      return all;
    };
    EXPECT_EQ(places(back.mesh), places(cube));
    if (ending == ".ply" || ending == ".off") continue;
    EXPECT_EQ(std::count(back.mesh.regions.begin(), back.mesh.regions.end(), back.mesh.regions[0]),
              std::count(cube.regions.begin(), cube.regions.end(),
                         cube.regions[ending == ".obj" || ending == ".stl" ? 2 : 0]));
  }
  EXPECT_THROW(write_mesh(generate_box({}), folder / "box.stl"), InvalidArgument);
}

TEST(SurfaceFiles, LinesMayEndInTwoBytes) {
  const Folder folder;
  for (const SurfaceSample& s : cube_files()) {
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

// As other programs write it: read with a warning.
TEST(SurfaceFiles, SmallFlawsAreWarnings) {
  std::string plain = "solid part\n";
  for (const Ids& t : cube_triangles()) {
    plain += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : t)
      plain += fmt::format("vertex {} {} {}\n", cube_points[v][0], cube_points[v][1], cube_points[v][2]);
    plain += "endloop\nendfacet\n";
  }
  const auto with = [&](const char* what, const char* instead) {
    return std::regex_replace(plain, std::regex(what), instead);
  };
  std::string off, binary;
  for (const SurfaceSample& s : cube_files()) {
    if (off.empty() && s.content.starts_with("OFF\n")) off = "OFF" + s.content.substr(4);
    if (binary.empty() && s.name.ends_with(".stl") && s.content.find('\0') != std::string::npos) binary = s.content;
  }
  const Folder folder;
  for (const auto& [name, content, warning] :
       std::vector<std::array<std::string, 3>>{{"a.stl", with("endloop", "end loop") + "endsolid part\n", "'end loop'"},
                                               {"a.stl", with("endfacet", "end facet") + "end solid\n", "'end facet'"},
                                               {"a.stl", plain + "endsolidpart\n", "right behind 'endsolid'"},
                                               {"a.stl", binary + "the end", "7 bytes behind"},
                                               {"a.off", off, "right behind 'OFF'"},
                                               {"a.stl", "\xef\xbb\xbf" + plain + "endsolid part\n", ""},
                                               {"a.off", "\xef\xbb\xbf" + off, "right behind 'OFF'"}}) {
    SCOPED_TRACE(warning);
    const MeshFile file = check_surface(folder.file(name, content));
    ASSERT_TRUE(file.report.valid()) << report_text(file.report);
    EXPECT_EQ(loops_of(file.mesh),
              loops_of(file.mesh.types[0] == CellType::triangle ? cube_triangles() : cube_squares));
    if (warning.empty()) {
      EXPECT_TRUE(file.report.warnings.empty());
      continue;
    }
    ASSERT_FALSE(file.report.warnings.empty());
    EXPECT_NE(file.report.warnings[0].message.find(warning), std::string::npos) << file.report.warnings[0].message;
  }
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

}  // namespace dartcast::test::surface_files_test
