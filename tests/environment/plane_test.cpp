// The environment in the plane: particles bounce, are carried and are swept as in space, and none is lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/response.hpp"
#include "dartcast/validity.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::plane_test {

using test::cell_at;

// 0: triangles, 1: quadrilaterals, 2: with hexagons.
MeshData rectangle(int kind, std::array<std::uint32_t, 2> cells, double jitter, double blocked,
                   std::uint64_t seed = 1) {
  RectangleOptions o;
  o.cells = cells;
  o.size = {static_cast<double>(cells[0]), static_cast<double>(cells[1])};
  o.jitter = jitter;
  o.blocked_share = blocked;
  o.seed = seed;
  if (kind == 0) o.type = CellType::triangle;
  if (kind == 2) o.mixed = true;
  return generate_rectangle(o);
}

// Particles with velocities, all of them bouncing.
class Swarm {
 public:
  Swarm(Environment& environment, std::size_t count, double speed, std::uint64_t seed)
      : environment_(environment), random_(seed) {
    std::vector<Vec3> points;
    double right = 0.0;
    double top = 0.0;
    for (const Vec3& p : environment.positions()) {
      right = std::max(right, p.x);
      top = std::max(top, p.y);
    }
    for (std::size_t i = 0; i < count; ++i) points.push_back({random_.uniform(0, right), random_.uniform(0, top), 0});
    environment.add(set, points);
    for (std::size_t i = 0; i < set.size(); ++i) {
      const double angle = random_.uniform(0, 2 * std::numbers::pi);
      velocities.push_back({speed * std::cos(angle), speed * std::sin(angle), 0});
    }
    statuses.assign(set.size(), ParticleStatus::alive);
  }

  StepReport step(double dt) {
    return environment_.advance(set, targets(dt), respond_with(responses_, velocities, statuses, dt));
  }
  // Without a response they stop at walls.
  StepReport step_to_walls(double dt) { return environment_.advance(set, targets(dt)); }

  Particles set;
  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;

 private:
  [[nodiscard]] std::vector<Vec3> targets(double dt) const {
    std::vector<Vec3> all;
    for (std::size_t i = 0; i < set.size(); ++i) all.push_back(set[i].position + velocities[i] * dt);
    return all;
  }

  Environment& environment_;
  Random random_;
  WallResponses responses_;
};

// Whether the contact's dart is where its point is: the vertex, or the edge; places are right to rounding.
void expect_dart_at_point(const Environment& environment, const Contact& c) {
  const CombinatorialMap& map = environment.map();
  const Vec3 a = environment.positions()[map.origin(c.dart).value];
  const Vec3 b = environment.positions()[map.origin(map.phi1(c.dart)).value];
  if (c.kind == Kind::vertex) {
    EXPECT_LT(norm(c.point - a), 1e-12);
    return;
  }
  EXPECT_NEAR(norm(c.point - a) + norm(c.point - b), norm(b - a), 1e-12);
}

class InThePlane : public testing::TestWithParam<int> {};

TEST_P(InThePlane, BouncingParticlesStayInFreeCells) {
  for (std::uint64_t seed = 1; seed <= test::scaled<std::uint64_t>(3, 100); ++seed) {
    Environment environment(rectangle(GetParam(), {20, 15}, 0.25, 0.2, seed));
    Swarm swarm(environment, 400, 1.0, seed);
    ASSERT_GT(swarm.set.size(), 200U);
    Counters counters;
    for (int i = 0; i < 60; ++i) {
      const StepReport report = i % 5 == 4 ? swarm.step_to_walls(1.0) : swarm.step(i % 7 == 0 ? 3.0 : 0.3);
      ASSERT_TRUE(report.held.empty());
      counters += report.counters;
      const Audit a = audit(environment.complex(), swarm.set);
      ASSERT_EQ(a.failed, 0U) << a.first;
      for (const Contact& c : report.contacts.contacts) {
        ASSERT_TRUE(c.kind == Kind::edge || c.kind == Kind::vertex);
        for (const WallHit& w : report.contacts.walls_of(c)) {
          ASSERT_NEAR(norm(w.normal), 1.0, 1e-14);
          ASSERT_EQ(w.normal.z, 0.0);
          ASSERT_TRUE(environment.map().view(w.face.cell).is_wall(w.face.face));
        }
      }
      for (const Vec3& v : swarm.velocities) ASSERT_NEAR(norm(v), 1.0, 1e-12) << "a rebound loses nothing";
    }
    EXPECT_GT(counters.contacts[static_cast<std::size_t>(Kind::edge)], 1000U);
    EXPECT_EQ(counters.contacts[static_cast<std::size_t>(Kind::face)], 0U);
  }
}

