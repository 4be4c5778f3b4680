// Frames from files: the fast way gives what reading each file as a mesh gives, in points and in refusals.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/scene_files.hpp"
#include "formats/vtk.hpp"
#include "mesh/same_cells.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/vtk_files.hpp"
#include "support/vtp_text.hpp"

namespace dartcast::frame_files_test {

namespace fs = std::filesystem;

class FrameFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("dartcast_frame_files_" + std::to_string(::getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  fs::path write(const std::string& name, const MeshData& mesh) const {
    write_mesh(mesh, folder / name);
    return folder / name;
  }
  fs::path write(const std::string& name, const std::string& text) const {
    write_bytes(folder / name, text);
    return folder / name;
  }
  static FrameReader reader(std::vector<fs::path> files, double scale = 1.0) {
    const MeshData mesh = read_valid_mesh(files.front()).mesh;
    std::vector<Finding> warnings;
    return frame_reader(std::move(files), &mesh, {}, scale, {}, warnings);
  }
  // The frame of `second` after `first`, and the same by reading it as a mesh of its own.
  void expect_same(const fs::path& first, const fs::path& second) const {
    const std::vector<Vec3> expected = read_valid_mesh(second).mesh.points;
    EXPECT_EQ(reader({first, second})(1), expected) << second;
  }
  void expect_refused_alike(const fs::path& first, const fs::path& second) const {
    const std::string expected = test::error_text([&] { read_valid_mesh(second); });
    const std::string found = test::error_text([&] { reader({first, second})(1); });
    EXPECT_NE(expected, "");
    EXPECT_EQ(found, "deformation: frame 1 cannot be read: " + expected);
  }

  fs::path folder;
};

MeshData moved(MeshData mesh, const std::function<void(Vec3&)>& move) {
  for (Vec3& x : mesh.points) move(x);
  return mesh;
}

void sway(Vec3& x) { x = {x.x + 0.1 * x.y / 3.0, 1.1 * x.y, x.z - 0.05 * x.x * x.x}; }

TEST_F(FrameFilesTest, EveryFormatGivesThePointsOfItsMesh) {
  for (const CellType type : test::cube_types) {
    const MeshData mesh = test::cubes(3, type);
    for (const std::string ending : {".vtu", ".vtk", ".msh", ".msh4", ".mesh"})
      expect_same(write("a" + ending, mesh), write("b" + ending, moved(mesh, sway)));
  }
  const MeshData plane = generate_rectangle({});
  expect_same(write("p.vtu", plane), write("q.vtu", moved(plane, [](Vec3& x) { x.x *= 1.5; })));
  expect_same(write("p.vtu", plane), write("q.vtu", moved(plane, [](Vec3& x) { x.z = 2.0; })));  // put in the plane
}

// The numbers of all encodings.
TEST_F(FrameFilesTest, PointsOfVtuFilesAreDecodedToTheBit) {
  for (const test::XmlData how : test::xml_data_kinds()) {
    const std::string text = test::cubes_vtu(how);
    const VtuPoints found = read_vtu_points(text, 0);
    EXPECT_EQ(found.points, read_valid_mesh(write("x.vtu", text)).mesh.points);
    EXPECT_EQ(found.cells, read_vtu_points(test::cubes_vtu(test::XmlData::appended_raw), 0).cells);
    EXPECT_EQ(found.cells, read_vtu_points(test::cubes_vtu(how, 2), 0).cells);  // pieces, which are joined
  }
  const MeshData mesh = moved(test::cubes(3), sway);  // compressed
  const VtuPoints found = read_vtu_points(read_bytes(write("x.vtu", mesh)), 0);
  EXPECT_EQ(found.points, mesh.points);
  EXPECT_NE(found.cells, read_vtu_points(read_bytes(write("y.vtu", test::cubes(3, CellType::prism))), 0).cells);
}

TEST_F(FrameFilesTest, FilesOfOtherCellsAreReadAsMeshes) {
  const MeshData mesh = test::cubes(3);
  MeshData other = moved(mesh, sway);  // a point that no cell has, and the same number of others
  other.points.insert(other.points.begin(), Vec3{9, 9, 9});
  for (std::uint32_t& p : other.connectivity) ++p;
  expect_same(write("a.vtu", mesh), write("b.vtu", other));
  expect_same(write("b.vtu", other), write("a.vtu", mesh));
  expect_same(write("b.vtu", other), write("b.vtu", moved(other, sway)));
  expect_same(write("a.vtu", mesh), write("c.vtu", moved(test::cubes(3, CellType::tetrahedron), sway)));
}

TEST_F(FrameFilesTest, WhatIsRefusedAsAMeshIsRefusedAsAFrame) {
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron}) {
    const MeshData mesh = test::cubes(3, type);
    const fs::path first = write("a.vtu", mesh);
    MeshData inverted = mesh;  // one corner pushed through the box
    inverted.points[21].x += 20.0;
    const auto refused = [&](const MeshData& frame) { expect_refused_alike(first, write("b.vtu", frame)); };
    if (type == CellType::tetrahedron) refused(inverted);
    refused(moved(mesh, [](Vec3& x) { x.z = 0.0; }));
    refused(moved(mesh, [](Vec3& x) { x.z *= 1e200; }));
    refused(moved(mesh, [](Vec3& x) { x.y = x.y == 3.0 ? std::numeric_limits<double>::quiet_NaN() : x.y; }));
    const std::string whole = read_bytes(write("c.vtu", moved(mesh, sway)));
    for (const double share : {0.0, 0.3, 0.7, 0.95})
      expect_refused_alike(first, write("b.vtu", whole.substr(0, std::size_t(share * double(whole.size())))));
  }
  for (const test::XmlData how : test::xml_data_kinds()) {
    const std::string whole = test::cubes_vtu(how);
    for (std::size_t size = 0; size < whole.size() - 12; size += 97)
      expect_refused_alike(write("a.vtu", whole), write("b.vtu", whole.substr(0, size)));
  }
}

