// VTK as an oracle: what we read of a file, VTK reads of it, too, number by number. We may refuse more.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"
#include "formats/vtk/vtk_grid.hpp"
#include "formats/vtp_write.hpp"
#include "formats/vtu_write.hpp"
#include "support/mutants.hpp"
#include "support/sample_mesh.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"
#include "support/vtk_files.hpp"
#include "vtk/canonical.hpp"

namespace dartcast::test::vtk_oracle_test {

namespace fs = std::filesystem;

/// The process that reads by VTK. It is started again where it crashes.
class Vtk {
 public:
  Vtk() { std::signal(SIGPIPE, SIG_IGN); }
  ~Vtk() { stop(); }
  Vtk(const Vtk&) = delete;
  Vtk& operator=(const Vtk&) = delete;

  std::string read(const fs::path& path) {
    if (in_ == nullptr) start();
    std::fprintf(in_, "%s\n", path.c_str());
    std::fflush(in_);
    std::string text;
    for (int c = 0; !text.ends_with("\nend\n");) {
      if ((c = std::fgetc(out_)) == EOF) {
        stop();
        return "refused";  // it has crashed
      }
      text += static_cast<char>(c);
    }
    return text.substr(0, text.size() - 5);
  }

 private:
  void start() {
    std::array<int, 2> to{};
    std::array<int, 2> from{};
    if (::pipe(to.data()) != 0 || ::pipe(from.data()) != 0) throw Error("no pipe");
    child_ = ::fork();
    if (child_ == 0) {
      ::dup2(to[0], STDIN_FILENO);
      ::dup2(from[1], STDOUT_FILENO);
      for (const int end : {to[0], to[1], from[0], from[1]}) ::close(end);
      ::execl(DARTCAST_VTK_READER, DARTCAST_VTK_READER, nullptr);
      ::_exit(1);
    }
    ::close(to[0]);
    ::close(from[1]);
    in_ = ::fdopen(to[1], "w");
    out_ = ::fdopen(from[0], "r");
  }
  void stop() {
    if (in_ == nullptr) return;
    std::fclose(in_);
    std::fclose(out_);
    in_ = nullptr;
    ::waitpid(child_, nullptr, 0);
  }

  std::FILE* in_ = nullptr;
  std::FILE* out_ = nullptr;
  pid_t child_ = 0;
};

void add_arrays(const char* section, const std::vector<VtkArray>& arrays, bool texts_alone, CanonicalText& out) {
  out.line(section);
  for (const VtkArray& a : arrays) {
    if (texts_alone && !a.is_text) continue;
    out.line(a.name);
    if (!a.is_text) out.size(a.components);
    for (const double x : a.values) out.number(x);
    for (const std::string& text : a.texts) out.text(text);
  }
}

std::string canonical(const VtkGrid& grid) {
  CanonicalText out;
  const std::size_t points = grid.points.size();
  out.line("points");
  for (const Vec3& p : grid.points) {
    for (const double x : {p.x, p.y, p.z}) out.number(x);
  }
  out.line("cells");
  for (std::size_t c = 0; c < grid.types.size(); ++c) {
    out.line(std::to_string(grid.types[c]));
    std::size_t counts = 0;  // of the next entries, those that are no points
    for (std::size_t at = grid.offsets[c]; at < grid.offsets[c + 1]; ++at) {
      const std::uint32_t entry = grid.connectivity[at];
      const bool first = at == grid.offsets[c];
      if (grid.types[c] == vtk_polyhedron && (first || counts == 0)) {
        out.size(entry);
        counts = first ? 0 : entry;
      } else {
        out.point(entry, points);
        --counts;
      }
    }
  }
  add_arrays("point_data", grid.point_data, false, out);
  add_arrays("cell_data", grid.cell_data, false, out);
  add_arrays("field", grid.field, true, out);
  return out.text();
}

/// The text of the file as we read it; "refused: why" where we refuse it. A number that names no point is refused where
/// the mesh is checked.
std::string ours(const std::string& name, const std::string& content) {
  try {
    const std::string text =
        canonical(name.ends_with(".vtk")
                      ? read_legacy_grid(content, 0)
                      : read_vtk_xml_grid(content, name.ends_with(".vtp") ? "PolyData" : "UnstructuredGrid", 0));
    return text.find(" x") == std::string::npos ? text : "refused: a number that names no point";
  } catch (const InvalidMesh& e) {
    return std::string("refused: ") + e.what();
  }
}

/// The two texts from a little before the first byte that differs.
std::string difference(const std::string& vtk, const std::string& here) {
  const auto at = std::mismatch(vtk.begin(), vtk.end(), here.begin(), here.end()).first - vtk.begin();
  const std::size_t from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(at - 40, 0));
  return "VTK:  " + vtk.substr(from, 200) + "\nhere: " + here.substr(std::min(from, here.size()), 200);
}

struct Sample {
  std::string name;
  std::string content;
};

