// Meshes around surfaces: regions, volumes and patches with known truth; surfaces and programs that are not right.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "mesh/cell_types.hpp"
#include "meshing/closed_surfaces.hpp"
#include "meshing/tetrahedra.hpp"
#include "output/mesh_report_text.hpp"
#include "support/closed_surfaces.hpp"
#include "support/expectations.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"

namespace dartcast::mesh_surfaces_test {

namespace fs = std::filesystem;
using test::add_face;
using test::cuboid;

std::string off_of(const MeshData& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.points.size(), mesh.cell_count());
  for (const Vec3& p : mesh.points) text += fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x, p.y, p.z);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    text += std::to_string(mesh.cell(c).size());
    for (const std::uint32_t p : mesh.cell(c)) text += " " + std::to_string(p);
    text += "\n";
  }
  return text;
}

/// Both in one surface.
MeshData joined(MeshData a, const MeshData& b) {
  const auto n = static_cast<std::uint32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (std::size_t c = 0; c < b.cell_count(); ++c) {
    std::vector<std::uint32_t> corners(b.cell(c).begin(), b.cell(c).end());
    for (std::uint32_t& p : corners) p += n;
    a.add_cell(b.types[c], corners);
  }
  return a;
}

/// The programs that are installed. Each is one more to install; continuous integration has both.
std::vector<Mesher> meshers() {
  std::vector<Mesher> found;
  for (const auto& [mesher, name] : {std::pair(Mesher::tetgen, "tetgen"), std::pair(Mesher::gmsh, "gmsh")}) {
    if (std::system(fmt::format("command -v {} >/dev/null", name).c_str()) == 0)
      found.push_back(mesher);
    else
      std::cout << "left out: meshes by " << name << ", which is not installed\n";
  }
  return found;
}

MeshData cube(double half) { return cuboid({-half, -half, -half}, {half, half, half}); }

class MeshSurfaces : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              fmt::format("mesh_surfaces_{}", ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const MeshData& mesh) const { return write(name, off_of(mesh)); }
  fs::path write(const std::string& name, const std::string& text) const {
    write_bytes(folder_ / name, text);
    return folder_ / name;
  }

  SurfaceScene scene_of(const std::vector<std::pair<std::string, MeshData>>& surfaces) const {
    SurfaceScene scene;
    for (const auto& [region, mesh] : surfaces) scene.surfaces.push_back({region, write(region + ".off", mesh)});
    return scene;
  }

  fs::path folder_;
};

std::map<std::string, double> volumes_of(const MeshData& mesh) {
  std::map<std::string, double> volumes;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto p = [&](std::size_t k) { return mesh.points[mesh.cell(c)[k]]; };
    volumes[mesh.region_names.at(mesh.regions[c])] += dot(cross(p(1) - p(0), p(2) - p(0)), p(3) - p(0)) / 6.0;
  }
  return volumes;
}

void expect_volumes(const MeshFile& file, const std::map<std::string, double>& expected) {
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  const auto found = volumes_of(file.mesh);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, volume] : expected) EXPECT_NEAR(found.at(name), volume, 1e-12 * volume) << name;
}

std::map<std::string, std::size_t> patches_of(const MeshData& mesh) {
  std::map<std::string, std::size_t> patches;
  for (const std::int32_t tag : mesh.patch_tags) ++patches[mesh.patch_names.at(tag)];
  return patches;
}

void expect_defect(const MeshFile& file, const std::string& kind, std::initializer_list<const char*> words) {
  ASSERT_FALSE(file.report.valid());
  const Finding& defect = file.report.defects.front();
  EXPECT_EQ(defect.kind, kind) << defect.message;
  test::expect_parts(defect.message, words);
}

// As the check of the file itself refuses it.
void expect_refused(const SurfaceScene& scene, const std::string& kind, std::initializer_list<const char*> words) {
  expect_defect(mesh_surfaces(scene), kind, words);
  const fs::path& file = scene.surfaces.front().file;
  if (scene.surfaces.size() == 1 && is_surface_file(file)) expect_defect(check_mesh(file), kind, words);
}

