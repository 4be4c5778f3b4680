// Our .vtu and .vtp files as VTK reads them: the same data sets as from VTK's own writers, in every compression.
#include "formats/xml_write.hpp"

#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"
#include "formats/vtk/vtk_mesh.hpp"
#include "formats/vtp_write.hpp"
#include "formats/vtu_write.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::xml_write_test {

namespace fs = std::filesystem;
using test::Folder;

constexpr std::array<Compression, 3> compressions = {Compression::none, Compression::fast, Compression::small};

std::vector<double> values_of(vtkDataArray* array) {
  std::vector<double> values;
  for (vtkIdType i = 0; array != nullptr && i < array->GetNumberOfTuples(); ++i) {
    for (int k = 0; k < array->GetNumberOfComponents(); ++k) values.push_back(array->GetComponent(i, k));
  }
  return values;
}

std::vector<std::vector<vtkIdType>> cells_of(vtkCellArray* cells) {
  std::vector<std::vector<vtkIdType>> all;
  for (vtkIdType c = 0; cells != nullptr && c < cells->GetNumberOfCells(); ++c) {
    vtkIdType size = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(c, size, ids);
    all.emplace_back(ids, ids + size);
  }
  return all;
}

void expect_same_arrays(vtkFieldData& found, vtkFieldData& expected) {
  ASSERT_EQ(found.GetNumberOfArrays(), expected.GetNumberOfArrays());
  for (int a = 0; a < expected.GetNumberOfArrays(); ++a) {
    vtkDataArray* array = expected.GetArray(a);
    SCOPED_TRACE(array->GetName());
    vtkDataArray* same = found.GetArray(array->GetName());
    ASSERT_NE(same, nullptr);
    EXPECT_EQ(same->GetNumberOfComponents(), array->GetNumberOfComponents());
    EXPECT_EQ(values_of(same), values_of(array));
  }
}

template <class T>
std::vector<T> faces_of(vtkUnstructuredGrid& grid) {
  std::vector<T> faces;
  for (vtkIdType c = 0; c < grid.GetNumberOfCells(); ++c) {
    if (grid.GetCellType(c) != VTK_POLYHEDRON) continue;
    vtkIdType count = 0;
    const vtkIdType* stream = nullptr;
    grid.GetFaceStream(c, count, stream);
    faces.push_back(count);
    for (vtkIdType f = 0; f < count; ++f) {
      faces.insert(faces.end(), stream, stream + *stream + 1);
      stream += *stream + 1;
    }
  }
  return faces;
}

void expect_same_grid(vtkUnstructuredGrid& found, vtkUnstructuredGrid& expected) {
  EXPECT_EQ(values_of(found.GetPoints()->GetData()), values_of(expected.GetPoints()->GetData()));
  EXPECT_EQ(found.GetPoints()->GetDataType(), VTK_DOUBLE);
  EXPECT_EQ(cells_of(found.GetCells()), cells_of(expected.GetCells()));
  EXPECT_EQ(values_of(found.GetCellTypesArray()), values_of(expected.GetCellTypesArray()));
  EXPECT_EQ(faces_of<vtkIdType>(found), faces_of<vtkIdType>(expected));
  expect_same_arrays(*found.GetPointData(), *expected.GetPointData());
  expect_same_arrays(*found.GetCellData(), *expected.GetCellData());
}

// The truth: VTK's own grid, as it wrote it to a legacy file.
void expect_as_by_vtk(const MeshData& mesh) {
  const Folder folder;
  write_legacy_vtk(mesh, folder / "a.vtk");
  vtkNew<vtkUnstructuredGridReader> legacy;
  legacy->SetFileName((folder / "a.vtk").c_str());
  legacy->ReadAllScalarsOn();
  legacy->ReadAllFieldsOn();
  legacy->Update();
  const std::shared_ptr<const MeshData> shared = std::make_shared<const MeshData>(mesh);
  for (const Compression compression : compressions) {
    SCOPED_TRACE(static_cast<int>(compression));
    const fs::path path = folder / "a.vtu";
    write_xml(path, vtu_data_set(shared), compression, replace_file);
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    ASSERT_EQ(reader->GetErrorCode(), 0U);
    expect_same_grid(*reader->GetOutput(), *legacy->GetOutput());
    const ParsedMesh parsed = parse_vtu(path, read_bytes(path));
    EXPECT_EQ(parsed.mesh.region_names, mesh.region_names);
    EXPECT_EQ(parsed.mesh.patch_names, mesh.patch_names);
  }
}

TEST(XmlWrite, EveryTypeOfCellIsAsByVtk) {
  MeshData mesh = test::mixed_mesh();
  expect_as_by_vtk(mesh);
  mesh.region_names[-8] = "a <wall> & \"more\"";
  mesh.free = {1, 0, 1, 0};
  mesh.cell_data = {{"heat", 1, {0.1, -0.0, 1e-310, 1e300}}, {"a <b> & \"c\"", 2, {1, 2, 3}}};
  mesh.point_data = {{"short", 3, {1.0 / 3.0, 2.0}}};
  expect_as_by_vtk(mesh);
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  mesh.patch_tags.clear();
  expect_as_by_vtk(mesh);
}

