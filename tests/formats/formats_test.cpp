// Every format, read from files made by hand and written back.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
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

TEST(Formats, GmshEntitiesOfPartsHaveTheirGroups) {
  const std::string text =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 5 \"wall\"\n3 6 \"inside\"\n$EndPhysicalNames\n"
      "$Entities\n0 0 1 1\n3 0 0 0 1 1 1 1 5 0\n4 0 0 0 1 1 1 1 6 0\n$EndEntities\n"
      "$PartitionedEntities\n2\n1\n9 1\n1 0 2 2\n1 3 4 2 1 2 0 0 0 0\n"
      "11 2 3 1 1 0 0 0 1 1 1 1 5 0\n12 2 3 1 2 0 0 0 1 1 1 0 0\n"
      "21 3 4 1 1 0 0 0 1 1 1 1 6 0\n22 3 4 1 2 0 0 0 1 1 1 0 0\n$EndPartitionedEntities\n"
      "$Nodes\n1 5 1 5\n3 21 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n$EndNodes\n"
      "$Elements\n4 4 1 4\n2 11 2 1\n1 1 2 4\n2 12 2 1\n2 1 5 2\n3 21 4 1\n3 1 2 3 4\n3 22 4 1\n4 1 3 2 5\n"
      "$EndElements\n";
  const ParsedMesh parsed = parse_gmsh(text);
  EXPECT_EQ(parsed.mesh.regions, (std::vector<std::int32_t>{6, 6}));
  EXPECT_EQ(parsed.mesh.patch_tags, (std::vector<std::int32_t>{5, 5}));
  EXPECT_TRUE(parsed.warnings.empty());
  const ParsedMesh unknown = parse_gmsh(std::regex_replace(text, std::regex("2 12 2 1\n2 1 5"), "2 13 2 1\n2 1 5"));
  ASSERT_EQ(unknown.warnings.size(), 1U);
  EXPECT_EQ(unknown.warnings[0].kind, "unknown_entities");
  EXPECT_EQ(unknown.warnings[0].count, 1U);
}

TEST(Formats, GmshElementsOfSeveralGroupsCountOnce) {
  const MeshData mesh = sample_mesh();
  const std::string text = format_gmsh_2(mesh);
  const std::size_t begin = text.find("$Elements\n") + 10;
  const std::size_t lines = text.find('\n', begin) + 1;
  const std::size_t end = text.find("$EndElements");
  const int n = std::stoi(text.substr(begin));
  std::istringstream in(text.substr(lines, end - lines));
  std::string all;
  for (std::string line; std::getline(in, line);)
    all += line + "\n" + std::regex_replace(line, std::regex("^(\\d+ \\d+ 2) \\d+"), "$1 77") + "\n";
  const MeshFile file =
      read_mesh(Folder().file("a.msh", text.substr(0, begin) + std::to_string(2 * n) + "\n" + all + text.substr(end)));
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  expect_same(file.mesh, mesh);
  ASSERT_EQ(file.report.warnings.size(), 1U);
  EXPECT_EQ(file.report.warnings[0].kind, "several_groups");
  EXPECT_EQ(file.report.warnings[0].count, static_cast<std::size_t>(n));
}

TEST(Formats, GmshNodesMayHaveParameters) {
  const MeshData mesh = sample_mesh();
  const std::string text = format_gmsh_2(mesh);
  const std::size_t begin = text.find("$Nodes\n");
  const std::size_t end = text.find("$EndNodes");
  std::istringstream in(text.substr(begin + 7, end - begin - 7));
  std::string nodes = "$ParametricNodes\n", line;
  std::getline(in, line);
  nodes += line + "\n";
  const std::vector<std::string> parameters = {" 0 4", " 1 2 0.5", " 2 1 0.25 -1e3", " 3 1"};
  for (std::size_t i = 0; std::getline(in, line); ++i) nodes += line + parameters[i % 4] + "\n";
  const MeshFile file =
      read_mesh(Folder().file("a.msh", text.substr(0, begin) + nodes + "$EndParametricNodes" + text.substr(end + 9)));
  expect_accepted(file);
  expect_same(file.mesh, mesh);
}