// Every place and every step on the lattice: most of what is decided is degenerate.
TEST_P(InThePlane, NobodyIsLostOnALattice) {
  std::uint64_t steps = 0;
  std::uint64_t at_vertices = 0;
  for (std::uint64_t seed = 1; steps < test::scaled<std::uint64_t>(100'000, 10'000'000); ++seed) {
    Environment environment(rectangle(GetParam(), {12, 12}, 0.0, 0.25, seed));
    Random random(seed);
    std::vector<Vec3> points;
    for (int i = 0; i < 300; ++i) points.push_back({random.below(25) / 2.0, random.below(25) / 2.0, 0});
    Particles set;
    environment.add(set, points);
    std::vector<Vec3> velocities(set.size());
    std::vector<ParticleStatus> statuses(set.size(), ParticleStatus::alive);
    const WallResponses responses;
    for (int i = 0; i < 40; ++i) {
      std::vector<Vec3> targets;
      for (std::size_t k = 0; k < set.size(); ++k) {
        velocities[k] = {(random.below(9) - 4.0) / 2.0, (random.below(9) - 4.0) / 2.0, 0};
        targets.push_back(set[k].position + velocities[k]);
      }
      const StepReport report = environment.advance(set, targets, respond_with(responses, velocities, statuses, 1.0));
      ASSERT_TRUE(report.held.empty());
      steps += report.counters.particle_steps;
      at_vertices += report.counters.contacts[static_cast<std::size_t>(Kind::vertex)];
      for (const Contact& c : report.contacts.contacts) expect_dart_at_point(environment, c);
      ASSERT_FALSE(HasFailure());
      const Audit a = audit(environment.complex(), set);
      ASSERT_EQ(a.failed, 0U) << a.first;
    }
  }
  EXPECT_GT(at_vertices, steps / 50);
}

TEST_P(InThePlane, ParticlesFollowAMovingScene) {
  Environment environment(rectangle(GetParam(), {16, 16}, 0.2, 0.2, 7));
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  Swarm swarm(environment, 400, 1.0, 3);
  std::uint64_t swept = 0;
  std::uint64_t compared = 0;
  for (int i = 1; i <= test::scaled(100, 3000); ++i) {
    const std::span<Vec3> next = environment.next_positions();
    const double t = 0.05 * i;
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const Vec3& r = rest[k];
      next[k] = {r.x + 0.4 * std::sin(t + 0.7 * r.y), r.y + 0.4 * std::sin(1.3 * t + 0.5 * r.x), 0.0};
    }
    environment.move();
    ASSERT_TRUE(environment.validity().valid());
    // A third of the particles rests: what moves them is the scene.
    for (std::size_t k = 0; k < swarm.set.size(); k += 3) swarm.velocities[k] = {};
    const StepReport report = swarm.step(0.05);
    ASSERT_TRUE(report.held.empty());
    for (const Contact& c : report.contacts.contacts) {
      swept += c.particle % 3 == 0 && norm(c.wall_displacement) > 0.0 ? 1 : 0;
      if (report.counters.steps_split > 0) continue;  // met in between
      const CellView cell = environment.map().view(report.contacts.walls_of(c)[0].face.cell);
      const auto ends = cell.shape().corners(report.contacts.walls_of(c)[0].face.face);
      const std::uint32_t a = cell.vertex(ends[0]).value;
      const std::uint32_t b = cell.vertex(ends[1]).value;
      const auto now = environment.positions();
      const auto before = environment.complex().previous_positions();
      const double along = norm(c.point - now[a]) / norm(now[b] - now[a]);
      const Vec3 moved = (now[a] - before[a]) * (1.0 - along) + (now[b] - before[b]) * along;
      ASSERT_LT(norm(c.wall_displacement - moved), 1e-9) << "the wall moves at that point as its ends do";
      ++compared;
    }
    const Audit a = audit(environment.complex(), swarm.set);
    ASSERT_EQ(a.failed, 0U) << a.first;
  }
  EXPECT_GT(swept, test::scaled(20U, 600U)) << "walls pass over particles at rest";
  EXPECT_GT(compared, test::scaled(100U, 3000U));
}

