// Our .vtu, .vtp and .vtk files are read as the same data sets, in every compression (tests/vtk: by VTK, too).
#include "formats/xml_write.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"
#include "formats/vtk.hpp"
#include "formats/vtk/vtk_grid.hpp"
#include "formats/vtp_write.hpp"
#include "formats/vtu_write.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::xml_write_test {

namespace fs = std::filesystem;
using test::Folder;

constexpr std::array<Compression, 3> compressions = {Compression::none, Compression::fast, Compression::small};

std::vector<std::vector<std::uint32_t>> cells_of(const VtkGrid& grid, std::uint8_t type) {
  std::vector<std::vector<std::uint32_t>> all;
  for (std::size_t c = 0; c < grid.types.size(); ++c) {
    const auto begin = grid.connectivity.begin();
    if (grid.types[c] == type)
      all.emplace_back(begin + static_cast<std::ptrdiff_t>(grid.offsets[c]),
                       begin + static_cast<std::ptrdiff_t>(grid.offsets[c + 1]));
  }
  return all;
}

void expect_same_arrays(const std::vector<VtkArray>& found, const std::vector<VtkArray>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t a = 0; a < expected.size(); ++a) {
    SCOPED_TRACE(expected[a].name);
    EXPECT_EQ(found[a].name, expected[a].name);
    EXPECT_EQ(found[a].components, expected[a].components);
    EXPECT_EQ(found[a].values, expected[a].values);
  }
}

void expect_same_grid(const VtkGrid& found, const VtkGrid& expected) {
  EXPECT_EQ(found.points, expected.points);
  EXPECT_EQ(found.types, expected.types);
  EXPECT_EQ(found.offsets, expected.offsets);
  EXPECT_EQ(found.connectivity, expected.connectivity);
  expect_same_arrays(found.point_data, expected.point_data);
  expect_same_arrays(found.cell_data, expected.cell_data);
}

// Two writers, and two readers.
void expect_alike(const MeshData& mesh) {
  const Folder folder;
  write_legacy_vtk(mesh, folder / "a.vtk");
  const VtkGrid legacy = read_legacy_grid(read_bytes(folder / "a.vtk"), 0);
  EXPECT_EQ(legacy.points, mesh.points);
  const std::shared_ptr<const MeshData> shared = std::make_shared<const MeshData>(mesh);
  for (const Compression compression : compressions) {
    SCOPED_TRACE(static_cast<int>(compression));
    const fs::path path = folder / "a.vtu";
    write_xml(path, vtu_data_set(shared), compression, replace_file);
    expect_same_grid(read_vtk_xml_grid(read_bytes(path), "UnstructuredGrid", 0), legacy);
    const ParsedMesh parsed = parse_vtu(path, read_bytes(path));
    EXPECT_EQ(parsed.mesh.region_names, mesh.region_names);
    EXPECT_EQ(parsed.mesh.patch_names, mesh.patch_names);
  }
}

TEST(XmlWrite, EveryTypeOfCell) {
  MeshData mesh = test::sample_mesh();
  expect_alike(mesh);
  mesh.region_names[-8] = "a <wall> & \"more\"";
  mesh.free = {1, 0, 1, 0};
  mesh.cell_data = {{"heat", 1, {0.1, -0.0, 1e-310, 1e300}}, {"a <b> & \"c\"", 2, {1, 2, 3}}};
  mesh.point_data = {{"short", 3, {1.0 / 3.0, 2.0}}};
  expect_alike(mesh);
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  mesh.patch_tags.clear();
  expect_alike(mesh);
}

TEST(XmlWrite, Polyhedra) {
  MeshData mesh = test::polyhedra();
  expect_alike(mesh);
  mesh.points.push_back({0.2, 0.1, 0.01});
  test::add(mesh, CellType::tetrahedron, {4, 5, 8, 9});
  test::add(mesh, CellType::polyhedron, {4, 3, 8, 9, 4, 3, 8, 4, 7, 3, 9, 7, 4, 3, 7, 9, 8});
  test::add_face(mesh, {0, 3, 2, 1}, -5);
  expect_alike(mesh);
}

TEST(XmlWrite, MeshesOfThePlane) {
  expect_alike(test::planar_mesh());
  expect_alike(test::planar_polygons());
}

// Arrays of many blocks of compression, and of exactly one or two.
TEST(XmlWrite, ManyBlocks) {
  BoxOptions box;
  box.cells = {24, 20, 16};
  box.size = {1.0, 1.0, 1.0};
  box.type = CellType::tetrahedron;
  box.jitter = 0.2;
  MeshData mesh = generate_box(box);
  DataArray numbers{"numbers", 1, {}};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) numbers.values.push_back(1.0 / static_cast<double>(c + 1));
  mesh.cell_data = {numbers};
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  mesh.patch_tags.clear();
  mesh.patch_names.clear();
  ASSERT_GT(mesh.cell_count() * sizeof(double), 3 * 65536U);
  expect_alike(mesh);
}

