// Named groups of faces that are no walls: errors where a scene names them, else warnings.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>

#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "mesh/cell_types.hpp"
#include "support/expectations.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::patch_walls_test {

// Faces between the cells of a box, as a group: walls only where one side is blocked.
TEST(PatchWalls, APatchThatIsNamedHasAWall) {
  MeshData mesh = generate_box({.cells = {2, 1, 1}, .size = Vec3{2, 1, 1}});
  mesh.regions = {1, 2};
  mesh.region_names = {{1, "left"}, {2, "right"}};
  mesh.patch_names[7] = "membrane";
  mesh.patch_names[8] = "nothing";
  for_each_face(mesh, 0, [&](std::span<const std::uint32_t> face) {
    const auto is_inner = [&](std::uint32_t p) { return mesh.points[p].x == 1.0; };
    if (std::all_of(face.begin(), face.end(), is_inner)) mesh.add_patch_face(face, 7);
  });
  const test::Folder folder;
  write_mesh(mesh, folder / "a.vtu");
  const std::string environment = "[environment]\nmesh = 'a.vtu'\n";
  const auto scene = [&](const std::string& text) { return parse_scene(text, folder / "s.toml"); };
  const std::string inlet = "[[particles]]\ninlet = 'membrane'\nrate = 1\n";
  for (const std::string& text : {environment + "[contact.patch.membrane]\nresponse = 'stick'\n", environment + inlet,
                                  environment + "patches = ['xmin', 'membrane']\n"}) {
    const std::string error = test::error_text([&] { load_scene_files(scene(text)); });
    test::expect_parts(error, {"a.vtu", "membrane", "1 faces lie between two free cells"});
    Scene loaded = scene(text);
    loaded.environment.patches = {};
    loaded.environment.mesh = mesh;
    EXPECT_EQ(test::error_text([&] { const Simulation s(loaded); }).empty(), text.find("patches") != std::string::npos);
    loaded.environment.walls = {"membrane"};
    EXPECT_EQ(inner_walls(Simulation(loaded).environment().map()).size(), 2U);
    const std::string blocked =
        std::regex_replace(text, std::regex("'a.vtu'\n"), "'a.vtu'\nfree = { region = ['left'] }\n");
    EXPECT_NO_THROW(const Simulation s(load_scene_files(scene(blocked)).scene)) << blocked;
    const std::string walls = std::regex_replace(text, std::regex("'a.vtu'\n"), "'a.vtu'\nwalls = ['membrane']\n");
    const LoadedScene inner = load_scene_files(scene(walls));
    EXPECT_TRUE(inner.warnings.empty());
    const Simulation s(inner.scene);
    const std::vector<CellFace> sides = inner_walls(s.environment().map());
    ASSERT_EQ(sides.size(), 2U);
    for (const CellFace f : sides) EXPECT_EQ(s.environment().map().patch(f), s.environment().map().patch("membrane"));
  }
  test::expect_parts(
      test::error_text([&] { load_scene_files(scene(environment + "[contact.patch.nothing]\nresponse = 'stick'\n")); }),
      {"nothing", "no cell has a face of it"});
  test::expect_parts(test::error_text([&] { load_scene_files(scene(environment + "walls = ['skin']\n")); }),
                     {"no patch 'skin'", "membrane"});
  const LoadedScene passed = load_scene_files(scene(environment));
  ASSERT_EQ(passed.warnings.size(), 1U);
  EXPECT_EQ(passed.warnings[0].kind, "inner_faces");
  EXPECT_NE(passed.warnings[0].message.find("(membrane)"), std::string::npos);
  EXPECT_EQ(check_mesh(folder / "a.vtu").report.warnings.back().kind, "inner_faces");
}

}  // namespace dartcast::patch_walls_test