TEST_P(InThePlane, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::string> hashes;
  for (const unsigned threads : {1U, 2U, 5U}) {
    Environment environment(rectangle(GetParam(), {20, 20}, 0.2, 0.2, 5), Threads{threads});
    Swarm swarm(environment, 5000, 1.0, 9);
    StateHash hash;
    for (int i = 0; i < 20; ++i) {
      swarm.step(0.4);
      for (std::size_t k = 0; k < swarm.set.size(); ++k) hash.add(k, swarm.set[k], swarm.velocities[k]);
    }
    hashes.push_back(hash.hex());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

INSTANTIATE_TEST_SUITE_P(Meshes, InThePlane, testing::Values(0, 1, 2));

// In a room without obstacles a path of rebounds is a straight one, folded.
TEST(Plane, ReboundsFoldAStraightPath) {
  for (int kind = 0; kind < 3; ++kind) {
    Environment environment(rectangle(kind, {8, 4}, kind == 2 ? 0.25 : 0.4, 0.0));
    Particles set;
    const Vec3 start = {1.25, 2.75, 0};
    const Vec3 velocity = {11.5, -7.125, 0};
    environment.add(set, std::vector<Vec3>{start});
    std::vector<Vec3> velocities = {velocity};
    std::vector<ParticleStatus> statuses = {ParticleStatus::alive};
    const WallResponses responses;
    for (int i = 1; i <= 50; ++i) {
      const std::vector<Vec3> targets = {set[0].position + velocities[0]};
      environment.advance(set, targets, respond_with(responses, velocities, statuses, 1.0));
      const auto folded = [](double x, double length) {
        const double r = std::fmod(std::fmod(x, 2 * length) + 2 * length, 2 * length);
        return r > length ? 2 * length - r : r;
      };
      EXPECT_NEAR(set[0].position.x, folded(start.x + i * velocity.x, 8), 1e-11);
      EXPECT_NEAR(set[0].position.y, folded(start.y + i * velocity.y, 4), 1e-11);
    }
  }
}

// The scene moves by (1, 0) while a particle rests: the left wall meets it when it has gone as far.
TEST(Plane, AWallThatPassesIsMetInTime) {
  Environment environment(rectangle(1, {1, 1}, 0.0, 0.0));
  Particles set;
  environment.add(set, std::vector<Vec3>{{0.375, 0.75, 0}});
  std::vector<Vec3> next(environment.positions().begin(), environment.positions().end());
  for (Vec3& p : next) p.x += 1.0;
  environment.move(next);
  const StepReport report = environment.advance(set, std::vector<Vec3>{{0.375, 0.75, 0}});
  ASSERT_EQ(report.contacts.contacts.size(), 1U);
  const Contact& c = report.contacts.contacts[0];
  EXPECT_NEAR(c.time_of_impact, 0.375, 1e-12);
  EXPECT_LT(norm(c.point - Vec3{1.0, 0.75, 0}), 1e-12);
  EXPECT_EQ(c.wall_displacement, (Vec3{1.0, 0.0, 0.0}));
  EXPECT_EQ(report.contacts.walls_of(c)[0].normal, (Vec3{1.0, 0.0, 0.0}));
  EXPECT_EQ(audit(environment.complex(), set).failed, 0U);
}

TEST(Plane, LocatesInFacesOnEdgesAndAtVertices) {
  Environment environment(rectangle(1, {4, 4}, 0.0, 0.0));
  EXPECT_EQ(environment.locate({0.5, 0.25, 0}).kind, Kind::face);
  EXPECT_EQ(environment.locate({1.0, 0.25, 0}).kind, Kind::edge);
  EXPECT_EQ(environment.locate({1.0, 2.0, 0}).kind, Kind::vertex);
  EXPECT_EQ(environment.locate({4.5, 2.0, 0}).place, Place::outside);
  const Location edge = environment.locate({1.0, 0.25, 0});
  const CombinatorialMap& map = environment.map();
  EXPECT_EQ(environment.positions()[map.origin(edge.dart).value].x, 1.0);
  EXPECT_EQ(environment.positions()[map.origin(map.phi1(edge.dart)).value].x, 1.0);
  EXPECT_EQ(map.phi2(map.phi2(edge.dart)), edge.dart);
  EXPECT_FALSE(map.phi3(edge.dart).valid());
}

// The edge between two cells, as the first runs along it.
Dart dart_between(const CombinatorialMap& map, Cell a, Cell b) {
  for (std::uint16_t d = 0; d < map.shape(a).dart_count(); ++d) {
    if (map.view(a).neighbour(d) == b) return {a, d};
  }
  return {};
}

// The paper's three cases in the plane: an edge is opened and sewn again, two faces are merged, a face is split.
TEST(Plane, ParticlesFollowWhatIsOpenedAndSewn) {
  Environment environment(rectangle(1, {2, 1}, 0.0, 0.0));
  const Cell left = cell_at(environment, {0.5, 0.5, 0});
  const Cell right = cell_at(environment, {1.5, 0.5, 0});
  const auto opened =
      environment.edit([&](ComplexEdit& e) { unsew(e.topology(), e.map().face(dart_between(e.map(), left, right))); });
  EXPECT_EQ(opened.map.created.size(), 2U) << "both ends of the edge are parted";
  Particles set;
  environment.add(set, std::vector<Vec3>{{0.5, 0.25, 0}, {1.5, 0.5, 0}});
  const std::vector<Vec3> across = {{1.75, 0.25, 0}, {1.5, 0.5, 0}};
  ASSERT_EQ(environment.advance(set, across).contacts.contacts.size(), 1U);
  EXPECT_EQ(set[0].position, (Vec3{1.0, 0.25, 0}));
  EXPECT_EQ(set[0].touching_count, 1);

  environment.edit([&](ComplexEdit& e) {
    const CombinatorialMap& map = e.map();
    const auto at_one = [&](Cell c) {
      std::uint16_t d = 0;
      while (e.position(map.origin({c, d})).x != 1.0 || e.position(map.origin(map.phi1({c, d}))).x != 1.0) ++d;
      return Dart{c, d};
    };
    sew(e.topology(), at_one(set[0].cell), at_one(set[1].cell));
  });
  const UpdateReport report = environment.update_after_edit(set);
  EXPECT_EQ(report.located, 2U);
  EXPECT_EQ(set[0].touching_count, 0);
  EXPECT_TRUE(environment.advance(set, across).contacts.contacts.empty());
  EXPECT_EQ(set[0].position, across[0]);
  EXPECT_EQ(audit(environment.complex(), set).failed, 0U);
}

TEST(Plane, ParticlesFollowMergedAndSplitFaces) {
  Environment environment(rectangle(1, {4, 1}, 0.0, 0.0));
  Particles set;
  environment.add(set, std::vector<Vec3>{{0.5, 0.25, 0}, {1.25, 0.5, 0}, {3.5, 0.5, 0}});
  const ParticleState far = set[2];
  environment.edit([&](ComplexEdit& e) { merge_faces(e.topology(), dart_between(e.map(), set[0].cell, set[1].cell)); });
  EXPECT_EQ(environment.update_after_edit(set).touched, 2U);
  EXPECT_EQ(set[0].cell, set[1].cell);
  EXPECT_EQ(set[2].cell, far.cell);
  const Cell whole = set[0].cell;
  const ComplexEditReport split = environment.edit([&](ComplexEdit& e) {
    std::vector<Dart> ends;
    for (std::uint16_t d = 0; d < e.map().shape(whole).dart_count(); ++d) {
      if (e.position(e.map().origin({whole, d})).x == 1.0) ends.push_back({whole, d});
    }
    ASSERT_EQ(ends.size(), 2U) << "where the edge was, vertices are left";
    split_face(e.topology(), ends[0], ends[1]);
  });
  EXPECT_EQ(split.map.added.size(), 2U);
  EXPECT_EQ(environment.update_after_edit(set).located, 2U);
  EXPECT_NE(set[0].cell, set[1].cell);
  EXPECT_EQ(environment.map().type(set[0].cell), CellType::quadrilateral);
  environment.edit([&](ComplexEdit& e) { e.topology().set_free(set[1].cell, false); });
  const UpdateReport moved = environment.update_after_edit(set, OrphanPolicy::relocate);
  ASSERT_EQ(moved.orphaned.size(), 1U);
  EXPECT_EQ(moved.orphaned[0].distance, 0.25) << "to the edge of the cell on the left";
  EXPECT_EQ(set[1].position, (Vec3{1.0, 0.5, 0}));
  EXPECT_EQ(audit(environment.complex(), set).failed, 0U);
}

TEST(Plane, WhatNeedsSpaceIsRefused) {
  Environment environment(rectangle(1, {2, 1}, 0.0, 0.0));
  const Cell c = cell_at(environment, {0.5, 0.5, 0});
  EXPECT_THROW(environment.edit([&](ComplexEdit& e) {
    split_cell(e.topology(), std::vector<Dart>{{c, 0}});
  }),
               InvalidArgument);
  EXPECT_THROW(environment.edit([&](ComplexEdit& e) {
    e.place(split_edge(e.topology(), {c, 0}).vertex, {0.5, 0.0, 0.5});
  }),
               InvalidArgument);
  EXPECT_EQ(environment.map().cell_count(), 2U);
  EXPECT_TRUE(check_validity(environment.complex(), {}).valid());
}

TEST(Plane, SaysWhenATriangleInverts) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {4, 0, 0}, {1, 2, 0}};
  mesh.add_cell(CellType::triangle, std::vector<std::uint32_t>{0, 1, 2});
  Environment environment(mesh);
  const std::vector<Vec3> after = {{0, 0, 0}, {4, 0, 0}, {1, -2, 0}};
  const auto found = environment.first_inversion(after);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->how.safe_time, 0.5, 1e-9);
  EXPECT_LE(found->how.safe_time, 0.5);
  EXPECT_EQ(found->how.kind, InversionKind::vertex_edge);
  const double share = environment.move_until_inverted(after, 0.9);
  EXPECT_NEAR(share, 0.45, 1e-9);
  EXPECT_TRUE(environment.validity().valid());
}

