// The barrel of the paper's figure 20: it falls through a channel that bends and narrows meanwhile, and comes to rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dartcast/audit.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/generators.hpp"
#include "support/tier.hpp"

namespace dartcast::barrel_test {

constexpr double dt = 2e-3;
constexpr int deforming_steps = 500;  // one second: longer than the fall

MeshData channel() {
  BoxOptions box;
  box.cells = {4, 4, 16};
  box.size = {1.0, 1.0, 4.0};
  return generate_box(box);
}

// The middle of the channel bends by 0.4 and narrows by a quarter; its ends stay.
void deform(std::span<const Vec3> rest, double share, std::span<Vec3> out) {
  const double s = share * share * (3.0 - 2.0 * share);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vec3& p = rest[i];
    const double bump = std::pow(std::sin(std::numbers::pi * p.z / 4.0), 2);
    const double width = 1.0 - 0.25 * s * bump;
    out[i] = {0.5 + (p.x - 0.5) * width + 0.4 * s * bump, 0.5 + (p.y - 0.5) * width, p.z};
  }
}

struct Fall {
  double peak = 0.0;
  double end = 0.0;  // kinetic energy, greatest in the last 100 steps
  double input = 0.0;
  Vec3 centre;
  std::string hash;
};

Fall fall(const BodyOptions& options, int steps, unsigned threads = 1) {
  Environment environment(channel(), Threads{threads});
  WallResponse wall;
  wall.restitution = 0.3;
  wall.friction = 0.4;
  BodiesOptions o;
  o.dt = dt;
  o.gravity = {0.0, 0.0, -9.81};
  o.drag = 2.0;  // a barrel on its side rocks for long
  Bodies bodies(environment, o, WallResponses(wall));
  BarrelOptions barrel;
  barrel.centre = {0.5, 0.5, 3.6};
  bodies.add(generate_barrel(barrel).points, options);
  EXPECT_EQ(bodies.size(), 1U);
  if (bodies.size() != 1) return {};
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  Fall r;
  for (int i = 1; i <= steps; ++i) {
    if (i <= deforming_steps) {
      deform(rest, static_cast<double>(i) / deforming_steps, environment.next_positions());
      environment.move();
    }
    const double before = bodies.energy(0).total();
    const BodiesStep& step = bodies.step();
    const BodyEnergy energy = bodies.energy(0);
    EXPECT_LE(energy.total(), (before + step.input) * (1.0 + 2.0 * energy_slack)) << "step " << i;
    if (i > deforming_steps) EXPECT_EQ(step.input, 0.0) << "step " << i;
    if (i % 20 == 0 || test::full_tier()) {
      const Audit audited = audit(environment.complex(), bodies.particles(), environment.threads());
      EXPECT_EQ(audited.failed, 0U) << "step " << i << ": " << audited.first;
    }
    if (::testing::Test::HasFailure()) return r;
    r.peak = std::max(r.peak, energy.kinetic);
    r.input += step.input;
    if (i > steps - 100) r.end = std::max(r.end, energy.kinetic);
  }
  r.centre = bodies.rigid_motion_of(0).centre;
  r.hash = bodies.state_hash().hex();
  return r;
}

BodyOptions oak() {
  BodyOptions o;
  o.mass = 10.0;
  o.pull = 0.3;
  o.damping = 5.0;
  o.angular_velocity = {0.5, 0.0, 0.3};
  return o;
}

TEST(Barrel, FallsThroughADeformingChannelAndComesToRest) {
  if (test::sanitized()) GTEST_SKIP() << "takes its full number of steps";
  const Fall r = fall(oak(), 3200);
  EXPECT_GT(r.peak, 50.0);
  EXPECT_GT(r.input, 0.0);  // the channel has pushed it
  EXPECT_LE(r.end, 1e-6 * r.peak);
  EXPECT_LT(r.centre.z, 0.3);  // on the floor
  EXPECT_GT(r.centre.z, 0.15);
}

TEST(Barrel, OfSoftRegionsKeepsTheLawToo) {
  BodyOptions o = oak();
  BarrelOptions barrel;
  barrel.centre = {0.5, 0.5, 3.6};
  o.match.clusters = overlapping_clusters(generate_barrel(barrel).points, 0.25);
  o.stiffness = 0.1 / (dt * dt);
  const Fall r = fall(o, test::scaled(600, 2000));
  EXPECT_GT(r.peak, 0.0);
}

TEST(Barrel, FallsTheSameForAnyNumberOfThreads) {
  const int steps = test::scaled(300, 1000);
  const Fall one = fall(oak(), steps, 1);
  EXPECT_EQ(fall(oak(), steps, 2).hash, one.hash);
  EXPECT_EQ(fall(oak(), steps, 5).hash, one.hash);
}

}  // namespace dartcast::barrel_test
