// Meshes of the plane in every format, read from files made by hand and written back.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/gmsh.hpp"
#include "formats/medit.hpp"
#include "output/info.hpp"
#include "output/mesh_report_text.hpp"
#include "support/round_trip.hpp"

namespace dartcast::test::planar_formats_test {

using Names = std::map<std::int32_t, std::string>;

std::string repair_kinds(const MeshReport& report) {
  std::string out;
  for (const Finding& f : report.repairs) out += f.kind + " " + std::to_string(f.count) + ";";
  return out;
}

TEST(PlanarFormats, GmshOfEveryVersion) {
  const MeshData mesh = planar_mesh();
  const Folder folder;
  for (const auto& [format, content] : gmsh_files(mesh)) {
    SCOPED_TRACE(format);
    const MeshFile file = read_mesh(folder.file("a.msh", content));
    expect_accepted(file, 2);
    EXPECT_EQ(file.report.format, format);
    expect_same(file.mesh, mesh);
    const std::uint32_t first = format[5] == '1' ? 4 : 3;  // after the edges
    EXPECT_EQ(file.mesh.source, (std::vector<std::uint32_t>{first, first + 1, first + 2, first + 3}));
  }
}

TEST(PlanarFormats, Gmsh40AsciiByHand) {
  const std::string text =
      "$MeshFormat\n4 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 5 \"wall\"\n2 6 \"the inside\"\n3 7 \"no volume\"\n"
      "$EndPhysicalNames\n$Entities\n0 1 1 0\n3 0 0 0 1 1 1 1 5 0\n4 0 0 0 1 1 1 2 6 9 1 3\n$EndEntities\n"
      "$Nodes\n1 3\n4 2 0 3\n1 0 0 0\n2 1 0 0\n30 0 1 0\n$EndNodes\n"
      "$Elements\n3 4\n3 1 1 2\n1 1 2\n2 30 1\n4 2 2 1\n4 1 2 30\n9 1 1 1\n5 2 30\n$EndElements\n";
  const ParsedMesh parsed = parse_gmsh(text);
  EXPECT_EQ(cells_of(parsed.mesh), (Cells{{CellType::triangle, 6, {0, 1, 2}}}));
  EXPECT_EQ(faces_of(parsed.mesh), (Faces{{5, {0, 1}}, {5, {2, 0}}}));  // the third edge is in no group
  EXPECT_EQ(parsed.mesh.region_names, (Names{{6, "the inside"}}));
  EXPECT_EQ(parsed.mesh.patch_names, (Names{{5, "wall"}}));
}

TEST(PlanarFormats, MeditWithAndWithoutZ) {
  const Folder folder;
  const std::string flat =
      "MeshVersionFormatted 1\nDimension 2\nVertices 4\n0 0 1\n1 0 1\n1 1 1\n0 1 2\nEdges\n2\n1 2 3\n2 3 0\n"
      "Triangles\n2\n1 2 3 5\n1 4 3 6\nEnd\n";
  const MeshFile file = read_mesh(folder.file("a.mesh", flat));
  EXPECT_EQ(file.report.verdict(), Verdict::repair);
  EXPECT_EQ(repair_kinds(file.report), "orientation 1;");
  EXPECT_EQ(file.report.repairs[0].first, std::vector<std::size_t>{1});
  const Cells cells = {{CellType::triangle, 5, {0, 1, 2}}, {CellType::triangle, 6, {0, 2, 3}}};
  EXPECT_EQ(cells_of(file.mesh), cells);
  EXPECT_EQ(faces_of(file.mesh), (Faces{{3, {0, 1}}}));

  const std::string high =
      "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 .5 1\n1 0 .5 1\n1 1 .5 1\n0 1 .5 2\n"
      "Triangles\n2\n1 2 3 5\n1 3 4 6\nEnd\n";
  const MeshFile raised = read_mesh(folder.file("a.mesh", high));
  EXPECT_EQ(repair_kinds(raised.report), "plane 4;");
  EXPECT_EQ(cells_of(raised.mesh), cells);
  for (const Vec3& p : raised.mesh.points) EXPECT_EQ(p.z, 0.0);

  std::string surface = high;
  surface.replace(surface.find("1 1 .5"), 6, "1 1 .6");
  const MeshReport refused = read_mesh(folder.file("a.mesh", surface)).report;
  ASSERT_EQ(refused.defects.size(), 1U);
  EXPECT_EQ(refused.defects[0].kind, "no_volume");
  EXPECT_NE(refused.defects[0].message.find("a surface in space"), std::string::npos);
}

// A square as a pixel, a triangle, and a pentagon; lines in one piece and in three; a point.
TEST(PlanarFormats, LegacyVtkByHand) {
  const std::string text =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
      "0 0 1 1 0 1 0 1 1 1 1 1 2 0 1 0 2 1 1 2 1 -1 1.5 1\n"
      "CELLS 6 25\n2 0 1\n4 0 1 2 3\n1 5\n3 1 4 3\n5 2 3 6 5 7\n4 4 3 6 5\n"
      "CELL_TYPES 6\n3\n8\n1\n5\n7\n4\n"
      "CELL_DATA 6\nSCALARS region int 1\nLOOKUP_TABLE default\n4 5 9 6 7 8\n"
      "FIELD more 1\nheat 1 6 double\n0 1 2 3 4 5\n";
  const Folder folder;
  const MeshFile file = read_mesh(folder.file("a.vtk", text));
  EXPECT_EQ(repair_kinds(file.report), "plane 8;") << report_text(file.report);
  EXPECT_TRUE(file.report.warnings.empty()) << report_text(file.report);
  EXPECT_EQ(cells_of(file.mesh), (Cells{{CellType::triangle, 6, {1, 4, 3}},
                                        {CellType::quadrilateral, 5, {0, 1, 3, 2}},
                                        {CellType::polygon, 7, {2, 3, 6, 5, 7}}}));
  EXPECT_EQ(faces_of(file.mesh), (Faces{{4, {0, 1}}, {8, {4, 3}}, {8, {3, 6}}, {8, {6, 5}}}));
  EXPECT_EQ(file.mesh.source, (std::vector<std::uint32_t>{1, 3, 4}));
  ASSERT_EQ(file.mesh.cell_data.size(), 2U);
  EXPECT_EQ(file.mesh.cell_data[1].values, (std::vector<double>{1, 3, 4}));
}

TEST(PlanarFormats, VtuAsciiByHand) {
  const std::string text = R"(<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="5" NumberOfCells="3">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 1 1 0 0 1 0 2 0 0</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 3 2 1 1 4 2 3 0</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4 7 9</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">7 5 3</DataArray></Cells>
<CellData><DataArray type="Int32" Name="region" format="ascii">1 2 3</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>)";
  const Folder folder;
  const MeshFile file = read_mesh(folder.file("a.vtu", text));
  EXPECT_EQ(repair_kinds(file.report), "orientation 1;") << report_text(file.report);
  EXPECT_EQ(cells_of(file.mesh),
            (Cells{{CellType::triangle, 2, {1, 4, 2}}, {CellType::quadrilateral, 1, {0, 1, 2, 3}}}));
  EXPECT_EQ(faces_of(file.mesh), (Faces{{3, {3, 0}}}));
}