TEST(Plane, RefusesWhatIsNotInIt) {
  Environment environment(rectangle(0, {4, 4}, 0.0, 0.0));
  Particles set;
  EXPECT_THROW(environment.add(set, std::vector<Vec3>{{1, 1, 0.5}}), InvalidArgument);
  environment.add(set, std::vector<Vec3>{{1.5, 1.25, 0}});
  EXPECT_THROW(environment.advance(set, std::vector<Vec3>{{1.5, 1.25, 1e-90}}), InvalidArgument);
  EXPECT_EQ(audit(environment.complex(), set).failed, 0U);
}

// The z of positions in the plane may be any number: it is not read.
TEST_P(InThePlane, TheHeightOfVerticesIsNotRead) {
  Environment flat(rectangle(GetParam(), {10, 8}, 0.25, 0.2));
  Environment high(rectangle(GetParam(), {10, 8}, 0.25, 0.2));
  const std::vector<Vec3> rest(flat.positions().begin(), flat.positions().end());
  Swarm in_flat(flat, 200, 1.0, 3);
  Swarm in_high(high, 200, 1.0, 3);
  Random random(9);
  for (int step = 1; step <= 40; ++step) {
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const double lean = 0.6 * std::sin(0.3 * step);
      const Vec3 x = {rest[v].x + lean * std::sin(rest[v].y), rest[v].y + lean * std::cos(rest[v].x), 0.0};
      flat.next_positions()[v] = x;
      high.next_positions()[v] = {x.x, x.y, random.uniform(-3.0, 3.0)};
    }
    flat.move();
    high.move();
    ASSERT_EQ(flat.validity().invalid_count, high.validity().invalid_count);
    const StepReport a = step % 3 == 0 ? in_flat.step_to_walls(0.3) : in_flat.step(0.3);
    const StepReport b = step % 3 == 0 ? in_high.step_to_walls(0.3) : in_high.step(0.3);
    ASSERT_EQ(a.contacts.contacts.size(), b.contacts.contacts.size());
    for (std::size_t i = 0; i < a.contacts.contacts.size(); ++i) {
      ASSERT_EQ(a.contacts.contacts[i].point, b.contacts.contacts[i].point);
      ASSERT_EQ(a.contacts.contacts[i].wall_displacement, b.contacts.contacts[i].wall_displacement);
    }
    for (std::size_t i = 0; i < in_flat.set.size(); ++i) {
      ASSERT_EQ(in_flat.set[i].position, in_high.set[i].position) << "particle " << i << " in step " << step;
      ASSERT_EQ(in_flat.set[i].cell, in_high.set[i].cell);
      ASSERT_EQ(in_flat.velocities[i], in_high.velocities[i]);
    }
    const Audit audited = audit(high.complex(), in_high.set);
    ASSERT_EQ(audited.failed, 0U) << audited.first;
  }
}

TEST(Plane, MovesOutOfItAreRefused) {
  Environment environment(rectangle(0, {4, 4}, 0.0, 0.0));
  const std::vector<Vec3> before(environment.positions().begin(), environment.positions().end());
  std::vector<Vec3> after = before;
  for (Vec3& x : after) x.x += 0.25;
  after[7].z = 1e-18;
  try {
    environment.move(after);
    ADD_FAILURE();
  } catch (const InvalidArgument& e) {
    EXPECT_NE(std::string(e.what()).find("point 7"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("plane"), std::string::npos) << e.what();
  }
  EXPECT_EQ(std::vector<Vec3>(environment.positions().begin(), environment.positions().end()), before);
  EXPECT_THROW((void)environment.first_inversion(after), InvalidArgument);
  EXPECT_THROW(environment.move_until_inverted(after), InvalidArgument);
}

}  // namespace dartcast::plane_test
