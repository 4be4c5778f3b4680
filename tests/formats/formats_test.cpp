// Every format, read from files made by hand and written back.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/gmsh.hpp"
#include "formats/medit.hpp"
#include "output/mesh_report_text.hpp"
#include "scene/scene_mesh.hpp"
#include "support/round_trip.hpp"

namespace dartcast::test::formats_test {

TEST(Formats, GmshOfEveryVersion) {
  const MeshData mesh = sample_mesh();
  const Folder folder;
  for (const auto& [format, content] : gmsh_files(mesh)) {
    const MeshFile file = read_mesh(folder.file("a.msh", content));
    SCOPED_TRACE(format);
    expect_accepted(file);
    EXPECT_EQ(file.report.format, format);
    expect_same(file.mesh, mesh);
    EXPECT_EQ(file.mesh.source,
              (std::vector<std::uint32_t>(format[5] == '1' ? std::vector<std::uint32_t>{3, 4, 5, 6}
                                                           : std::vector<std::uint32_t>{2, 3, 4, 5})));
  }
}

TEST(Formats, Gmsh40AsciiByHand) {
  const std::string text =
      "$MeshFormat\n4 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 5 \"wall\"\n3 6 \"the inside\"\n$EndPhysicalNames\n"
      "$Entities\n0 0 1 1\n3 0 0 0 1 1 1 1 5 0\n4 0 0 0 1 1 1 2 6 9 1 3\n$EndEntities\n"
      "$Nodes\n1 4\n4 3 0 4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n40 0 0 1\n$EndNodes\n"
      "$Elements\n2 2\n3 2 2 1\n1 1 3 2\n4 3 4 1\n2 1 2 3 40\n$EndElements\n";
  const ParsedMesh parsed = parse_gmsh(text);
  EXPECT_EQ(parsed.mesh.points.size(), 4U);
  EXPECT_EQ(cells_of(parsed.mesh), (Cells{{CellType::tetrahedron, 6, {0, 1, 2, 3}}}));
  EXPECT_EQ(faces_of(parsed.mesh), (Faces{{5, {0, 2, 1}}}));
  EXPECT_EQ(parsed.mesh.region_names.at(6), "the inside");
  EXPECT_EQ(parsed.mesh.patch_names.at(5), "wall");
}

TEST(Formats, Gmsh20AsciiSkipsOtherSectionsAndElements) {
  const std::string text =
      "$Comments\nanything $Nodes\n$EndComments\n$MeshFormat\n2 0 8\n$EndMeshFormat\n"
      "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
      "$Elements\n4\n1 15 2 1 1 1\n2 1 2 1 1 1 2\n3 2 0 1 3 2\n4 4 3 8 1 0 1 2 3 4\n$EndElements\n"
      "$NodeData\n1\n\"a\"\n$EndNodeData\n";
  const ParsedMesh parsed = parse_gmsh(text);
  EXPECT_EQ(cells_of(parsed.mesh), (Cells{{CellType::tetrahedron, 8, {0, 1, 2, 3}}}));
  EXPECT_EQ(parsed.mesh.source, std::vector<std::uint32_t>{3});
  EXPECT_TRUE(parsed.mesh.patch_tags.empty());  // no tag: no patch
}

TEST(Formats, MeditByHand) {
  const std::string text =
      " MeshVersionFormatted 1\n# a comment 7\nDimension\n3\nVertices 5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 +2\n9.5e0 9 "
      "9 0\n"
      "Corners\n2\n1 2\nNormals\n1\n0.5 .5 1\nTriangles\n2\n1 3 2 4\n1 2 4 0\nTetrahedra\n1\n1 2 3 4 17\nEnd\n";
  const Folder folder;
  const MeshFile file = read_mesh(folder.file("a.mesh", text));
  EXPECT_EQ(file.report.verdict(), Verdict::repair);
  ASSERT_EQ(file.report.repairs.size(), 1U);
  EXPECT_EQ(file.report.repairs[0].kind, "unused_points");
  EXPECT_EQ(file.report.repairs[0].first, std::vector<std::size_t>{4});
  EXPECT_EQ(cells_of(file.mesh), (Cells{{CellType::tetrahedron, 17, {0, 1, 2, 3}}}));
  EXPECT_EQ(faces_of(file.mesh), (Faces{{4, {0, 2, 1}}}));
}

TEST(Formats, LegacyVtkOfBothWaysToWriteCells) {
  const std::string head = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  const std::string points = "POINTS 8 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1\n";
  const std::string data =
      "CELL_TYPES 2\n11 1\nCELL_DATA 2\nSCALARS region int 1\nLOOKUP_TABLE default\n4 5\nPOINT_DATA 8\nVECTORS v "
      "double\n"
      "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24\nFIELD more 1\nt 1 8 float\n1 2 3 4 5 6 7 8\n";
  const Folder folder;
  for (const std::string& cells :
       {std::string("CELLS 2 11\n8 0 1 2 3 4 5 6 7\n1 3\n"),
        std::string("CELLS 3 9\nOFFSETS vtktypeint64\n0 8 9\nCONNECTIVITY vtktypeint64\n0 1 2 3 4 5 6 7 3\n")}) {
    const std::string version =
        cells.find("OFFSETS") == std::string::npos ? head : "# vtk DataFile Version 5.1" + head.substr(26);
    const MeshFile file = read_mesh(folder.file("a.vtk", version + points + cells + data));
    expect_accepted(file);
    EXPECT_EQ(cells_of(file.mesh), (Cells{{CellType::hexahedron, 4, {0, 1, 3, 2, 4, 5, 7, 6}}}));  // a voxel
    ASSERT_EQ(file.mesh.point_data.size(), 2U);
    EXPECT_EQ(file.mesh.point_data[0].name, "v");
    EXPECT_EQ(file.mesh.point_data[0].components, 3U);
    EXPECT_EQ(file.mesh.point_data[0].values[23], 24.0);
    ASSERT_EQ(file.mesh.cell_data.size(), 1U);
    EXPECT_EQ(file.mesh.cell_data[0].values, std::vector<double>{4.0});
    EXPECT_EQ(file.mesh.source, std::vector<std::uint32_t>{0});
  }
}

TEST(Formats, PrismsInEitherOrderOfVtk) {
  const std::string head =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 "
      "0 1 1\n";
  const Folder folder;
  // VTK's own order: the first triangle's normal points outwards.
  const MeshFile documented = read_mesh(folder.file("a.vtk", head + "CELLS 1 7\n6 0 2 1 3 5 4\nCELL_TYPES 1\n13\n"));
  expect_accepted(documented);
  const MeshFile as_gmsh = read_mesh(folder.file("a.vtk", head + "CELLS 1 7\n6 0 1 2 3 4 5\nCELL_TYPES 1\n13\n"));
  EXPECT_EQ(as_gmsh.report.verdict(), Verdict::repair);
  EXPECT_EQ(as_gmsh.mesh.connectivity, documented.mesh.connectivity);
  EXPECT_EQ(documented.mesh.connectivity, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
}

TEST(Formats, VtuAsciiByHand) {
  const std::string text = R"(<?xml version="1.0"?>
<!-- > a comment < -->
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="BigEndian"><UnstructuredGrid>
<Piece NumberOfPoints='4' NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>
<CellData><DataArray type="Float32" Name="heat" format="ascii">0.5</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>)";
  const Folder folder;
  const MeshFile file = read_mesh(folder.file("a.vtu", text));
  expect_accepted(file);
  EXPECT_EQ(cells_of(file.mesh), (Cells{{CellType::tetrahedron, 0, {0, 1, 2, 3}}}));
  ASSERT_EQ(file.mesh.cell_data.size(), 1U);
  EXPECT_EQ(file.mesh.cell_data[0].values, std::vector<double>{0.5});
}

TEST(Formats, FreeCellsCountWhereDartcastHasWrittenThem) {
  const Folder folder;
  MeshData mesh = sample_mesh();
  mesh.free = {1, 0, 1, 0};
  write_mesh(mesh, folder / "own.vtu");
  const MeshData own = read_valid_mesh(folder / "own.vtu").mesh;
  EXPECT_EQ(own.free, mesh.free);
  // An array of that name in another program's file stays an array, also when dartcast copies it.
  mesh.cell_data.push_back({"free", 1, {1, 0, 1, 0}});
  mesh.free.clear();
  for (const std::string name : {"other.vtu", "other.vtk"}) {
    write_mesh(mesh, folder / name);
    const MeshData other = read_valid_mesh(folder / name).mesh;
    EXPECT_TRUE(other.free.empty()) << name;
    EXPECT_EQ(other.cell_data.at(0).values, mesh.cell_data[0].values) << name;
  }
  const auto scene = [&](const std::string& keys) {
    return load_scene_mesh(
               parse_scene("[environment]\nmesh = '" + (folder / "own.vtu").string() + "'\n" + keys, "s.toml")
                   .environment)
        .mesh.free;
  };
  EXPECT_EQ(scene(""), own.free);
  EXPECT_EQ(scene("free = { region = ['rest'] }\n"), (std::vector<std::uint8_t>{0, 0, 0, 1}));
  EXPECT_EQ(scene("free = { array = 'free', values = [0] }\n"), (std::vector<std::uint8_t>{0, 1, 0, 1}));
}

TEST(Formats, VtuBinaryInEitherByteOrder) {
  const Folder folder;
  for (const std::string format : {"binary", "appended"}) {
    for (const bool big_endian : {false, true}) {
      const MeshFile file = read_mesh(folder.file("a.vtu", binary_vtu(format, big_endian)));
      expect_accepted(file);
      EXPECT_EQ(cells_of(file.mesh),
                (Cells{{CellType::tetrahedron, 0, {0, 1, 2, 3}}, {CellType::tetrahedron, 0, {0, 2, 1, 4}}}));
      ASSERT_EQ(file.mesh.points.size(), 5U);
      EXPECT_EQ(file.mesh.points[4].z, -1. / 3.);
    }
  }
}

TEST(RoundTrip, EveryFormatKeepsPointsCellsRegionsAndPatches) { expect_round_trips(sample_mesh()); }

TEST(RoundTrip, VtkKeepsPolyhedraArraysAndFree) {
  MeshData mesh = polyhedra();
  mesh.point_data = {{"velocity", 3, std::vector<double>(27, 1.0 / 3.0)}};
  mesh.cell_data = {{"heat", 1, {0.1, -0.0}}};
  mesh.free = {1, 0};
  expect_vtk_keeps_arrays(mesh);
}

TEST(RoundTrip, WhatAFormatCannotHoldIsRefused) {
  const Folder folder;
  for (const std::string ending : {"msh", "msh4", "mesh"}) {
    EXPECT_THROW(write_mesh(polyhedra(), folder / ("p." + ending)), InvalidArgument) << ending;
  }
  EXPECT_THROW(write_mesh(sample_mesh(), folder / "a.obj"), InvalidArgument);
  for (const std::string ending : {"vtu", "vtk", "msh", "mesh"}) {
    EXPECT_THROW(write_mesh(sample_mesh(), folder / ("no/such/folder/a." + ending)), Error) << ending;
  }
}

TEST(Formats, OthersAreRefusedByName) {
  const Folder folder;
  const auto message = [&](const std::string& name, const std::string& content) {
    const MeshFile file = read_mesh(folder.file(name, content));
    EXPECT_EQ(file.report.verdict(), Verdict::refuse) << name;
    return file.report.defects.empty() ? std::string() : file.report.defects[0].message;
  };
  EXPECT_NE(message("a.obj", "v 0 0 0\n").find(".vtu"), std::string::npos);
  EXPECT_NE(message("a.obj", "v 0 0 0\n").find("read_surface()"), std::string::npos);
  EXPECT_EQ(message("a.xyz", "v 0 0 0\n").find("read_surface()"), std::string::npos);
  EXPECT_NE(message("a.mesh", "MFEM mesh v1.0\n\ndimension\n3\n").find("MFEM mesh v1.0"), std::string::npos);
  EXPECT_NE(message("b.mesh", "MFEM NC mesh v1.0\n\ndimension\n3\n").find("MFEM NC mesh"), std::string::npos);
  EXPECT_NE(message("a.msh", "(0 \"GAMBIT to Fluent File\")\n").find("Fluent"), std::string::npos);
  EXPECT_NE(message("b.msh", "MeshVersionFormatted 2\n").find("Medit"), std::string::npos);
  EXPECT_NE(message("a.vtk", "<VTKFile type=\"UnstructuredGrid\"></VTKFile>").find(".vtu"), std::string::npos);
  EXPECT_NE(message("b.vtk", "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\n").find("POLYDATA"),
            std::string::npos);
  EXPECT_NE(message("a.vtu", "<VTKFile type=\"PolyData\"></VTKFile>").find("PolyData"), std::string::npos);
  EXPECT_NE(message("c.msh", "$MeshFormat\n3.0 0 8\n$EndMeshFormat\n").find("3.0"), std::string::npos);
  EXPECT_NE(message("e.vtk", "").find("empty"), std::string::npos);
  EXPECT_FALSE(read_mesh(folder / "none.vtu").report.valid());
  EXPECT_FALSE(read_mesh(std::filesystem::temp_directory_path()).report.valid());
}

TEST(Formats, NumbersThatNameNoPointAreFound) {
  const Folder folder;
  for (const std::string number : {"0", "-1", "5", "4294967297", "4294967296"}) {
    const std::string medit =
        "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
        "Tetrahedra\n1\n1 2 3 " +
        number + " 0\nEnd\n";
    const std::string gmsh =
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n"
        "0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 " +
        number + "\n$EndElements\n";
    const std::string vtk =
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
        "CELLS 1 5\n4 0 1 2 " +
        (number == "0" ? "4" : number) + "\nCELL_TYPES 1\n10\n";
    for (const auto& path : {folder.file("a.mesh", medit), folder.file("a.msh", gmsh), folder.file("a.vtk", vtk)}) {
      const MeshReport report = read_mesh(path).report;
      ASSERT_EQ(report.defects.size(), 1U) << path << " " << number;
      const bool unreadable = number.size() > 9 && path.extension() == ".vtk";  // not in VTK's 32 bits
      const bool negative = number == "-1" && path.extension() == ".msh";
      EXPECT_EQ(report.defects[0].kind, unreadable || negative ? "file" : "id_out_of_range") << path << " " << number;
    }
  }
}

TEST(Formats, SecondOrderCellsAreRefusedByName) {
  const Folder folder;
  const std::string gmsh =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n"
      "$Elements\n1\n1 11 0 1 1 1 1 1 1 1 1 1 1\n$EndElements\n";
  const std::string medit =
      "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nTetrahedraP2\n1\n1 1 1 1 1 1 1 1 1 1 0\nEnd\n";
  const std::string vtk =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1 11\n"
      "10 0 0 0 0 0 0 0 0 0 0\nCELL_TYPES 1\n24\n";
  for (const auto& path : {folder.file("a.msh", gmsh), folder.file("a.mesh", medit), folder.file("a.vtk", vtk)}) {
    const MeshReport report = read_mesh(path).report;
    ASSERT_EQ(report.defects.size(), 1U) << path << report_text(report);
    EXPECT_EQ(report.defects[0].kind, "second_order");
    EXPECT_EQ(report.defects[0].count, 1U);
  }
}

std::string repeated(const std::string& word, int n) {
  std::string out;
  for (int i = 0; i < n; ++i) out += word;
  return out;
}

/// Gmsh's element types that have curved sides, with their numbers of nodes, from its list of types.
std::vector<std::pair<int, int>> gmsh_higher_order() {
  std::vector<std::pair<int, int>> types = {{9, 6},   {10, 9},  {11, 10},  {12, 27}, {13, 18}, {14, 14}, {16, 8},
                                            {17, 20}, {18, 15}, {19, 13},  {20, 9},  {21, 10}, {22, 12}, {23, 15},
                                            {24, 15}, {25, 21}, {29, 20},  {30, 35}, {31, 56}, {32, 22}, {33, 28},
                                            {90, 40}, {91, 75}, {137, 16}, {138, 4}, {139, 5}};
  const auto add = [&](int first, const std::vector<int>& nodes) {
    for (const int n : nodes) types.emplace_back(first++, n);
  };
  add(36, {16, 25, 36, 12, 16, 20, 28, 36, 45, 55, 66, 49, 64, 81, 100, 121, 18, 21, 24, 27, 30, 24, 28, 32, 36, 40});
  add(71, {84, 120, 165, 220, 286});
  add(79, {34, 40, 46, 52, 58});
  for (int order = 3; order <= 9; ++order) types.emplace_back(89 + order, (order + 1) * (order + 1) * (order + 1));
  for (int order = 3; order <= 9; ++order) types.emplace_back(96 + order, 8 + 12 * (order - 1));
  for (int order = 5; order <= 9; ++order) types.emplace_back(101 + order, (order + 1) * (order + 1) * (order + 2) / 2);
  for (int order = 3; order <= 9; ++order) types.emplace_back(108 + order, 6 + 9 * (order - 1));
  for (int order = 3; order <= 9; ++order)
    types.emplace_back(115 + order, (order + 1) * (order + 2) * (2 * order + 3) / 6);
  for (int order = 3; order <= 9; ++order) types.emplace_back(122 + order, 5 + 8 * (order - 1));
  return types;
}

// In version 2, and in 4.1 in binary: the nodes are skipped right where the next element is read.
TEST(Formats, EveryGmshElementOfHigherOrderIsNamedAsSuch) {
  const Folder folder;
  EXPECT_EQ(gmsh_higher_order().size(), 26U + 26 + 5 + 5 + 7 + 7 + 5 + 7 + 7 + 7);
  for (const auto& [type, nodes] : gmsh_higher_order()) {
    const std::string ones = repeated(" 1", nodes);
    const std::string number = std::to_string(type);
    const std::string v2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n2\n1 " +
                           number + " 0" + ones + "\n2 " + number + " 0" + ones + "\n$EndElements\n";
    const std::string v4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 1 1 1\n3 1 0 1\n1\n0 0 0\n$EndNodes\n" +
                           ("$Elements\n1 2 1 2\n3 1 " + number) + " 2\n1" + ones + "\n2" + ones + "\n$EndElements\n";
    for (const std::string& content : {v2, v4}) {
      const MeshReport report = read_mesh(folder.file("a.msh", content)).report;
      ASSERT_EQ(report.defects.size(), 1U) << type;
      EXPECT_EQ(report.defects[0].kind, "second_order") << type << report_text(report);
      EXPECT_EQ(report.defects[0].count, 2U) << type;
    }
  }
}

TEST(Formats, OtherElementsOfGmshAreRefusedByNumber) {
  const Folder folder;
  for (const int type : {34, 35, 67, 70, 76, 133, 141, 1000, -1}) {
    const auto path =
        folder.file("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 " +
                                 std::to_string(type) + " 0 1 1 1 1\n$EndElements\n");
    const std::string message = read_mesh(path).report.defects.at(0).message;
    EXPECT_NE(message.find("line 10: element type " + std::to_string(type)), std::string::npos) << message;
  }
  // Curves are left out, whatever their order.
  const std::string curves = "1 26 0 1 1 1 1\n2 62 0" + repeated(" 1", 7) + "\n3 66 0" + repeated(" 1", 11) + "\n";
  const ParsedMesh parsed = parse_gmsh(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n4\n" +
      curves + "4 4 0 1 2 3 4\n$EndElements\n");
  EXPECT_EQ(parsed.second_order.count, 0U);
  EXPECT_EQ(parsed.mesh.source, std::vector<std::uint32_t>{3});
}

TEST(Formats, GmshSizesOfFourBytesBelongToVersion41) {
  const Folder folder;
  for (const std::string head : {"2.2 0 4", "4 0 4", "4.1 0 5", "4.1 1 2"}) {
    const auto path = folder.file("a.msh", "$MeshFormat\n" + head + "\n$EndMeshFormat\n");
    const std::string message = read_mesh(path).report.defects.at(0).message;
    EXPECT_NE(message.find("line 2"), std::string::npos) << message;
  }
}

/// VTK's types of one cell that has any number of corners, in both of its formats.
TEST(Formats, EveryCellTypeOfVtkGetsAVerdict) {
  const Folder folder;
  for (int type = 0; type < 90; ++type) {
    const bool curve = type == 21 || type == 35 || type == 51 || type == 60 || type == 68 || type == 75;
    const bool higher = (type >= 21 && type <= 37) || (type >= 51 && type <= 56) || (type >= 60 && type <= 81);
    for (const int corners : {1, 4, 8, 10, 15, 27, 64}) {
      const std::string ids = repeated(" 0", corners);
      const std::string vtk =
          "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1 " +
          std::to_string(corners + 1) + "\n" + std::to_string(corners) + ids + "\nCELL_TYPES 1\n" +
          std::to_string(type) + "\n";
      const std::string vtu =
          "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid><Piece NumberOfPoints=\"1\" "
          "NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 "
          "0</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\">" +
          ids + "</DataArray><DataArray type=\"Int64\" Name=\"offsets\">" + std::to_string(corners) +
          "</DataArray><DataArray type=\"UInt8\" Name=\"types\">" + std::to_string(type) +
          "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
      for (const auto& path : {folder.file("a.vtk", vtk), folder.file("a.vtu", vtu)}) {
        const MeshReport report = read_mesh(path).report;
        ASSERT_FALSE(report.valid()) << path << " type " << type;
        const bool fits = report.defects[0].message.find("VTK cannot read") == std::string::npos;
        if (higher && !curve && fits) EXPECT_EQ(report.defects[0].kind, "second_order") << type << " " << corners;
      }
    }
  }
}

TEST(Formats, EndingsAreListed) {
  using Endings = std::vector<std::string>;
  EXPECT_EQ(mesh_endings(),
            (Endings{".vtu", ".pvtu", ".vtk", ".msh", ".msh2", ".msh4", ".mesh", ".meshb", ".ele", ".node"}));
  EXPECT_EQ(writable_mesh_endings(), (Endings{".vtu", ".vtk", ".msh", ".msh2", ".msh4", ".mesh"}));
}

TEST(Report, JsonHasTheFieldsOfTheInterface) {
  const Folder folder;
  write_mesh(sample_mesh(), folder / "a.msh");
  const auto json = nlohmann::json::parse(report_json(read_mesh(folder / "a.msh").report));
  EXPECT_EQ(json["file"], (folder / "a.msh").string());
  EXPECT_EQ(json["format"], "Gmsh 2.2 ASCII");
  EXPECT_EQ(json["points"], 12);
  EXPECT_EQ(json["cells"], (nlohmann::json{{"hexahedron", 1}, {"prism", 1}, {"pyramid", 1}, {"tetrahedron", 1}}));
  EXPECT_EQ(json["regions"], (nlohmann::json{{"lumen", 2}, {"a wall, thick", 1}, {"rest", 1}}));
  EXPECT_EQ(json["valid"], true);
  EXPECT_TRUE(json["repairs"].empty() && json["warnings"].empty() && json["defects"].empty());

  const auto refused = nlohmann::json::parse(report_json(read_mesh(folder.file("\xff.msh", "$\xfe\n")).report));
  EXPECT_EQ(refused["valid"], false);
  EXPECT_EQ(refused["defects"][0]["kind"], "file");
  const std::string text = report_text(read_mesh(folder / "a.msh").report);
  EXPECT_NE(text.find("verdict: accept"), std::string::npos);
}

}  // namespace dartcast::test::formats_test
