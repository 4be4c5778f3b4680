// Files of TetGen, and Medit's binary files; cells of second order by their corners.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "output/mesh_report_text.hpp"
#include "support/expectations.hpp"
#include "support/mutants.hpp"
#include "support/same_mesh.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::test::tetrahedra_files_test {

MeshData box() {
  BoxOptions options;
  options.cells = {2, 2, 1};
  options.size = {1.0, 1.0, 1.0};
  options.type = CellType::tetrahedron;
  options.jitter = 0.3;
  MeshData mesh = generate_box(options);
  mesh.patch_names.clear();
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) mesh.regions.push_back(1 + static_cast<std::int32_t>(c % 2));
  mesh.region_names.clear();
  return mesh;
}

struct TetgenFiles {
  std::string node, ele, face;
};

TetgenFiles tetgen_files(const MeshData& mesh, int first) {
  const bool plane = mesh.dimension() == 2;
  TetgenFiles files;
  files.node = fmt::format("# points\n{} {} 1 1\n", mesh.points.size(), plane ? 2 : 3);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const Vec3& p = mesh.points[i];
    files.node +=
        fmt::format("{} {:.17g} {:.17g}{} 0.5 -1\n", i + first, p.x, p.y, plane ? "" : fmt::format(" {:.17g}", p.z));
  }
  files.ele = fmt::format("{} {} 1\n", mesh.cell_count(), plane ? 3 : 4);
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    files.ele += std::to_string(c + first);
    for (const std::uint32_t p : mesh.cell(c)) files.ele += fmt::format(" {}", p + first);
    files.ele += fmt::format(" {} # a comment\n", mesh.regions[c]);
  }
  files.face = fmt::format("{} 1\n", mesh.patch_tags.size());
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    files.face += std::to_string(f + first);
    for (const std::uint32_t p : mesh.patch_face(f)) files.face += fmt::format(" {}", p + first);
    files.face += fmt::format(" {} 7 -1\n", mesh.patch_tags[f]);
  }
  return files;
}

void write(const Folder& folder, const TetgenFiles& files) {
  (void)folder.file("a.node", files.node);
  (void)folder.file("a.ele", files.ele);
  if (!files.face.empty()) (void)folder.file("a.face", files.face);
}

TEST(TetGen, FilesAreReadByEitherName) {
  const MeshData mesh = box();
  ASSERT_FALSE(mesh.patch_tags.empty());
  for (const int first : {0, 1}) {
    const Folder folder;
    write(folder, tetgen_files(mesh, first));
    for (const char* name : {"a.node", "a.ele"}) {
      const MeshFile file = read_mesh(folder / name);
      EXPECT_EQ(file.report.verdict(), Verdict::accept) << report_text(file.report);
      EXPECT_EQ(file.report.format, "TetGen");
      expect_same(file.mesh, mesh);
    }
  }
}

TEST(TetGen, FilesOfTriangle) {
  RectangleOptions options;
  options.cells = {3, 2};
  options.size = {1.0, 1.0};
  options.type = CellType::triangle;
  MeshData mesh = generate_rectangle(options);
  mesh.regions.assign(mesh.cell_count(), 4);
  mesh.patch_tags.clear();
  mesh.patch_faces.clear();
  mesh.patch_offsets = {0};
  const Folder folder;
  TetgenFiles files = tetgen_files(mesh, 1);
  files.face.clear();
  write(folder, files);
  const MeshFile file = read_mesh(folder / "a.ele");
  ASSERT_TRUE(file.report.valid()) << report_text(file.report);
  expect_same(file.mesh, mesh);
}

TEST(TetGen, FilesThatAreNotRight) {
  const MeshData mesh = box();
  const auto refused = [&](auto&& change, std::initializer_list<const char*> words) {
    const Folder folder;
    TetgenFiles files = tetgen_files(mesh, 0);
    change(files);
    write(folder, files);
    const MeshFile file = read_mesh(folder / "a.node");
    ASSERT_FALSE(file.report.valid());
    expect_parts(file.report.defects[0].message, words);
  };
  refused([](TetgenFiles& f) { f.node = "2 4 0 0\n0 0 0 0 0\n1 1 1 1 1\n"; }, {".node, line 1", "dimension 4"});
  refused([](TetgenFiles& f) { f.node = "2 3 0 0\n0 0 0 0\n2 0 0 0\n"; }, {".node, line 3", "counted from 0 or 1"});
  refused([](TetgenFiles& f) { f.node = "2000000000 3 0 0\n0 0 0 0\n"; }, {".node", "announced"});
  refused([](TetgenFiles& f) { f.node.resize(f.node.size() / 2); }, {".node"});
  refused([](TetgenFiles& f) { f.ele = "1 3 0\n0 0 1 2\n"; }, {".ele", "cells of 3 points"});
  refused([](TetgenFiles& f) { f.ele = "1 4 0\n0 0 1 2 x\n"; }, {".ele, line 2", "whole number"});
  refused([](TetgenFiles& f) { f.ele = "1 4 0\n0 0 1 2 5000\n"; }, {"point"});
  refused([](TetgenFiles& f) { f.ele = "1 10 0\n0 0 1 2 3 4 5 6 7 8 9\n"; }, {"second"});
  refused([](TetgenFiles& f) { f.ele = "0 4 0\n"; }, {".ele", "no cells"});  // round 21921 of the mutants
  refused([](TetgenFiles& f) { f.face = "3 1\n0 0 1"; }, {".face"});
  const Folder folder;
  (void)folder.file("a.node", tetgen_files(mesh, 0).node);
  expect_parts(read_mesh(folder / "a.node").report.defects.at(0).message, {"a.ele", "no such file"});
}