// Regions.

TEST_F(MeshSurfaces, ACubeInABox) {
  std::vector<Mesher> all = meshers();
  all.push_back(Mesher::any);
  for (const Mesher mesher : all) {
    SurfaceScene scene = scene_of({{"lumen", cube(1.0)}});
    scene.box = 1.5;
    scene.mesher = mesher;
    const MeshFile file = mesh_surfaces(scene);
    expect_volumes(file, {{"lumen", 8.0}, {"outside", 27.0 - 8.0}});
    EXPECT_EQ(file.report.format, mesher == Mesher::gmsh ? "tetrahedra by gmsh" : "tetrahedra by tetgen");
    for (std::size_t c = 0; c < file.mesh.cell_count(); ++c)
      EXPECT_EQ(file.mesh.free[c] == 1, file.mesh.region_names.at(file.mesh.regions[c]) == "lumen");
    const auto patches = patches_of(file.mesh);
    for (int k = 1; k <= 6; ++k) EXPECT_EQ(patches.at(fmt::format("wall_{}", k)), 2U);
    EXPECT_EQ(patches.count("wall_7"), 0U);
    EXPECT_GE(patches.at("box"), 12U);
  }
}

TEST_F(MeshSurfaces, SizeBoundsTheEdges) {
  SurfaceScene scene = scene_of({{"ring", test::torus(2.0, 0.7)}});
  for (const Mesher mesher : meshers()) {
    scene.mesher = mesher;
    scene.size = 0.0;
    const std::size_t coarse = mesh_surfaces(scene).mesh.cell_count();
    scene.size = 0.2;
    EXPECT_GT(mesh_surfaces(scene).mesh.cell_count(), 3 * coarse);
  }
}

TEST_F(MeshSurfaces, SurfacesInOneAnother) {
  for (const Mesher mesher : meshers()) {
    SurfaceScene scene = scene_of({{"c", cube(1.0)}, {"b", cube(2.0)}, {"a", cube(3.0)}});
    scene.surfaces.push_back({"far", write("far.off", cuboid({5, 5, 5}, {6, 7, 8}))});
    scene.box = 2.0;
    scene.mesher = mesher;
    const double box = 22.0 * 1.0;  // from -3 - 5.5 to 8 + 5.5, and 2 x (3 + 6), 2 x (3 + 7), 2 x (3 + 8)
    const double all = 18.0 * 20.0 * box;
    expect_volumes(mesh_surfaces(scene),
                   {{"c", 8.0}, {"b", 64.0 - 8.0}, {"a", 216.0 - 64.0}, {"far", 6.0}, {"outside", all - 216.0 - 6.0}});
  }
}

TEST_F(MeshSurfaces, PartsOfAFileEncloseTheSpaceBetweenThem) {
  for (const Mesher mesher : meshers()) {
    SurfaceScene scene = scene_of({{"wall", joined(joined(cube(2.0), cube(1.5)), cube(1.0))}, {"core", cube(0.5)}});
    scene.mesher = mesher;
    const MeshFile file = mesh_surfaces(scene);
    ASSERT_TRUE(file.report.valid()) << report_text(file.report);
    const auto volumes = volumes_of(file.mesh);
    EXPECT_NEAR(volumes.at("wall"), 64.0 - 27.0 + 8.0 - 1.0, 1e-12 * 44.0);
    EXPECT_NEAR(volumes.at("core"), 1.0, 1e-12);
    // TetGen fails on this box, and takes one with larger edges.
    EXPECT_NEAR(volumes.at("outside"), 4.8 * 4.8 * 4.8 - 64.0 + 27.0 - 8.0, 3.0);
  }
}