// Faces and edges beside cells of space are what they were: patches, and nothing.
TEST(PlanarFormats, CellsOfSpaceComeFirst) {
  const std::string text =
      "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
      "Edges\n1\n1 2 9\nTriangles\n1\n1 3 2 4\nTetrahedra\n1\n1 2 3 4 17\nEnd\n";
  const ParsedMesh parsed = parse_medit(text);
  EXPECT_EQ(cells_of(parsed.mesh), (Cells{{CellType::tetrahedron, 17, {0, 1, 2, 3}}}));
  EXPECT_EQ(faces_of(parsed.mesh), (Faces{{4, {0, 2, 1}}}));
}

TEST(PlanarFormats, DefectsAreFound) {
  const Folder folder;
  const auto defect = [&](const std::string& triangles, const std::string& point) {
    const std::string text = "MeshVersionFormatted 2\nDimension 2\nVertices\n4\n0 0 0\n1 0 0\n1 1 0\n" + point +
                             " 0\nTriangles\n2\n" + triangles + "\nEnd\n";
    const MeshReport report = read_mesh(folder.file("a.mesh", text)).report;
    return report.defects.empty() ? std::string("none") : report.defects[0].kind;
  };
  EXPECT_EQ(defect("1 2 3 0 1 3 4 0", "0 1"), "none");
  EXPECT_EQ(defect("1 2 3 0 1 3 5 0", "0 1"), "id_out_of_range");
  EXPECT_EQ(defect("1 2 3 0 1 3 0 0", "0 1"), "id_out_of_range");
  EXPECT_EQ(defect("1 2 3 0 1 3 3 0", "0 1"), "repeated_corner");
  EXPECT_EQ(defect("1 2 3 0 1 3 4 0", ".5 .5"), "flat");
  EXPECT_EQ(defect("1 2 3 0 1 2 3 0", "0 1"), "same_side");
  EXPECT_EQ(defect("1 2 3 0 1 3 4 0", "-1e308 1"), "out_of_range");
  EXPECT_EQ(defect("1 2 3 0 1 3 4", "0 1"), "file");
}

TEST(PlanarFormats, SecondOrderCellsAndMfemAreRefusedByName) {
  const Folder folder;
  const std::string gmsh =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n"
      "$Elements\n2\n1 8 0 1 1 1\n2 9 0 1 1 1 1 1 1\n$EndElements\n";
  const MeshReport report = read_mesh(folder.file("a.msh", gmsh)).report;
  ASSERT_EQ(report.defects.size(), 1U);
  EXPECT_EQ(report.defects[0].kind, "second_order");
  EXPECT_EQ(report.defects[0].count, 1U);
  const MeshReport mfem = read_mesh(folder.file("a.mesh", "MFEM mesh v1.0\n\ndimension\n2\n")).report;
  ASSERT_EQ(mfem.defects.size(), 1U);
  EXPECT_NE(mfem.defects[0].message.find("MFEM mesh v1.0"), std::string::npos);
}

