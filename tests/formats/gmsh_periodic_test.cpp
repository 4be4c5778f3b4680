// Gmsh's periodic entities, which are pairs of patches.
#include <gtest/gtest.h>

#include <string>

#include "complex/periodic_faces.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/generators.hpp"
#include "formats/gmsh.hpp"
#include "support/round_trip.hpp"

namespace dartcast::test::gmsh_periodic_test {

// A section $Periodic of one entity: the nodes of xmax are those of xmin, moved. It is text in binary files of version 2, too.
std::string periodic_section(const MeshData& mesh, std::int32_t entity, std::int32_t master, bool v41) {
  const std::string matrix = "1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n";
  std::string nodes;
  std::size_t count = 0;
  for (std::size_t a = 0; a < mesh.points.size(); ++a) {
    for (std::size_t b = 0; b < mesh.points.size(); ++b) {
      if (mesh.points[a].x != 0.0 || mesh.points[b] != mesh.points[a] + Vec3{1.0, 0.0, 0.0}) continue;
      nodes += std::to_string(b + 1) + " " + std::to_string(a + 1) + "\n";
      ++count;
    }
  }
  return "$Periodic\n1\n2 " + std::to_string(entity) + " " + std::to_string(master) + (v41 ? "\n16 " : "\nAffine ") +
         matrix + std::to_string(count) + "\n" + nodes + "$EndPeriodic\n";
}

TEST(GmshPeriodic, EntitiesArePairs) {
  MeshData mesh = generate_box({.cells = {3, 2, 2}, .size = Vec3{1.0, 1.0, 1.0}});
  mesh.regions.assign(mesh.cell_count(), 1);
  mesh.region_names[1] = "fluid";
  constexpr std::int32_t xmin = 1;
  constexpr std::int32_t xmax = 2;
  for (const bool v41 : {false, true}) {
    for (const std::string& file : {v41 ? format_gmsh_4(mesh) : format_gmsh_2(mesh), gmsh_22_binary(mesh, false)}) {
      const bool named = file.find("$PhysicalNames") != std::string::npos;
      const bool of_41 = v41 && named;
      const ParsedMesh parsed = parse_gmsh(file + periodic_section(mesh, xmax, xmin, of_41));
      ASSERT_EQ(parsed.mesh.periodic.size(), 1U);
      EXPECT_EQ(parsed.mesh.periodic[0].a + parsed.mesh.periodic[0].b, named ? "xminxmax" : "12");
      EXPECT_EQ(parsed.mesh.periodic[0].translate, (Vec3{1.0, 0.0, 0.0}));
      EXPECT_TRUE(parsed.warnings.empty());
      EXPECT_EQ(CellComplex(parsed.mesh).periodic()->face_count(0), 4U);
      // An entity in no group.
      EXPECT_TRUE(parse_gmsh(file + periodic_section(mesh, xmax, 99, of_41)).mesh.periodic.empty());
    }
  }
}

}  // namespace dartcast::test::gmsh_periodic_test