std::vector<double> written_and_read(const std::vector<double>& values, Compression compression, bool keep) {
  const Folder folder;
  VtpFile file(std::vector<Vec3>(values.size()));
  file.add("x", values);
  XmlDataSet data = file.data();
  if (keep) data.section("PointData").arrays.front().keep();
  for (int i = 0; i < 2; ++i) write_xml(folder / "a.vtp", data, compression, write_pieces);
  return read_vtk_xml_grid(read_bytes(folder / "a.vtp"), "PolyData", 0).point_data.at(0).values;
}

TEST(XmlWrite, BlocksThatAreFullOrNot) {
  for (const std::size_t size : {0U, 1U, 8191U, 8192U, 8193U, 16384U}) {
    std::vector<double> values(size);
    for (std::size_t i = 0; i < size; ++i) values[i] = static_cast<double>(i) / 3.0;
    for (const Compression compression : compressions) {
      EXPECT_EQ(written_and_read(values, compression, false), values) << size;
      EXPECT_EQ(written_and_read(values, compression, true), values) << size;
    }
  }
}

VtkGrid written_and_read(const VtpFile& file, Compression compression) {
  const Folder folder;
  write_xml(folder / "a.vtp", file.data(), compression, replace_file);
  return read_vtk_xml_grid(read_bytes(folder / "a.vtp"), "PolyData", 0);
}

TEST(XmlWrite, PointsLinesAndPolygons) {
  using Cells = std::vector<std::vector<std::uint32_t>>;
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0.5}, {1.0 / 3.0, -0.0, 1e-310}, {2, 2, 2}};
  for (const Compression compression : compressions) {
    VtpFile file(points);
    file.add_vertices();
    file.add_line();
    file.add_polygons(std::vector<std::size_t>{0, 3, 7}, std::vector<std::uint32_t>{0, 1, 2, 3, 2, 1, 0});
    file.add("id", std::vector<std::uint64_t>{5, std::uint64_t{1} << 62U, 7, 8});
    file.add("flag", std::vector<std::uint8_t>{0, 1, 2, 255});
    file.add("speed", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {-1, -2, -3}});
    const VtkGrid data = written_and_read(file, compression);
    EXPECT_EQ(data.points, points);
    EXPECT_EQ(cells_of(data, vtk_poly_vertex), (Cells{{0}, {1}, {2}, {3}}));
    EXPECT_EQ(cells_of(data, vtk_poly_line), (Cells{{0, 1, 2, 3}}));
    EXPECT_EQ(cells_of(data, vtk_polygon), (Cells{{0, 1, 2}, {3, 2, 1, 0}}));
    EXPECT_EQ(cells_of(data, vtk_triangle_strip), Cells());
    ASSERT_EQ(data.point_data.size(), 3U);
    EXPECT_EQ(data.point_data[0].values, (std::vector<double>{5, 4611686018427387904.0, 7, 8}));
    EXPECT_EQ(data.point_data[1].values, (std::vector<double>{0, 1, 2, 255}));
    EXPECT_EQ(data.point_data[2].values, (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, -1, -2, -3}));
  }
}

TEST(XmlWrite, NothingIsAFileToo) {
  const Folder folder;
  for (const Compression compression : compressions) {
    VtpFile file({});
    file.add_vertices();
    file.add_line();
    file.add("id", std::vector<std::uint64_t>{});
    const VtkGrid data = written_and_read(file, compression);
    EXPECT_TRUE(data.points.empty() && data.types.empty());
    EXPECT_NE(find_array(data.point_data, "id"), nullptr);
    write_xml(folder / "a.vtu", vtu_data_set(std::make_shared<const MeshData>()), compression, replace_file);
    EXPECT_TRUE(read_vtk_xml_grid(read_bytes(folder / "a.vtu"), "UnstructuredGrid", 0).types.empty());
  }
}

TEST(FileWrite, AFullDiskIsAnErrorWithTheName) {
  const std::string_view text = "text";
  try {
    write_pieces("/dev/full", {&text, 1});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("/dev/full: the file cannot be written (No space left on device)"),
              std::string::npos)
        << e.what();
  }
}

TEST(FileWrite, AReplacedFileIsOldOrNew) {
  const Folder folder;
  const fs::path path = folder.file("a", "old");
  const std::array<std::string_view, 3> pieces = {"n", "", "ew"};
  replace_file(path, pieces);
  EXPECT_EQ(read_bytes(path), "new");
  append_bytes(path, "er");
  EXPECT_EQ(read_bytes(path), "newer");
  fs::create_directory(folder / "a.part");  // in the way
  EXPECT_THROW(replace_file(path, pieces), Error);
  EXPECT_EQ(read_bytes(path), "newer");
  EXPECT_THROW(append_bytes(folder / "none", "x"), Error);
  EXPECT_THROW(replace_file(folder / "none" / "b", pieces), Error);
}

}  // namespace dartcast::xml_write_test