TEST(Formats, MeditTextsInQuotesMayHoldKeywords) {
  const MeshData mesh = sample_mesh();
  std::string text = format_medit(mesh);
  text.insert(text.find("Vertices"),
              "Identifier\n\"made by hand, End of Vertices # \"\nGeometry\n\"/data/My Triangles 2/a.mesh\"\n");
  const MeshFile file = read_mesh(Folder().file("a.mesh", text));
  expect_accepted(file);
  expect_same(file.mesh, mesh);
}

TEST(Formats, ByteOrderMarksAndZerosAtTheStart) {
  const Folder folder;
  write_mesh(sample_mesh(), folder / "a.vtu");
  std::vector<std::string> names = mesh_endings();
  for (const std::string& ending : surface_endings()) names.push_back(ending);
  for (const auto& [name, text] :
       std::vector<std::pair<std::string, std::string>>{{"b.vtu", slurp(folder / "a.vtu")},
                                                        {"b.msh", format_gmsh_2(sample_mesh())},
                                                        {"b.mesh", format_medit(sample_mesh())}}) {
    expect_same(read_mesh(folder.file(name, "\xef\xbb\xbf" + text)).mesh, sample_mesh());
    EXPECT_NE(read_mesh(folder.file(name, "\xff\xfe" + text)).report.defects.at(0).message.find("UTF-16"),
              std::string::npos);
  }
  for (const std::string& ending : names) {
    if (ending == ".node" || ending == ".ele") continue;
    const std::filesystem::path path = folder.file("zeros" + ending, "");
    std::filesystem::resize_file(path, std::uintmax_t{1} << 36U);
    const MeshFile file = is_surface_file(path) ? check_surface(path) : read_mesh(path);
    EXPECT_NE(file.report.defects.at(0).message.find("are zeros"), std::string::npos)
        << ending << report_text(file.report);
    std::filesystem::remove(path);
  }
}

// Two tetrahedra, each in a piece of its own; and as one that is a ghost in the second piece.
TEST(Formats, PiecesAreJoinedByTheirPoints) {
  const auto piece = [](const std::string& points, const std::string& corners, const std::string& ghosts) {
    const std::string n = ghosts.size() == 1 ? "1" : "2";
    return "<Piece NumberOfPoints='5' NumberOfCells='" + n +
           "'><PointData><DataArray type='Float64' Name='u' format='ascii'>"
           "0 1 2 3 4</DataArray></PointData><CellData><DataArray type='UInt8' Name='vtkGhostType' format='ascii'>" +
           ghosts + "</DataArray></CellData><Points><DataArray type='Float64' NumberOfComponents='3' format='ascii'>" +
           points + "</DataArray></Points><Cells><DataArray type='Int32' Name='connectivity' format='ascii'>" +
           corners + "</DataArray><DataArray type='Int32' Name='offsets' format='ascii'>" + (n == "1" ? "4" : "4 8") +
           "</DataArray><DataArray type='UInt8' Name='types' format='ascii'>" + (n == "1" ? "10" : "10 10") +
           "</DataArray></Cells></Piece>";
  };
  const auto file = [](const std::string& pieces) {
    return "<VTKFile type='UnstructuredGrid' version='1.0'><UnstructuredGrid>" + pieces +
           "</UnstructuredGrid></VTKFile>";
  };
  const std::string up = "0 0 0 1 0 0 0 1 0 0 0 1 0 0 -1";
  const std::string down = "0 0 -1 0 1 0 1 0 0 -0 0 0 0 0 1";
  const Folder folder;
  for (const bool ghost : {false, true}) {
    const std::string first = piece(up, ghost ? "0 1 2 3 0 2 1 4" : "0 1 2 3", ghost ? "0 1" : "0");
    const std::string second = piece(down, ghost ? "3 1 2 0 3 2 1 4" : "3 1 2 0", ghost ? "0 1" : "0");
    (void)folder.file("one.vtu", file(first));
    std::filesystem::create_directories(folder / "parts");
    write_bytes(folder / "parts" / "two.vtu", file(second));
    const std::string index =
        "<VTKFile type='PUnstructuredGrid'><PUnstructuredGrid><Piece Source='one.vtu'/><Piece "
        "Source='parts/two.vtu'/></PUnstructuredGrid></VTKFile>";
    for (const std::filesystem::path& path :
         {folder.file("a.vtu", file(first + second)), folder.file("a.pvtu", index)}) {
      const MeshFile read = read_mesh(path);
      ASSERT_TRUE(read.report.valid()) << report_text(read.report);
      EXPECT_EQ(read.report.points, 5U);
      EXPECT_EQ(read.report.parts, 1U);
      EXPECT_EQ(read.report.cells, (std::map<std::string, std::size_t>{{"tetrahedron", 2}}));
      EXPECT_EQ(read.mesh.point_data.at(0).values, (std::vector<double>{0, 1, 2, 3, 4}));
    }
  }
  const std::string other = std::regex_replace(file(piece(down, "3 1 2 0", "0")), std::regex("'u'"), "'v'");
  write_bytes(folder / "parts" / "two.vtu", other);
  EXPECT_NE(read_mesh(folder / "a.pvtu").report.defects.at(0).message.find("two.vtu: it has other arrays"),
            std::string::npos);
}

