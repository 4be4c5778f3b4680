// Catheters with edges: no segment ever meets a wall. The truth is the audit of SolidSet, which shares no code with steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "solids/audit_solids.hpp"
#include "support/catheter_scenes.hpp"
#include "support/element_checks.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::catheter_edges_test {

// Segments that meet a wall, with edges or without.
std::size_t pierced(const Environment& environment, const Catheter& c) {
  const std::vector<Vec3> points = c.points();
  const WallAudit walls(environment.complex());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i + 1 < points.size(); ++i)
    count += walls.meets_wall(points, {{i, i + 1, i + 1}, 2, 1, 1}) ? 1 : 0;
  return count;
}

// A box of cubes or tetrahedra, every fifth blocked, in which a catheter with long segments goes its random way.
class AmongObstacles {
 public:
  explicit AmongObstacles(std::uint64_t seed, bool edges = true)
      : random_(seed),
        environment(test::cubes(6, seed % 2 == 0 ? CellType::hexahedron : CellType::tetrahedron, 0.1, 0.2, seed),
                    Threads{1 + static_cast<unsigned>(seed % 2)}) {
    for (int tries = 0; !catheter; ++tries) {
      CatheterOptions o;
      o.spacing = random_.uniform(0.3, 1.5);
      o.length = 8.0;
      o.stiffness = random_.below(2) == 0 ? 0.01 : 10.0;
      o.tip_length = 2.0;
      o.tip_curvature = random_.uniform(0.0, 0.5 / o.spacing);
      o.edges = edges;
      o.entry = test::random_vector(random_, 3.0) + Vec3{3.0, 3.0, 3.0};
      o.direction = test::random_vector(random_);
      try {
        catheter.emplace(environment, o);
      } catch (const InvalidArgument&) {
        if (tries > 10000) throw;
      }
    }
  }

  CatheterStep step() {
    const double h = catheter->options().spacing;
    const double push = random_.below(5) == 0 ? -h * random_.uniform() : 0.6 * h * random_.uniform();
    return catheter->step({push, random_.uniform(-0.3, 0.3), test::random_vector(random_, 0.1)});
  }
  double move(double size) {
    return catheter->move_with(test::waved(environment.positions(), random_.uniform(-size, size)));
  }
  void expect_sound() const {
    const SolidAudit segments = catheter->audit();
    EXPECT_EQ(segments.failed, 0U) << segments.first;
    const Audit points = audit(environment.complex(), catheter->particles());
    EXPECT_EQ(points.failed, 0U) << points.first;
  }

 private:
  Random random_;

 public:
  Environment environment;
  std::optional<Catheter> catheter;
};

TEST(CatheterEdges, NoSegmentMeetsAWall) {
  std::size_t checked = 0;
  std::size_t contacts = 0;
  double least_share = 1.0;
  for (std::uint64_t seed = 1; seed <= std::max<std::uint64_t>(2, test::scaled<std::uint64_t>(24, 400)); ++seed) {
    AmongObstacles run(seed);
    for (int i = 0; i < 60; ++i) {
      if (seed % 3 != 0) least_share = std::min(least_share, run.move(seed % 3 == 1 ? 0.05 : 0.3));
      contacts += run.step().contacts;
      checked += run.catheter->audit().checked;
      run.expect_sound();
      ASSERT_FALSE(testing::Test::HasFailure()) << seed << " " << i;
    }
  }
  EXPECT_GT(checked, test::sanitized() ? 100U : 500U);
  EXPECT_GT(contacts, test::sanitized() ? 50U : 500U);
  if (!test::sanitized()) EXPECT_LT(least_share, 1.0);  // walls stop, too
}

