// Spheres where a move puts a vertex beyond the range of exact signs and back: no position and no velocity becomes NaN,
// and what the vertex did is no motion of a wall.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "dartcast/spheres.hpp"
#include "support/tier.hpp"

namespace dartcast::far_vertices_test {

void run(std::size_t vertex, double Vec3::*axis, double to) {
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.size = {3, 3, 3};
  Environment environment(generate_box(o));
  Random random(vertex);
  std::vector<Vec3> start;
  std::vector<Vec3> velocities;
  for (int i = 0; i < 40; ++i) {
    start.push_back({random.uniform(0.2, 2.8), random.uniform(0.2, 2.8), random.uniform(0.2, 2.8)});
    velocities.push_back({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)});
  }
  Particles particles;
  environment.add(particles, start);
  const std::vector<double> radii(start.size(), 0.15);
  std::vector<ParticleStatus> statuses(start.size());
  const WallResponses responses(WallResponse{WallResponseKind::reflect, 0.5, 0.1});
  SphereStepper stepper;
  const std::vector<Vec3> rest(environment.positions().begin(), environment.positions().end());
  for (int step = 0; step < 6; ++step) {
    std::vector<Vec3> next = rest;
    if (step % 3 != 2) next[vertex].*axis = to;
    environment.move(next);
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i) targets.push_back(particles[i].position + velocities[i] * 0.2);
    stepper.advance(environment, particles, radii, targets, respond_with(responses, velocities, statuses, 0.2));
    const Audit a = audit(environment.complex(), particles);
    ASSERT_EQ(a.failed, 0U) << "vertex " << vertex << " at " << to << ": " << a.first;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      ASSERT_LT(norm(velocities[i]), 1e3) << "vertex " << vertex << " at " << to << ", sphere " << i;
    }
  }
}

TEST(SpheresAndFarVertices, NothingBecomesNaNAndNobodyIsThrown) {
  const std::size_t stride = test::full_tier() ? 1 : test::sanitized() ? 31 : 7;
  for (const double to : {1e91, -1e160, 1e300, -1.7e308, std::numeric_limits<double>::infinity(), std::nan("")}) {
    for (std::size_t vertex = 0; vertex < 64; vertex += stride) {
      for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) run(vertex, axis, to);
    }
  }
}

}  // namespace dartcast::far_vertices_test