std::vector<Sample> made_here() {
  std::vector<Sample> all;
  for (const XmlData how : xml_data_kinds()) {
    for (const int pieces : {1, 2}) all.push_back({"cubes.vtu", cubes_vtu(how, pieces)});
    all.push_back({"bare.vtu", cubes_vtu(how, 1, false)});
    all.push_back({"points.vtp", points_vtp(how)});
  }
  for (const bool other : {false, true}) {
    all.push_back({"cubes.vtk", joined(cubes_vtk_sections(other))});
    for (const char* format : {"binary", "appended"}) all.push_back({"order.vtu", binary_vtu(format, other)});
  }
  const Folder folder;
  MeshData mesh = sample_mesh();
  mesh.free = {1, 0, 1, 0};
  mesh.cell_data = {{"heat", 1, {0.1, -0.0, 1e-310, 1e300}}, {"a <b> & \"c\" 100%", 2, {1, 2, 3}}};
  mesh.point_data = {{"short", 3, {1.0 / 3.0, 2.0}}};
  for (const MeshData& m : {mesh, sample_mesh(), polyhedra(), planar_mesh(), planar_polygons()}) {
    for (const char* name : {"written.vtu", "written.vtk"}) {
      write_mesh(m, folder / name);
      all.push_back({name, slurp(folder / name)});
    }
    for (const Compression compression : {Compression::fast, Compression::small}) {
      write_xml(folder / "a.vtu", vtu_data_set(std::make_shared<const MeshData>(m)), compression, write_pieces);
      all.push_back({"packed.vtu", slurp(folder / "a.vtu")});
    }
  }
  for (const Compression compression : {Compression::none, Compression::fast, Compression::small}) {
    for (const std::vector<Vec3>& points :
         {std::vector<Vec3>{}, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0.5}, {1.0 / 3.0, -0.0, 1e-310}, {2, 2, 2}}}) {
      VtpFile file(points);
      file.add_vertices();
      file.add_line();
      if (!points.empty())
        file.add_polygons(std::vector<std::size_t>{0, 3, 7}, std::vector<std::uint32_t>{0, 1, 2, 3, 2, 1, 0});
      std::vector<double> speed(9000 * points.size());
      std::iota(speed.begin(), speed.end(), 0.5);
      file.add("speed", std::vector<Vec3>(points.size(), Vec3{1, 2, 3}));
      file.add("id", std::vector<std::uint64_t>(points.size(), std::uint64_t{1} << 62U));
      file.add("flag", std::vector<std::uint8_t>(points.size(), 255));
      file.add_texts("names", std::vector<std::string>{"a", "b c"});
      write_xml(folder / "a.vtp", file.data(), compression, write_pieces);
      all.push_back({"written.vtp", slurp(folder / "a.vtp")});
    }
  }
  return all;
}

/// Files by VTK's own writers, in all encodings.
std::vector<Sample> made_by_vtk() {
  const Folder folder;
  const std::string command = std::string(DARTCAST_VTK_READER) + " '" + (folder / "").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::vector<Sample> all;
  for (const auto& entry : fs::directory_iterator(folder / ""))
    all.push_back({entry.path().filename().string(), slurp(entry.path())});
  std::sort(all.begin(), all.end(), [](const Sample& a, const Sample& b) { return a.name < b.name; });
  return all;
}

class VtkOracle : public testing::Test {
 protected:
  /// Returns whether we have read the file. We must read it where `must`.
  bool agrees(const Sample& s, bool must, const std::string& how) {
    const std::string found = ours(s.name, s.content);
    if (found.starts_with("refused")) {
      EXPECT_FALSE(must) << s.name << ", " << how << ": " << found;
      return false;
    }
    const std::string expected = vtk_.read(folder_.file("a" + fs::path(s.name).extension().string(), s.content));
    if (expected.find("is higher than this reader supports") != std::string::npos) return false;
    EXPECT_TRUE(found == expected) << s.name << ", " << how << "\n" << difference(expected, found);
    return true;
  }

  Folder folder_;
  Vtk vtk_;
};

TEST_F(VtkOracle, FilesOfOurs) {
  for (const Sample& s : made_here()) agrees(s, true, "whole");
}

TEST_F(VtkOracle, FilesOfVtk) {
  const std::vector<Sample> samples = made_by_vtk();
  EXPECT_EQ(samples.size(), 2U * (3 * 37 + 2 * 4));
  for (const Sample& s : samples) {
    const bool lzma = s.name.find("lzma") != std::string::npos;
    EXPECT_NE(agrees(s, !lzma, "whole"), lzma) << s.name;
    if (lzma) EXPECT_NE(ours(s.name, s.content).find("vtkLZMADataCompressor"), std::string::npos);
  }
}

TEST_F(VtkOracle, FilesOfOthers) {
  NEED_DATA("meshes made by others");
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data_folder())) {
    const std::string ending = entry.path().extension().string();
    if (!entry.is_regular_file() || (ending != ".vtu" && ending != ".vtk" && ending != ".vtp")) continue;
    // VTK 9.1 does not read these two: faces as VTK 9.4 writes them, and a header encoded apart.
    const std::string name = entry.path().filename().string();
    if (name == "new_2.3.vtu" || name == "app_b64sep_u32_le.vtu") continue;
    files += agrees({name, slurp(entry.path())}, false, entry.path().string()) ? 1 : 0;
  }
  EXPECT_GT(files, 20);
}

TEST_F(VtkOracle, Mutants) {
  std::vector<Sample> samples = made_here();
  const std::vector<Sample> others = made_by_vtk();
  samples.insert(samples.end(), others.begin(), others.end());
  std::erase_if(samples, [](const Sample& s) { return s.content.size() > 50000; });
  Mutants mutants(56);
  const int rounds = scaled(10000, 200000);
  int read = 0;
  for (int round = 0; round < rounds; ++round) {
    const Sample& s = samples[mutants.below(samples.size())];
    if (agrees({s.name, mutants.damaged(s.content)}, false, "mutant " + std::to_string(round))) ++read;
    if (HasFailure()) return;
  }
  EXPECT_GT(read, rounds / 20);
}

}  // namespace dartcast::test::vtk_oracle_test
