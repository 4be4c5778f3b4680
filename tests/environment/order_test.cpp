// Moves, edits, advances and follows in any order: no set of particles is left that can do neither of the last two.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "complex/simplex.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "support/edit_meshes.hpp"
#include "support/expectations.hpp"
#include "support/particle_checks.hpp"
#include "support/random_edits.hpp"
#include "support/tier.hpp"
#include "tracking/carry.hpp"

namespace dartcast::order_test {

using test::error_text;
using test::same_bits;

std::vector<Vec3> places_of(const Particles& particles) {
  std::vector<Vec3> places;
  for (const ParticleState& s : particles.states()) places.push_back(s.position);
  return places;
}

// An environment with the means to change it, the same for the same seed.
class Scene {
 public:
  Scene(const MeshData& mesh, std::uint64_t seed)
      : environment(mesh, Threads{2}),
        random(seed),
        rest_(environment.positions().begin(), environment.positions().end()),
        bag_(environment.map()),
        usual_(bag_.size()) {}

  [[nodiscard]] bool flat() const { return environment.map().dimension() == 2; }

  std::vector<Vec3> points(std::size_t n) {
    return test::random_points(n, {0.0, 0.0, 0.0}, {1.0, 1.0, flat() ? 0.0 : 1.0}, random);
  }

  // Vertices go where they were at first, and a little further; some cells are turned inside out where it is strong.
  void move(double strength) {
    std::vector<Vec3> next = rest_;
    for (Vec3& x : next) {
      x += Vec3{strength * random.uniform(-1.0, 1.0), strength * random.uniform(-1.0, 1.0),
                flat() ? 0.0 : strength * random.uniform(-1.0, 1.0)};
    }
    environment.move(next);
  }

  // The next edit that is not refused, or none.
  bool edit(int tries = 30) {
    for (int i = 0; i < tries; ++i) {
      const test::EditKind kind = test::draw_kind(bag_, usual_, random, environment.map().dimension());
      try {
        const ComplexEditReport done = environment.edit([&](ComplexEdit& e) {
          const Cell c = bag_.draw(e.map(), random);
          test::apply(e.topology(), test::draw_edit(e.map(), kind, c, bag_, random));
        });
        bag_.update(done.map);
        update_after_edit(done, environment.positions().size(), rest_);
        return true;
      } catch (const Error&) {
      }
    }
    return false;
  }

  // Targets of particles that have no motion of their own, after a move.
  [[nodiscard]] std::vector<Vec3> carried(const Particles& particles) const {
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i)
      targets.push_back(flat() ? carried<3>(particles, i) : carried<4>(particles, i));
    return targets;
  }

  Environment environment;
  Random random;

 private:
  template <std::size_t N>
  [[nodiscard]] Vec3 carried(const Particles& particles, std::size_t i) const {
    const ParticleState& s = particles[i];
    const auto now = current_space<N>(environment.complex());
    const auto before = previous_space<N>(environment.complex()).corners(s.at());
    if (volume_sign(now.corners(s.at())) != Sign::positive) return s.position;
    const Weights w = s.held ? particles.held_weights(i) : detail::barycentric(before, s.position);
    return detail::carried(now, s.at(), w).position;
  }

  std::vector<Vec3> rest_;
  test::CellBag bag_;
  std::size_t usual_;
};

// Two scenes that do the same in another order.
struct Twins {
  Scene a, b;
  Particles in_a, in_b;

  Twins(const MeshData& mesh, std::uint64_t seed) : a(mesh, seed), b(mesh, seed) {
    a.environment.add(in_a, a.points(200));
    b.environment.add(in_b, b.points(200));
  }
};

class Orders : public testing::TestWithParam<test::EditMesh> {};

constexpr std::array all_policies = {OrphanPolicy::hold, OrphanPolicy::relocate, OrphanPolicy::absorb};