TEST_F(MeshSurfaces, OneRegionOfTwoFiles) {
  SurfaceScene scene = scene_of({{"lumen", cube(1.0)}});
  scene.surfaces.push_back({"lumen", write("b.off", cuboid({3, 0, 0}, {4, 1, 1}))});
  const MeshFile file = mesh_surfaces(scene);
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  EXPECT_NEAR(volumes_of(file.mesh).at("lumen"), 9.0, 1e-12);
}

TEST_F(MeshSurfaces, CurvedSurfacesKeepTheirTriangles) {
  const MeshData surface = test::torus(2.0, 0.7);
  const MeshFile file = mesh_surfaces(scene_of({{"ring", surface}}));
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  EXPECT_TRUE(std::equal(surface.points.begin(), surface.points.end(), file.mesh.points.begin()));
  EXPECT_EQ(patches_of(file.mesh).at("wall"), 2 * surface.cell_count());
}

TEST_F(MeshSurfaces, ParticlesStayInside) {
  const std::string text =
      "[environment]\nmesh = { surface = 'ring.off', box = 1.4, inside = 'ring' }\n[[particles]]\ncount = 300\n"
      "[motion]\ndt = 0.05\ngravity = [0.1, 0.2, -0.3]\n[contact]\nrestitution = 0.9\n";
  write("ring.off", test::torus(2.0, 0.7));
  Simulation simulation(load_scene_files(parse_scene(text, folder_ / "scene.toml")).scene);
  for (int step = 0; step < 60; ++step) {
    simulation.step();
    EXPECT_EQ(simulation.audit().failed, 0U);
  }
  EXPECT_EQ(simulation.particles().size(), 300U);
  for (const ParticleState& s : simulation.particles().states())
    EXPECT_LT(std::hypot(std::hypot(s.position.x, s.position.y) - 2.0, s.position.z), 0.7 + 1e-12);
}

// Patches.

TEST_F(MeshSurfaces, GroupsOfFilesArePatches) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng floor\nf 1 3 2\ng sides\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  SurfaceScene scene;
  scene.surfaces = {{"inside", write("a.obj", obj)}};
  auto patches = patches_of(mesh_surfaces(scene).mesh);
  EXPECT_EQ(patches.at("floor"), 1U);
  EXPECT_EQ(patches.at("sides"), 3U);
  scene.surfaces.push_back({"other", write("b.off", cuboid({3, 3, 3}, {4, 4, 4}))});
  patches = patches_of(mesh_surfaces(scene).mesh);
  EXPECT_EQ(patches.at("inside_floor"), 1U);
  EXPECT_EQ(patches.at("other_wall_1"), 2U);
}

/// A tube of so many sides along z, without its ends. Its upper end is off the plane by `bend`.
MeshData tube(std::uint32_t sides, double low, double high, double bend = 0.0) {
  MeshData mesh;
  for (const double z : {0.0, 5.0}) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double a = 2.0 * std::numbers::pi * k / sides;
      const double r = z == 0.0 ? low : high;
      mesh.points.push_back({r * std::cos(a), r * std::sin(a), z + (z > 0.0 && k % 2 == 0 ? bend : 0.0)});
    }
  }
  for (std::uint32_t k = 0; k < sides; ++k) add_face(mesh, {k, (k + 1) % sides, sides + (k + 1) % sides, sides + k});
  return mesh;
}

TEST_F(MeshSurfaces, FlatEndsAreClosed) {
  SurfaceScene scene = scene_of({{"vessel", tube(12, 1.0, 1.5)}});
  expect_defect(mesh_surfaces(scene), "open", {"holes", "--cap", "around"});
  EXPECT_EQ(mesh_surfaces(scene).report.defects.front().count, 2U);
  scene.cap = true;
  const MeshFile file = mesh_surfaces(scene);
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  std::map<std::string, double> height;
  for (std::size_t f = 0; f < file.mesh.patch_tags.size(); ++f)
    height[file.mesh.patch_names.at(file.mesh.patch_tags[f])] = file.mesh.points[file.mesh.patch_face(f)[0]].z;
  EXPECT_EQ(height.at("inlet"), 5.0);  // the larger one
  EXPECT_EQ(height.at("outlet"), 0.0);
  EXPECT_EQ(patches_of(file.mesh).at("wall"), 24U);
}

