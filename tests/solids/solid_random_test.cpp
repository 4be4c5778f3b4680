// Random calls of a set of solids, also where cells invert and edits put walls into solids: nothing is pierced, and no call
// ends in an internal error.
#include <gtest/gtest.h>

#include <algorithm>

#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "dartcast/remeshing.hpp"
#include "solids/joint_move.hpp"
#include "support/meshes.hpp"
#include "support/solid_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::solid_random_test {

using test::ball;
using test::scaled;

class RandomCalls {
 public:
  explicit RandomCalls(std::uint64_t seed)
      : random_(seed),
        environment_(test::cubes(5, seed % 2 == 0 ? CellType::hexahedron : CellType::tetrahedron, 0.1, 0.2, seed),
                     Threads{1}),
        solids_(environment_) {}

  void call() {
    switch (random_.below(9)) {
      case 0:
      case 1: add(); break;
      case 2: remove(); break;
      case 3:
      case 4: expect_unit_normals(advance()); break;
      case 5:
      case 6: expect_unit_normals(move()); break;
      case 7: edit(); break;
      case 8: solids_.restore(solids_.checkpoint()); break;
    }
  }
  void expect_valid() {
    const SolidAudit audit = solids_.audit();
    EXPECT_EQ(audit.failed, 0U) << audit.first;
    const Audit places = dartcast::audit(environment_.complex(), solids_.particles());
    EXPECT_EQ(places.failed, 0U) << places.first;
    stuck += solids_.stuck().size();
    steps += solids_.size();
  }

  std::size_t stuck = 0;
  std::size_t steps = 0;

 private:
  static void expect_unit_normals(const SolidStep& step) {
    for (const SolidContact& c : step.contacts) EXPECT_NEAR(norm(c.normal), 1.0, 1e-12);
  }
  void add() {
    if (solids_.size() > 6) return;
    const Vec3 at = {random_.uniform(0, 5), random_.uniform(0, 5), random_.uniform(0, 5)};
    solids_.add(test::moved(random_.below(2) == 0 ? ball(random_.uniform(0.1, 0.8)) : test::rod(4, 0.4), at));
  }
  void remove() {
    if (solids_.size() > 2) solids_.remove(random_.below(static_cast<std::uint32_t>(solids_.size())));
  }
  std::vector<Vec3> targets() {
    std::vector<Vec3> to(solids_.positions().begin(), solids_.positions().end());
    const double size = random_.below(4) == 0 ? 3.0 : 0.3;
    const Vec3 way = test::random_vector(random_, size);
    for (Vec3& x : to) x += way + test::random_vector(random_, 0.1 * size);
    return to;
  }
  const SolidStep& advance() {
    if (random_.below(2) == 0) return solids_.advance(targets(), options());
    return JointMoves::advance(solids_, way(), {.rounds = 0});
  }
  const SolidStep& move() {
    if (random_.below(2) == 0) return solids_.move_with(targets(), walls(), options());
    MovePartner* const solids = &JointMoves::prepare(solids_, way(), {.rounds = 0});
    move_together(environment_, {&solids, 1}, walls());
    return JointMoves::last_step(solids_);
  }
  // In slices, on a path that bulges.
  SolidWay way() {
    SolidWay all = {targets(), 1 + random_.below(5)};
    const std::vector<Vec3> from(solids_.positions().begin(), solids_.positions().end());
    const Vec3 bulge = test::random_vector(random_, 2.0);
    const std::vector<std::uint32_t> first(solids_.first_vertices().begin(), solids_.first_vertices().end());
    all.place = [=, to = all.targets](std::uint32_t solid, double share, std::span<Vec3> place) {
      const std::size_t v = first[solid];
      for (std::size_t i = 0; i < place.size(); ++i)
        place[i] = from[v + i] + (to[v + i] - from[v + i]) * share + bulge * (share * (1.0 - share));
    };
    return all;
  }
  // Large waves invert cells.
  std::vector<Vec3> walls() {
    return test::waved(environment_.positions(), random_.below(5) == 0 ? 0.5 : random_.uniform(-0.1, 0.1));
  }
  SolidStepOptions options() { return {.rounds = random_.below(3) == 0 ? 0U : 6U}; }
  void edit() {
    const std::vector<Cell> cells = environment_.map().cells();
    const Cell c = cells[random_.below(static_cast<std::uint32_t>(cells.size()))];
    const auto face = static_cast<std::uint16_t>(random_.below(environment_.map().shape(c).face_count()));
    try {
      environment_.edit([&](ComplexEdit& e) {
        switch (random_.below(3)) {
          case 0: e.topology().set_free(c, !e.map().is_free(c)); break;
          case 1: unsew(e.topology(), {c, face}); break;
          case 2: subdivide(e, c); break;
        }
      });
    } catch (const EditRefused&) {
      return;  // a cell that is inverted, or a face that is a wall
    }
    solids_.update_after_edit();
  }

  Random random_;
  Environment environment_;
  SolidSet solids_;
};

TEST(SolidRandom, NoCallPiercesOrBreaks) {
  std::size_t stuck = 0;
  std::size_t steps = 0;
  const int sequences = std::max(6, scaled(60, 3000));
  for (int seed = 1; seed <= sequences; ++seed) {
    RandomCalls calls(static_cast<std::uint64_t>(seed));
    for (int k = 0; k < 40; ++k) {
      ASSERT_NO_THROW(calls.call()) << "seed " << seed << ", call " << k;
      calls.expect_valid();
      if (HasFailure()) FAIL() << "seed " << seed << ", call " << k;
    }
    stuck += calls.stuck;
    steps += calls.steps;
  }
  if (!test::sanitized()) EXPECT_GT(stuck, 0U);  // rare
  EXPECT_GT(steps, 10 * stuck);
}

}  // namespace dartcast::solid_random_test
