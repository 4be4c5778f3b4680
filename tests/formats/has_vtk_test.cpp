// Builds with VTK and without it: the formats that they read and write, and the words for the others.
#include <gtest/gtest.h>

#include <algorithm>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/point_file.hpp"
#include "support/expectations.hpp"
#include "support/refusals.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::test::has_vtk_test {

using Endings = std::vector<std::string>;

const Endings other_endings = {".msh", ".msh2", ".msh4", ".mesh"};

/// The words for this ending, and another way.
void expect_no_vtk(const std::string& text, const std::string& file, const std::string& task, const char* remedy) {
  expect_parts(text, {file.c_str(), ("this build of dartcast has no VTK, which it needs to " + task).c_str(),
                      "-DDARTCAST_VTK=ON, or ", remedy});
}

Endings with(Endings endings, const Endings& more) {
  endings.insert(endings.end(), more.begin(), more.end());
  return endings;
}

// DARTCAST_TEST_VTK: whether CMake was asked for VTK.
TEST(HasVtk, IsThatOfTheBuild) { EXPECT_EQ(has_vtk(), DARTCAST_TEST_VTK == 1); }

TEST(HasVtk, EndingsAreThoseOfThisBuild) {
  const Endings read = with(other_endings, {".meshb", ".ele", ".node"});
  EXPECT_EQ(mesh_endings(), has_vtk() ? with({".vtu", ".pvtu", ".vtk"}, read) : read);
  EXPECT_EQ(writable_mesh_endings(), with(has_vtk() ? Endings{".vtu", ".vtk"} : Endings{".vtu"}, other_endings));
}

TEST(HasVtk, EveryEndingOfTheListsIsWrittenAndRead) {
  const Folder folder;
  for (const std::string& ending : writable_mesh_endings()) {
    EXPECT_NO_THROW(write_mesh(mixed_mesh(), folder / ("a" + ending))) << ending;
    const Endings endings = mesh_endings();
    const bool read = std::find(endings.begin(), endings.end(), ending) != endings.end();
    EXPECT_EQ(read_mesh(folder / ("a" + ending)).report.valid(), read) << ending;
  }
}

TEST(WithoutVtk, FilesAreRefusedInWords) {
  if (has_vtk()) GTEST_SKIP() << "this build has VTK";
  const Folder folder;
  write_mesh(mixed_mesh(), folder / "a.vtu");
  for (const std::string ending : {".vtu", ".vtk"}) {
    const std::filesystem::path file = ending == ".vtu" ? folder / "a.vtu" : folder.file("a.vtk", "# vtk DataFile\n");
    const MeshFile read = read_mesh(file);
    ASSERT_EQ(read.report.defects.size(), 1U);
    EXPECT_EQ(read.report.defects[0].kind, "file");
    expect_no_vtk(error_text([&] { (void)read_valid_mesh(file); }), "a" + ending, "read " + ending + " files", ".msh");
  }
  expect_no_vtk(error_text([&] { (void)read_points(folder.file("a.vtp", "<VTKFile/>")); }), "a.vtp", "read .vtp files",
                ".csv");
  EXPECT_THROW(write_mesh(mixed_mesh(), folder / "b.vtk"), InvalidArgument);
  expect_no_vtk(error_text([&] { write_mesh(mixed_mesh(), folder / "b.vtk"); }), "b.vtk", "write .vtk files", ".vtu");
  EXPECT_FALSE(std::filesystem::exists(folder / "b.vtk"));
  // The lists of what is supported do not name it.
  const std::string other = error_text([&] { (void)read_valid_mesh(folder.file("a.xyz", "1 2 3\n")); });
  expect_parts(other, {".msh", ".mesh"});
  EXPECT_EQ(other.find(".vt"), std::string::npos) << other;
}

TEST(WithoutVtk, ScenesNameTheFileThatNeedsIt) {
  if (has_vtk()) GTEST_SKIP() << "this build has VTK";
  const Folder folder;
  write_mesh(generate_bar(), folder / "a.vtu");
  (void)folder.file("a.vtp", "<VTKFile/>");
  const auto failure = [&](const std::string& text) {
    return error_text([&] { (void)load_scene_files(parse_scene(text, folder / "scene.toml")); });
  };
  const std::string bar = "[environment]\ngenerator = 'bar'\n";
  const std::string motion = "[motion]\ndt = 0.1\nsteps = 1\n";
  for (const std::string& scene :
       {"[environment]\nmesh = 'a.vtu'\n" + motion, "[environment]\nmesh = 'a.vtu'\nskip_bad_cells = true\n" + motion,
        bar + motion + "[[deformation]]\nkind = 'frames'\nfiles = ['a.vtu', 'a.vtu']\ntimes = [0, 1]\n",
        bar + motion + "field = { array = 'U', files = 'a.vtu' }\n"})
    expect_no_vtk(failure(scene), "a.vtu", "read .vtu files", ".msh");
  expect_no_vtk(failure(bar + "[[particles]]\npositions = 'a.vtp'\n" + motion), "a.vtp", "read .vtp files", ".csv");
}

}  // namespace dartcast::test::has_vtk_test
