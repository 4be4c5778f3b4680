// Ways of solids in slices: what is stored touches no wall in any slice, by all walls and without a search.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dartcast/generators.hpp"
#include "solids/elements.hpp"
#include "solids/joint_move.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::solid_slices_test {

struct Arcs {
  std::vector<Vec3> from, to;
  std::vector<std::uint32_t> first;
  Vec3 bulge;
  unsigned slices = 1;

  [[nodiscard]] Vec3 at(std::size_t v, double share) const {
    if (share == 0.0) return from[v];
    if (share == 1.0) return to[v];
    return from[v] + (to[v] - from[v]) * share + bulge * std::sin(std::numbers::pi * share);
  }
  [[nodiscard]] SolidWay way() const {
    SolidWay all = {to, slices};
    all.place = [this](std::uint32_t solid, double share, std::span<Vec3> place) {
      for (std::size_t i = 0; i < place.size(); ++i) place[i] = at(first[solid] + i, share);
    };
    return all;
  }
};

// Whether the part touches a wall on its way between two shares of the step, where the walls are at others.
bool touches(const SolidElement& e, std::size_t first, const Arcs& arcs, std::array<double, 2> shares,
             std::array<double, 2> walls_at, std::span<const MovingTriangle> walls) {
  MovingElement m;
  m.count = e.count;
  for (unsigned i = 0; i < e.count; ++i) {
    m.from[i] = arcs.at(first + e.vertex[i], shares[0]);
    m.to[i] = arcs.at(first + e.vertex[i], shares[1]);
  }
  std::vector<MovingTriangle> now;
  for (MovingTriangle t : walls) {
    const MovingTriangle whole = t;
    for (unsigned k = 0; k < 3; ++k) {
      t.from[k] = whole.from[k] + (whole.to[k] - whole.from[k]) * walls_at[0];
      t.to[k] = whole.from[k] + (whole.to[k] - whole.from[k]) * walls_at[1];
    }
    if (test::boxes_meet(m, t)) now.push_back(t);
  }
  return test::first_touch_of(m, now).has_value();
}

TEST(SolidSlices, StoredMotionsTouchNoWall) {
  BoxOptions box;
  box.cells = {10, 10, 10};
  box.size = {10.0, 10.0, 10.0};
  box.blocked_share = 0.1;
  box.jitter = 0.7;
  box.seed = 9;
  Environment environment(generate_box(box), Threads{1});
  ASSERT_GT(environment.complex().steiner_point_count(), 0U);
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  Random random(4);
  test::TossedSolids tossed(environment, 7);
  SolidMesh mesh = test::ball(0.5);
  tossed.fill(mesh, 6, 10.0);
  const auto elements = elements_of(mesh);
  std::size_t checked = 0;
  std::size_t stopped = 0;
  std::size_t walls_stopped = 0;
  for (int s = 0; s < std::max(10, test::scaled(30, 300)); ++s) {
    Arcs arcs;
    arcs.from.assign(tossed.solids.positions().begin(), tossed.solids.positions().end());
    arcs.to = arcs.from;
    for (Vec3& x : arcs.to) x += test::random_vector(random, 0.1);
    arcs.first.assign(tossed.solids.first_vertices().begin(), tossed.solids.first_vertices().end());
    arcs.bulge = test::random_vector(random, 1.5);
    arcs.slices = 2 + random.below(6);
    const bool moves = s % 2 == 1;
    if (moves) {
      MovePartner* const solids = &JointMoves::prepare(tossed.solids, arcs.way(), {.rounds = 0});
      move_together(environment, {&solids, 1}, test::waved(rest, 0.15 * std::sin(0.5 * s)));
    } else {
      JointMoves::advance(tossed.solids, arcs.way(), {.rounds = 0});
    }
    const SolidStep& step = JointMoves::last_step(tossed.solids);
    ASSERT_EQ(tossed.solids.audit().failed, 0U) << tossed.solids.audit().first;
    ASSERT_EQ(audit(environment.complex(), tossed.solids.particles()).failed, 0U);
    walls_stopped += step.walls_made < 1.0 ? 1 : 0;
    const auto walls = test::all_walls(environment.complex(), moves);
    for (std::uint32_t solid = 0; solid < tossed.solids.size(); ++solid) {
      const std::size_t first = arcs.first[solid];
      const double made = step.made[solid];
      for (std::size_t v = first; v < arcs.first[solid + 1]; ++v)
        EXPECT_EQ(tossed.solids.positions()[v], arcs.at(v, made)) << "on its way";
      stopped += made < 1.0 ? 1 : 0;
      if (step.walls_made < 1.0) continue;
      for (unsigned slice = 0; slice < arcs.slices; ++slice) {
        const std::array<double, 2> at = {double(slice) / arcs.slices, (slice + 1.0) / arcs.slices};
        const std::array<double, 2> shares = {std::min(at[0], made), std::min(at[1], made)};
        for (const SolidElement& e : elements)
          EXPECT_FALSE(touches(e, first, arcs, shares, at, walls)) << s << " " << solid << " " << slice;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 100U);
  EXPECT_GT(stopped, 20U);
  EXPECT_GT(walls_stopped, test::sanitized() ? 0U : 2U);
}

}  // namespace dartcast::solid_slices_test
