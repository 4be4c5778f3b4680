// The catheter in the demo's vessel, which bends and pulses: steered into either branch, and seen from within.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/error.hpp"
#include "support/catheter_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::steering_test {

constexpr double pi = std::numbers::pi;
constexpr double dt = 3e-4;    // s, of scenes/vessel.toml
constexpr double push = 2e-4;  // m, in a step

CatheterOptions in_vessel(const test::MovingVessel& vessel) {
  CatheterOptions o;
  o.length = 0.07;
  o.spacing = 1e-3;
  o.stiffness = 1e-9;
  o.tip_length = 8e-3;
  o.tip_curvature = 120.0;
  o.entry = vessel.centre(1.5e-3);
  o.direction = vessel.centre(3.0e-3) - o.entry;
  return o;
}

// Pushes it in to the given length while the vessel moves, turned by `turn` in all at first.
struct Insertion {
  test::MovingVessel vessel;
  Catheter catheter;
  int steps = 0;
  double worst_segment = 0.0;
  double worst_length = 0.0;
  double refused = 0.0;
  double least_share = 1.0;  // of the walls' way, that the catheter left them
  std::uint64_t audited = 0;
  std::uint64_t failed = 0;

  explicit Insertion(unsigned threads = 1, const VesselOptions& options = test::coarse_vessel())
      : vessel(options), catheter((vessel.move_to(0.0), vessel.environment), in_vessel(vessel)) {
    vessel.environment.set_threads({threads});
  }

  void step(double forward, double turn, bool audited_too = true) {
    least_share = std::min(least_share, vessel.move_to(dt * ++steps, catheter));
    const CatheterStep s = catheter.step({forward, turn});
    worst_segment = std::max(worst_segment, s.worst_segment);
    if (catheter.inserted() > 0.0)
      worst_length = std::max(worst_length, std::abs(catheter.measured_length() / catheter.inserted() - 1.0));
    refused += std::abs(forward - s.pushed);
    if (!audited_too) return;
    const Audit a = audit(vessel.environment.complex(), catheter.particles());
    audited += a.checked;
    failed += a.failed + catheter.audit().failed;
  }

  void insert(double length, double turn, bool audited_too = true) {
    constexpr int turning = 20;
    for (int i = 0; catheter.inserted() < length && i < 1000; ++i)
      step(push, i < turning ? turn / turning : 0.0, audited_too);
  }

  // The cell of a point, at rest: the mean of its corners, and how far along the vessel it is.
  struct Where {
    Vec3 rest;
    double path = 0.0;
  };
  [[nodiscard]] Where where(const ParticleState& s) const {
    const CombinatorialMap& map = vessel.environment.map();
    const auto corners = vessel.mesh.cell(map.source(s.cell));
    Where w;
    for (const std::uint32_t v : corners) {
      w.rest += vessel.mesh.points[v] * (1.0 / static_cast<double>(corners.size()));
      w.path += vessel.path(v) / static_cast<double>(corners.size());
    }
    return w;
  }
};

// The same vessel, the same pushes: only the turn at the entry differs. (The trunk is 30 mm long.)
TEST(Steering, IntoEitherBranch) {
  for (std::size_t side = 0; side < (test::sanitized() ? 1U : 2U); ++side) {
    Insertion run(1, VesselOptions{});
    run.insert(test::sanitized() ? 0.045 : 0.060, side == 0 ? 0.5 * pi : -0.5 * pi);
    const Insertion::Where tip = run.where(run.catheter.particles()[0]);
    EXPECT_GT(tip.path, test::sanitized() ? 0.037 : 0.052);
    EXPECT_GT(side == 0 ? -tip.rest.x : tip.rest.x, test::sanitized() ? 2e-3 : 9e-3) << tip.rest.x;
    EXPECT_EQ(run.failed, 0U);
    EXPECT_EQ(run.audited, run.catheter.particles().size() * static_cast<std::size_t>(run.steps));
    EXPECT_LE(run.worst_segment, 0.01);
    EXPECT_LE(run.worst_length, 0.01);
    EXPECT_LE(run.refused, 1e-9);
    EXPECT_EQ(run.least_share, 1.0);
    RecordProperty(side == 0 ? "left" : "right", std::to_string(run.worst_segment) + " " + std::to_string(tip.path));
  }
}

// Held in the vessel through a whole period of its bending, then pulled out.
TEST(Steering, StaysAndComesBack) {
  Insertion run;
  run.insert(0.050, 0.5 * pi, false);
  for (int i = 0; i < std::max(20, test::scaled(300, 1000)); ++i) run.step(0.0, 0.0, i % 10 == 0);
  EXPECT_LE(run.worst_segment, 0.01);
  EXPECT_LE(run.worst_length, 0.01);
  while (run.catheter.inserted() > 0.0 && run.steps < 3000) run.step(-1e-3, 0.0, run.steps % 10 == 0);
  EXPECT_LE(run.worst_segment, 0.01);
  EXPECT_EQ(run.catheter.inserted(), 0.0);
  EXPECT_EQ(run.failed, 0U);
  for (const ParticleState& s : run.catheter.particles().states()) EXPECT_EQ(s.position, run.catheter.entry());
}

