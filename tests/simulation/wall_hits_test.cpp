// Hits of wall faces, against counts of contact lists by hand and a geometric truth for faces that continue over edits.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/events.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/statistics.hpp"
#include "support/with_response.hpp"

namespace dartcast::wall_hits_test {

std::uint64_t sum(const std::vector<std::uint64_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

std::uint64_t sum(const std::vector<FaceHits>& faces) {
  return std::accumulate(faces.begin(), faces.end(), std::uint64_t{0},
                         [](std::uint64_t n, const FaceHits& f) { return n + f.hits; });
}

MeshData box(std::uint32_t n, CellType type = CellType::hexahedron) {
  BoxOptions options;
  options.cells = {n, n, n};
  options.size = {1.0 * n, 1.0 * n, 1.0 * n};
  options.type = type;
  return generate_box(options);
}

// The corner points of each wall of a free cell, without those where the wall is straight, by its face. It knows of no
// vertex number. Positions are dyadic, so that all of this is exact.
std::map<std::set<std::array<double, 3>>, CellFace> walls_by_place(const Environment& environment) {
  std::map<std::set<std::array<double, 3>>, CellFace> walls;
  const CombinatorialMap& map = environment.map();
  for (const Cell c : map.cells()) {
    const CellView view = map.view(c);
    for (std::uint16_t f = 0; view.is_free() && f < view.shape().face_count(); ++f) {
      if (!view.is_wall(f)) continue;
      std::vector<Vec3> x;
      for (const std::uint16_t k : view.shape().corners(f)) x.push_back(environment.positions()[view.vertex(k).value]);
      std::set<std::array<double, 3>> corners;
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Vec3& before = x[(k + x.size() - 1) % x.size()];
        const Vec3& after = x[(k + 1) % x.size()];
        if (cross(x[k] - before, after - x[k]) != Vec3{}) corners.insert({x[k].x, x[k].y, x[k].z});
      }
      walls[corners] = {c, f};
    }
  }
  return walls;
}

// Particles that fly about in a box, in a simulation that keeps hits.
class WallHitsTest : public testing::Test {
 protected:
  static SimulationOptions options() {
    return test::with_response(SimulationOptions{.dt = 0.05, .gravity = {0.0, 0.0, -1.0}}, Reflect{1.0, 0.0});
  }
  static StatisticsOptions hits() {
    StatisticsOptions options;
    options.hits = true;
    return options;
  }
};

TEST_F(WallHitsTest, AreTheContactsOfEachFaceCountedByHand) {
  Environment environment(box(3));
  Simulation simulation(environment, options());
  simulation.set_statistics(hits());
  simulation.add_random(200, {1.5, 0.75, 0.5});
  WallHits own;
  std::map<CellFace, std::uint64_t> truth;
  for (int i = 0; i < 40; ++i) {
    const SimulationStep& step = simulation.step();
    own.add(environment, step.report.contacts);
    for (const Contact& c : step.contacts()) ++truth[step.report.contacts.walls_of(c).front().face];
  }
  ASSERT_GT(truth.size(), 20U);
  const std::vector<FaceHits> faces = simulation.statistics().hits.faces();
  ASSERT_EQ(faces.size(), truth.size());
  auto expected = truth.begin();
  for (const FaceHits& f : faces) {
    EXPECT_EQ(f.face, expected->first);
    EXPECT_EQ(f.hits, expected->second);
    EXPECT_EQ(f.patch, environment.map().patch(f.face));
    EXPECT_EQ(simulation.statistics().hits.of(f.face), f.hits);
    ++expected;
  }
  EXPECT_EQ(own.faces(), faces);
  EXPECT_EQ(own.by_patch(environment), simulation.totals().contacts_by_patch);
  EXPECT_EQ(own.of({Cell{0, 13}, 0}), 0U);  // in the middle
  EXPECT_EQ(simulation.state_hash(), [] {
    Environment other(box(3));
    Simulation without(other, options());
    without.add_random(200, {1.5, 0.75, 0.5});
    for (int i = 0; i < 40; ++i) without.step();
    return without.state_hash();
  }());
}

TEST_F(WallHitsTest, GoAlongWithADeformationAndAreTheSameForAnyThreads) {
  std::vector<std::vector<FaceHits>> found;
  for (const unsigned threads : {1U, 3U}) {
    Environment environment(box(3, CellType::tetrahedron), Threads{threads});
    Simulation simulation(environment, options());
    DeformationStep twist;
    twist.kind = DeformationKind::twist;
    twist.centre = {1.5, 1.5, 1.5};
    twist.amplitude = 0.4;
    twist.length = 3.0;
    simulation.set_deformation(Deformation({twist}, environment.positions()));
    simulation.set_statistics(hits());
    simulation.add_random(500, {1.5, 0.75, 0.5}, 0.0);
    simulation.add_random(50, {1.5, 0.75, 0.5}, 0.05);  // spheres count, too
    std::map<CellFace, std::uint64_t> truth;
    for (int i = 0; i < 30; ++i) {
      const SimulationStep& step = simulation.step();
      for (const Contact& c : step.contacts()) ++truth[step.report.contacts.walls_of(c).front().face];
    }
    found.push_back(simulation.statistics().hits.faces());
    for (const FaceHits& f : found.back()) EXPECT_EQ(f.hits, truth[f.face]);
    EXPECT_EQ(found.back().size(), truth.size());
  }
  EXPECT_EQ(found[0], found[1]);
}

// One wall face of a unit cube, hit once.
struct OneHit {
  OneHit() {
    Particles particles;
    environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}});
    const StepReport report = environment.advance(particles, std::vector<Vec3>{{0.5, 0.25, -1.0}});
    hits.add(environment, report.contacts);
    face = hits.faces().at(0).face;
  }

  void edit(const std::function<void(ComplexEdit&)>& make) {
    environment.edit(make);
    hits.update_after_edit(environment);
  }

  Environment environment{box(1)};
  WallHits hits;
  CellFace face;
};

