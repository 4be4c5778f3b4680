// The walls near moving points, edges and triangles in vessels and bones that others have meshed.
#include <gtest/gtest.h>

#include "dartcast/mesh_files.hpp"
#include "dartcast/mesh_selection.hpp"
#include "support/placed_elements.hpp"
#include "support/shared_data.hpp"
#include "support/tier.hpp"

namespace dartcast::near_elements_data_test {

using test::scaled;

TEST(NearElementsOfOthers, FindsWhatIsTouchedFirst) {
  NEED_DATA("elements in an aneurysm and a femur");
  test::ElementOutcome outcome;
  for (const char* file : test::all_or_first({"aneurysm3d.box.msh", "femur.lumen.msh"})) {
    MeshData mesh = read_mesh(test::data_folder() / "derived" / file).mesh;
    const std::vector<std::string> lumen = {"lumen"};
    select_free_regions(mesh, lumen);
    double edges = 0.0;
    for (std::size_t c = 0; c < mesh.cell_count(); ++c)
      edges += norm(mesh.points[mesh.cell(c)[1]] - mesh.points[mesh.cell(c)[0]]);
    const double size = edges / static_cast<double>(mesh.cell_count());
    for (const bool moving : {false, true}) {
      Environment environment(mesh, Threads{1});
      test::compare_elements(environment, size, static_cast<std::size_t>(std::max(30, scaled(300, 10000))), moving, 7,
                             outcome);
    }
  }
  EXPECT_EQ(outcome.unlike, 0);
  for (const unsigned corners : {1U, 2U, 3U}) EXPECT_GT(outcome.touched[corners], 0) << corners;
}

}  // namespace dartcast::near_elements_data_test
