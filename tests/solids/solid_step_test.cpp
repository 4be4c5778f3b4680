// Steps of solids among walls: nothing is ever pierced, whatever the options, whether walls rest or move.
#include <gtest/gtest.h>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "solids/elements.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::solid_step_test {

using test::ball;
using test::scaled;
using test::TossedSolids;

BoxOptions obstacles(double share) {
  BoxOptions box;
  box.cells = {16, 16, 16};
  box.size = {16.0, 16.0, 16.0};
  box.blocked_layer = true;
  box.blocked_share = share;
  box.jitter = 0.2;
  box.seed = 9;
  return box;
}

struct Tossed {
  std::uint64_t steps = 0;
  std::uint64_t contacts = 0;
  std::uint64_t edge_contacts = 0;
  std::uint64_t cut = 0;
  std::uint64_t pierced = 0;
  double made = 0.0;
  double travelled = 0.0;
  std::string first;
};

// `wave`: radians of a wave that the walls make in a step; 0: they rest.
Tossed run(const SolidMesh& mesh, std::size_t bodies, int steps, double wave, const SolidStepOptions& options,
           Threads threads = {1}) {
  Environment environment(generate_box(obstacles(wave > 0.0 ? 0.12 : 0.04)), threads);
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  TossedSolids tossed(environment, 4);
  tossed.fill(mesh, bodies, 16.0);
  Tossed r;
  for (int s = 1; s <= steps; ++s) {
    const std::vector<Vec3> targets = tossed.targets();
    const SolidStep* step = nullptr;
    if (wave > 0.0) {
      std::vector<Vec3> walls = rest;
      for (Vec3& p : walls) {
        const double phase = wave * s + 0.7 * p.x;
        p += Vec3{0.15 * std::sin(phase + p.y), 0.15 * std::sin(phase + p.z), 0.15 * std::sin(phase + p.x)};
      }
      step = &tossed.solids.move_with(targets, walls, options);
    } else {
      step = &tossed.solids.advance(targets, options);
    }
    tossed.follow();
    r.steps += tossed.solids.size();
    r.contacts += step->contacts.size();
    r.cut += step->cut;
    for (const SolidContact& c : step->contacts) r.edge_contacts += c.kind == SolidContactKind::edge_edge ? 1 : 0;
    for (const double made : step->made) r.made += made;
    for (std::size_t v = 0; v < targets.size(); ++v)
      r.travelled += norm(tossed.solids.positions()[v] - tossed.before()[v]) / static_cast<double>(targets.size());
    if (s % 10 != 0 && s != steps) continue;
    const SolidAudit audit = tossed.solids.audit();
    r.pierced += audit.failed;
    if (r.first.empty()) r.first = audit.first;
    EXPECT_EQ(dartcast::audit(environment.complex(), tossed.solids.particles()).failed, 0U);
  }
  return r;
}

// Bodies need some 40 steps to reach a wall.
int steps_of(unsigned rounds) { return std::max(60, scaled(rounds == 12 ? 250 : 60, 3000)); }

TEST(SolidStep, NothingIsPiercedAtRest) {
  for (const SolidMesh& mesh : test::all_or_first({ball(0.9), ball(1.0, 1), test::rod(24, 0.5)})) {
    for (const unsigned rounds : {12U, 2U, 0U}) {
      const Tossed r = run(mesh, 8, steps_of(rounds), 0.0, {.rounds = rounds});
      EXPECT_EQ(r.pierced, 0U) << r.first;
      EXPECT_GT(r.edge_contacts, 4U);
      if (rounds == 12) {
        // A long rod that is pulled into a wedge stays there until the pull turns.
        const double share = mesh.triangles.empty() ? 0.7 : 0.99;
        EXPECT_GT(r.made, share * static_cast<double>(r.steps)) << "corrections leave little to cut";
      } else {
        EXPECT_GT(r.cut, 0U);
      }
    }
  }
}

TEST(SolidStep, NothingIsPiercedByWallsThatMove) {
  for (const SolidMesh& mesh : test::all_or_first({test::rod(12, 0.3), ball(0.4), ball(0.4, 1)})) {
    for (const unsigned rounds : {12U, 2U, 0U}) {
      const Tossed r = run(mesh, 8, steps_of(rounds), 0.06, {.rounds = rounds});
      EXPECT_EQ(r.pierced, 0U) << r.first;
      EXPECT_GT(r.contacts, 5U);
      if (rounds == 0) EXPECT_GT(r.cut, 5U);
    }
  }
}

