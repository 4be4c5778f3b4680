// Files that announce more than may be taken are refused before it is taken, and the bound holds.
#include "formats/read_memory.hpp"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <utility>

#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "formats/file_write.hpp"
#include "formats/point_file.hpp"
#include "formats/vtu_write.hpp"
#include "output/mesh_report_text.hpp"
#include "support/tier.hpp"
#include "support/vtk_files.hpp"

namespace dartcast::test::read_memory_test {

constexpr std::uint64_t mebi = std::uint64_t{1} << 20U;

/// The memory that the function adds to a process, at its peak, in bytes.
std::uint64_t peak_of(const std::function<void()>& work) {
  ::malloc_trim(0);  // what this process has to spare would not show
  rusage usage{};
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::_exit(0);
  }
  int status = 0;
  ::wait4(child, &status, 0, &usage);
  EXPECT_EQ(status, 0);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

MeshData box_of(std::uint32_t edge, CellType type) {
  BoxOptions options;
  options.cells = {edge, edge, edge};
  options.size = {1, 1, 1};
  options.type = type;
  MeshData mesh = generate_box(options);
  (void)check_and_repair(mesh);
  return mesh;
}

std::string refusal(const MeshFile& file) { return file.report.valid() ? "accepted" : file.report.defects[0].message; }

/// A .vtu of some kilobytes with a zero at each of many cells: it packs well, as an array of zeros does.
std::filesystem::path packed(const Folder& folder) {
  MeshData mesh = box_of(12, CellType::tetrahedron);
  for (int k = 0; k < 400; ++k)
    mesh.cell_data.push_back({"zero" + std::to_string(k), 1, std::vector<double>(mesh.cell_count(), 0.0)});
  const auto shared = std::make_shared<const MeshData>(std::move(mesh));
  write_xml(folder / "packed.vtu", vtu_data_set(shared), Compression::small, write_pieces);
  return folder / "packed.vtu";
}

TEST(ReadMemory, ASmallFileThatGrowsIsRefusedInWordsBeforeItGrows) {
  const Folder folder;
  const auto path = packed(folder);
  EXPECT_LT(std::filesystem::file_size(path), mebi);
  ReadOptions options;
  options.max_memory = 80 * mebi;
  const std::string message = refusal(read_mesh(path, options));
  EXPECT_NE(message.find("may take 1"), std::string::npos) << message;
  EXPECT_NE(message.find("83.9 MB are allowed"), std::string::npos) << message;
  EXPECT_NE(message.find("--max-memory"), std::string::npos) << message;
  const std::uint64_t idle = peak_of([] {});
  const std::uint64_t of_sanitizers = test::sanitized() ? 64 * mebi : 0;
  EXPECT_LT(peak_of([&] { (void)read_mesh(path, options); }), idle + 6 * mebi + of_sanitizers);
  options.max_memory = 400 * mebi;
  EXPECT_EQ(refusal(read_mesh(path, options)), "accepted");
}

TEST(ReadMemory, EveryReaderKeepsTheLimit) {
  const Folder folder;
  const MeshData mesh = box_of(6, CellType::hexahedron);
  ReadOptions tight;
  tight.max_memory = 48 * mebi + 1;
  ReadOptions wide;
  wide.max_memory = 100 * mebi;
  for (const std::string name : {"a.vtu", "a.vtk", "a.msh", "a.msh4", "a.mesh"}) {
    write_mesh(mesh, folder / name);
    EXPECT_NE(refusal(read_mesh(folder / name, tight)).find("--max-memory"), std::string::npos) << name;
    EXPECT_EQ(refusal(read_mesh(folder / name, wide)), "accepted") << name;
    EXPECT_EQ(refusal(read_mesh(folder / name)), "accepted") << name;
  }
  const auto surface = folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_NE(refusal(check_surface(surface, tight)).find("--max-memory"), std::string::npos);
  EXPECT_THROW((void)read_surface(surface, tight), InvalidMesh);
  EXPECT_EQ(refusal(check_surface(surface, wide)), "accepted");
  for (const auto& points :
       {folder.file("a.vtp", points_vtp(XmlData::ascii)), folder.file("a.csv", "x,y,z\n0,0,0\n")}) {
    EXPECT_THROW((void)read_points(points, tight), Error) << points;
    EXPECT_EQ(read_points(points, wide).points.empty(), false) << points;
  }
}

// Whatever sizes a file announces, sums do not overflow.
TEST(ReadMemory, SumsStop) {
  ReadSizes sizes;
  sizes.file = sizes.points = sizes.cells = sizes.corners = sizes.values = sizes.decoded = UINT64_MAX;
  EXPECT_EQ(memory_of_vtk(sizes), std::uint64_t{1} << 63U);
  EXPECT_EQ(memory_of_text(UINT64_MAX), std::uint64_t{1} << 63U);
  EXPECT_THROW(check_memory(memory_of_vtk(sizes), 0), InvalidMesh);
  EXPECT_NO_THROW(check_memory(1000, 1000));
  EXPECT_THROW(check_memory(1001, 1000), InvalidMesh);
}

/// The least limit under which the file is read, up to the digits that the refusal shows.
std::uint64_t min_limit(const std::filesystem::path& path) {
  ReadOptions options;
  options.max_memory = 1;
  const std::string message = refusal(read_mesh(path, options));
  double number = 0.0;
  char unit = 0;
  EXPECT_EQ(std::sscanf(message.c_str(), "reading it may take %lf %cB", &number, &unit), 2) << message;
  const auto first = static_cast<std::uint64_t>(number * (unit == 'G' ? 1e9 : 1e6));
  return std::max(first, memory_of_mesh(read_mesh(path).mesh));
}

// The process takes no more, its mesh read and its map built, than the limit under which a file is read; nor is the
// limit out of proportion.
TEST(ReadMemory, TheCountIsAnUpperBound) {
  if (test::sanitized()) GTEST_SKIP() << "a sanitizer takes memory of its own";
  const Folder folder;
  MeshData tetrahedra = box_of(24, CellType::tetrahedron);
  tetrahedra.point_data.push_back({"v", 3, std::vector<double>(3 * tetrahedra.points.size(), 0.1)});
  OctahedraOptions octahedra;
  octahedra.cells = {20, 20, 20};
  octahedra.size = {1.0, 1.0, 1.0};
  MeshData polyhedra_mesh = generate_octahedra(octahedra);
  (void)check_and_repair(polyhedra_mesh);
  const std::vector<std::pair<std::string, MeshData>> meshes = {
      {"tetrahedra", tetrahedra}, {"hexahedra", box_of(36, CellType::hexahedron)}, {"octahedra", polyhedra_mesh}};
  for (const auto& [kind, mesh] : meshes) {
    for (const std::string ending : {".vtu", ".vtk", ".msh", ".mesh"}) {
      if (ending != ".vtu" && !test::full_tier()) continue;
      if (kind == "octahedra" && ending[1] == 'm') continue;
      const auto path = folder / (kind + ending);
      write_mesh(mesh, path);
      const std::uint64_t limit = min_limit(path) - 24 * mebi;  // less what the program itself has
      const std::uint64_t taken = peak_of([&] { const CellComplex complex(read_mesh(path).mesh); });
      // The program itself, with the libraries that a file of this format calls in.
      write_mesh(box_of(1, CellType::hexahedron), folder / ("tiny" + ending));
      const std::uint64_t idle =
          peak_of([&] { const CellComplex complex(read_mesh(folder / ("tiny" + ending)).mesh); });
      EXPECT_LE(taken, idle + limit) << path << ": " << (taken - idle) / mebi << " of " << limit / mebi;
      EXPECT_LE(limit, 6 * (taken - std::min(taken, idle)) + 48 * mebi)
          << path << ": " << (taken - idle) / mebi << " of " << limit / mebi;
    }
  }
}

}  // namespace dartcast::test::read_memory_test
