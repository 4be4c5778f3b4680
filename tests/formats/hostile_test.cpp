// Damaged files: every one must get a verdict, soon, with little memory, and what is accepted must be sound.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <ctime>
#include <random>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "output/mesh_report_text.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::test::hostile_test {

struct Sample {
  std::string name;
  std::string content;
};

/// A .vtu with its arrays inline, by hand, with a polyhedron.
std::string ascii_vtu() {
  return R"(<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="5" NumberOfCells="2"><Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 1 2 3 4</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4 8</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10 42</DataArray>
<DataArray type="Int64" Name="faces" format="ascii">4 3 1 3 2 3 1 2 4 3 2 3 4 3 3 1 4</DataArray>
<DataArray type="Int64" Name="faceoffsets" format="ascii">-1 17</DataArray></Cells>
<CellData><DataArray type="Int32" Name="region" format="ascii">1 2</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>)";
}

std::string ascii_vtk() {
  return "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 "
         "1 1\n"
         "CELLS 2 23\n4 0 1 2 3\n17 4 3 1 3 2 3 1 2 4 3 2 3 4 3 3 1 4\nCELL_TYPES 2\n10\n42\nCELL_DATA 2\n"
         "SCALARS region int 1\nLOOKUP_TABLE default\n1 2\nPOINT_DATA 5\nFIELD f 1\nheat 1 5 double\n1 2 3 4 5\n";
}

std::string written(const MeshData& mesh, const std::string& name) {
  const Folder folder;
  write_mesh(mesh, folder / name);
  return slurp(folder / name);
}

std::vector<Sample> samples() {
  const MeshData mesh = sample_mesh();
  return {{"a.msh", gmsh_1(mesh)},
          {"b.msh", written(mesh, "b.msh")},
          {"c.msh", gmsh_22_binary(mesh, false)},
          {"d.msh", gmsh_4_binary(mesh, false, true)},
          {"e.msh", written(mesh, "e.msh4")},
          {"f.msh", gmsh_4_binary(mesh, true, false)},
          {"g.mesh", written(mesh, "g.mesh")},
          {"h.vtk", ascii_vtk()},
          {"i.vtk", written(polyhedra(), "i.vtk")},
          {"j.vtu", ascii_vtu()},
          {"k.vtu", written(polyhedra(), "k.vtu")},
          {"l.vtu", written(mesh, "l.vtu")},
          {"m.vtu", binary_vtu("appended", false)},
          {"n.vtu", binary_vtu("binary", true)},
          {"o.msh", written(planar_mesh(), "o.msh")},
          {"p.msh", gmsh_4_binary(planar_mesh(), true, false)},
          {"q.mesh", written(planar_mesh(), "q.mesh")},
          {"r.vtk", written(planar_polygons(), "r.vtk")},
          {"s.vtu", written(planar_polygons(), "s.vtu")},
          {"t.msh", gmsh_4_binary(mesh, true, false, true)}};
}

using test::full_tier;

/// Reads the content; what is accepted must hold up when it is inspected again.
bool expect_verdict(const Folder& folder, const std::string& name, const std::string& content, const std::string& how) {
  MeshFile file = read_mesh(folder.file(name, content));
  EXPECT_FALSE(report_json(file.report).empty());
  if (!file.report.valid()) {
    EXPECT_FALSE(file.report.defects[0].message.empty()) << name << ", " << how;
    return false;
  }
  const MeshReport again = check_and_repair(file.mesh);
  EXPECT_TRUE(again.valid() && again.repairs.empty()) << name << ", " << how << "\n" << report_text(again);
  return true;
}

class Hostile : public testing::Test {
 protected:
  void TearDown() override {
    if (test::sanitized()) return;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    EXPECT_LT(processor_seconds() - start_, full_tier() ? 600.0 : 60.0);
    EXPECT_LT(usage.ru_maxrss, 600 * 1024) << "kilobytes";
  }

  static double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

  Folder folder_;
  double start_ = processor_seconds();
};

TEST_F(Hostile, SamplesAreAcceptedWhole) {
  for (const Sample& s : samples()) EXPECT_TRUE(expect_verdict(folder_, s.name, s.content, "whole"));
}

TEST_F(Hostile, TruncatedAnywhere) {
  for (const Sample& s : samples()) {
    // Without its last byte, a line's end, a file may still be whole.
    const std::size_t whole = s.content.find_last_not_of(" \r\n");
    for (std::size_t n = 0; n < whole; n += stride(1, 7)) {
      const bool accepted = expect_verdict(folder_, s.name, s.content.substr(0, n), "cut at " + std::to_string(n));
      // Only what follows the last array of .vtk, or "End" of .mesh, may be missed.
      const bool open_end = s.name.ends_with(".mesh") || s.name.ends_with(".vtk");
      EXPECT_FALSE(accepted && !open_end) << s.name << " cut at " << n;
    }
  }
}

