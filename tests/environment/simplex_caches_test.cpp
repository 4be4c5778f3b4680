// The caches of particles never change where they go: whatever happens to a set, its next step equals the step of a set
// without caches.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/random.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/map_edits.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::test::simplex_caches_test {

enum class Places { anywhere, lattice };

class Mixed {
 public:
  Mixed(std::uint64_t seed, Places places)
      : environment_(mesh(), Threads{2}), random_(seed, 17), on_lattice_(places == Places::lattice) {
    add(60);
  }

  // Something happens, then a step; whether it is that of particles that keep nothing.
  ::testing::AssertionResult step() {
    happen();
    if (on_lattice_) happen();
    Particles fresh = environment_.restored(set_.states(), weights());
    if (random_.below(on_lattice_ ? 64 : 4) == 0) move();
    const std::vector<Vec3> targets = any_targets(set_);
    const StepReport kept = environment_.advance(set_, targets);
    const StepReport without = environment_.advance(fresh, targets);
    contacts += kept.contacts.contacts.size();
    if (!std::ranges::equal(kept.contacts.contacts, without.contacts.contacts, equal))
      return ::testing::AssertionFailure() << "other contacts";
    if (kept.counters.orientation.tests != without.counters.orientation.tests)
      return ::testing::AssertionFailure() << "other tests";
    for (std::size_t i = 0; i < set_.size(); ++i) {
      if (!same_bits(set_[i], fresh[i])) return ::testing::AssertionFailure() << "particle " << i;
    }
    return ::testing::AssertionSuccess();
  }

  std::size_t contacts = 0;
  std::size_t edits = 0;

 private:
  static MeshData mesh() {
    BoxOptions box;
    box.cells = {5, 5, 5};
    box.size = {5, 5, 5};
    box.blocked_share = 0.1;
    return generate_box(box);
  }

  static bool equal(const Contact& a, const Contact& b) {
    return a.particle == b.particle && a.kind == b.kind && a.dart == b.dart && a.point == b.point &&
           a.time_of_impact == b.time_of_impact && a.wall_displacement == b.wall_displacement && a.unused == b.unused;
  }

  [[nodiscard]] std::vector<Weights> weights() const {
    std::vector<Weights> weights;
    for (std::size_t i = 0; i < set_.size(); ++i) weights.push_back(set_.held_weights(i));
    return weights;
  }

  Vec3 any_vector(double length) {
    return Vec3{random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)} * length;
  }

  std::vector<Vec3> any_targets(const Particles& set) {
    std::vector<Vec3> targets;
    for (const ParticleState& s : set.states())
      targets.push_back(on_lattice_ ? next_on_lattice(s.position) : s.position + any_vector(0.2));
    return targets;
  }

  // Points whose coordinates are eighths, many of them whole: on faces, edges and corners. Most stay on theirs.
  static double eighth(double x) { return std::round(8.0 * x) / 8.0; }
  Vec3 next_on_lattice(const Vec3& p) {
    const auto next = [&](double x) {
      return eighth(x) + 0.125 * (random_.below(3) == 0 ? random_.below(3) - 1.0 : 0.0);
    };
    const Vec3 q = {next(p.x), next(p.y), next(p.z)};
    return q == p ? q + Vec3{0.125, 0, 0} : q;  // at rest only the counts may differ
  }
  Vec3 any_on_lattice() {
    const auto any = [&] { return random_.below(2) == 0 ? 1.0 + random_.below(4) : 0.125 * (1 + random_.below(38)); };
    return {any(), any(), any()};
  }

  void happen() {
    const std::uint32_t kind = random_.below(12);
    if (kind == 0) add(3);
    if (kind == 1) remove();
    if (kind == 2) reorder();
    if (kind == 3 || kind == 4) step_some();
    if (kind == 5) edit();
    if (kind == 5 && random_.below(2) == 0) step_some();
  }

  void add(std::size_t count) {
    std::vector<Vec3> points;
    while (points.size() < count)
      points.push_back(on_lattice_ ? any_on_lattice() : Vec3{2.5, 2.5, 2.5} + any_vector(2.4));
    environment_.add(set_, points);
  }

  void remove() {
    std::vector<std::uint8_t> marks(set_.size());
    for (std::uint8_t& m : marks) m = random_.below(20) == 0 ? 1 : 0;
    set_.remove(marks);
  }

  void reorder() {
    std::vector<std::uint32_t> order(set_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::rotate(order.begin(), order.begin() + 1, order.end());
    set_.reorder(order);
  }

  // As what moves particles in rounds does.
  void step_some() {
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 0; i < set_.size(); ++i) {
      if (random_.below(3) == 0) which.push_back(i);
    }
    Particles some = set_.selected(which);
    if (random_.below(2) == 0) environment_.advance(set_, any_targets(set_));  // some are put back to where they were
    for (std::uint32_t round = 0; round < random_.below(3); ++round) environment_.advance(some, any_targets(some));
    set_.replace(which, some);
  }

  void edit() {
    const std::vector<Cell> cells = environment_.map().cells();
    const Cell c = cells[random_.below(static_cast<std::uint32_t>(cells.size()))];
    const std::size_t darts = environment_.map().shape(c).dart_count();
    environment_.edit([&](ComplexEdit& e) {
      if (on_lattice_) return e.topology().set_free(c, !environment_.map().is_free(c));
      split_edge(e.topology(), {c, static_cast<std::uint16_t>(random_.below(static_cast<std::uint32_t>(darts)))});
    });
    environment_.update_after_edit(set_);
    ++edits;
  }

  void move() {
    const std::span<Vec3> next = environment_.next_positions();
    const Vec3 all = any_vector(0.1);
    const double own = random_.below(2) == 0 ? 0.03 : 1e-6;
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = environment_.positions()[i] + all + any_vector(own);
    environment_.move();
  }

  Environment environment_;
  Random random_;
  bool on_lattice_;
  Particles set_;
};