// It has as many points as the mesh, but no cell uses the last one.
TEST_F(FrameFilesTest, AFrameWithoutACellLacksItsPoint) {
  const MeshData mesh = test::cubes(3);
  MeshData fewer = mesh;
  fewer.types.pop_back();
  fewer.offsets.pop_back();
  fewer.connectivity.resize(fewer.offsets.back());
  const FrameReader read = reader({write("a.vtu", mesh), write("b.vtu", fewer)});
  EXPECT_NE(test::error_text([&] { read(1); }).find("63 points; the scene's mesh has 64"), std::string::npos);
}

// A mirrored mesh is taken as it was, and its cells are turned over.
TEST_F(FrameFilesTest, AMirroredFrameIsTaken) {
  const MeshData mesh = test::cubes(2, CellType::tetrahedron);
  expect_same(write("a.vtu", mesh), write("b.vtu", moved(mesh, [](Vec3& x) { x.x = -x.x; })));
}

TEST_F(FrameFilesTest, ChecksFilesAtTheStartAndCountsWhenTheyAreRead) {
  const fs::path good = write("a.vtu", test::cubes(2)), other = write("b.vtu", test::cubes(3));
  EXPECT_EQ(test::error_text([&] {
              reader({good, other, folder / "none.vtu"});
            }),
            (folder / "none.vtu").string() + ": no such file");
  const FrameReader read = reader({good, other, good}, 2.0);
  EXPECT_EQ(test::error_text([&] { read(1); }),
            "deformation: frame 1 cannot be read: " + other.string() +
                ": 64 points; the scene's mesh has 27: frames must have the same points");
  EXPECT_EQ(read(2), moved(test::cubes(2), [](Vec3& x) { x *= 2.0; }).points);
  fs::remove(good);
  EXPECT_NE(test::error_text([&] { read(2); }).find("a.vtu: no such file"), std::string::npos);
}

TEST_F(FrameFilesTest, PointsAloneAreThoseOfTheMesh) {
  const MeshData mesh = test::cubes(2);
  const std::vector<Vec3> swayed = moved(mesh, sway).points;
  const fs::path first = write("a.vtp", test::vtp_text(mesh.points, {{0, 1, 2}}));
  std::vector<Finding> warnings;
  const FrameReader read = frame_reader({first, write("b.vtp", test::vtp_text(swayed, {})), write("c.vtu", mesh),
                                         write("d.vtp", test::vtp_text({swayed.begin(), swayed.end() - 1}, {}))},
                                        &mesh, {}, 2.0, {}, warnings);
  const auto doubled = [](std::vector<Vec3> points) {
    for (Vec3& x : points) x *= 2.0;
    return points;
  };
  EXPECT_EQ(read(0), doubled(mesh.points));
  EXPECT_EQ(read(1), doubled(swayed));
  EXPECT_EQ(read(2), doubled(mesh.points));
  EXPECT_NE(test::error_text([&] { read(3); }).find("d.vtp: 26 points; the scene's mesh has 27"), std::string::npos);
}

TEST_F(FrameFilesTest, AMeshStaysValidWhileItsCellsArePositive) {
  for (const CellType type : test::cube_types) {
    const MeshData mesh = test::cubes(2, type);
    EXPECT_TRUE(stays_valid(mesh, moved(mesh, sway).points));
    EXPECT_FALSE(stays_valid(mesh, moved(mesh, [](Vec3& x) { x.y = -x.y; }).points));
    EXPECT_FALSE(stays_valid(mesh, moved(mesh, [](Vec3& x) { x.y = 1.0; }).points));
  }
  const MeshData plane = generate_rectangle({});
  EXPECT_TRUE(stays_valid(plane, plane.points));
  EXPECT_FALSE(stays_valid(plane, moved(plane, [](Vec3& x) { x.z = 1.0; }).points));
}