TEST(XmlWrite, PolyhedraAreAsByVtk) {
  MeshData mesh = test::polyhedra();
  expect_as_by_vtk(mesh);
  mesh.points.push_back({0.2, 0.1, 0.01});
  test::add(mesh, CellType::tetrahedron, {4, 5, 8, 9});
  test::add(mesh, CellType::polyhedron, {4, 3, 8, 9, 4, 3, 8, 4, 7, 3, 9, 7, 4, 3, 7, 9, 8});
  test::add_face(mesh, {0, 3, 2, 1}, -5);
  expect_as_by_vtk(mesh);
}

TEST(XmlWrite, MeshesOfThePlaneAreAsByVtk) {
  expect_as_by_vtk(test::planar_mesh());
  expect_as_by_vtk(test::planar_polygons());
}

// Arrays of many blocks of compression, and of exactly one or two.
TEST(XmlWrite, ManyBlocksAreAsByVtk) {
  BoxOptions box;
  box.cells = {24, 20, 16};
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
  expect_as_by_vtk(mesh);
}

std::vector<double> written_and_read(const std::vector<double>& values, Compression compression, bool keep) {
  const Folder folder;
  VtpFile file(std::vector<Vec3>(values.size()));
  file.add("x", values);
  XmlDataSet data = file.data();
  if (keep) data.section("PointData").arrays.front().keep();
  for (int i = 0; i < 2; ++i) write_xml(folder / "a.vtp", data, compression, write_pieces);
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder / "a.vtp").c_str());
  reader->Update();
  EXPECT_EQ(reader->GetErrorCode(), 0U);
  return values_of(reader->GetOutput()->GetPointData()->GetArray("x"));
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

vtkPolyData& read_vtp(vtkXMLPolyDataReader& reader, const VtpFile& file, Compression compression,
                      const fs::path& path) {
  write_xml(path, file.data(), compression, replace_file);
  reader.SetFileName(path.c_str());
  reader.Update();
  EXPECT_EQ(reader.GetErrorCode(), 0U);
  return *reader.GetOutput();
}

TEST(XmlWrite, PointsLinesAndPolygons) {
  using Cells = std::vector<std::vector<vtkIdType>>;
  const Folder folder;
  for (const Compression compression : compressions) {
    VtpFile file({{0, 0, 0}, {1, 0, 0.5}, {1.0 / 3.0, -0.0, 1e-310}, {2, 2, 2}});
    file.add_vertices();
    file.add_line();
    file.add_polygons(std::vector<std::size_t>{0, 3, 7}, std::vector<std::uint32_t>{0, 1, 2, 3, 2, 1, 0});
    file.add("id", std::vector<std::uint64_t>{5, std::uint64_t{1} << 62U, 7, 8});
    file.add("flag", std::vector<std::uint8_t>{0, 1, 2, 255});
    file.add("speed", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {-1, -2, -3}});
    vtkNew<vtkXMLPolyDataReader> reader;
    vtkPolyData& data = read_vtp(*reader, file, compression, folder / "a.vtp");
    EXPECT_EQ(values_of(data.GetPoints()->GetData()),
              (std::vector<double>{0, 0, 0, 1, 0, 0.5, 1.0 / 3.0, -0.0, 1e-310, 2, 2, 2}));
    EXPECT_EQ(cells_of(data.GetVerts()), (Cells{{0}, {1}, {2}, {3}}));
    EXPECT_EQ(cells_of(data.GetLines()), (Cells{{0, 1, 2, 3}}));
    EXPECT_EQ(cells_of(data.GetPolys()), (Cells{{0, 1, 2}, {3, 2, 1, 0}}));
    EXPECT_EQ(cells_of(data.GetStrips()), Cells());
    EXPECT_EQ(data.GetPointData()->GetArray("id")->GetVariantValue(1).ToString(), "4611686018427387904");
    EXPECT_EQ(values_of(data.GetPointData()->GetArray("flag")), (std::vector<double>{0, 1, 2, 255}));
    EXPECT_EQ(values_of(data.GetPointData()->GetArray("speed")),
              (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, -1, -2, -3}));
  }
}

TEST(XmlWrite, NothingIsAFileToo) {
  const Folder folder;
  for (const Compression compression : compressions) {
    VtpFile file({});
    file.add_vertices();
    file.add_line();
    file.add("id", std::vector<std::uint64_t>{});
    vtkNew<vtkXMLPolyDataReader> reader;
    vtkPolyData& data = read_vtp(*reader, file, compression, folder / "a.vtp");
    EXPECT_EQ(data.GetNumberOfPoints(), 0);
    EXPECT_EQ(data.GetNumberOfCells(), 0);
    EXPECT_NE(data.GetPointData()->GetArray("id"), nullptr);
    write_xml(folder / "a.vtu", vtu_data_set(std::make_shared<const MeshData>()), compression, replace_file);
    vtkNew<vtkXMLUnstructuredGridReader> grid;
    grid->SetFileName((folder / "a.vtu").c_str());
    grid->Update();
    EXPECT_EQ(grid->GetErrorCode(), 0U);
    EXPECT_EQ(grid->GetOutput()->GetNumberOfCells(), 0);
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