// Each contact is a place on the chain that is close to a wall, on its free side, by the corners of that wall.
TEST(CatheterEdges, ContactsAreWhereTheChainPresses) {
  std::array<std::size_t, 2> count{};
  for (std::uint64_t seed = 1; seed <= test::scaled<std::uint64_t>(80, 800); ++seed) {
    AmongObstacles scene(seed);
    const auto walls = test::all_walls(scene.environment.complex(), false);
    const CombinatorialMap& map = scene.environment.map();
    for (int i = 0; i < 15; ++i) {
      scene.step();
      const std::vector<Vec3> points = scene.catheter->points();
      const std::vector<SolidContact> contacts = scene.catheter->contacts();
      for (const SolidContact& c : contacts) {
        ASSERT_LT(c.vertices[c.count - 1U], points.size());
        Vec3 place = points[c.vertices[0]] * c.weights[0];
        if (c.count == 2) place += points[c.vertices[1]] * c.weights[1];
        EXPECT_LE(norm(place - c.point), 1e-12);
        const CellView cell = map.view(c.face.cell);
        ASSERT_TRUE(cell.is_wall(c.face.face));
        std::array<Vec3, 3> wall;
        for (std::size_t k = 0; k < 3; ++k)
          wall[k] = scene.environment.complex()
                        .positions()[cell.vertex(cell.shape().triangle(c.face.face, c.triangle)[k]).value];
        const Vec3 free_side = cross(wall[2] - wall[0], wall[1] - wall[0]);
        EXPECT_NEAR(dot(c.wall_point - wall[0], free_side), 0.0, 1e-9);
        EXPECT_GT(c.gap, 0.0);
        EXPECT_NEAR(c.gap, test::clearance(walls, c.point), 1e-9);
        EXPECT_NEAR(dot(c.point - c.wall_point, c.normal), c.gap, 1e-9);
        EXPECT_LT(norm(c.point - c.wall_point), 0.1 * scene.catheter->options().spacing);
        EXPECT_EQ(c.patch, map.patch(c.face));
        EXPECT_EQ(c.kind, c.count == 2 ? SolidContactKind::edge_edge : SolidContactKind::vertex_face);
        ++count[c.count - 1U];
      }
      if (i != 10 || contacts.empty()) continue;
      Catheter other(scene.environment, scene.catheter->options());
      other.restore(scene.catheter->checkpoint());
      const std::vector<SolidContact> again = other.contacts();
      ASSERT_EQ(again.size(), contacts.size());
      for (std::size_t k = 0; k < again.size(); ++k) {
        EXPECT_EQ(again[k].dart, contacts[k].dart);
        EXPECT_EQ(again[k].point, contacts[k].point);
      }
    }
  }
  EXPECT_GT(count[0], test::sanitized() ? 1U : 100U);
  if (!test::sanitized()) EXPECT_GT(count[1], 20U);
}

// The test above would see it.
TEST(CatheterEdges, WithoutThemSegmentsCutCorners) {
  std::size_t count = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    AmongObstacles run(seed, false);
    for (int i = 0; i < 30; ++i) {
      run.step();
      count += pierced(run.environment, *run.catheter);
    }
    EXPECT_EQ(run.catheter->audit().checked, 0U);
  }
  EXPECT_GT(count, 20U);
}

CatheterOptions in_pipe(double length, double spacing) {
  CatheterOptions o;
  o.length = length;
  o.spacing = spacing;
  o.stiffness = 1.0;
  o.entry = {2.5, 2.5, 2.0};
  o.direction = {0.0, 0.0, 1.0};
  return o;
}

// A pipe that a catheter lies in, and that is pinched: its walls stop at it.
TEST(CatheterEdges, WallsStopWhereTheyWouldCrushIt) {
  Environment environment(test::pipe(12));
  CatheterOptions o = in_pipe(8.0, 0.8);
  Catheter c(environment, o);
  c.step({7.0});
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  const auto pinched = [&](double to) {  // two sides come within `to` of the plane x = 2.9 half-way
    std::vector<Vec3> now = rest;
    for (Vec3& x : now) {
      const double share = std::max(0.0, 1.0 - std::abs(x.z - 6.0) / 4.0);
      x.x += (2.9 - x.x) * share * (1.0 - to);
    }
    return now;
  };
  double share = 1.0;
  for (int i = 1; i <= 20; ++i) {
    share = c.move_with(pinched(1.0 - 0.05 * i));
    c.step({});
    EXPECT_EQ(c.audit().failed, 0U) << i << " " << c.audit().first;
  }
  EXPECT_LT(share, 1.0);  // the last would leave no room at all
  EXPECT_EQ(c.move_with(rest), 1.0);
  EXPECT_EQ(c.audit().failed, 0U);
}