// A particle that follows an edit made after a move is where it would be, had the move carried it before the edit.
TEST_P(Orders, AMoveThenAnEditIsFollowed) {
  std::size_t changed = 0;
  for (int run = 0; run < test::scaled(12, 400); ++run) {
    Twins t(GetParam().make(), static_cast<std::uint64_t>(run));
    const OrphanPolicy orphaned = all_policies[static_cast<std::size_t>(run) % 3];
    for (int step = 0; step < 6; ++step) {
      const double strength = step == 4 ? 0.2 : 0.01;
      t.a.move(strength);
      t.b.move(strength);
      t.a.environment.advance(t.in_a, t.a.carried(t.in_a));
      const bool edited = t.a.edit();
      ASSERT_EQ(t.b.edit(), edited);
      if (!edited) break;
      const UpdateReport in_turn = t.a.environment.update_after_edit(t.in_a, orphaned);
      const UpdateReport late = t.b.environment.update_after_edit(t.in_b, orphaned);
      changed += in_turn.located;
      ASSERT_EQ(in_turn.orphaned.size(), late.orphaned.size());
      ASSERT_TRUE(same_bits(test::copy_of(t.in_a), t.in_b)) << "run " << run << ", step " << step;
      EXPECT_FALSE(t.b.environment.awaits_advance(t.in_b));
      const Audit found = audit(t.b.environment.complex(), t.in_b);
      ASSERT_EQ(found.failed, 0U) << found.first;
      // The caches beside the states belong to the new places, too.
      const std::vector<Vec3> on = t.a.points(t.in_a.size());
      ASSERT_EQ(t.b.points(t.in_b.size()).size(), on.size());
      t.a.environment.advance(t.in_a, on);
      t.b.environment.advance(t.in_b, on);
      ASSERT_TRUE(same_bits(test::copy_of(t.in_a), t.in_b)) << "run " << run << ", step " << step;
    }
  }
  if (!test::sanitized()) EXPECT_GT(changed, 50U);
}

// An edit may be followed after the next move, too: as if that had not been made yet.
TEST_P(Orders, AnEditThenAMoveIsFollowed) {
  for (int run = 0; run < test::scaled(12, 400); ++run) {
    Twins t(GetParam().make(), static_cast<std::uint64_t>(run) + 1000);
    const OrphanPolicy orphaned = all_policies[static_cast<std::size_t>(run) % 3];
    for (int step = 0; step < 6; ++step) {
      const bool edited = t.a.edit();
      ASSERT_EQ(t.b.edit(), edited);
      if (!edited) break;
      t.a.environment.update_after_edit(t.in_a, orphaned);
      const double strength = step == 4 ? 0.2 : 0.01;
      t.a.move(strength);
      t.b.move(strength);
      t.b.environment.update_after_edit(t.in_b, orphaned);
      ASSERT_TRUE(same_bits(test::copy_of(t.in_a), t.in_b)) << "run " << run << ", step " << step;
      EXPECT_TRUE(t.b.environment.awaits_advance(t.in_b));
      const std::vector<Vec3> on = t.a.points(t.in_a.size());
      ASSERT_EQ(t.b.points(t.in_b.size()).size(), on.size());
      t.a.environment.advance(t.in_a, on);
      t.b.environment.advance(t.in_b, on);
      ASSERT_TRUE(same_bits(test::copy_of(t.in_a), t.in_b)) << "run " << run << ", step " << step;
      const Audit found = audit(t.b.environment.complex(), t.in_b);
      ASSERT_EQ(found.failed, 0U) << found.first;
    }
  }
}

// --- any order

// Sets of particles in one environment, and what each has gone along with so far.
class Machine {
 public:
  Machine(const MeshData& mesh, std::uint64_t seed) : scene_(mesh, seed) {}

  void act() {
    Set& set = sets_[scene_.random.below(set_count)];
    switch (scene_.random.below(12)) {
      case 0:
      case 1: move(); break;
      case 2:
      case 3: edit(); break;
      case 4:
      case 5: advance(set); break;
      case 6:
      case 7: update_after_edit(set); break;
      case 8: add(set); break;
      case 9: thin_out(set); break;
      case 10: part_and_join(set); break;
      default: restore(set); break;
    }
  }

  // Every set that is not empty can advance or follow; those that have followed everything are where they say.
  void check() {
    for (const Set& set : sets_) {
      if (set.particles.size() == 0) continue;
      Particles tried = set.particles;
      const std::string advanced = error_text([&] { scene_.environment.advance(tried, places_of(tried)); });
      if (!advanced.empty()) {
        ASSERT_NE(advanced.find("update_after_edit()"), std::string::npos) << advanced;
        ASSERT_TRUE(same_bits(test::copy_of(set.particles), tried));
        ASSERT_EQ(error_text([&] { scene_.environment.update_after_edit(tried); }), "");
        ASSERT_EQ(error_text([&] { scene_.environment.advance(tried, places_of(tried)); }), "");
      }
      const Audit found = audit(scene_.environment.complex(), tried);
      ASSERT_EQ(found.failed, 0U) << found.first;
      if (!is_current(set)) continue;
      const Audit here = audit(scene_.environment.complex(), set.particles);
      ASSERT_EQ(here.failed, 0U) << here.first;
    }
    check_late();
  }

  int late_refused = 0;
  int remedies = 0;

 private:
  static constexpr std::uint32_t set_count = 3;

  struct Set {
    Particles particles;
    int moves = 0;
    int edits = 0;
  };

  [[nodiscard]] bool is_current(const Set& s) const { return s.moves == moves_ && s.edits == edits_; }

  // The contract: once after each move a set advances, or follows a later edit; it follows each edit before the next.
  template <class Missing>
  [[nodiscard]] bool all_have(const Missing& has) const {
    return std::all_of(sets_.begin(), sets_.end(), [&](const Set& s) { return s.particles.size() == 0 || has(s); });
  }

