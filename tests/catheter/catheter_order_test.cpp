// A catheter among moves and edits in any order: it follows both, and refuses to be left behind.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "support/meshes.hpp"

namespace dartcast::catheter_order_test {

struct Inserted {
  Environment environment = Environment(test::cubes(2), Threads{1});
  Catheter catheter = Catheter(environment, options());

  Inserted() { catheter.step({0.25}); }

  static CatheterOptions options() {
    CatheterOptions o;
    o.length = 0.5;
    o.spacing = 0.0625;
    o.entry = {0.25, 0.5, 0.5};
    o.direction = {1.0, 0.0, 0.0};
    return o;
  }

  // Turns the vessel about the z axis.
  void turn(double angle) {
    std::vector<Vec3> points(environment.positions().begin(), environment.positions().end());
    for (Vec3& x : points)
      x = {x.x * std::cos(angle) - x.y * std::sin(angle), x.x * std::sin(angle) + x.y * std::cos(angle), x.z};
    catheter.move_with(points);
  }

  void split_an_edge_at(const Vec3& place) {
    const Cell c = environment.locate(place).simplex.cell;
    environment.edit([&](ComplexEdit& e) { split_edge(e.topology(), Dart{c, 0}); });
  }

  void free_all(bool free) {
    environment.edit([&](ComplexEdit& e) {
      for (const Cell c : e.map().cells()) e.topology().set_free(c, free);
    });
  }

  [[nodiscard]] bool is_sound() const { return audit(environment.complex(), catheter.particles()).failed == 0; }
};

void expect_near(const Inserted& a, const Inserted& b, double within) {
  EXPECT_LE(norm(a.catheter.entry() - b.catheter.entry()), within);
  EXPECT_LE(norm(a.catheter.direction() - b.catheter.direction()), within);
  const std::vector<Vec3> of_a = a.catheter.points();
  const std::vector<Vec3> of_b = b.catheter.points();
  ASSERT_EQ(of_a.size(), of_b.size());
  for (std::size_t i = 0; i < of_a.size(); ++i) EXPECT_LE(norm(of_a[i] - of_b[i]), within) << i;
}

TEST(CatheterOrder, AnEditThenAMove) {
  Inserted in_turn;
  Inserted late;
  in_turn.split_an_edge_at({1.5, 1.5, 1.5});
  in_turn.catheter.update_after_edit();
  in_turn.turn(0.1);
  late.split_an_edge_at({1.5, 1.5, 1.5});
  EXPECT_THROW(late.turn(0.1), InvalidArgument);
  late.catheter.update_after_edit();
  late.turn(0.1);
  in_turn.catheter.step({});
  late.catheter.step({});
  EXPECT_EQ(in_turn.catheter.state_hash(), late.catheter.state_hash());
  expect_near(in_turn, late, 0.0);
  EXPECT_TRUE(late.is_sound());
}

TEST(CatheterOrder, AMoveThenAnEdit) {
  Inserted in_turn;
  Inserted late;
  in_turn.turn(0.1);
  in_turn.catheter.step({});
  in_turn.split_an_edge_at({1.4, 1.6, 1.5});
  in_turn.catheter.update_after_edit();
  late.turn(0.1);
  late.split_an_edge_at({1.4, 1.6, 1.5});
  late.catheter.update_after_edit();
  late.catheter.step({});
  EXPECT_NEAR(late.catheter.direction().y, std::sin(0.1), 1e-12);
  expect_near(in_turn, late, 1e-6);
  EXPECT_TRUE(late.is_sound());
}

TEST(CatheterOrder, AnEditThatLeavesNoFreeCell) {
  Inserted scene;
  scene.free_all(false);
  EXPECT_NO_THROW(scene.catheter.update_after_edit());
  EXPECT_NO_THROW(scene.catheter.step({0.0625}));
  scene.free_all(true);
  EXPECT_NO_THROW(scene.catheter.update_after_edit());
  EXPECT_NEAR(scene.catheter.step({0.0625}).pushed, 0.0625, 1e-12);
  EXPECT_TRUE(scene.is_sound());
}

}  // namespace dartcast::catheter_order_test