// The straight motion between the positions as stored touches no wall of the scene.
TEST(SolidStep, StoredMotionsTouchNoWall) {
  BoxOptions box = obstacles(0.1);
  box.jitter = 0.7;
  Environment environment(generate_box(box), Threads{1});
  ASSERT_GT(environment.complex().steiner_point_count(), 0U);
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  TossedSolids tossed(environment, 7);
  tossed.fill(ball(0.9), 6, 16.0);
  tossed.fill(test::rod(8, 0.5), 12, 16.0);
  SolidMesh mesh = ball(0.9);
  const SolidMesh line = test::rod(8, 0.5);
  const auto every = static_cast<std::uint32_t>(test::stride(1, 5));
  std::uint64_t contacts = 0;
  for (std::uint32_t s = 0; s < std::max(45U, scaled(60U, 600U)); ++s) {
    const bool moves = s % 2 == 1;
    const SolidStepOptions options = {.rounds = s % 4 < 2 ? 0U : 12U};
    const auto targets = tossed.targets();
    const auto to = test::waved(rest, 0.1 * std::sin(0.5 * s));
    contacts += (moves ? tossed.solids.move_with(targets, to, options) : tossed.solids.advance(targets, options))
                    .contacts.size();
    const auto walls = test::all_walls(environment.complex(), moves);
    const auto first = tossed.solids.first_vertices();
    for (std::uint32_t solid = s % every; solid < tossed.solids.size(); solid += every) {
      const auto parts = elements_of(first[solid + 1] - first[solid] == 12 ? mesh : line);
      for (const SolidElement& e : parts) {
        MovingElement m;
        m.count = e.count;
        for (unsigned i = 0; i < e.count; ++i) {
          m.from[i] = tossed.before()[first[solid] + e.vertex[i]];
          m.to[i] = tossed.solids.positions()[first[solid] + e.vertex[i]];
        }
        EXPECT_FALSE(test::first_touch_of(m, walls).has_value()) << s << " " << solid;
      }
    }
    tossed.follow();
  }
  EXPECT_GT(contacts, 20U);
}

TEST(SolidStep, SameBitsForAnyThreads) {
  const auto positions = [](Threads threads, bool moves) {
    Environment environment(generate_box(obstacles(0.08)), threads);
    const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
    TossedSolids tossed(environment, 3);
    tossed.fill(ball(0.7, 1), 8, 16.0);
    std::vector<Vec3> all;
    for (int s = 0; s < std::max(40, scaled(40, 400)); ++s) {
      const auto targets = tossed.targets();
      const SolidStep& step =
          moves ? tossed.solids.move_with(targets, test::waved(rest, 0.002 * s)) : tossed.solids.advance(targets);
      tossed.follow();
      all.insert(all.end(), tossed.solids.positions().begin(), tossed.solids.positions().end());
      for (const SolidContact& c : step.contacts) all.insert(all.end(), {c.point, c.wall_point, c.normal});
    }
    return all;
  };
  for (const bool moves : {false, true}) {
    const auto one = positions(Threads{1}, moves);
    EXPECT_EQ(positions(Threads{3}, moves), one);
  }
}

// The paper's figure 21: the vertices of an edge pass an obstacle on both sides, and the edge would cut its corner.
TEST(SolidStep, AnEdgeDoesNotCutACorner) {
  MeshData mesh = test::cubes(5);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[62] = 0;  // from 2 to 3 along each axis
  Environment environment(mesh);
  const std::vector<Vec3> targets = {{2.5, 2.1, 1.5}, {2.5, 2.1, 3.7}};
  for (const unsigned rounds : {0U, 12U}) {
    SolidSet edge(environment);
    edge.add(solid_of_polyline(std::vector<Vec3>{{2.5, 0.5, 1.5}, {2.5, 0.5, 3.7}}));
    const SolidStep& step = edge.advance(targets, {.rounds = rounds});
    ASSERT_GE(step.contacts.size(), 1U);
    for (const SolidContact& c : step.contacts) {
      EXPECT_EQ(c.kind, SolidContactKind::edge_edge);
      EXPECT_EQ(c.wall_kind, Kind::edge);
      EXPECT_NEAR(c.time_of_impact, 1.5 / 1.6, 1e-5);
      EXPECT_NEAR(c.normal.y, -1.0, 1e-9);
      EXPECT_NEAR(c.wall_point.y, 2.0, 1e-12);
      EXPECT_LT(edge.positions()[0].y, 2.0);
    }
    if (rounds > 0) {
      EXPECT_DOUBLE_EQ(step.made[0], 1.0);
      EXPECT_NEAR(edge.positions()[0].y, 2.0, 0.1);
    } else {
      EXPECT_NEAR(step.made[0], 15.0 / 16.0 * 1.5 / 1.6, 1e-5);
    }
    EXPECT_EQ(edge.audit().failed, 0U);
  }
}

