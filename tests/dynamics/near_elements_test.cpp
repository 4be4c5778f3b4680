// The walls near moving points, edges and triangles, against all walls of the scene.
#include <gtest/gtest.h>

#include "support/element_checks.hpp"
#include "support/placed_elements.hpp"

namespace dartcast::near_elements_test {

using test::cubes;
using test::scaled;

TEST(NearElements, FindsWhatIsTouchedFirst) {
  const std::array<CellType, 3> types = {CellType::hexahedron, CellType::tetrahedron, CellType::pyramid};
  test::ElementOutcome outcome;
  for (const bool moving : {false, true}) {
    for (std::size_t k = 0; k < types.size(); ++k) {
      Environment environment(cubes(8, types[k], 0.06, 0.2, k + 1), Threads{1});
      test::compare_elements(environment, 1.0, static_cast<std::size_t>(std::max(40, scaled(180, 168000))), moving,
                             k + 1, outcome);
    }
  }
  EXPECT_EQ(outcome.unlike, 0);
  for (const unsigned corners : {1U, 2U, 3U}) EXPECT_GT(outcome.touched[corners], scaled(20, 15000)) << corners;
}

// Within a margin, too: the walls that the margin adds are those that a sphere of that radius would find.
TEST(NearElements, FindsWhatIsWithinAMargin) {
  Environment environment(cubes(6), Threads{1});
  const CellComplex& complex = environment.complex();
  NearWalls near;
  MovingElement edge;
  edge.count = 2;
  edge.from = {Vec3{1.5, 1.5, 0.5}, Vec3{4.5, 4.5, 0.5}};
  edge.to = edge.from;
  const Cell cell = environment.locate(edge.from[0]).simplex.cell;
  const VertexMotion rest = {complex.positions(), complex.positions()};
  EXPECT_TRUE(near.search(complex, cell, edge, rest).empty());
  EXPECT_TRUE(near.search(complex, cell, edge, rest, 0.499).empty());
  EXPECT_FALSE(near.search(complex, cell, edge, rest, 0.5).empty());
}

// A long edge in a diagonal reaches the cells along it, not those of the box around it; in any scene.
TEST(NearElements, CellsReachedDoNotGrowWithTheScene) {
  for (const std::uint32_t cells : {12U, 24U}) {
    Environment environment(cubes(cells), Threads{1});
    const CellComplex& complex = environment.complex();
    NearWalls near;
    MovingElement edge;
    edge.count = 2;
    edge.from = {Vec3{1.5, 1.5, 1.5}, Vec3{10.4, 10.3, 10.2}};
    edge.to = {Vec3{1.6, 1.5, 1.5}, Vec3{10.4, 10.4, 10.2}};
    const VertexMotion rest = {complex.positions(), complex.positions()};
    near.search(complex, environment.locate(edge.from[0]).simplex.cell, edge, rest);
    EXPECT_LT(near.cells_reached().size(), 120U);
  }
}

}  // namespace dartcast::near_elements_test
