// Edits while particles move: who is touched is located again exactly, all others keep every bit, and nobody is lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "dartcast/audit.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/response.hpp"
#include "support/edit_meshes.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/particle_checks.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"

namespace dartcast::edits_test {

using test::cell_at;
using test::same_bits;

std::vector<Vec3> jittered(const Particles& particles, Random& random, double by, unsigned dimension = 3) {
  std::vector<Vec3> targets;
  for (const ParticleState& s : particles.states()) {
    const Vec3 by_random{random.uniform(-by, by), random.uniform(-by, by), random.uniform(-by, by)};
    targets.push_back(s.position + Vec3{by_random.x, by_random.y, dimension == 2 ? 0.0 : by_random.z});
  }
  return targets;
}

// The face between two cells, as the first sees it.
CellFace face_between(const CombinatorialMap& map, Cell a, Cell b) {
  for (std::uint16_t f = 0; f < map.shape(a).face_count(); ++f) {
    if (map.view(a).neighbour(f) == b) return {a, f};
  }
  return {};
}

// Everything that must hold of particles that followed an edit; `before`: their states before it.
void expect_followed(const ComplexEditReport& edit, const UpdateReport& report,
                     const std::vector<ParticleState>& before, const Particles& after) {
  std::set<Cell> touched;
  for (const CellHandle& h : edit.map.removed) touched.insert(h.cell);
  touched.insert(edit.map.marked.begin(), edit.map.marked.end());
  std::map<std::uint32_t, OrphanedParticle> orphaned;
  for (const OrphanedParticle& p : report.orphaned) orphaned[p.particle] = p;
  std::uint64_t at_touched = 0;
  std::size_t j = 0;  // absorbed particles leave gaps
  for (std::uint32_t i = 0; i < before.size(); ++i) {
    const ParticleState& s = before[i];
    at_touched += touched.count(s.cell) != 0 || std::any_of(s.touching.begin(), s.touching.begin() + s.touching_count,
                                                            [&](CellFace f) { return touched.count(f.cell) != 0; })
                      ? 1
                      : 0;
    const auto found = orphaned.find(i);
    if (found != orphaned.end() && found->second.outcome == OrphanPolicy::absorb) continue;
    const ParticleState& now = after[j++];
    if (found == orphaned.end() && !before[i].held) ASSERT_EQ(test::bits(now.position), test::bits(before[i].position));
    if (touched.count(before[i].cell) != 0 || before[i].touching_count > 0) continue;
    ASSERT_TRUE(same_bits(now, before[i])) << "particle " << i << " was not touched";
  }
  ASSERT_EQ(j, after.size());
  ASSERT_EQ(report.touched, at_touched);
}

class Edits : public testing::TestWithParam<test::EditMesh> {};

// A scene that turns, with particles that slide, and edits at random in between.
class EditedScene {
 public:
  EditedScene(const MeshData& mesh, OrphanPolicy orphaned)
      : environment_(mesh),
        random_(static_cast<std::uint64_t>(orphaned) + 1),
        orphaned_(orphaned),
        rest_(environment_.positions().begin(), environment_.positions().end()),
        bag_(environment_.map()),
        usual_(bag_.size()) {
    const bool flat = environment_.map().dimension() == 2;
    environment_.add(particles_, test::random_points(250, {0.0, 0.0, 0.0}, {1.0, 1.0, flat ? 0.0 : 1.0}, random_));
  }

  void edit() {
    ComplexEditReport done;
    try {
      const test::EditKind kind = test::draw_kind(bag_, usual_, random_, environment_.map().dimension());
      done = environment_.edit([&](ComplexEdit& e) {
        const Cell c = bag_.draw(e.map(), random_);
        test::apply(e.topology(), test::draw_edit(e.map(), kind, c, bag_, random_));
      });
    } catch (const Error&) {
      return;
    }
    ++edits;
    bag_.update(done.map);
    ASSERT_TRUE(check_integrity(environment_.map(), done.map.added, 1).empty());
    const std::vector<ParticleState> before = test::copy_of(particles_);
    const UpdateReport report = environment_.update_after_edit(particles_, orphaned_);
    expect_followed(done, report, before, particles_);
    update_after_edit(done, environment_.positions().size(), rest_);
    for (const PlacedVertex& p : done.placed) rest_[p.vertex.value] = environment_.positions()[p.vertex.value];
    located += report.located;
    left += report.orphaned.size();
  }