TEST_F(MeshSurfaces, EndsThatAreNotFlatAreRefused) {
  SurfaceScene scene = scene_of({{"vessel", tube(12, 1.0, 1.0, 0.05)}});
  scene.cap = true;
  EXPECT_TRUE(mesh_surfaces(scene).report.valid());
  scene = scene_of({{"vessel", tube(12, 1.0, 1.0, 0.5)}});
  scene.cap = true;
  expect_defect(mesh_surfaces(scene), "cap", {"not near a plane", "(", "5.", "tolerance"});
  scene.cap_tolerance = 1.0;
  const MeshFile file = mesh_surfaces(scene);
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  EXPECT_EQ(patches_of(file.mesh).count("inlet"), 1U);
}

// Surfaces that are not right.

TEST_F(MeshSurfaces, OrientationIsRepaired) {
  MeshData mixed = cube(1.0);
  std::reverse(mixed.connectivity.begin(), mixed.connectivity.begin() + 4);
  const MeshFile file = mesh_surfaces(scene_of({{"lumen", mixed}}));
  EXPECT_EQ(file.report.verdict(), Verdict::repair);
  EXPECT_EQ(file.report.repairs.front().kind, "orientation");
  EXPECT_NEAR(volumes_of(file.mesh).at("lumen"), 8.0, 1e-12);
  MeshData inwards = cube(1.0);
  for (std::size_t c = 0; c < inwards.cell_count(); ++c)
    std::reverse(inwards.connectivity.begin() + static_cast<std::ptrdiff_t>(4 * c),
                 inwards.connectivity.begin() + static_cast<std::ptrdiff_t>(4 * c + 4));
  EXPECT_NEAR(volumes_of(mesh_surfaces(scene_of({{"lumen", inwards}})).mesh).at("lumen"), 8.0, 1e-12);
}

TEST_F(MeshSurfaces, SurfacesThatAreRefused) {
  MeshData open = cube(1.0);
  open.types.pop_back();
  open.offsets.pop_back();
  open.connectivity.resize(open.offsets.back());
  expect_refused(scene_of({{"a", open}}), "open", {"around (1, 0, 0)", "4 edges"});
  expect_refused(scene_of({{"a", joined(cube(1.0), cuboid({0.5, 0.5, 0.5}, {2, 2, 2}))}}), "self_intersection",
                 {"cross or touch", "face"});
  expect_refused(scene_of({{"a", cube(1.0)}, {"b", cuboid({1, -1, -1}, {2, 1, 1})}}), "self_intersection",
                 {"a.off", "b.off"});  // they touch
  expect_refused(scene_of({{"a", joined(cube(1.0), cube(1.0))}}), "self_intersection", {"face"});
  MeshData flat;
  flat.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  for (const auto& t : {std::array{0U, 1U, 2U}, {0U, 3U, 1U}, {1U, 3U, 2U}, {0U, 2U, 3U}})
    add_face(flat, {t[0], t[1], t[2]});
  expect_refused(scene_of({{"a", flat}}), "flat", {"without area"});
  SurfaceScene missing;
  missing.surfaces = {{"a", folder_ / "none.stl"}};
  expect_refused(missing, "file", {"no such file"});
  missing.surfaces = {{"a", write("a.doc", "x")}};
  expect_refused(missing, "file", {".doc", "supported"});
}

