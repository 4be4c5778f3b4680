// Edits of the environment with solids in it: nothing is passed in silence.
#include <gtest/gtest.h>

#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"

namespace dartcast::solid_edit_test {

using test::ball;
using test::moved;

// A closed solid in a box of unit cubes, around the cube in the middle.
struct Edited : ::testing::Test {
  Environment environment{test::cubes(5)};
  SolidSet solids{environment};

  Cell cell_at(const Vec3& x) { return environment.locate(x).simplex.cell; }
  void set_free(Cell c, bool free) {
    environment.edit([&](ComplexEdit& e) { e.topology().set_free(c, free); });
  }
  std::vector<Vec3> places() const { return {solids.positions().begin(), solids.positions().end()}; }
  std::vector<Vec3> places(const Vec3& by) const {
    std::vector<Vec3> to = places();
    for (Vec3& p : to) p += by;
    return to;
  }
};

TEST_F(Edited, AWallInAnEdgeHoldsItUntilItIsGone) {
  const std::vector<Vec3> line = {{1.5, 2.5, 2.5}, {3.5, 2.5, 2.5}};
  ASSERT_EQ(solids.add(solid_of_polyline(line)).solid, 0U);
  ASSERT_EQ(solids.add(moved(ball(0.3), {1.0, 1.0, 1.0})).solid, 1U);
  const Cell middle = cell_at({2.5, 2.5, 2.5});
  set_free(middle, false);
  EXPECT_THROW(solids.advance(places()), InvalidArgument) << "the edit was not followed";
  solids.update_after_edit();
  ASSERT_EQ(solids.stuck().size(), 1U);
  EXPECT_EQ(solids.stuck()[0].solid, 0U);
  EXPECT_EQ(solids.stuck()[0].refusal, SolidRefusal::meets_wall);
  EXPECT_EQ(solids.stuck()[0].count, 2);
  EXPECT_EQ(solids.audit().checked, 20U);
  EXPECT_EQ(solids.audit().failed, 0U);

  const std::vector<Vec3> before = places();
  const SolidStep& step = solids.advance(places({0.1, 0.0, 0.0}));
  EXPECT_EQ(step.held, std::vector<std::uint32_t>{0});
  EXPECT_EQ(step.made, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(step.cut, 0U);
  EXPECT_EQ(solids.positions()[0], before[0]);
  EXPECT_EQ(solids.positions()[2], before[2] + (Vec3{0.1, 0.0, 0.0}));

  // The mesh carries it along, and the other solid moves by itself.
  std::vector<Vec3> walls(environment.positions().begin(), environment.positions().end());
  for (Vec3& p : walls) p.y += 0.25;
  const std::vector<Vec3> start = places();
  EXPECT_EQ(solids.move_with(places(), walls).walls_made, 1.0);
  EXPECT_NEAR(solids.positions()[0].y, start[0].y + 0.25, 1e-12);
  EXPECT_EQ(solids.positions()[2], start[2]);
  EXPECT_EQ(audit(environment.complex(), solids.particles()).failed, 0U);

  set_free(middle, true);
  solids.update_after_edit();
  EXPECT_TRUE(solids.stuck().empty());
  EXPECT_EQ(solids.advance(places({0.0, 0.0, 0.125})).made, (std::vector<double>{1.0, 1.0}));
}

TEST_F(Edited, ACutThroughAnEdgeHoldsIt) {
  const std::vector<Vec3> line = {{1.5, 2.5, 2.5}, {3.5, 2.5, 2.5}};
  solids.add(solid_of_polyline(line));
  const Cell left = cell_at({1.5, 2.5, 2.5});
  const Cell right = cell_at({2.5, 2.5, 2.5});
  environment.edit([&](ComplexEdit& e) {
    const CellView view = e.map().view(left);
    std::uint16_t face = 0;
    while (view.is_wall(face) || view.neighbour(face) != right) ++face;
    unsew(e.topology(), {left, face});
  });
  solids.update_after_edit();
  ASSERT_EQ(solids.stuck().size(), 1U);
  EXPECT_EQ(solids.stuck()[0].refusal, SolidRefusal::meets_wall);
}

TEST_F(Edited, AVertexInABlockedCellHoldsItsSolid) {
  solids.add(moved(ball(0.3), {2.5, 2.5, 2.5}));
  const std::vector<Vec3> before = places();
  const Cell middle = cell_at({2.5, 2.5, 2.5});
  set_free(middle, false);
  solids.update_after_edit();
  ASSERT_EQ(solids.stuck().size(), 1U);
  EXPECT_EQ(solids.stuck()[0].refusal, SolidRefusal::vertex_not_free);
  solids.advance(places({0.1, 0.0, 0.0}));
  EXPECT_EQ(places(), before);
  set_free(middle, true);
  solids.update_after_edit();
  EXPECT_TRUE(solids.stuck().empty());
  EXPECT_EQ(solids.advance(places({0.1, 0.0, 0.0})).made[0], 1.0);
}

// A solid that is carried along within a cell that becomes flat stays stuck there when the cell is free again.
TEST_F(Edited, AVertexInAFlatCellHoldsItsSolid) {
  solids.add(moved(ball(0.3), {2.5, 2.5, 2.5}));
  const Cell middle = cell_at({2.5, 2.5, 2.5});
  set_free(middle, false);
  solids.update_after_edit();
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  std::vector<Vec3> flat = rest;
  for (Vec3& p : flat) p.z = p.z == 3.0 ? 2.0 : p.z;
  EXPECT_EQ(solids.move_with(places(), flat).walls_made, 1.0);
  set_free(middle, true);
  solids.update_after_edit();
  ASSERT_EQ(solids.stuck().size(), 1U);
  EXPECT_EQ(solids.stuck()[0].refusal, SolidRefusal::cell_not_positive);
  EXPECT_EQ(solids.move_with(places(), rest).walls_made, 1.0);
  EXPECT_EQ(solids.advance(places({0.1, 0.0, 0.0})).held, std::vector<std::uint32_t>{0});
  EXPECT_EQ(audit(environment.complex(), solids.particles()).failed, 0U);
}

TEST_F(Edited, AWallWithinAClosedSolidHoldsIt) {
  solids.add(moved(ball(1.5), {2.5, 2.5, 2.5}));
  set_free(cell_at({2.5, 2.5, 2.5}), false);
  solids.update_after_edit();
  ASSERT_EQ(solids.stuck().size(), 1U);
  EXPECT_EQ(solids.stuck()[0].refusal, SolidRefusal::encloses_wall);
}

TEST_F(Edited, ASolidThatIsRemovedLeavesTheOthers) {
  const std::vector<Vec3> line = {{1.5, 2.5, 2.5}, {3.5, 2.5, 2.5}};
  solids.add(moved(ball(0.3), {1.0, 1.0, 1.0}));
  solids.add(moved(ball(0.2), {4.0, 4.0, 4.0}));
  solids.add(solid_of_polyline(line));
  solids.add(moved(ball(0.3), {4.0, 1.0, 1.0}));
  set_free(cell_at({2.5, 2.5, 2.5}), false);
  solids.update_after_edit();
  const std::vector<Vec3> all = places();
  solids.remove(1);
  EXPECT_THROW(solids.remove(3), InvalidArgument);
  std::vector<Vec3> others(all.begin(), all.begin() + 12);
  others.insert(others.end(), all.begin() + 24, all.end());
  EXPECT_EQ(places(), others);
  EXPECT_EQ(solids.size(), 3U);
  ASSERT_EQ(solids.stuck().size(), 1U);
  EXPECT_EQ(solids.stuck()[0].solid, 1U);
  EXPECT_EQ(solids.first_vertices()[3], 26U);
  solids.remove(1);
  EXPECT_TRUE(solids.stuck().empty());
  EXPECT_EQ(solids.advance(places({0.1, 0.0, 0.0})).made, (std::vector<double>{1.0, 1.0}));
  EXPECT_EQ(solids.audit().checked, 40U);
  EXPECT_EQ(solids.audit().failed, 0U);
}

TEST_F(Edited, GoesOnFromACheckpointToTheLastBit) {
  ASSERT_EQ(solids.add(moved(ball(0.4), {1.2, 1.2, 1.2})).solid, 0U);
  const std::vector<Vec3> line = {{1.5, 2.5, 2.5}, {3.5, 2.5, 2.5}};
  ASSERT_EQ(solids.add(solid_of_polyline(line)).solid, 1U);
  set_free(cell_at({2.5, 2.5, 2.5}), false);
  solids.update_after_edit();
  solids.advance(places({-0.5, 0.1, -0.7}));
  const SolidCheckpoint saved = solids.checkpoint();
  const std::vector<Vec3> at = places();
  const SolidStep first = solids.advance(places({0.3, -1.5, -0.4}));
  const std::vector<Vec3> end = places();
  ASSERT_NE(end, at);

  SolidCheckpoint shorter = saved;
  shorter.states.pop_back();
  EXPECT_THROW(solids.restore(shorter), InvalidArgument);
  solids.restore(saved);
  EXPECT_EQ(places(), at);
  ASSERT_EQ(solids.stuck().size(), 1U);
  EXPECT_EQ(solids.stuck()[0].solid, 1U);
  const SolidStep& second = solids.advance(places({0.3, -1.5, -0.4}));
  EXPECT_EQ(places(), end);
  EXPECT_EQ(second.made, first.made);
  EXPECT_EQ(second.contacts.size(), first.contacts.size());
}

}  // namespace dartcast::solid_edit_test