void expect_steps_of_particles_that_keep_nothing(Places places) {
  std::size_t contacts = 0;
  std::size_t edits = 0;
  for (int seed = 0; seed < scaled(20, 1000); ++seed) {
    Mixed mixed(static_cast<std::uint64_t>(seed), places);
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(mixed.step()) << "seed " << seed << ", step " << i;
    contacts += mixed.contacts;
    edits += mixed.edits;
  }
  EXPECT_GT(contacts, static_cast<std::size_t>(std::max(1, scaled(1000, 50000))));
  EXPECT_GT(edits, static_cast<std::size_t>(std::max(1, scaled(40, 2000))));
}

TEST(SimplexCache, NeverChangeAStep) { expect_steps_of_particles_that_keep_nothing(Places::anywhere); }

// Cells are blocked and freed beside particles that know that they are on no wall.
TEST(SimplexCache, NeverChangeAStepOnALattice) { expect_steps_of_particles_that_keep_nothing(Places::lattice); }

// The inner facet lies in x + 3y = 0, and its gradient is (1/3, 1, 0), of which a float keeps (g, 1, 0): g x + y is
// zero, and nothing rounded, where x + 3y is 2^-26.
TEST(SimplexCache, CoordinatesThatAreRoundedProveNoZeros) {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {3, -1, 0}, {0, 0, 1}, {0, 1, 0}, {1, -2, 0}};
  mesh.add_cell(CellType::tetrahedron, {{1, 0, 2, 3}});
  mesh.add_cell(CellType::tetrahedron, {{0, 1, 2, 4}});
  Environment environment(mesh);
  const double third = 1.0F / 3.0F;
  const Vec3 on_facet = {1.5, -0.5, 0.25};
  for (const Vec3& off : {Vec3{0.5, -0.5 * third, 0}, Vec3{-0.5, 0.5 * third, 0}}) {
    Particles set;
    for (const Vec3& start : {Vec3{0.75, 0, 0.25}, Vec3{1, -0.75, 0.25}}) environment.add(set, std::span(&start, 1));
    ASSERT_EQ(set.size(), 2U);
    const std::vector<Vec3> starts = {set[0].position, set[1].position};
    for (int i = 0; i < 3; ++i) environment.advance(set, starts);
    environment.advance(set, std::vector<Vec3>(2, on_facet));
    ASSERT_EQ(check_states(environment, set), "");
    environment.advance(set, std::vector<Vec3>(2, on_facet + off));
    EXPECT_EQ(set[0].position, on_facet + off);
    EXPECT_EQ(check_states(environment, set), "");
  }
}

}  // namespace dartcast::test::simplex_caches_test