// Not inserted yet: the cell around the entry stays positive.
TEST(CatheterEdges, WallsStopBeforeTheEntryIsFlat) {
  Environment environment(test::pipe(12));
  CatheterOptions o = in_pipe(8.0, 0.8);
  Catheter c(environment, o);
  std::vector<Vec3> flat(environment.positions().begin(), environment.positions().end());
  for (Vec3& x : flat) x.x = 5.0 - x.x;
  const double share = c.move_with(flat);
  EXPECT_GT(share, 0.4);
  EXPECT_LT(share, 0.5);
  EXPECT_EQ(audit(environment.complex(), c.particles()).failed, 0U);
}

// Positions that are no numbers are no way for the cells around it.
TEST(CatheterEdges, WallsThatGoNowhereStayWhereTheyAre) {
  Environment environment(test::pipe(12));
  Catheter c(environment, in_pipe(8.0, 0.8));
  c.step({5.0});
  const StateHash before = c.state_hash();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
    EXPECT_EQ(c.move_with(std::vector<Vec3>(rest.size(), Vec3{bad, bad, bad})), 0.0);
    EXPECT_TRUE(std::equal(rest.begin(), rest.end(), environment.positions().begin()));
    EXPECT_EQ(c.state_hash(), before);
  }
  EXPECT_NEAR(c.step({0.5}).pushed, 0.5, 1e-12);
  EXPECT_EQ(c.audit().failed, 0U);
}

// A cell between two points is blocked, and opened again.
TEST(CatheterEdges, AnEditThatPiercesASegmentHoldsTheCatheter) {
  Environment environment(test::pipe(14));
  CatheterOptions o = in_pipe(9.0, 3.0);
  o.entry.z = 2.5;
  Catheter c(environment, o);
  c.step({6.0});
  ASSERT_GT(c.points().size(), 2U);
  const Vec3 between = (c.points()[0] + c.points()[1]) * 0.5;
  const Cell cell = environment.locate(between).simplex.cell;
  const auto set_free = [&](bool free) {
    environment.edit([&](ComplexEdit& e) { e.topology().set_free(cell, free); });
    c.update_after_edit();
  };
  set_free(false);
  const StateHash before = c.state_hash();
  const CatheterStep held = c.step({0.5});
  EXPECT_TRUE(held.stuck);
  EXPECT_EQ(held.pushed, 0.0);
  EXPECT_EQ(c.state_hash(), before);
  EXPECT_EQ(pierced(environment, c), 1U);
  EXPECT_EQ(c.audit().checked, 0U);
  std::vector<Vec3> now(environment.positions().begin(), environment.positions().end());
  for (Vec3& x : now) x += {0.25, 0.0, 0.0};
  EXPECT_EQ(c.move_with(now), 1.0);  // it is carried along
  EXPECT_TRUE(c.step({0.5}).stuck);
  EXPECT_LE(norm((c.points()[0] + c.points()[1]) * 0.5 - between - Vec3{0.25, 0.0, 0.0}), 1e-12);
  set_free(true);
  const CatheterStep freed = c.step({0.5});
  EXPECT_FALSE(freed.stuck);
  EXPECT_NEAR(freed.pushed, 0.5, 1e-12);
  EXPECT_EQ(c.audit().failed, 0U);
}

TEST(CatheterEdges, AMoveWithoutItIsRefused) {
  Environment environment(test::pipe(14));
  CatheterOptions o = in_pipe(5.0, 0.5);
  Catheter with(environment, o);
  o.edges = false;
  Catheter without(environment, o);
  const std::vector<Vec3> now(environment.positions().begin(), environment.positions().end());
  const StateHash before = with.state_hash();
  EXPECT_THROW(with.move_with(std::span(now).first(5)), InvalidArgument);
  environment.move(now);
  EXPECT_THROW(with.step({0.1}), InvalidArgument);
  EXPECT_THROW(with.move_with(now), InvalidArgument);
  EXPECT_EQ(with.state_hash(), before);
  EXPECT_NO_THROW(without.step({0.1}));
  EXPECT_EQ(without.move_with(now), 1.0);
  EXPECT_NO_THROW(without.step({0.1}));
}

}  // namespace dartcast::catheter_edges_test
