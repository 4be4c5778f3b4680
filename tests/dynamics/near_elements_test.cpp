// The walls near moving points, edges and triangles, against all walls of the scene.
#include <gtest/gtest.h>

#include "support/element_checks.hpp"
#include "support/shared_data.hpp"

namespace dartcast::near_elements_test {

using test::cubes;
using test::scaled;

// An element that touches no wall at the start, and the cell of its first corner.
struct Placed {
  MovingElement element;
  Cell cell;
};

// Elements of half a cell to five cells at free places of a box, some of them without extent.
std::vector<Placed> place(Environment& environment, double box, std::size_t count, Random& random) {
  const auto walls = test::all_walls(environment.complex(), false);
  constexpr std::array<double, 6> sizes = {0.5, 1.0, 2.0, 5.0, 1e-9, 0.0};
  std::vector<Placed> placed;
  while (placed.size() < count) {
    const Vec3 at = {random.uniform(0, box), random.uniform(0, box), random.uniform(0, box)};
    const Location location = environment.locate(at);
    if (location.place != Place::free) continue;
    const auto kind = static_cast<unsigned>(placed.size());
    const MovingElement e = test::element_at(random, at, 1 + kind % 3, sizes[kind / 3 % sizes.size()]);
    if (!test::meets_at_start(e, walls)) placed.push_back({e, location.simplex.cell});
  }
  return placed;
}

struct Outcome {
  std::array<int, 4> touched{};  // by the number of corners
  int unlike = 0;
};

void compare(const CellComplex& complex, const VertexMotion& motion, std::span<const MovingTriangle> walls,
             const Placed& p, Outcome& outcome) {
  NearWalls near;
  std::vector<MovingTriangle> found;
  for (const NearWall& w : near.search(complex, p.cell, p.element, motion)) found.push_back(w.corners);
  const auto time = test::first_touch_of(p.element, found);
  const auto truth = test::first_touch_of(p.element, walls);
  outcome.unlike += time != truth ? 1 : 0;
  outcome.touched[p.element.count] += time ? 1 : 0;
}

TEST(NearElements, FindsWhatIsTouchedFirst) {
  const std::array<CellType, 3> types = {CellType::hexahedron, CellType::tetrahedron, CellType::pyramid};
  Outcome outcome;
  for (const bool moving : {false, true}) {
    for (std::size_t k = 0; k < types.size(); ++k) {
      Environment environment(cubes(8, types[k], 0.06, 0.2, k + 1), Threads{1});
      Random random(k + 1);
      auto placed = place(environment, 8.0, static_cast<std::size_t>(std::max(40, scaled(180, 168000))), random);
      if (moving) environment.move(test::waved(environment.positions(), 0.1));
      const CellComplex& complex = environment.complex();
      const auto walls = test::all_walls(complex, moving);
      const VertexMotion motion = {moving ? complex.previous_positions() : complex.positions(), complex.positions()};
      for (std::size_t i = 0; i < placed.size(); ++i) {
        const Vec3 way = test::random_vector(random, i % 4 == 0 ? 1.5 : 0.15);
        for (unsigned c = 0; c < placed[i].element.count; ++c)
          placed[i].element.to[c] += way + test::random_vector(random, i % 4 == 1 ? 0.5 : 0.02);
        compare(complex, motion, walls, placed[i], outcome);
      }
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
