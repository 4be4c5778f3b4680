// Writing and reading back, the same for meshes of space and of the plane.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "formats/gmsh.hpp"
#include "output/mesh_report_text.hpp"
#include "support/same_mesh.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::test {

inline void expect_accepted(const MeshFile& file, unsigned dimension = 3) {
  EXPECT_EQ(file.report.verdict(), Verdict::accept) << report_text(file.report);
  EXPECT_EQ(file.report.dimension, static_cast<int>(dimension));
}

/// Gmsh 4.1 as a program of 32 bits writes it: in ASCII only the head is another.
inline std::string with_short_sizes(std::string gmsh_41) {
  return gmsh_41.replace(gmsh_41.find("4.1 0 8"), 7, "4.1 0 4");
}

/// The mesh in each of Gmsh's formats, with the name that a report gives it.
inline std::vector<std::pair<std::string, std::string>> gmsh_files(const MeshData& mesh) {
  return {{"Gmsh 1 ASCII", gmsh_1(mesh)},
          {"Gmsh 2.2 ASCII", format_gmsh_2(mesh)},
          {"Gmsh 2.2 binary", gmsh_22_binary(mesh, false)},
          {"Gmsh 2.2 binary", gmsh_22_binary(mesh, true)},
          {"Gmsh 4 binary", gmsh_4_binary(mesh, false, false)},
          {"Gmsh 4 binary", gmsh_4_binary(mesh, false, true)},
          {"Gmsh 4.1 ASCII", format_gmsh_4(mesh)},
          {"Gmsh 4.1 binary", gmsh_4_binary(mesh, true, false)},
          {"Gmsh 4.1 binary", gmsh_4_binary(mesh, true, true)},
          {"Gmsh 4.1 ASCII", with_short_sizes(format_gmsh_4(mesh))},
          {"Gmsh 4.1 binary", gmsh_4_binary(mesh, true, false, true)},
          {"Gmsh 4.1 binary", gmsh_4_binary(mesh, true, true, true)}};
}

/// Points, cells, regions and patches, in every format that is read; names where it has a place for them.
inline void expect_round_trips(const MeshData& mesh) {
  const Folder folder;
  const std::vector<std::string> read = mesh_endings();
  for (const std::string& ending : writable_mesh_endings()) {
    if (std::find(read.begin(), read.end(), ending) == read.end()) continue;
    SCOPED_TRACE(ending);
    write_mesh(mesh, folder / ("a" + ending));
    const MeshFile file = read_mesh(folder / ("a" + ending));
    expect_accepted(file, mesh.dimension());
    expect_same(file.mesh, mesh);
    if (ending == ".mesh") continue;
    EXPECT_EQ(file.mesh.region_names, mesh.region_names);
    EXPECT_EQ(file.mesh.patch_names, mesh.patch_names);
  }
}

/// Arrays and free marks, in VTK's formats. Precondition: one array at points, one at cells, marks.
inline void expect_vtk_keeps_arrays(const MeshData& mesh) {
  const Folder folder;
  for (const std::string ending : {"vtu", "vtk"}) {
    SCOPED_TRACE(ending);
    write_mesh(mesh, folder / ("p." + ending));
    const MeshFile file = read_mesh(folder / ("p." + ending));
    expect_accepted(file, mesh.dimension());
    expect_same(file.mesh, mesh);
    ASSERT_EQ(file.mesh.point_data.size(), 1U);
    EXPECT_EQ(file.mesh.point_data[0].values, mesh.point_data[0].values);
    ASSERT_EQ(file.mesh.cell_data.size(), mesh.regions.empty() ? 2U : 3U);
    EXPECT_EQ(file.mesh.cell_data[0].name, mesh.cell_data[0].name);
    EXPECT_EQ(file.mesh.cell_data[0].values, mesh.cell_data[0].values);
    EXPECT_EQ(file.mesh.cell_data[1].name, "free");
    EXPECT_EQ(file.mesh.cell_data[1].values, std::vector<double>(mesh.free.begin(), mesh.free.end()));
    EXPECT_EQ(file.mesh.free, mesh.free);
  }
}

}  // namespace dartcast::test