// Medit's binary files.

std::string meshb_of(const MeshData& mesh, int version, bool swapped) {
  Bytes out(swapped);
  out.number<std::int32_t>(1).number<std::int32_t>(version);
  const auto integer = [&](std::int64_t i) {
    version == 4 ? out.number<std::int64_t>(i) : out.number(static_cast<std::int32_t>(i));
  };
  const auto real = [&](double x) { version == 1 ? out.number(static_cast<float>(x)) : out.number(x); };
  const auto head = [&](int code, std::size_t bytes) {
    out.number<std::int32_t>(code);
    const std::size_t next = out.out.size() + (version >= 3 ? 8 : 4) + bytes;
    version >= 3 ? out.number(static_cast<std::int64_t>(next)) : out.number(static_cast<std::int32_t>(next));
  };
  const std::size_t word = version == 4 ? 8 : 4;
  head(3, 4);
  const int dimension = static_cast<int>(mesh.dimension());
  out.number<std::int32_t>(dimension);
  head(4, word + mesh.points.size() * (static_cast<std::size_t>(dimension) * (version == 1 ? 4 : 8) + word));
  integer(static_cast<std::int64_t>(mesh.points.size()));
  for (const Vec3& p : mesh.points) {
    real(p.x), real(p.y);
    if (dimension == 3) real(p.z);
    integer(9);
  }
  head(13, word * 2);  // corners: not used here
  integer(1), integer(1);
  const auto elements = [&](int code, std::size_t corners, std::size_t count, auto&& each) {
    head(code, word * (1 + count * (corners + 1)));
    integer(static_cast<std::int64_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
      const auto [list, tag] = each(i);
      for (const std::uint32_t p : list) integer(p + std::int64_t{1});
      integer(tag);
    }
  };
  const std::map<CellType, std::pair<int, std::size_t>> codes = {
      {CellType::tetrahedron, {8, 4}}, {CellType::hexahedron, {10, 8}}, {CellType::prism, {9, 6}},
      {CellType::pyramid, {49, 5}},    {CellType::triangle, {6, 3}},    {CellType::quadrilateral, {7, 4}}};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto [code, corners] = codes.at(mesh.types[c]);
    elements(code, corners, 1, [&](std::size_t) { return std::pair(mesh.cell(c), mesh.regions[c]); });
  }
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t n = mesh.patch_face(f).size();
    elements(n == 2 ? 5 : (n == 3 ? 6 : 7), n, 1,
             [&](std::size_t) { return std::pair(mesh.patch_face(f), mesh.patch_tags[f]); });
  }
  head(54, 0);
  return out.out;
}

MeshData as_floats(MeshData mesh) {
  for (Vec3& p : mesh.points) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
  return mesh;
}

TEST(Meshb, EveryVersionAndByteOrder) {
  const Folder folder;
  for (const MeshData& mesh : {sample_mesh(), planar_mesh()}) {
    for (const int version : {1, 2, 3, 4}) {
      for (const bool swapped : {false, true}) {
        const MeshFile file = read_mesh(folder.file("a.meshb", meshb_of(mesh, version, swapped)));
        EXPECT_EQ(file.report.verdict(), Verdict::accept) << report_text(file.report);
        EXPECT_EQ(file.report.format, "Medit binary");
        expect_same(file.mesh, version == 1 ? as_floats(mesh) : mesh);
      }
    }
  }
}

TEST(Meshb, FilesThatAreNotRight) {
  const Folder folder;
  const auto message = [&](const std::string& content) {
    const MeshFile file = read_mesh(folder.file("a.meshb", content));
    return file.report.valid() ? std::string() : file.report.defects[0].message;
  };
  expect_parts(message("MeshVersionFormatted 2\n"), {"not of Medit"});
  std::string version = meshb_of(sample_mesh(), 2, false);
  version[4] = 5;
  expect_parts(message(version), {"byte 8", "version 5"});
  std::string back = meshb_of(sample_mesh(), 2, false);
  back[12] = 3;  // where the section behind Dimension begins
  expect_parts(message(back), {"byte 20", "is not behind this one"});
  std::string many = meshb_of(sample_mesh(), 4, false);
  many[39] = 127;  // of the number of vertices
  expect_parts(message(many), {"byte 44", "vertices are announced"});
}

