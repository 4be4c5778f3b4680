// Steps while vertices move that would be split, or are not known to have one part: which of them a batch takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "tracking/batch/batch.hpp"
#include "tracking/batch/particle_cache.hpp"

namespace dartcast::test::batch_split_test {

// One tetrahedron on a base that leans over, and a particle in it.
class OneStep {
 public:
  OneStep(const Vec3& apex, const Vec3& place) : complex_(tetrahedron(apex)) {
    state_.put({complex_.map().cells().front(), 0}, place);
    vertices_.push_back(detail::vertex_numbers(complex_, state_.at()));
    const detail::SimplexCacheEntry entry =
        detail::cache_entry_of(detail::CacheKind::previous_geometry, complex_.positions(), vertices_.front(), place);
    is_known_ = !std::isnan(entry.w[0]);
    caches_.push_back(entry, 0);
  }

  [[nodiscard]] bool is_known() const { return is_known_; }
  void hold() { state_.held = true; }

  // Moves the vertices, and says what the batch does of the step to the target.
  detail::StepStatus step(const std::function<Vec3(const Vec3&)>& moved, const Vec3& target) {
    std::ranges::transform(complex_.positions(), complex_.next_positions().begin(), moved);
    complex_.commit_positions();
    std::vector<ParticleState> states = {state_};
    const std::vector<Vec3> targets = {target};
    std::vector<detail::StepStatus> status(1);
    std::vector<StepState> partial;
    Counters counters;
    detail::step_batch({&complex_, true, true, StepOptions{}},
                       {states, vertices_, caches_.from(0), targets, status, partial}, counters);
    return status.front();
  }

 private:
  static MeshData tetrahedron(const Vec3& apex) {
    MeshData mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, apex};
    mesh.add_cell(CellType::tetrahedron, std::vector<std::uint32_t>{0, 1, 2, 3});
    return mesh;
  }

  CellComplex complex_;
  ParticleState state_;
  std::vector<detail::VertexNumbers> vertices_;
  detail::SimplexCache caches_;
  bool is_known_ = false;
};

Vec3 sheared(const Vec3& p) { return {p.x + 0.3 * p.y, p.y, p.z}; }

TEST(SplitBatch, WalksTheFirstPart) {
  OneStep step({0, 0, 1}, {0.2, 0.2, 0.6});
  ASSERT_TRUE(step.is_known());
  EXPECT_EQ(step.step(sheared, {50, 1, 2}), 0);  // the number of its partial step
}

TEST(SplitBatch, LeavesWhatIsHeld) {
  OneStep step({0, 0, 1}, {0.2, 0.2, 0.6});
  step.hold();
  EXPECT_EQ(step.step(sheared, {50, 1, 2}), detail::step_untouched);
}

TEST(SplitBatch, LeavesANearTarget) {
  OneStep step({0, 0, 1}, {0.2, 0.2, 0.6});
  EXPECT_EQ(step.step(
                [](const Vec3& p) {
                  return Vec3{p.x + 2.0 * p.y, p.y, p.z};
                },
                {0.3, 0.1, 0.6}),
            detail::step_untouched);
}

// A tetrahedron that was flat says nothing of where its particle is, and so nothing of the parts: its target may be inside.
TEST(SplitBatch, LeavesWhatHasUnknownCoordinates) {
  OneStep step({0.3, 0.3, 0.6 + 1e-13}, {0.25, 0.25, 0.5});
  ASSERT_FALSE(step.is_known());
  const auto thick = [](const Vec3& p) { return Vec3{p.x, p.y, p.z - p.x - p.y > 1e-14 ? 1.0 : 0.0}; };
  EXPECT_EQ(step.step(thick, {0.3, 0.3, 0.2}), detail::step_untouched);
}

}  // namespace dartcast::test::batch_split_test