TEST_F(WallHitsTest, AFaceContinuesWhereAVertexIsPutOnItsEdge) {
  OneHit one;
  const Shape& shape = one.environment.map().shape(one.face.cell);
  const Dart edge{one.face.cell, shape.first_dart(one.face.face)};
  one.edit([&](ComplexEdit& e) { split_edge(e.topology(), edge); });
  ASSERT_EQ(one.hits.faces().size(), 1U);
  const FaceHits after = one.hits.faces()[0];
  EXPECT_EQ(after.hits, 1U);
  EXPECT_NE(after.face.cell, one.face.cell);
  EXPECT_EQ(one.environment.map().shape(after.face.cell).degree(after.face.face), 5U);
  EXPECT_TRUE(one.hits.ended_by_patch().empty());
  const auto dart = [&] {  // the new vertex is taken away again
    const CellView view = one.environment.map().view(after.face.cell);
    for (std::uint16_t d = view.shape().first_dart(after.face.face);; ++d) {
      if (view.vertex(view.shape().origin(d)).value >= 8) return Dart{after.face.cell, d};
    }
  };
  one.edit([&](ComplexEdit& e) { merge_edges(e.topology(), dart()); });
  ASSERT_EQ(one.hits.faces().size(), 1U);
  EXPECT_EQ(one.hits.faces()[0].hits, 1U);
  EXPECT_TRUE(one.hits.ended_by_patch().empty());
}

TEST_F(WallHitsTest, AFaceThatIsSplitEndsAndItsPartsStartAtZero) {
  OneHit one;
  const std::uint16_t first = one.environment.map().shape(one.face.cell).first_dart(one.face.face);
  const Patch patch = one.environment.map().patch(one.face);
  one.edit([&](ComplexEdit& e) {
    split_face(e.topology(), {one.face.cell, first}, {one.face.cell, static_cast<std::uint16_t>(first + 2)});
  });
  EXPECT_TRUE(one.hits.faces().empty());
  ASSERT_EQ(one.hits.ended_by_patch().size(), patch.value + 1U);
  EXPECT_EQ(one.hits.ended_by_patch()[patch.value], 1U);
  EXPECT_EQ(sum(one.hits.by_patch(one.environment)), 1U);
}

TEST_F(WallHitsTest, AFaceEndsWhereItsCellIsBlockedOrRemoved) {
  for (const bool blocked : {true, false}) {
    Environment environment(box(2));
    Particles particles;
    environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}});
    const StepReport report = environment.advance(particles, std::vector<Vec3>{{0.5, 0.25, -1.0}, {1.5, 0.25, -1.0}});
    WallHits hits;
    hits.add(environment, report.contacts);
    const CellFace face = hits.faces().at(0).face;
    environment.edit([&](ComplexEdit& e) {
      if (blocked)
        e.topology().set_free(face.cell, false);
      else
        remove(e.topology(), face.cell);
    });
    hits.update_after_edit(environment);
    ASSERT_EQ(hits.faces().size(), 1U);
    EXPECT_NE(hits.faces()[0].face, face);
    EXPECT_EQ(sum(hits.ended_by_patch()), 1U);
    EXPECT_EQ(sum(hits.by_patch(environment)), 2U);
  }
}