// Damage.

TEST(TetrahedraFiles, MutantsGetAVerdict) {
  const Folder folder;
  const MeshData mesh = box();
  const TetgenFiles whole = tetgen_files(mesh, 1);
  const std::vector<std::string> meshb = {meshb_of(sample_mesh(), 1, false), meshb_of(sample_mesh(), 2, true),
                                          meshb_of(planar_mesh(), 3, false), meshb_of(sample_mesh(), 4, false)};
  Mutants mutants(17);
  int accepted = 0;
  const int rounds = scaled(40000, 400000);  // 20,000 for each reader
  for (int round = 0; round < rounds; ++round) {
    std::filesystem::path path;
    if (round % 2 == 0) {
      path = folder.file("b.meshb", mutants.damaged(meshb[mutants.below(meshb.size())]));
    } else {
      TetgenFiles files = whole;
      std::string& one = *std::array{&files.node, &files.ele, &files.face}[mutants.below(3)];
      one = mutants.damaged(one);
      write(folder, files);
      path = folder / (mutants.below(2) == 0 ? "a.node" : "a.ele");
    }
    MeshFile file = read_mesh(path);
    if (!file.report.valid()) {
      ASSERT_FALSE(file.report.defects[0].message.empty()) << round;
      continue;
    }
    ++accepted;
    const MeshReport again = check_and_repair(file.mesh);
    ASSERT_TRUE(again.valid() && again.repairs.empty()) << round << "\n" << report_text(again);
  }
  EXPECT_GT(accepted, rounds / 50);
}

// Cells of second order.

void expect_linearised(const MeshFile& refused, const MeshFile& taken, std::size_t count, CellType type) {
  ASSERT_FALSE(refused.report.valid());
  EXPECT_EQ(refused.report.defects[0].kind, "second_order");
  EXPECT_NE(refused.report.defects[0].message.find("--linearise"), std::string::npos);
  ASSERT_TRUE(taken.report.valid()) << report_text(taken.report);
  ASSERT_EQ(taken.report.verdict(), Verdict::warn);
  EXPECT_EQ(taken.report.warnings[0].kind, "linearised");
  EXPECT_EQ(taken.report.warnings[0].count, count);
  ASSERT_EQ(taken.mesh.cell_count(), 1U);
  EXPECT_EQ(taken.mesh.types[0], type);
  EXPECT_EQ(taken.mesh.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
}

TEST(SecondOrder, CornersOfATetrahedronInEveryFormat) {
  const Folder folder;
  ReadOptions linearise;
  linearise.linearise = true;
  std::string points, msh_points, medit_points;
  const std::vector<Vec3> all = {{0, 0, 0},   {1, 0, 0},  {0, 1, 0},  {0, 0, 1},   {.5, .1, 0},
                                 {.5, .5, 0}, {0, .5, 0}, {0, 0, .5}, {.5, 0, .5}, {0, .5, .5}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string p = fmt::format("{} {} {}", all[i].x, all[i].y, all[i].z);
    points += p + "\n";
    msh_points += fmt::format("{} {}\n", i + 1, p);
    medit_points += p + " 0\n";
  }
  const std::string numbers = "1 2 3 4 5 6 7 8 9 10";
  const auto expect = [&](const std::string& name, const std::string& content, std::size_t count) {
    SCOPED_TRACE(name);
    const std::filesystem::path path = folder.file(name, content);
    expect_linearised(read_mesh(path), read_mesh(path, linearise), count, CellType::tetrahedron);
  };
  expect("a.msh",
         "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n" + msh_points + "$EndNodes\n$Elements\n2\n1 11 2 1 1 " +
             numbers + "\n2 9 2 2 1 1 2 3 5 6 7\n$EndElements\n",
         2);
  expect("a.mesh",
         "MeshVersionFormatted 2\nDimension 3\nVertices\n10\n" + medit_points + "TetrahedraP2\n1\n" + numbers +
             " 1\nEnd\n",
         1);
  (void)folder.file("a.node", "10 3 0 0\n" + msh_points);
  expect("a.ele", "1 10 0\n1 " + numbers + "\n", 1);
  const std::string head =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n" + points;
  for (const char* type : {"24", "71"})
    expect("a.vtk", head + "CELLS 1 11\n10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n" + type + "\n", 1);
}

}  // namespace dartcast::test::tetrahedra_files_test