TEST(PlanarFormats, RefusedMeshesThrowWhereAValidOneIsNeeded) {
  const Folder folder;
  write_mesh(planar_mesh(), folder / "a.msh");
  EXPECT_EQ(read_valid_mesh(folder / "a.msh").mesh.cell_count(), 4U);
  MeshData twice = planar_mesh();
  twice.add_cell(CellType::triangle, std::array{6U, 5U, 7U});
  twice.regions.push_back(3);
  write_mesh(twice, folder / "b.msh");
  EXPECT_THROW((void)read_valid_mesh(folder / "b.msh"), InvalidMesh);
}

TEST(PlanarRoundTrip, EveryFormatKeepsPointsCellsRegionsAndPatches) { expect_round_trips(planar_mesh()); }

TEST(PlanarRoundTrip, VtkKeepsPolygonsArraysAndFree) {
  MeshData mesh = planar_polygons();
  mesh.point_data = {{"velocity", 3, std::vector<double>(36, 1.0 / 3.0)}};
  mesh.cell_data = {{"heat", 1, {0.1, -0.0, 3, 4, 5}}};
  mesh.free = {1, 0, 1, 0, 1};
  expect_vtk_keeps_arrays(mesh);
}

TEST(PlanarRoundTrip, GeneratedMeshes) {
  const Folder folder;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RectangleOptions o;
    o.cells = {12, 9};
    o.size = {1.0, 1.0};
    o.mixed = true;
    o.jitter = 0.3;
    o.seed = seed;
    const MeshData mesh = generate_rectangle(o);
    for (const char* name : {"a.vtu", "a.vtk"}) {
      write_mesh(mesh, folder / name);
      const MeshFile file = read_mesh(folder / name);
      expect_accepted(file, 2);
      expect_same(file.mesh, mesh);
    }
  }
}

TEST(PlanarRoundTrip, WhatAFormatCannotHoldIsRefused) {
  const Folder folder;
  MeshData triangle;  // as a polygon: of three corners any format holds it
  triangle.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  add(triangle, CellType::polygon, {0, 1, 2});
  for (const std::string ending : {"msh", "msh4", "mesh"}) {
    SCOPED_TRACE(ending);
    EXPECT_THROW(write_mesh(planar_polygons(), folder / ("p." + ending)), InvalidArgument);
    write_mesh(triangle, folder / ("t." + ending));
    const MeshFile file = read_mesh(folder / ("t." + ending));
    expect_accepted(file, 2);
    EXPECT_EQ(cells_of(file.mesh), (Cells{{CellType::triangle, 0, {0, 1, 2}}}));
  }
}

TEST(PlanarCheck, TheReportNamesThePlane) {
  const Folder folder;
  write_mesh(planar_mesh(), folder / "a.msh");
  const MeshReport report = check_mesh(folder / "a.msh").report;
  EXPECT_EQ(report.verdict(), Verdict::accept);
  const std::string text = report_text(report);
  EXPECT_NE(text.find("8 points; 2 quadrilateral, 2 triangle; 1 connected parts; a planar mesh (2D)"),
            std::string::npos)
      << text;
  const auto json = nlohmann::json::parse(report_json(report));
  EXPECT_EQ(json["dimension"], 2);
  EXPECT_EQ(json["regions"], (nlohmann::json{{"lumen", 2}, {"a wall, thick", 1}, {"rest", 1}}));
}

TEST(PlanarInfo, CountsAsInSpace) {
  MeshData mesh = planar_mesh();
  MeshInfo info = mesh_info(mesh, "m");
  EXPECT_EQ(info.dimension, 2U);
  EXPECT_EQ(info.free_cells, 4U);
  EXPECT_EQ(info.patches, (std::map<std::string, std::size_t>{{"inlet", 2}, {"outlet", 1}}));
  EXPECT_EQ(info.simplices, 6U);
  EXPECT_EQ(info.shapes, 2U);
  const auto json = nlohmann::json::parse(info_json(info));
  EXPECT_EQ(json["dimension"], 2);
  EXPECT_EQ(json["cells"], (nlohmann::json{{"quadrilateral", 2}, {"triangle", 2}}));
  EXPECT_EQ(json["wall_faces"], info.wall_faces);
  const std::string text = info_text(info);
  EXPECT_NE(text.find("wall edges: " + std::to_string(info.wall_faces) + ", by patch: 2 inlet, 1 outlet"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("in the plane z = 0"), std::string::npos) << text;
  mesh.free = {1, 0, 1, 1};
  EXPECT_EQ(mesh_info(mesh, "m").free_cells, 3U);
}

}  // namespace dartcast::test::planar_formats_test