  void move() {
    if (!all_have([&](const Set& s) { return s.moves == moves_; })) return;
    scene_.move(scene_.random.below(4) == 0 ? 0.2 : 0.01);
    ++moves_;
  }

  void edit() {
    if (!all_have([&](const Set& s) { return s.edits == edits_; })) return;
    if (!late_) late_ = sets_[scene_.random.below(set_count)];
    if (!scene_.edit(5)) return;
    ++edits_;
    moves_at_edit_ = moves_;
  }

  void advance(Set& set) {
    const std::vector<Vec3> targets = scene_.points(set.particles.size());
    const std::vector<ParticleState> before = test::copy_of(set.particles);
    const std::string why = error_text([&] { scene_.environment.advance(set.particles, targets); });
    if (set.particles.size() > 0 && set.edits != edits_) {
      ASSERT_NE(why.find("update_after_edit()"), std::string::npos) << why;
      ASSERT_TRUE(same_bits(before, set.particles));
      return;
    }
    ASSERT_EQ(why, "");
    set.moves = moves_;
    set.edits = edits_;
  }

  void update_after_edit(Set& set) {
    const auto orphaned = all_policies[scene_.random.below(3)];
    const std::size_t size = set.particles.size();
    ASSERT_EQ(error_text([&] {
                const UpdateReport report = scene_.environment.update_after_edit(set.particles, orphaned);
                const auto gone = std::count_if(report.orphaned.begin(), report.orphaned.end(),
                                                [](const auto& p) { return p.outcome == OrphanPolicy::absorb; });
                ASSERT_EQ(set.particles.size() + static_cast<std::size_t>(gone), size);
              }),
              "");
    if (set.edits != edits_ && moves_at_edit_ == moves_) set.moves = moves_;
    set.edits = edits_;
  }

  void add(Set& set) {
    const std::vector<Vec3> places = scene_.points(20);
    const std::vector<ParticleState> before = test::copy_of(set.particles);
    for (int tries = 0;; ++tries) {
      const std::string why = error_text([&] { scene_.environment.add(set.particles, places); });
      if (why.empty()) break;
      ASSERT_LT(tries, 2);
      ASSERT_TRUE(tries > 0 || same_bits(before, set.particles));
      ASSERT_FALSE(is_current(set));
      // It names what to do first.
      if (why.find("update_after_edit()") != std::string::npos)
        update_after_edit(set);
      else if (why.find("advance") != std::string::npos)
        advance(set);
      else
        FAIL() << why;
    }
    set.moves = moves_;
    set.edits = edits_;
  }

  void thin_out(Set& set) {
    std::vector<std::uint8_t> marks(set.particles.size());
    const std::uint32_t share = scene_.random.below(4);
    for (auto& m : marks) m = scene_.random.below(4) <= share ? 1 : 0;
    set.particles.remove(marks);
  }

  // Some go on alone for a while, and come back.
  void part_and_join(Set& set) {
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 0; i < set.particles.size(); i += 2) which.push_back(i);
    Set some = {set.particles.selected(which), set.moves, set.edits};
    if (some.particles.size() == 0) return;
    if (set.edits == edits_ && set.moves == moves_) {
      advance(some);
      ASSERT_EQ(error_text([&] { set.particles.replace(which, some.particles); }), "");
      return;
    }
    const std::vector<ParticleState> before = test::copy_of(set.particles);
    if (set.edits != edits_)
      update_after_edit(some);
    else
      advance(some);
    if (some.particles.size() != which.size()) return;
    const std::string why = error_text([&] { set.particles.replace(which, some.particles); });
    ASSERT_NE(why, "");
    ASSERT_TRUE(same_bits(before, set.particles));
    // The remedy: the whole set does the same.
    if (set.edits != edits_)
      update_after_edit(set);
    else
      advance(set);
    if (set.particles.size() != before.size()) return;
    ASSERT_EQ(error_text([&] { set.particles.replace(which, some.particles); }), "");
  }

  void restore(Set& set) {
    if (!is_current(set)) return;
    std::vector<Weights> weights;
    for (std::size_t i = 0; i < set.particles.size(); ++i) weights.push_back(set.particles.held_weights(i));
    set.particles = scene_.environment.restored(set.particles.states(), weights);
  }

  // A copy that nobody has cared for, and that has missed an edit or a move by now: it is refused, and the remedy does.
  void check_late() {
    if (!late_) return;
    if (late_->particles.size() == 0) return late_.reset();
    if (late_->moves + 2 > moves_ && late_->edits + 2 > edits_) return;
    Particles& particles = late_->particles;
    const std::vector<ParticleState> before = test::copy_of(particles);
    const std::vector<Vec3> places = places_of(particles);
    for (const auto& call : std::vector<std::function<void()>>{
             [&] { scene_.environment.advance(particles, places); },
             [&] { scene_.environment.update_after_edit(particles); },
             [&] { scene_.environment.add(particles, places); },
             [&] { static_cast<void>(scene_.environment.trace(particles, 0, places)); }}) {
      const std::string why = error_text(call);
      ASSERT_NE(why.find("missed"), std::string::npos) << why;
      ASSERT_NE(why.find("add() their positions to a new set"), std::string::npos) << why;
      ASSERT_TRUE(same_bits(before, particles));
    }
    ++late_refused;
    Particles anew;
    ASSERT_EQ(error_text([&] { scene_.environment.add(anew, places); }), "");
    ASSERT_EQ(error_text([&] { scene_.environment.advance(anew, places_of(anew)); }), "");
    remedies += anew.size() > 0 ? 1 : 0;
    late_.reset();
  }

  Scene scene_;
  std::array<Set, set_count> sets_;
  std::optional<Set> late_;
  int moves_ = 0;
  int edits_ = 0;
  int moves_at_edit_ = 0;
};