TEST_F(Hostile, BytesChanged) {
  std::mt19937 random(7);
  for (int round = 0; round < (full_tier() ? 30 : 1); ++round) {
    for (const Sample& s : samples()) {
      for (std::size_t at = 0; at < s.content.size(); at += stride(1, 7)) {
        std::string content = s.content;
        content[at] = static_cast<char>(random() % 256);
        expect_verdict(folder_, s.name, content, "byte " + std::to_string(at));
      }
    }
  }
}

TEST_F(Hostile, NumbersReplaced) {
  const std::vector<std::string> numbers = {"-1",
                                            "0",
                                            "3",
                                            "1e400",
                                            "nan",
                                            "inf",
                                            "4294967295",
                                            "-2147483648",
                                            "1000000000",
                                            "9223372036854775807",
                                            "99999999999999999999",
                                            "x"};
  for (const Sample& s : samples()) {
    std::vector<std::size_t> starts;
    for (std::size_t i = 1; i < s.content.size(); ++i) {
      const auto digit = [](char c) { return (c >= '0' && c <= '9') || c == '-' || c == '.'; };
      if (digit(s.content[i]) && !digit(s.content[i - 1])) starts.push_back(i);
    }
    for (std::size_t k = 0; k < starts.size(); k += stride(1, 7)) {
      const std::size_t at = starts[k];
      const std::size_t end = std::min(s.content.find_first_not_of("0123456789-.e+", at), s.content.size());
      for (const std::string& number : numbers) {
        expect_verdict(folder_, s.name, s.content.substr(0, at) + number + s.content.substr(end),
                       number + " at " + std::to_string(at));
      }
    }
  }
}

TEST_F(Hostile, WordsOfBinaryFilesReplaced) {
  const std::vector<std::uint64_t> words = {
      0, 1, 0xffffffffU, 0x7fffffffU, 0x80000000U, 0x7fffffffffffffffU, 0xffffffffffffffffU};
  for (const Sample& s : samples()) {
    if (s.name[0] != 'c' && s.name[0] != 'd' && s.name[0] != 'f' && s.name[0] != 'i' && s.name[0] != 'p' &&
        s.name[0] != 'r' && s.name[0] != 't')
      continue;
    for (std::size_t at = 20; at + 8 <= s.content.size(); at += stride(3, 23)) {
      for (const std::uint64_t word : words) {
        std::string content = s.content;
        std::memcpy(content.data() + at, &word, word > 0xffffffffU ? 8 : 4);
        expect_verdict(folder_, s.name, content, "word at " + std::to_string(at));
      }
    }
  }
}

TEST_F(Hostile, MemoryBombs) {
  const std::string big = "1000000000000000000";
  const auto refused = [&](const std::string& name, const std::string& content) {
    EXPECT_FALSE(expect_verdict(folder_, name, content, "bomb")) << content;
  };
  refused("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + big + "\n");
  const auto file = read_mesh(folder_ / "a.msh");
  EXPECT_NE(file.report.defects[0].message.find("line 5: " + big + " nodes are announced"), std::string::npos)
      << file.report.defects[0].message;
  refused("a.msh", "$NOD\n" + big + "\n");
  refused("a.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 " + big + " 1 1\n3 1 0 " + big + "\n");
  refused("a.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 " + big + "\n");
  refused("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n" + big + "\n");
  refused("a.mesh", "MeshVersionFormatted 2\nDimension 3\nTetrahedra\n" + big + "\n");
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  refused("a.vtk", head + "POINTS " + big + " double\n");
  refused("a.vtk", head + "POINTS 1 double\n0 0 0\nCELLS " + big + " " + big + "\n");
  refused("a.vtk", head + "FIELD f 1\na 1000000000 1000000000 double\n");
  refused("a.vtk", head + "FIELD f " + big + "\n");
  refused("a.vtk", head + "POINTS 1 double\n0 0 0\nCELLS 1 2\n1 0\nCELL_TYPES 1\n1\nPOINT_DATA " + big + "\n");
  std::string vtu = ascii_vtu();
  vtu.replace(vtu.find("NumberOfPoints=\"5\""), 18, "NumberOfPoints=\"" + big + "\"");
  refused("a.vtu", vtu);
  // 2^31 blocks of 2^31 bytes announced in base64, 12 bytes of header.
  std::string packed = ascii_vtu();
  packed.replace(packed.find("byte_order"), 10, "compressor=\"vtkZLibDataCompressor\" byte_order");
  packed.replace(packed.find("\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1"), 49,
                 "\"3\" format=\"binary\">AAAAgAAAAIAAAACA");
  refused("a.vtu", packed);
}

}  // namespace dartcast::test::hostile_test