  void move(double turn) {
    const auto next = environment_.next_positions();
    for (std::size_t v = 0; v < next.size(); ++v) next[v] = rest_[v] + Vec3{turn * rest_[v].y, -turn * rest_[v].x, 0.0};
    environment_.move();
  }

  void advance() {
    const ContactCallback slide = [](const Contact& c, std::span<const WallHit> walls, auto) {
      const Vec3 n = walls[0].normal;
      return AfterContact{c.unused - n * dot(c.unused, n), true};
    };
    environment_.advance(particles_, jittered(particles_, random_, 0.2, environment_.map().dimension()), slide);
  }

  void check() const { test::expect_audited(environment_.complex(), particles_); }
  void check_all() const { ASSERT_TRUE(check_integrity(environment_.map(), 1).empty()); }

  int edits = 0;
  std::uint64_t located = 0;
  std::size_t left = 0;

 private:
  Environment environment_;
  Random random_;
  OrphanPolicy orphaned_;
  Particles particles_;
  std::vector<Vec3> rest_;
  test::CellBag bag_;
  std::size_t usual_;
};

// Ten edits are tried in each step: 10^4 in all, 10^6 in the full tier.
TEST_P(Edits, LoseNobody) {
  for (const OrphanPolicy orphaned : {OrphanPolicy::hold, OrphanPolicy::relocate, OrphanPolicy::absorb}) {
    EditedScene scene(GetParam().make(), orphaned);
    for (int step = 0; step < test::scaled(48, 4800); ++step) {
      for (int i = 0; i < 10; ++i) ASSERT_NO_FATAL_FAILURE(scene.edit());
      ASSERT_NO_FATAL_FAILURE(scene.check());
      if (step % 3 == 0) scene.move(0.02 * (step % 5));
      scene.advance();
      ASSERT_NO_FATAL_FAILURE(scene.check());
      if (step % 10 == 0) ASSERT_NO_FATAL_FAILURE(scene.check_all());
    }
    if (test::sanitized()) continue;
    EXPECT_GT(scene.edits, test::scaled(100, 2500));
    EXPECT_GT(scene.located, 100U);
    EXPECT_GT(scene.left, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, Edits, testing::ValuesIn(test::all_edit_meshes()),
                         [](const auto& mesh) { return std::string(mesh.param.name); });

// The paper's first case: two cells are sewn, and a particle crosses where there was a wall.
TEST(FollowEdit, OpensTheWayWhereCellsAreSewn) {
  Environment environment(test::unit_box({2, 1, 1}));
  const Cell left = cell_at(environment, {0.5, 0.5, 0.5});
  const Cell right = cell_at(environment, {1.5, 0.5, 0.5});
  environment.edit([&](ComplexEdit& e) { unsew(e.topology(), face_between(e.map(), left, right)); });
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.25, 0.375}, {1.5, 0.5, 0.5}});
  const std::vector<Vec3> across = {{1.75, 0.25, 0.375}, {1.5, 0.5, 0.5}};
  const StepReport stopped = environment.advance(particles, across);
  ASSERT_EQ(stopped.contacts.contacts.size(), 1U);
  EXPECT_EQ(particles[0].position.x, 1.0);
  EXPECT_EQ(particles[0].touching_count, 1);

  environment.edit([&](ComplexEdit& e) {
    const CombinatorialMap& map = e.map();
    const Cell a = particles[0].cell;
    const Cell b = particles[1].cell;
    for (std::uint16_t d = 0; d < map.shape(a).dart_count(); ++d) {
      if (map.phi3({a, d}).valid() || e.position(map.origin({a, d})).x != 1.0) continue;
      for (std::uint16_t f = 0; f < map.shape(b).dart_count(); ++f) {
        const bool same = e.position(map.origin({a, d})) == e.position(map.origin(map.phi1({b, f}))) &&
                          e.position(map.origin(map.phi1({a, d}))) == e.position(map.origin({b, f})) &&
                          e.position(map.origin(map.phi_1({a, d}))).x == 1.0 &&
                          e.position(map.origin(map.phi_1({b, f}))).x == 1.0;
        if (same) {
          sew(e.topology(), {a, d}, {b, f});
          return;
        }
      }
    }
  });
  const UpdateReport report = environment.update_after_edit(particles);
  EXPECT_EQ(report.touched, 2U);
  EXPECT_EQ(report.located, 2U);
  EXPECT_TRUE(report.orphaned.empty());
  EXPECT_EQ(particles[0].touching_count, 0);  // it touches no wall any more
  EXPECT_TRUE(environment.advance(particles, across).contacts.contacts.empty());
  EXPECT_EQ(particles[0].position, across[0]);
  test::expect_audited(environment.complex(), particles);
}