// A prism, a pyramid and a tetrahedron in the form of a hexahedron, in each of its 24 orders.
TEST(Formats, CollapsedHexahedraGetTheirOwnTypes) {
  using Corners = std::array<std::uint32_t, 8>;
  const std::vector<std::pair<CellType, Corners>> forms = {{CellType::prism, {0, 1, 1, 2, 4, 5, 5, 6}},
                                                           {CellType::pyramid, {0, 1, 2, 3, 4, 4, 4, 4}},
                                                           {CellType::tetrahedron, {0, 1, 2, 2, 4, 4, 4, 4}}};
  for (const auto& [type, corners] : forms) {
    std::set<Corners> orders = {corners};
    for (bool grows = true; grows;) {
      std::set<Corners> more = orders;
      for (const Corners& c : orders) {
        more.insert({c[1], c[2], c[3], c[0], c[5], c[6], c[7], c[4]});
        more.insert({c[4], c[5], c[1], c[0], c[7], c[6], c[2], c[3]});
      }
      grows = more.size() > orders.size();
      orders = more;
    }
    EXPECT_GE(orders.size(), 3U);
    for (const Corners& c : orders) {
      MeshData mesh;
      mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}};
      mesh.add_cell(CellType::hexahedron, c);
      const std::array<std::uint32_t, 4> side = {0, 1, 1, 2};
      mesh.add_patch_face(side, 3);
      const MeshReport report = check_and_repair(mesh);
      ASSERT_TRUE(report.valid()) << report_text(report);
      EXPECT_EQ(mesh.types, std::vector<CellType>{type});
      EXPECT_EQ(report.repairs.at(0).kind, "collapsed");
    }
  }
  MeshData mesh = generate_box({.cells = {2, 1, 1}, .size = Vec3{1.0, 1.0, 1.0}});
  mesh.connectivity[8] = mesh.connectivity[14];  // a diagonal: no cell
  const Folder folder;
  write_mesh(mesh, folder / "a.vtu");
  EXPECT_EQ(check_mesh(folder / "a.vtu").report.defects.at(0).kind, "repeated_corner");
  const MeshFile skipped = check_mesh(folder / "a.vtu", {}, {}, true);
  EXPECT_TRUE(skipped.report.valid()) << report_text(skipped.report);
  EXPECT_EQ(skipped.report.cells.at("hexahedron"), 1U);
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