// A scene holds a reader then, and the first file has been read.
// As SimVascular's solver writes results: the points stay, and an array has their displacement.
TEST_F(FrameFilesTest, ADisplacementIsAddedToThePoints) {
  const MeshData rest = test::cubes(3, CellType::tetrahedron);
  const auto with_displacement = [&](const std::string& array, double t, MeshData mesh) {
    std::vector<double> values;
    for (const Vec3& x : rest.points) {
      for (const double d : {0.1 * t * x.y, 0.2 * t, -0.05 * t * x.x}) values.push_back(d);
    }
    mesh.point_data.push_back({array, 3, values});
    return mesh;
  };
  MeshData all = rest;
  for (int k = 0; k < 3; ++k) {
    write(fmt::format("result_{:03}.vtu", k), with_displacement("Displacement", k, rest));
    all = with_displacement(fmt::format("d_{:02}", k), k, all);
  }
  write("all.vtu", all);
  write("mesh.vtu", rest);
  const auto load = [&](const std::string& keys) {
    return load_scene_files(
               parse_scene("[environment]\nmesh = 'mesh.vtu'\nscale = 0.5\n[[deformation]]\nkind = 'frames'\n" + keys,
                           folder / "scene.toml"))
        .scene;
  };
  for (const char* keys : {"files = 'result_*.vtu'\nspacing = 0.1\ndisplacement = 'Displacement'\n",
                           "files = ['result_000.vtu', 'result_001.vtu', 'result_002.vtu']\ntimes = [0.0, 0.1, 0.2]\n"
                           "displacement = 'Displacement'\n",
                           "files = 'all.vtu'\nspacing = 0.1\ndisplacement = 'd_*'\n"}) {
    SCOPED_TRACE(keys);
    const DeformationStep step = load(keys).deformation.front().step;
    ASSERT_EQ(step.times, (std::vector<double>{0.0, 0.1, 0.2}));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto t = static_cast<double>(k);
      const std::vector<Vec3> points = step.reader(k);
      ASSERT_EQ(points.size(), rest.points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& x = rest.points[i];
        test::expect_near(points[i], (x + Vec3{0.1 * t * x.y, 0.2 * t, -0.05 * t * x.x}) * 0.5, 1e-15);
      }
    }
  }
  test::expect_parts(
      test::error_text([&] { (void)load("files = 'result_*.vtu'\nspacing = 0.1\ndisplacement = 'D'\n"); }),
      {"deformation", "displacement 'D'", "Displacement (3)"});
}

// The same files without the key: walls would stand still, and nobody would know why. Points that move need no warning,
// nor do files without such an array.
TEST_F(FrameFilesTest, ADisplacementThatIsNotUsedIsWarnedOf) {
  const MeshData rest = test::cubes(2, CellType::tetrahedron);
  const auto warnings_of = [&](const std::string& array, const auto& motion) {
    MeshData moving = rest;
    moving.point_data.push_back({array, 3, std::vector<double>(3 * rest.points.size(), 0.5)});
    for (int k = 0; k < 3; ++k) {
      write(fmt::format("result_{:03}.vtu", k), moving);
      moving.points = moved(moving, motion).points;
    }
    return load_scene_files(parse_scene("[environment]\nmesh = 'result_000.vtu'\n[[deformation]]\nkind = 'frames'\n"
                                        "files = 'result_*.vtu'\nspacing = 0.1\n",
                                        folder / "scene.toml"))
        .warnings;
  };
  const auto stands = [](Vec3&) {};
  for (const char* array : {"Displacement", "displ"}) {
    const std::vector<Finding> warnings = warnings_of(array, stands);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_EQ(warnings.front().count, 3U);
    test::expect_parts(warnings.front().message,
                       {"points stand still", "result_000.vtu", fmt::format("displacement = \"{}\"", array).c_str()});
  }
  EXPECT_TRUE(warnings_of("velocity", stands).empty());
  EXPECT_TRUE(warnings_of("Displacement", sway).empty());
}

TEST_F(FrameFilesTest, ScenesReadTheirFramesLater) {
  const MeshData mesh = test::cubes(2);
  write("a.vtu", mesh);
  write("b.vtu", moved(mesh, sway));
  const std::string text =
      "[environment]\nmesh = 'a.vtu'\nscale = 2.0\n[[deformation]]\nkind = 'frames'\nfiles = ['a.vtu', 'b.vtu', "
      "'a.vtu']\ntimes = [0, 1, 2]\n";
  const Scene scene = load_scene_files(parse_scene(text, folder / "s.toml")).scene;
  ASSERT_EQ(scene.deformation.size(), 1U);
  EXPECT_TRUE(scene.deformation[0].frames.empty());
  EXPECT_TRUE(scene.deformation[0].step.frames.empty());
  std::vector<Vec3> expected = moved(mesh, sway).points;
  for (Vec3& x : expected) x *= 2.0;
  EXPECT_EQ(scene.deformation[0].step.reader(1), expected);
  fs::remove(folder / "b.vtu");
  EXPECT_THROW(load_scene_files(parse_scene(text, folder / "s.toml")), InvalidMesh);
}

}  // namespace dartcast::frame_files_test