TEST_F(MeshSurfaces, MembersOutOfRange) {
  const auto refused = [&](auto&& change, const char* word) {
    SurfaceScene scene = scene_of({{"a", cube(1.0)}});
    change(scene);
    test::expect_parts(test::error_text([&] { mesh_surfaces(scene); }), {"surfaces", word});
  };
  refused([](SurfaceScene& s) { s.surfaces.clear(); }, "at least one");
  refused([](SurfaceScene& s) { s.box = 1.0; }, "box");
  refused([](SurfaceScene& s) { s.box = std::nan(""); }, "box");
  refused([](SurfaceScene& s) { s.size = -1.0; }, "size");
  refused([](SurfaceScene& s) { s.angle = 0.0; }, "angle");
  refused([](SurfaceScene& s) { s.seconds = 0.0; }, "seconds");
  refused([](SurfaceScene& s) { s.outside = "a"; }, "outside");
  refused([](SurfaceScene& s) { s.surfaces[0].region.clear(); }, "region");
}

// Programs that are not right.

/// In place of the search path, a folder whose tetgen is a script.
class Path {
 public:
  Path(const fs::path& folder, const std::string& script) : before_(std::getenv("PATH")) {
    fs::create_directories(folder);
    if (!script.empty()) {
      write_bytes(folder / "tetgen", "#!/bin/sh\n" + script + "\n");
      fs::permissions(folder / "tetgen", fs::perms::owner_all);
    }
    ::setenv("PATH", (script.empty() ? folder.string() : folder.string() + ":/bin:/usr/bin").c_str(), 1);
  }
  ~Path() { ::setenv("PATH", before_.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

 private:
  std::string before_;
};

TEST_F(MeshSurfaces, ProgramsThatFail) {
  SurfaceScene scene = scene_of({{"a", cube(1.0)}});
  const auto expect = [&](const std::string& script, std::initializer_list<const char*> words) {
    SCOPED_TRACE(script);
    const Path path(folder_ / "bin", script);
    expect_defect(mesh_surfaces(scene), "mesher", words);
    fs::remove_all(folder_ / "bin");
  };
  expect("", {"tetgen is not installed", "package tetgen", "package gmsh"});
  scene.mesher = Mesher::tetgen;
  expect("", {"tetgen is not installed"});
  expect("echo some reason; exit 3", {"status 3", "some reason"});
  expect("kill -ABRT $$", {"status 134"});
  expect("exit 0", {"no such file"});
  scene.seconds = 0.3;
  expect("sleep 100", {"more than 0.3 s"});
  scene.seconds = 600.0;
  const std::string mesh = "MeshVersionFormatted 2\nDimension 3\nVertices\n";
  expect("cat > scene.1.mesh <<END\n" + mesh + "1\n0 0 0 0\nTetrahedra\n1\n1 1 1 1 0\nEnd\nEND", {"moved points"});
}

TEST_F(MeshSurfaces, TetrahedraThatDoNotFitTheSurface) {
  const SurfaceScene scene = scene_of({{"a", test::torus(2.0, 0.7)}});
  const ClosedSurfaces surfaces = read_closed_surfaces(scene, {});
  const Tetrahedra good = run_tetgen(surfaces, scene, std::uint64_t{1} << 32U);
  EXPECT_NO_THROW(mesh_with_regions(surfaces, scene, good));
  const auto expect = [&](auto&& change, const char* word) {
    Tetrahedra bad = good;
    change(bad);
    const std::string text = test::error_text([&] { mesh_with_regions(surfaces, scene, bad); });
    EXPECT_FALSE(text.empty());
    test::expect_parts(text, {word});
  };
  const auto inner = [&](const std::array<std::uint32_t, 4>& c) {
    return std::all_of(c.begin(), c.end(), [&](std::uint32_t p) { return p < surfaces.points.size(); });
  };
  expect([&](Tetrahedra& t) { t.cells.erase(std::find_if(t.cells.begin(), t.cells.end(), inner)); }, "");
  expect([&](Tetrahedra& t) { t.cells.push_back(t.cells.front()); }, "three tetrahedra");
  expect([&](Tetrahedra& t) { t.cells.front()[0] = 1000000; }, "do not exist");
  expect([&](Tetrahedra& t) { t.cells.clear(); }, "not kept face 0 of");
  // A surface with one triangle less leaks, whatever the program says.
  ClosedSurfaces open = surfaces;
  open.triangles.pop_back();
  EXPECT_NE(test::error_text([&] { mesh_with_regions(open, scene, good); }).find("leaks"), std::string::npos);
}

// Scenes.

TEST_F(MeshSurfaces, ScenesNameSurfaces) {
  write("a.off", cube(1.0));
  write("b.off", cuboid({3, 3, 3}, {4, 4, 4}));
  const auto read = [&](const std::string& mesh) {
    return parse_scene("[environment]\nmesh = " + mesh + "\n", folder_ / "scene.toml").environment.mesh;
  };
  const auto one = std::get<SurfaceScene>(read(
      "{ surface = 'a.off', box = 2, size = 0.5, inside = 'lumen', outside = 'tissue', cap = true, angle = 30, with = "
      "'gmsh', seconds = 9 }"));
  ASSERT_EQ(one.surfaces.size(), 1U);
  EXPECT_EQ(one.surfaces[0].region, "lumen");
  EXPECT_EQ(one.surfaces[0].file, folder_ / "a.off");
  EXPECT_EQ(one.outside, "tissue");
  EXPECT_EQ(one.box, 2.0);
  EXPECT_EQ(one.size, 0.5);
  EXPECT_TRUE(one.cap);
  EXPECT_EQ(one.angle, 30.0);
  EXPECT_EQ(one.mesher, Mesher::gmsh);
  EXPECT_EQ(one.seconds, 9.0);
  const auto two = std::get<SurfaceScene>(read("{ surface = { lumen = 'a.off', plaque = 'b.off' } }"));
  ASSERT_EQ(two.surfaces.size(), 2U);
  EXPECT_EQ(two.surfaces[1].region, "plaque");
  const auto refused = [&](const std::string& mesh, std::initializer_list<const char*> words) {
    test::expect_parts(test::error_text([&] { read(mesh); }), words);
  };
  refused("{ box = 2 }", {"2:", "surface"});
  refused("{ surface = 'a.off', box = 1 }", {"box = 1", "more than 1"});
  refused("{ surface = 'a.off', with = 'netgen' }", {"netgen", "tetgen, gmsh"});
  refused("{ surface = {} }", {"no region"});
  refused("{ surface = { outside = 'a.off' } }", {"outside"});
  refused("{ surface = 'a.off', sise = 1 }", {"sise"});
  refused("{ surface = { a = 'a.off' }, inside = 'b' }", {"inside"});
}

TEST_F(MeshSurfaces, AMeshIsKept) {
  write("a.off", cube(1.0));
  const fs::path kept = folder_ / "kept.msh";
  const auto load = [&](const std::string& more, const fs::path& to) {
    ReadOptions options;
    options.kept_mesh = to;
    Scene scene = parse_scene("[environment]\nmesh = { surface = 'a.off'" + more + " }\n", folder_ / "scene.toml");
    return std::get<MeshData>(load_scene_files(std::move(scene), options).scene.environment.mesh);
  };
  const MeshData made = load("", kept);
  const MeshData not_kept = load("", {});
  EXPECT_EQ(made.points, not_kept.points);
  EXPECT_EQ(made.connectivity, not_kept.connectivity);
  EXPECT_EQ(made.free, not_kept.free);
  {
    const Path path(folder_ / "bin", "");
    const MeshData again = load("", kept);
    EXPECT_EQ(again.points, made.points);
    EXPECT_EQ(again.connectivity, made.connectivity);
    EXPECT_EQ(again.free, made.free);
    EXPECT_EQ(again.patch_names, made.patch_names);
    EXPECT_NE(test::error_text([&] { load(", box = 3", kept); }).find("not installed"), std::string::npos);
  }
  EXPECT_NE(load(", box = 3", kept).points, made.points);
  EXPECT_EQ(load("", kept).points, made.points);
  write("a.off", cube(2.0));
  EXPECT_NE(load("", kept).points, made.points);
  // A damaged file is made again.
  const MeshData whole = load("", kept);
  fs::resize_file(kept, fs::file_size(kept) / 2);
  EXPECT_EQ(load("", kept).points, whole.points);
}

// Surfaces made by others.

TEST_F(MeshSurfaces, EveryClosedSurfaceMakesAScene) {
  NEED_DATA("closed surfaces");
  const std::vector<const char*> names = {"sofa/aneurysm3D_1.off",
                                          "sofa/liver.obj",
                                          "beamadapter/aneurysm3d_surface.obj",
                                          "cgal/femur.off",
                                          "cgal/elephant.off",
                                          "cgal/knot1.off",
                                          "cgal/hand.off",
                                          "cgal/anchor.off",
                                          "cgal/mpi.off",
                                          "cgal/double-torus-example.off",
                                          "cgal/P.off",
                                          "cgal/3torus.off",
                                          "cgal/cube-shuffled.off",
                                          "cgal/quint_tris.off"};
  for (std::size_t i = 0; i < names.size(); i += test::stride(1, 4)) {
    const char* name = names[i];
    SCOPED_TRACE(name);
    const fs::path file = test::data_folder() / "surfaces" / name;
    const std::string text = fmt::format(
        "[environment]\nmesh = {{ surface = '{}' }}\n[[particles]]\ncount = 200\n[motion]\ndt = 0.02\n", file.string());
    Scene scene = load_scene_files(parse_scene(text, "scene.toml")).scene;
    const auto& mesh = std::get<MeshData>(scene.environment.mesh);
    const auto [low, high] = std::minmax_element(mesh.points.begin(), mesh.points.end(),
                                                 [](const Vec3& a, const Vec3& b) { return a.z < b.z; });
    scene.motion.gravity = {0.0, 0.0, (low->z - high->z) * 2.0};
    Simulation simulation(std::move(scene));
    for (int step = 0; step < 50; ++step) {
      simulation.step();
      ASSERT_EQ(simulation.audit().failed, 0U);
    }
    EXPECT_EQ(simulation.particles().size(), 200U);
  }
}

TEST_F(MeshSurfaces, EveryBrokenSurfaceIsRefusedWithItsPlace) {
  NEED_DATA("broken surfaces");
  struct Broken {
    const char* name;
    const char* kind;
    std::size_t count;
  };
  const std::vector<Broken> all = {{"beamadapter/carotids.stl", "self_intersection", 5},
                                   {"cgal/bones.off", "self_intersection", 366},
                                   {"cgal/cow.off", "self_intersection", 101},
                                   {"cgal/degtri_sliding.off", "flat", 4},
                                   {"cgal/quads_to_stitch.off", "open", 2},
                                   {"cgal/tetra_intersected_by_triangle.off", "self_intersection", 1},
                                   {"cgal/elephant-with-holes.off", "self_intersection", 173}};
  for (const Broken& broken : all) {
    SCOPED_TRACE(broken.name);
    SurfaceScene scene;
    scene.surfaces = {{"inside", test::data_folder() / "surfaces" / broken.name}};
    const std::clock_t start = std::clock();
    const MeshFile file = mesh_surfaces(scene);
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 10.0);
    const auto found = std::find_if(file.report.defects.begin(), file.report.defects.end(),
                                    [&](const Finding& d) { return d.kind == broken.kind; });
    ASSERT_NE(found, file.report.defects.end()) << report_text(file.report);
    EXPECT_EQ(found->count, broken.count);
    EXPECT_FALSE(found->first.empty());
  }
}

}  // namespace dartcast::mesh_surfaces_test