// The second: cells are merged, a particle's cell is another but its place is not; far away nobody is touched.
TEST(FollowEdit, LocatesInTheCellThatWasSimplified) {
  Environment environment(test::unit_box({4, 1, 1}));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.25}, {1.25, 0.5, 0.5}, {3.5, 0.5, 0.5}});
  const std::vector<ParticleState> before = test::copy_of(particles);
  const CellHandle stale = environment.map().handle(before[0].cell);
  environment.edit(
      [&](ComplexEdit& e) { merge_cells(e.topology(), face_between(e.map(), before[0].cell, before[1].cell)); });
  EXPECT_FALSE(environment.map().contains(stale));
  const UpdateReport report = environment.update_after_edit(particles);
  EXPECT_EQ(report.touched, 2U);
  EXPECT_EQ(report.located, 2U);
  EXPECT_EQ(particles[0].cell, particles[1].cell);
  EXPECT_EQ(particles[0].position, before[0].position);
  EXPECT_TRUE(same_bits(particles[2], before[2]));
  test::expect_audited(environment.complex(), particles);
}

// The darts of a face that start at x = 0.5.
std::vector<Dart> middle_darts(ComplexEdit& e, Cell c, std::uint16_t f) {
  std::vector<Dart> darts;
  for (unsigned i = 0; i < e.map().shape(c).degree(f); ++i) {
    const Dart d{c, static_cast<std::uint16_t>(e.map().shape(c).first_dart(f) + i)};
    if (e.position(e.map().origin(d)).x == 0.5) darts.push_back(d);
  }
  return darts;
}

// The third: a cell is cut in two, each particle is in the half where it lies; the cut then opened is a wall.
TEST(FollowEdit, LocatesInTheHalfThatItIsIn) {
  Environment environment(test::unit_box({1, 1, 1}));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.25, 0.5, 0.5}, {0.75, 0.5, 0.5}, {0.5, 0.25, 0.125}});
  environment.edit([&](ComplexEdit& e) {
    // A vertex in the middle of each edge along x, an edge around through these, a face in between.
    for (int k = 0; k < 4; ++k) {
      const Cell c = e.map().cells().front();
      for (std::uint16_t d = 0; d < e.map().shape(c).dart_count(); ++d) {
        const Vec3 a = e.position(e.map().origin({c, d}));
        const Vec3 b = e.position(e.map().origin(e.map().phi1({c, d})));
        if (a.x == 0.0 && b.x == 1.0) {
          split_edge(e.topology(), {c, d});
          break;
        }
      }
    }
    for (int k = 0; k < 4; ++k) {
      const Cell c = e.map().cells().front();
      for (std::uint16_t f = 0; f < e.map().shape(c).face_count(); ++f) {
        const auto ends = middle_darts(e, c, f);
        if (ends.size() != 2 || e.map().shape(c).degree(f) != 6) continue;
        split_face(e.topology(), ends[0], ends[1]);
        break;
      }
    }
    const Cell c = e.map().cells().front();
    std::vector<Dart> path;
    for (std::uint16_t d = 0; d < e.map().shape(c).dart_count() && path.empty(); ++d) {
      const Dart dart{c, d};
      if (e.position(e.map().origin(dart)).x == 0.5 && e.position(e.map().origin(e.map().phi1(dart))).x == 0.5)
        path.push_back(dart);
    }
    while (path.size() < 4) {
      Dart next = e.map().phi1(path.back());
      while (e.position(e.map().origin(e.map().phi1(next))).x != 0.5 || next == e.map().phi2(path.back()))
        next = e.map().alpha1(next);
      path.push_back(next);
    }
    split_cell(e.topology(), path);
  });
  const UpdateReport report = environment.update_after_edit(particles);
  EXPECT_EQ(report.located, 3U);
  EXPECT_NE(particles[0].cell, particles[1].cell);
  test::expect_audited(environment.complex(), particles);
  environment.edit(
      [&](ComplexEdit& e) { unsew(e.topology(), face_between(e.map(), particles[0].cell, particles[1].cell)); });
  environment.update_after_edit(particles);
  test::expect_audited(environment.complex(), particles);
  const std::vector<Vec3> across = {{0.75, 0.5, 0.5}, {0.25, 0.5, 0.5}, {0.5, 0.25, 0.5}};
  EXPECT_GE(environment.advance(particles, across).contacts.contacts.size(), 2U);
  test::expect_audited(environment.complex(), particles);
}