TEST_F(WallHitsTest, AFaceEndsWhereTheCellBehindItIsFreed) {
  Environment environment(box(2));
  const Cell beside = environment.locate({0.5, 0.5, 0.5}).simplex.cell;
  environment.edit([&](ComplexEdit& e) { e.topology().set_free(beside, false); });
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{1.5, 0.5, 0.5}});
  WallHits hits;
  hits.add(environment, environment.advance(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}}).contacts);
  ASSERT_EQ(sum(hits.faces()), 1U);
  environment.edit([&](ComplexEdit& e) { e.topology().set_free(beside, true); });
  hits.update_after_edit(environment);
  EXPECT_TRUE(hits.faces().empty());
  EXPECT_EQ(sum(hits.ended_by_patch()), 1U);
}

// At an edge two walls meet the particle. It counts once, at the first of them.
TEST_F(WallHitsTest, AContactWithSeveralWallsCountsOnce) {
  Environment environment(box(1));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}});
  const StepReport report = environment.advance(particles, std::vector<Vec3>{{-1.0, -1.0, 0.5}});
  ASSERT_EQ(report.contacts.contacts.size(), 1U);
  const auto walls = report.contacts.walls_of(report.contacts.contacts[0]);
  ASSERT_GT(walls.size(), 1U);
  WallHits hits;
  hits.add(environment, report.contacts);
  ASSERT_EQ(hits.faces().size(), 1U);
  EXPECT_EQ(hits.faces()[0].face, walls.front().face);
  EXPECT_NE(hits.faces()[0].face, walls.back().face);
}

// A face between two cells is a wall of one, then of the other: these are two walls.
TEST_F(WallHitsTest, AWallSeenFromItsOtherSideIsAnotherWall) {
  Environment environment(box(2));
  WallHits hits;
  const Location at = environment.locate({1.5, 0.5, 0.5});
  const Location beside = environment.locate({0.5, 0.5, 0.5});
  environment.edit([&](ComplexEdit& e) { e.topology().set_free(beside.simplex.cell, false); });
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{1.5, 0.5, 0.5}});
  const StepReport report = environment.advance(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}});
  hits.add(environment, report.contacts);
  ASSERT_EQ(hits.faces().at(0).face.cell, at.simplex.cell);
  environment.edit([&](ComplexEdit& e) {
    e.topology().set_free(beside.simplex.cell, true);
    e.topology().set_free(at.simplex.cell, false);
  });
  hits.update_after_edit(environment);
  EXPECT_TRUE(hits.faces().empty());
  EXPECT_EQ(sum(hits.ended_by_patch()), 1U);
}

// Cuts through walls that particles hit: each wall that is at the same place afterwards has its hits, all others none.
TEST_F(WallHitsTest, OverACutTheyStayOnTheWallsThatAreThereAfterwards) {
  BoxOptions tissue;
  tissue.cells = {8, 4, 4};
  tissue.size = {8.0, 4.0, 4.0};
  tissue.blocked_layer = true;
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron}) {
    tissue.type = type;
    Environment environment(generate_box(tissue));
    Simulation simulation(environment, options());
    simulation.set_statistics(hits());
    simulation.add_random(400, {1.0, 0.5, 0.25});
    for (int i = 0; i < 20; ++i) simulation.step();
    const auto before = walls_by_place(environment);
    const std::vector<FaceHits> faces = simulation.statistics().hits.faces();
    std::map<CellFace, std::uint64_t> hits_before;
    for (const FaceHits& f : faces) hits_before[f.face] = f.hits;
    apply(simulation, {0.0, Cut{Disc{{4.0, 2.0, 1.0}, {1.0, 0.0, 0.0}, 0.75}, 0.25}, OrphanPolicy::relocate});
    const WallHits& after = simulation.statistics().hits;
    std::uint64_t kept = 0;
    std::size_t continued = 0;
    for (const auto& [place, face] : walls_by_place(environment)) {
      const auto was = before.find(place);
      const std::uint64_t expected = was == before.end() ? 0 : hits_before[was->second];
      EXPECT_EQ(after.of(face), expected) << face.cell.value << " " << face.face;
      kept += after.of(face);
      if (was != before.end() && was->second.cell != face.cell && expected > 0) ++continued;
    }
    EXPECT_GT(continued, 0U);  // some walls have another cell now
    EXPECT_LT(kept, sum(faces));
    EXPECT_EQ(kept, sum(after.faces()));
    EXPECT_EQ(kept + sum(after.ended_by_patch()), sum(faces));
    EXPECT_EQ(after.by_patch(environment), simulation.totals().contacts_by_patch);
    for (int i = 0; i < 20; ++i) simulation.step();
    EXPECT_EQ(after.by_patch(environment), simulation.totals().contacts_by_patch);
  }
}

