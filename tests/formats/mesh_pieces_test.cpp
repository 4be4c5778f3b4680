// Meshes in pieces: written, read as a whole and as parts, and refused where a piece is damaged, missing or another's.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/file_text.hpp"
#include "support/part_checks.hpp"
#include "support/sample_mesh.hpp"
#include "support/stepped_scenes.hpp"

namespace dartcast::mesh_pieces_test {

namespace fs = std::filesystem;

MeshData checked(MeshData mesh) {
  EXPECT_TRUE(check_and_repair(mesh).valid());
  return mesh;
}

// All types of cells, blocked ones, regions without names and patches without some.
std::vector<MeshData> meshes() {
  std::vector<MeshData> all;
  for (const test::SteppedScene& scene : test::make_scenes()) {
    if (scene.mesh.dimension() == 3 && !scene.moved) all.push_back(checked(scene.mesh));
  }
  OctahedraOptions octahedra;
  octahedra.cells = {3, 3, 3};
  octahedra.size = {1.0, 1.0, 1.0};
  octahedra.blocked_share = 0.2;
  all.push_back(checked(generate_octahedra(octahedra)));
  MeshData tagged = checked(generate_box({.cells = {4, 3, 3}, .size = Vec3{1.0, 1.0, 1.0}}));
  for (std::size_t c = 0; c < tagged.cell_count(); ++c) tagged.regions.push_back(c < 5 ? 7 : -3);
  tagged.patch_names.erase(2);
  tagged.patch_order = {6, 2};
  tagged.cell_data.push_back({"depth", 1, std::vector<double>(tagged.cell_count(), 0.25)});
  tagged.point_data.push_back({"flow", 3, std::vector<double>(3 * tagged.points.size(), 0.5)});
  all.push_back(tagged);
  return all;
}

class MeshPieces : public testing::Test {
 protected:
  test::Folder folder;
  [[nodiscard]] std::string reason(const fs::path& path, std::uint32_t parts = 1) const {
    try {
      read_mesh_part(path, parts, parts - 1);
    } catch (const InvalidMesh& e) {
      return e.what();
    }
    return "";
  }
};

TEST_F(MeshPieces, AreReadAsTheWholeMesh) {
  for (const MeshData& mesh : meshes()) {
    write_mesh_parts(mesh, 5, folder / "mesh.pvtu");
    const MeshFile read = read_mesh(folder / "mesh.pvtu");
    ASSERT_TRUE(read.report.valid()) << read.report.defects.front().message;
    EXPECT_TRUE(read.report.repairs.empty());
    EXPECT_EQ(read.mesh.points, mesh.points);
    EXPECT_EQ(read.mesh.types, mesh.types);
    EXPECT_EQ(read.mesh.connectivity, mesh.connectivity);
    EXPECT_EQ(read.mesh.regions, mesh.regions);
    EXPECT_EQ(CombinatorialMap(read.mesh).patch_names(), CombinatorialMap(mesh).patch_names());
    ASSERT_EQ(read.mesh.cell_data.size() >= mesh.cell_data.size(), true);
    for (std::size_t k = 0; k < mesh.cell_data.size(); ++k)
      EXPECT_EQ(read.mesh.cell_data[k].values, mesh.cell_data[k].values);
    for (std::size_t k = 0; k < mesh.point_data.size(); ++k)
      EXPECT_EQ(read.mesh.point_data[k].values, mesh.point_data[k].values);
  }
}

TEST_F(MeshPieces, AreReadAsPartsOfAnyNumber) {
  for (const MeshData& mesh : meshes()) {
    constexpr std::uint32_t pieces = 5;
    write_mesh_parts(mesh, pieces, folder / "mesh.pvtu");
    for (std::uint32_t parts = 1; parts <= pieces; ++parts) {
      std::vector<std::uint32_t> owners = partition(mesh, pieces);
      for (std::uint32_t& o : owners) o = o * parts / pieces;
      for (std::uint32_t part = 0; part < parts; ++part)
        test::expect_is_part(mesh, owners, read_mesh_part(folder / "mesh.pvtu", parts, part), std::to_string(parts));
      if (HasFailure()) return;
    }
  }
}

TEST_F(MeshPieces, OfOtherMeshesAreRefused) {
  const MeshData mesh = checked(generate_box({.cells = {9, 3, 3}, .size = Vec3{1.0, 1.0, 1.0}}));
  const fs::path path = folder / "mesh.pvtu";
  write_mesh_parts(mesh, 3, path);
  EXPECT_EQ(reason(path, 3), "");
  EXPECT_NE(reason(path, 4).find("3 pieces cannot be shared by 4 processes"), std::string::npos);
  const auto copy = [&](const char* from, const char* to) {
    fs::copy_file(folder / from, folder / to, fs::copy_options::overwrite_existing);
  };
  copy("mesh_1.vtu", "kept.vtu");
  copy("mesh_0.vtu", "mesh_1.vtu");
  EXPECT_NE(reason(path).find("a part is missing, or is another one"), std::string::npos) << reason(path);
  copy("kept.vtu", "mesh_1.vtu");
  const std::string index = read_bytes(path);
  const auto without = [&](const char* piece) {
    const std::size_t at = index.find(std::string("<Piece Source=\"") + piece);
    std::string text = index;
    std::ofstream(path) << text.erase(at, text.find('>', at) + 1 - at);
    return reason(path);
  };
  EXPECT_NE(without("mesh_1").find("cannot be"), std::string::npos);
  EXPECT_NE(without("mesh_2").find("cannot be"), std::string::npos);
  std::ofstream(path) << index;
  MeshData moved = mesh;
  moved.points[53].x += 0.0625;
  write_mesh_parts(moved, 3, folder / "moved.pvtu");
  copy("moved_1.vtu", "mesh_1.vtu");
  EXPECT_NE(reason(path).find("different meshes"), std::string::npos) << reason(path);
  write_mesh(mesh, folder / "mesh_1.vtu");
  EXPECT_NE(reason(path).find("no array 'point_of_whole'"), std::string::npos) << reason(path);
  fs::remove(folder / "mesh_1.vtu");
  EXPECT_NE(reason(path).find("mesh_1.vtu"), std::string::npos) << reason(path);
  copy("kept.vtu", "mesh_1.vtu");
  EXPECT_EQ(reason(path), "");
}

// Whatever bytes a piece has, the answer is a part or a reason.
TEST_F(MeshPieces, WithDamagedNumbersAreRefused) {
  const MeshData mesh = checked(generate_box({.cells = {4, 2, 2}, .size = Vec3{1.0, 1.0, 1.0}}));
  const fs::path path = folder / "mesh.pvtu";
  write_mesh_parts(mesh, 2, path);
  const MeshData piece = read_mesh(folder / "mesh_1.vtu").mesh;
  const auto with = [&](const char* name, std::size_t at, double value) {
    MeshData changed = piece;
    for (std::vector<DataArray>* arrays : {&changed.point_data, &changed.cell_data}) {
      for (DataArray& a : *arrays) {
        if (a.name == name) a.values.at(at) = value;
      }
    }
    write_mesh(changed, folder / "mesh_1.vtu");
    return reason(path);
  };
  EXPECT_EQ(with("none", 0, 0.0), "");
  for (const double value : {-1.0, 0.5, 1e10, std::nan("")}) {
    for (const char* name : {"point_of_whole", "cell_of_whole", "source_of_whole", "handle_of_whole", "piece_of_cell"})
      EXPECT_NE(with(name, 1, value), "") << name << " " << value;
  }
  EXPECT_NE(with("point_of_whole", 2, 0.0).find("do not ascend"), std::string::npos);
  EXPECT_NE(with("cell_of_whole", 2, 0.0).find("do not ascend"), std::string::npos);
  EXPECT_NE(with("handle_of_whole", 2, 0.0), "");
  EXPECT_NE(with("piece_of_cell", 2, 2.0), "");
}

TEST_F(MeshPieces, AreNotWrittenWhereTheyCannotBe) {
  EXPECT_THROW(write_mesh_parts(generate_box({}), 2, folder / "mesh.pvtu"), InvalidArgument);
  EXPECT_THROW(write_mesh_parts(generate_box({}), 1, folder / "mesh.vtu"), InvalidArgument);
  EXPECT_THROW(write_mesh_parts(generate_box({}), 1, folder / "none" / "mesh.pvtu"), Error);
}

}  // namespace dartcast::mesh_pieces_test