class LeftInABlockedCell : public testing::Test {
 protected:
  LeftInABlockedCell() {
    environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.25}, {1.25, 0.5, 0.5}, {2.5, 0.5, 0.5}});
  }

  void block_the_middle(bool free = false) {
    environment.edit([&](ComplexEdit& e) { e.topology().set_free(middle, free); });
  }

  Environment environment = Environment(test::unit_box({3, 1, 1}));
  Particles particles;
  Cell middle = cell_at(environment, {1.5, 0.5, 0.5});
};

TEST_F(LeftInABlockedCell, MovesToTheNearestFreePlace) {
  block_the_middle();
  const UpdateReport report = environment.update_after_edit(particles, OrphanPolicy::relocate);
  EXPECT_EQ(report.touched, 1U);
  ASSERT_EQ(report.orphaned.size(), 1U);
  EXPECT_EQ(report.orphaned[0].particle, 1U);
  EXPECT_EQ(report.orphaned[0].place, Place::blocked);
  EXPECT_EQ(report.orphaned[0].outcome, OrphanPolicy::relocate);
  EXPECT_EQ(report.orphaned[0].distance, 0.25);
  EXPECT_EQ(particles[1].position, (Vec3{1.0, 0.5, 0.5}));
  EXPECT_EQ(particles[1].cell, particles[0].cell);
  test::expect_audited(environment.complex(), particles);
}

TEST_F(LeftInABlockedCell, StaysAndIsCarriedAlongUntilItsCellIsFree) {
  block_the_middle();
  const UpdateReport report = environment.update_after_edit(particles, OrphanPolicy::hold);
  ASSERT_EQ(report.orphaned.size(), 1U);
  EXPECT_EQ(report.orphaned[0].outcome, OrphanPolicy::hold);
  EXPECT_TRUE(particles[1].held);
  const std::vector<Vec3> right = {{0.5, 0.5, 0.25}, {1.75, 0.5, 0.5}, {2.5, 0.5, 0.5}};
  StepReport step = environment.advance(particles, right);
  ASSERT_EQ(step.held.size(), 1U);
  EXPECT_EQ(step.held[0].cell, middle);
  EXPECT_EQ(particles[1].position, (Vec3{1.25, 0.5, 0.5}));
  const auto shifted = [&](double by) {
    std::vector<Vec3> x(environment.positions().begin(), environment.positions().end());
    for (Vec3& v : x) v.y += by;
    return x;
  };
  environment.move(shifted(0.5));
  step = environment.advance(particles, right);
  EXPECT_EQ(step.held.size(), 1U);
  EXPECT_NEAR(particles[1].position.y, 1.0, 1e-15);
  EXPECT_TRUE(particles[1].held);
  test::expect_audited(environment.complex(), particles);
  EXPECT_NO_THROW(
      static_cast<void>(environment.restored(particles.states(), std::vector<Weights>(3, particles.held_weights(1)))));
  block_the_middle(true);
  EXPECT_TRUE(environment.update_after_edit(particles).orphaned.empty());
  EXPECT_FALSE(particles[1].held);
  test::expect_audited(environment.complex(), particles);
  const std::vector<Vec3> on = {particles[0].position, {1.75, 1.0, 0.5}, particles[2].position};
  EXPECT_TRUE(environment.advance(particles, on).held.empty());
  EXPECT_EQ(particles[1].position, on[1]);
}

TEST_F(LeftInABlockedCell, IsAbsorbed) {
  block_the_middle();
  const ParticleState last = particles[2];
  const UpdateReport report = environment.update_after_edit(particles, OrphanPolicy::absorb);
  ASSERT_EQ(report.orphaned.size(), 1U);
  EXPECT_EQ(report.orphaned[0].position, (Vec3{1.25, 0.5, 0.5}));
  ASSERT_EQ(particles.size(), 2U);
  EXPECT_TRUE(same_bits(particles[1], last));
}

TEST_F(LeftInABlockedCell, IsAbsorbedWhereThereIsNoFreeCell) {
  environment.edit([&](ComplexEdit& e) {
    for (const Cell c : e.map().cells()) e.topology().set_free(c, false);
  });
  const UpdateReport report = environment.update_after_edit(particles, OrphanPolicy::relocate);
  EXPECT_EQ(report.orphaned.size(), 3U);
  for (const OrphanedParticle& p : report.orphaned) EXPECT_EQ(p.outcome, OrphanPolicy::absorb);
  EXPECT_EQ(particles.size(), 0U);
}