// A wall comes over a solid at rest: it takes the solid along, or it stops where it would squeeze the solid.
TEST(SolidStep, AWallNeverPassesOverASolid) {
  Environment environment(test::cubes(4));
  SolidSet solids(environment);
  ASSERT_EQ(solids.add(test::moved(ball(0.3), {1.5, 1.5, 0.5})).refusal, SolidRefusal::none);
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  const auto stay = [&] { return std::vector<Vec3>(solids.positions().begin(), solids.positions().end()); };
  std::vector<Vec3> walls = rest;
  for (Vec3& p : walls) p.z += 0.5 * (1.0 - p.z / 4.0);  // the floor rises to 0.5
  const SolidStep& lifted = solids.move_with(stay(), walls);
  EXPECT_EQ(lifted.walls_made, 1.0);
  EXPECT_FALSE(lifted.contacts.empty());
  EXPECT_EQ(lifted.corrected, 1U);
  for (const Vec3& p : solids.positions()) EXPECT_GT(p.z, 0.5);
  EXPECT_EQ(solids.audit().failed, 0U);

  // Now floor and ceiling close on a solid that keeps its shape: 0.6 high.
  std::vector<Vec3> closed = rest;
  for (Vec3& p : closed) p.z = 0.8 + 0.1 * p.z;
  double made = 1.0;
  for (int s = 0; s < 200 && made > 0.0; ++s) {
    made = solids.move_with(stay(), closed, {.rounds = 0}).walls_made;
    EXPECT_LT(made, 1.0);
    EXPECT_EQ(solids.audit().failed, 0U);
  }
  EXPECT_EQ(made, 0.0) << "it comes to rest before it touches";
  EXPECT_EQ(audit(environment.complex(), solids.particles()).failed, 0U);
}

// Far from the origin a cut position is rounded by more than the way that is left, and can touch.
TEST(SolidStep, RoundedPositionsAreDetectedAgain) {
  constexpr double far = 0x1p43;  // where neighbours are 2^-9 apart
  MeshData mesh = test::cubes(6);
  for (Vec3& p : mesh.points) p = p * 0.25 + Vec3{far, far, far};
  Environment environment(mesh, Threads{1});
  Random random(5);
  std::uint64_t cut = 0;
  for (int body = 0; body < 4; ++body) {
    SolidSet solids(environment);
    ASSERT_EQ(solids.add(test::moved(ball(0.2), Vec3{far, far, far} + Vec3{0.75, 0.75, 0.75})).refusal,
              SolidRefusal::none);
    for (int s = 0; s < 40; ++s) {
      const Vec3 way = test::random_vector(random, 0.4);
      std::vector<Vec3> targets(solids.positions().begin(), solids.positions().end());
      for (Vec3& p : targets) p += way + test::random_vector(random, 0.05);
      const SolidStep& step = solids.advance(targets, {.rounds = 0});
      cut += step.cut;
      ASSERT_EQ(solids.audit().failed, 0U) << s;
    }
  }
  EXPECT_GT(cut, 20U);
}

// Corrections go to the vertices by their inverse masses; those of 0 go to their targets.
TEST(SolidStep, HeavyVerticesAreNotCorrected) {
  MeshData mesh = test::cubes(5);
  mesh.free.assign(mesh.cell_count(), 1);
  mesh.free[62] = 0;  // from 2 to 3 along each axis
  Environment environment(mesh);
  SolidSet solids(environment);
  solids.add(solid_of_polyline(std::vector<Vec3>{{2.5, 0.5, 1.5}, {2.5, 0.5, 3.7}}));
  solids.set_inverse_masses(std::vector<double>{0.0, 1.0});
  const std::vector<Vec3> targets = {{2.5, 1.5, 1.5}, {2.5, 3.0, 3.7}};
  const SolidStep& step = solids.advance(targets, {.separation = 0.125});
  EXPECT_EQ(solids.positions()[0], targets[0]);
  EXPECT_NE(solids.positions()[1], targets[1]);
  EXPECT_EQ(step.made[0], 1.0);
  EXPECT_EQ(step.corrected, 1U);
  ASSERT_FALSE(step.contacts.empty());
  for (const SolidContact& c : step.contacts) {
    EXPECT_GE(c.gap, 0.125 * (1.0 - 1e-9));
    EXPECT_GT(c.displacement.y, 1.0);
    EXPECT_EQ(c.wall_displacement, Vec3{});
  }
  EXPECT_EQ(solids.audit().failed, 0U);
}

// A cell that is flat proves nothing about what is behind it.
TEST(SolidStep, AFlatCellHoldsASolid) {
  Environment environment(test::cubes(4));
  SolidSet solids(environment);
  solids.add(test::moved(ball(0.3), {1.5, 1.5, 1.5}));
  const std::vector<Vec3> start(solids.positions().begin(), solids.positions().end());
  std::vector<Vec3> walls(environment.positions().begin(), environment.positions().end());
  for (Vec3& p : walls) p.z = p.z == 3.0 ? 2.0 : p.z;  // the third layer becomes flat
  const double made = solids.move_with(start, walls).walls_made;
  EXPECT_EQ(made, 1.0) << "the flat cells are out of reach";
  std::vector<Vec3> up = start;
  for (Vec3& p : up) p.z += 1.0;
  const SolidStep& step = solids.advance(up);
  EXPECT_EQ(step.held, std::vector<std::uint32_t>{0});
  EXPECT_EQ(step.made[0], 0.0);
  EXPECT_TRUE(step.contacts.empty());
  EXPECT_TRUE(std::equal(start.begin(), start.end(), solids.positions().begin()));
  std::vector<Vec3> aside = start;
  for (Vec3& p : aside) p.x += 1.0;
  EXPECT_EQ(solids.advance(aside).made[0], 1.0);
  EXPECT_TRUE(std::equal(aside.begin(), aside.end(), solids.positions().begin()));
}

}  // namespace dartcast::solid_step_test