// Cells are subdivided and merged at the end of steps: contacts of the step then name cells that are gone.
TEST_F(WallHitsTest, NoHitIsLostWhereCellsAreSubdividedAndMerged) {
  Environment environment(box(3));
  Simulation simulation(environment, options());
  simulation.set_statistics(hits());
  AdaptiveSubdivisionScene subdivision;
  subdivision.every = 2;
  subdivision.options.max_particles = 30;
  subdivision.options.min_particles = 12;
  simulation.set_adaptive_subdivision(subdivision);
  simulation.add_random(600, {1.5, 0.75, 0.5});
  for (int i = 0; i < 40; ++i) {
    simulation.step();
    ASSERT_EQ(simulation.statistics().hits.by_patch(environment), simulation.totals().contacts_by_patch) << i;
  }
  EXPECT_GT(simulation.event_log().subdivided, 0U);
  EXPECT_GT(simulation.event_log().merged, 0U);
  EXPECT_GT(sum(simulation.statistics().hits.ended_by_patch()), 0U);
}

TEST_F(WallHitsTest, GoOnFromACheckpoint) {
  const auto run = [](Simulation& simulation, int steps) {
    for (int i = 0; i < steps; ++i) simulation.step();
  };
  const auto make = [](Environment& environment) {
    auto simulation = std::make_unique<Simulation>(environment, options());
    simulation->set_statistics(hits());
    simulation->set_events({{0.5, Cut{Disc{{1.5, 1.5, 0.0}, {1.0, 0.0, 0.0}, 0.75}, 0.25}, OrphanPolicy::relocate}});
    return simulation;
  };
  BoxOptions tissue;
  tissue.cells = {4, 4, 4};
  tissue.size = {4.0, 4.0, 4.0};
  tissue.blocked_layer = true;
  Environment one(generate_box(tissue));
  const auto whole = make(one);
  whole->add_random(300, {1.0, 0.5, 0.25});
  run(*whole, 20);
  const SimulationCheckpoint saved = whole->checkpoint();
  run(*whole, 20);
  Environment two(generate_box(tissue));
  const auto resumed = make(two);
  resumed->restore(saved);
  EXPECT_LT(sum(resumed->statistics().hits.faces()), sum(whole->statistics().hits.faces()));
  run(*resumed, 20);
  EXPECT_EQ(resumed->statistics().hits.faces(), whole->statistics().hits.faces());
  EXPECT_EQ(resumed->statistics().hits.ended_by_patch(), whole->statistics().hits.ended_by_patch());
  Environment three(generate_box(tissue));
  Simulation without(three, options());
  EXPECT_THROW(without.restore(saved), InvalidArgument);
}

// In the plane the faces are edges: one with a vertex on it is two.
TEST_F(WallHitsTest, InThePlaneAnEdgeThatIsSplitEnds) {
  RectangleOptions rectangle;
  rectangle.cells = {2, 1};
  rectangle.size = {2.0, 1.0};
  Environment environment(generate_rectangle(rectangle));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.0}, {1.5, 0.5, 0.0}});
  const StepReport report = environment.advance(particles, std::vector<Vec3>{{0.5, -1.0, 0.0}, {1.5, -1.0, 0.0}});
  WallHits hits;
  hits.add(environment, report.contacts);
  ASSERT_EQ(hits.faces().size(), 2U);
  const CellFace face = hits.faces()[0].face;
  environment.edit([&](ComplexEdit& e) {
    split_edge(e.topology(), {face.cell, e.map().shape(face.cell).first_dart(face.face)});
  });
  hits.update_after_edit(environment);
  ASSERT_EQ(hits.faces().size(), 1U);
  EXPECT_EQ(sum(hits.ended_by_patch()), 1U);
}

TEST_F(WallHitsTest, AreNotRestoredToWhatIsNoWall) {
  Environment environment(box(3));
  WallHits hits;
  const Cell middle = environment.locate({1.5, 1.5, 1.5}).simplex.cell;
  EXPECT_THROW(hits.restore(environment, {{{middle, 0}, {}, 1}}, {}), InvalidArgument);
  EXPECT_THROW(hits.restore(environment, {{{Cell{1, 99}, 0}, {}, 1}}, {}), InvalidArgument);
}

}  // namespace dartcast::wall_hits_test