TEST_P(Orders, LeaveNoSetThatCanNeitherAdvanceNorFollow) {
  int refused = 0;
  int remedies = 0;
  for (int run = 0; run < test::scaled(6, 300); ++run) {
    Machine machine(GetParam().make(), static_cast<std::uint64_t>(run));
    for (int i = 0; i < 100; ++i) {
      ASSERT_NO_FATAL_FAILURE(machine.act()) << "run " << run << ", act " << i;
      ASSERT_NO_FATAL_FAILURE(machine.check()) << "run " << run << ", act " << i;
    }
    refused += machine.late_refused;
    remedies += machine.remedies;
  }
  if (test::sanitized()) return;
  EXPECT_GT(refused, 0);
  EXPECT_GT(remedies, 0);
}

INSTANTIATE_TEST_SUITE_P(Meshes, Orders, testing::ValuesIn(test::all_edit_meshes()),
                         [](const auto& mesh) { return std::string(mesh.param.name); });

// --- by hand

std::vector<Vec3> stretched(const Environment& environment, double by) {
  std::vector<Vec3> points(environment.positions().begin(), environment.positions().end());
  for (Vec3& x : points) x.x *= by;
  return points;
}

MeshData three_cubes() {
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.size = {1.0, 1.0, 1.0};
  return generate_box(o);
}

struct Cubes {
  Environment environment;
  Particles particles;

  Cubes() : environment(three_cubes()) {
    environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}, {0.125, 0.125, 0.125}});
  }

  void split() {
    environment.edit([&](ComplexEdit& e) { split_edge(e.topology(), Dart{particles[0].cell, 3}); });
  }
};

TEST(Order, AMoveThenAnEditTakesParticlesAlong) {
  Cubes c;
  c.environment.move(stretched(c.environment, 1.25));
  c.split();
  EXPECT_TRUE(c.environment.awaits_advance(c.particles));
  EXPECT_THROW(c.environment.advance(c.particles, places_of(c.particles)), InvalidArgument);
  const UpdateReport report = c.environment.update_after_edit(c.particles);
  EXPECT_EQ(report.located, 1U);
  EXPECT_LT(norm(c.particles[0].position - Vec3{0.625, 0.5, 0.5}), 1e-15);
  EXPECT_LT(norm(c.particles[1].position - Vec3{0.15625, 0.125, 0.125}), 1e-15);
  EXPECT_FALSE(c.environment.awaits_advance(c.particles));
  EXPECT_NO_THROW(c.environment.advance(c.particles, places_of(c.particles)));
  EXPECT_EQ(audit(c.environment.complex(), c.particles).failed, 0U);
}

// An edit may follow a move if no particle has to be carried: no sets, empty sets, sets that came later.
TEST(Order, AnEditAfterAMoveNeedsNobody) {
  Cubes c;
  Particles empty;
  Particles emptied = c.particles;
  emptied.remove(std::vector<std::uint8_t>{1, 1});
  c.environment.move(stretched(c.environment, 1.25));
  Particles later;
  c.environment.add(later, std::vector<Vec3>{{0.5, 0.5, 0.5}});
  c.split();
  EXPECT_EQ(c.environment.update_after_edit(later).orphaned.size(), 0U);
  for (Particles* particles : {&empty, &emptied}) {
    EXPECT_NO_THROW(c.environment.update_after_edit(*particles));
    EXPECT_NO_THROW(c.environment.add(*particles, std::vector<Vec3>{{0.5, 0.5, 0.5}}));
    EXPECT_NO_THROW(c.environment.advance(*particles, places_of(*particles)));
  }
  EXPECT_NO_THROW(c.environment.advance(later, places_of(later)));
}

}  // namespace dartcast::order_test