TEST_F(LeftInABlockedCell, AndOutsideWhereACellIsRemoved) {
  environment.edit([&](ComplexEdit& e) { remove(e.topology(), middle); });
  const UpdateReport report = environment.update_after_edit(particles, OrphanPolicy::hold);
  ASSERT_EQ(report.orphaned.size(), 1U);
  EXPECT_EQ(report.orphaned[0].place, Place::outside);
  EXPECT_EQ(report.orphaned[0].outcome, OrphanPolicy::relocate);  // it can't stay where there is nothing
  EXPECT_EQ(particles[1].position, (Vec3{1.0, 0.5, 0.5}));
  test::expect_audited(environment.complex(), particles);
}

// A wall that a particle rests on is taken away, from the other side.
TEST_F(LeftInABlockedCell, ForgetsAWallThatIsNoneAnyMore) {
  block_the_middle();
  environment.update_after_edit(particles, OrphanPolicy::absorb);
  const std::vector<Vec3> right = {{1.5, 0.5, 0.25}, particles[1].position};
  environment.advance(particles, right);
  ASSERT_EQ(particles[0].touching_count, 1);
  EXPECT_EQ(particles[0].position.x, 1.0);
  block_the_middle(true);
  environment.update_after_edit(particles);
  EXPECT_EQ(particles[0].touching_count, 0);
  EXPECT_TRUE(environment.advance(particles, right).contacts.contacts.empty());
}

TEST_F(LeftInABlockedCell, MustFollowEachEdit) {
  block_the_middle();
  EXPECT_THROW(environment.advance(particles, std::vector<Vec3>(3)), InvalidArgument);
  EXPECT_THROW(environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}}), InvalidArgument);
  block_the_middle(true);
  EXPECT_THROW(environment.update_after_edit(particles), InvalidArgument);
  Particles others;
  EXPECT_NO_THROW(environment.add(others, std::vector<Vec3>{{0.5, 0.5, 0.5}}));
  environment.move(std::vector<Vec3>(environment.positions().begin(), environment.positions().end()));
  block_the_middle();
  EXPECT_NO_THROW(environment.update_after_edit(others));  // it goes along with the move first
  EXPECT_NO_THROW(environment.advance(others, std::vector<Vec3>{{0.5, 0.5, 0.5}}));
}

TEST_F(LeftInABlockedCell, AnEditThatIsRefusedIsNone) {
  const CombinatorialMap before = environment.map();
  EXPECT_THROW(environment.edit([&](ComplexEdit& e) {
    e.topology().set_free(middle, false);
    remove(e.topology(), middle);
    remove(e.topology(), middle);
  }),
               InvalidArgument);
  EXPECT_TRUE(environment.map().contains(middle));
  EXPECT_TRUE(environment.map().is_free(middle));
  EXPECT_NO_THROW(environment.advance(particles, std::vector<Vec3>(3, {0.5, 0.5, 0.5})));
}

TEST(FollowEdit, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::string> hashes;
  for (const unsigned threads : {1U, 2U, 4U}) {
    Environment environment(test::edit_box(CellType::hexahedron), {threads});
    Random random(3);
    Particles particles;
    environment.add(particles, test::random_points(5000, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, random));
    test::CellBag bag(environment.map());
    for (int step = 0; step < test::scaled(40, 400); ++step) {
      try {
        bag.update(environment
                       .edit([&](ComplexEdit& e) {
                         for (int k = 0; k < 4; ++k) {
                           const Cell c =
                               e.map().cells()[random.below(static_cast<std::uint32_t>(e.map().cell_count()))];
                           const auto kind = k % 2 == 0 ? test::EditKind::split_edge : test::EditKind::mark;
                           test::apply(e.topology(), test::draw_edit(e.map(), kind, c, bag, random));
                         }
                       })
                       .map);
        environment.update_after_edit(particles);
      } catch (const EditRefused&) {
      }
      environment.advance(particles, jittered(particles, random, 0.1));
    }
    StateHash hash;
    for (std::size_t i = 0; i < particles.size(); ++i) hash.add(i, particles[i], {});
    hashes.push_back(hash.hex());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

}  // namespace dartcast::edits_test
