// The memory that a run takes whose motion is read from many large files.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "support/meshes.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::frames_memory_test {

namespace fs = std::filesystem;

// A box of hexahedra as raw appended .vtu: VTK's own writer would take most of this test's time.
std::string raw_vtu(const MeshData& mesh) {
  std::vector<std::string> data(4);
  const auto put = [&](std::size_t array, auto value) {
    data[array].append(reinterpret_cast<char*>(&value), sizeof value);
  };
  for (const Vec3& x : mesh.points) {
    for (const double c : {x.x, x.y, x.z}) put(0, c);
  }
  for (const std::uint32_t p : mesh.connectivity) put(1, std::int64_t{p});
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) put(2, static_cast<std::int64_t>(mesh.offsets[c + 1]));
  data[3].assign(mesh.cell_count(), '\x0c');
  std::string appended;
  std::vector<std::size_t> offsets;
  for (const std::string& array : data) {
    offsets.push_back(appended.size());
    appended += test::Bytes().number(static_cast<std::uint64_t>(array.size())).out + array;
  }
  const auto tag = [&](std::size_t array, const char* type, const char* name, int components) {
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type,
        name, components, offsets[array]);
  };
  return fmt::format(
             "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
             "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
             mesh.points.size(), mesh.cell_count()) +
         tag(0, "Float64", "Points", 3) + "</Points>\n<Cells>\n" + tag(1, "Int64", "connectivity", 1) +
         tag(2, "Int64", "offsets", 1) + tag(3, "UInt8", "types", 1) +
         "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">_" + appended +
         "</AppendedData>\n</VTKFile>\n";
}

// Runs the command; returns its peak of resident memory in bytes, 0 where it fails.
std::uint64_t peak_of(const char* binary, const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(binary, argv.data());
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  if (::wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) return 0;
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// In the full tier 1,000 frames of 103,776 points: 2.5 GB. In the quick one 300 frames of 24,389: 176 MB.
TEST(FramesMemory, ARunHoldsFewOfItsFrames) {
  const char* binary = std::getenv("DARTCAST_BINARY");
  ASSERT_TRUE(binary != nullptr) << "run this through ctest";
  if (test::sanitized()) GTEST_SKIP() << "left out under sanitizers, which take memory of their own";
  const bool full = test::full_tier();
  const std::size_t frames = full ? 1000 : 300;
  const MeshData rest = full ? test::unit_box({45, 46, 47}) : test::unit_box({28, 28, 28});
  const test::Folder folder;
  constexpr std::size_t different = 4;
  for (std::size_t k = 0; k < different; ++k) {
    MeshData frame = rest;
    for (Vec3& x : frame.points) x.x += 0.2 * std::sin(1.5 * double(k)) * x.y / 10.0;
    write_bytes(folder / fmt::format("f{}.vtu", k), raw_vtu(frame));
  }
  std::string files, times;
  for (std::size_t k = 0; k < frames; ++k) {
    files += fmt::format("'f{}.vtu', ", k % different);
    times += fmt::format("{}, ", 0.01 * double(k));
  }
  const fs::path scene = folder / "scene.toml";
  write_bytes(scene,
              fmt::format("[environment]\nmesh = 'f0.vtu'\n[[deformation]]\nkind = 'frames'\nfiles = [{}]\ntimes = "
                          "[{}]\n[[particles]]\ncount = 100\nvelocity = [1.0, 2.0, 3.0]\n[motion]\ndt = "
                          "0.01\nsteps = {}\n[output]\nevery = 0\n",
                          files, times, frames - 1));
  const std::uint64_t peak =
      peak_of(binary, {"dartcast", "run", scene.string(), "-q", "-o", (folder / "out").string()});
  RecordProperty("peak_MB", static_cast<int>(peak / 1000000));
  EXPECT_GT(peak, 0U);
  EXPECT_LT(peak, (full ? 300U : 130U) * 1000000U);
}

}  // namespace dartcast::frames_memory_test