TEST(Steering, IsTheSameForAnyThreadsAndGoesOnFromACheckpoint) {
  const double length = test::sanitized() ? 0.006 : 0.020;
  Insertion one(1);
  one.insert(length, 0.5 * pi, false);
  for (const unsigned threads : {2U, 5U}) {
    Insertion other(threads);
    other.insert(length, 0.5 * pi, false);
    EXPECT_EQ(other.catheter.state_hash(), one.catheter.state_hash()) << threads;
  }
  Insertion again;
  again.vessel.move_to(dt * one.steps, again.catheter);
  again.steps = one.steps;
  Catheter& resumed = again.catheter;
  resumed.restore(one.catheter.checkpoint());
  EXPECT_EQ(resumed.state_hash(), one.catheter.state_hash());
  for (int i = 0; i < 20; ++i) {
    one.step(push, 0.02, false);
    again.vessel.move_to(dt * ++again.steps, resumed);
    resumed.step({push, 0.02});
    ASSERT_EQ(resumed.state_hash(), one.catheter.state_hash()) << i;
  }
  CatheterCheckpoint bad = one.catheter.checkpoint();
  bad.states[3].cell = Cell();
  const StateHash before = resumed.state_hash();
  EXPECT_THROW(resumed.restore(bad), InvalidArgument);
  bad = one.catheter.checkpoint();
  bad.states.pop_back();
  bad.held_weights.pop_back();
  EXPECT_THROW(resumed.restore(bad), InvalidArgument);
  EXPECT_EQ(resumed.state_hash(), before);
}

// Whatever is asked of whatever catheter: points stay in the lumen and lengths right.
TEST(Steering, KeepsItsLengthsWhateverIsAsked) {
  for (std::uint64_t k = 0; k < std::max<std::uint64_t>(1, test::scaled<std::uint64_t>(4, 40)); ++k) {
    Random random(k + 1);
    test::MovingVessel vessel(test::coarse_vessel());
    CatheterOptions o = in_vessel(vessel);
    o.length = 0.09;
    o.spacing = random.uniform(0.25e-3, 1.25e-3);
    o.stiffness = std::pow(random.uniform(0.5e-3, 20e-3), 4);
    o.tip_length = random.uniform(0.0, 15e-3);
    o.tip_curvature = random.uniform(0.0, 250.0);
    o.friction = random.uniform(0.0, 0.5);
    Catheter c(vessel.environment, o);
    const bool moving = k % 2 == 1;
    for (int i = 1; i <= std::max(10, test::scaled(60, 300)); ++i) {
      if (moving) vessel.move_to(dt * i, c);
      const double forward = random.below(5) == 0 ? -1e-3 * random.uniform() : 1.5e-3 * random.uniform();
      const CatheterStep s = c.step({forward, random.below(3) == 0 ? random.uniform(-1.0, 1.0) : 0.0});
      ASSERT_LE(s.worst_segment, 0.01) << k << " " << i;
      if (i % 10 == 0) {
        ASSERT_EQ(audit(vessel.environment.complex(), c.particles()).failed, 0U);
        ASSERT_EQ(c.audit().failed, 0U) << k << " " << i;
      }
    }
    EXPECT_GT(c.inserted(), 0.0);
  }
}

TEST(Steering, ACameraGoesAlong) {
  Insertion run;
  run.insert(test::sanitized() ? 0.010 : 0.055, -0.5 * pi, false);
  std::vector<Vec3> points = run.catheter.points();
  std::reverse(points.begin(), points.end());  // from the entry
  CameraOptions o;
  o.spacing = 0.3e-3;
  const CameraPath path = camera_path(run.vessel.environment, points, o);
  ASSERT_GT(path.cameras.size(), test::sanitized() ? 30U : 170U);
  EXPECT_EQ(path.cameras.front().position, points.front());
  EXPECT_LE(norm(path.cameras.back().position - points.back()), 1e-9);
  for (std::size_t i = 0; i < path.cameras.size(); ++i) {
    const Camera& c = path.cameras[i];
    EXPECT_EQ(run.vessel.environment.locate(c.position).place, Place::free);
    EXPECT_NEAR(norm(c.direction), 1.0, 1e-12);
    EXPECT_NEAR(norm(c.up), 1.0, 1e-12);
    EXPECT_NEAR(dot(c.up, c.direction), 0.0, 1e-12);
    if (i == 0) continue;
    const Camera& before = path.cameras[i - 1];
    EXPECT_LE(c.arc - before.arc, 1.1 * o.spacing);  // walls push some aside
    EXPECT_GT(c.arc, before.arc);
    EXPECT_GT(dot(c.direction, before.direction), 0.98);
    EXPECT_LE(norm(c.up - before.up), norm(c.direction - before.direction) + 1e-12);  // no twist
  }
}

}  // namespace dartcast::steering_test
