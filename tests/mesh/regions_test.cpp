// Free cells by region and by array.
#include <gtest/gtest.h>

#include <functional>

#include "dartcast/error.hpp"
#include "dartcast/mesh_selection.hpp"

namespace dartcast::regions_test {

MeshData three_cells() {
  MeshData mesh;
  for (int c = 0; c < 3; ++c) mesh.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
  mesh.regions = {4, 5, -6};
  mesh.region_names = {{4, "lumen"}, {9, "nowhere"}};
  mesh.cell_data = {{"heat", 1, {0.5, 1.0, 1.0}}, {"velocity", 3, std::vector<double>(9, 0.0)}};
  return mesh;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InvalidMesh& error) {
    return error.what();
  }
  return "";
}

using Free = std::vector<std::uint8_t>;

TEST(SelectFree, ByRegionNameOrTag) {
  MeshData mesh = three_cells();
  select_free_regions(mesh, std::vector<std::string>{"lumen"});
  EXPECT_EQ(mesh.free, (Free{1, 0, 0}));
  select_free_regions(mesh, std::vector<std::string>{"-6", "lumen"});
  EXPECT_EQ(mesh.free, (Free{1, 0, 1}));
  select_free_regions(mesh, std::vector<std::string>{"4", "5"});
  EXPECT_EQ(mesh.free, (Free{1, 1, 0}));
}

TEST(SelectFree, AnUnknownRegionNamesThoseThereAre) {
  MeshData mesh = three_cells();
  mesh.free = {0, 1, 0};
  const std::string message = message_of([&] {
    select_free_regions(mesh, std::vector<std::string>{"lumen", "nowhere"});
  });
  EXPECT_NE(message.find("'nowhere'"), std::string::npos);
  EXPECT_NE(message.find("-6, lumen (4), 5"), std::string::npos) << message;
  EXPECT_EQ(mesh.free, (Free{0, 1, 0}));
}

TEST(SelectFree, ByValuesOfAnArray) {
  MeshData mesh = three_cells();
  select_free_values(mesh, "heat", std::vector<double>{1.0, 7.0});
  EXPECT_EQ(mesh.free, (Free{0, 1, 1}));
  EXPECT_NE(message_of([&] { select_free_values(mesh, "cold", std::vector<double>{1.0}); }).find("heat, velocity"),
            std::string::npos);
  EXPECT_NE(message_of([&] { select_free_values(mesh, "velocity", std::vector<double>{1.0}); }), "");
  EXPECT_NE(message_of([&] { select_free_values(mesh, "heat", std::vector<double>{3.0}); }), "");
  EXPECT_EQ(mesh.free, (Free{0, 1, 1}));
}

}  // namespace dartcast::regions_test
