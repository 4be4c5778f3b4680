// The same bits for any number of threads and any order of the particles (guarantee G5).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "base/random.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "support/mixed_mesh.hpp"
#include "support/particle_checks.hpp"
#include "support/tier.hpp"

namespace dartcast::threads_test {

using test::full_tier;

// Everything that a run leaves behind, by the particles' numbers.
struct Outcome {
  std::vector<ParticleState> states;
  std::vector<Vec3> velocities;
  std::map<std::uint32_t, std::vector<std::uint64_t>> contacts;  // all bits, in order of time
  Counters counters;
  std::size_t contact_count = 0;
  std::size_t held = 0;
};

void append(std::vector<std::uint64_t>& words, const Vec3& p) {
  const auto b = test::bits(p);
  words.insert(words.end(), b.begin(), b.end());
}

void record(Outcome& outcome, const StepReport& report, const std::vector<std::uint32_t>& name) {
  for (const Contact& c : report.contacts.contacts) {
    auto& words = outcome.contacts[name[c.particle]];
    words.insert(words.end(), {static_cast<std::uint64_t>(c.kind), c.dart.cell.value, c.dart.number, c.wall_count,
                               c.earlier, c.last ? 1U : 0U, std::bit_cast<std::uint64_t>(c.time_of_impact)});
    for (const Vec3& v : {c.point, c.wall_displacement, c.displacement, c.unused}) append(words, v);
    for (const WallHit& w : report.contacts.walls_of(c)) {
      words.insert(words.end(), {w.face.cell.value, w.face.face, w.triangle, w.patch.value});
      append(words, w.normal);
    }
  }
  outcome.contact_count += report.contacts.contacts.size();
  outcome.held += report.held.size();
  outcome.counters += report.counters;
}

MeshData scene() {
  BoxOptions o;
  o.cells = {7, 6, 8};
  o.size = {7, 6, 8};
  o.mixed = true;
  o.blocked_share = 0.15;
  o.jitter = 0.3;
  return generate_box(o);
}

// A swirl and a squeeze; later so strong that some cells turn invalid for a while.
Vec3 deformed(const Vec3& p, int step) {
  const double s = std::sin(0.3 * step);
  const double strong = step % 8 == 5 ? 2.5 : 1.0;
  return {p.x + 0.3 * strong * s * std::sin(p.y + p.z), p.y + 0.3 * s * std::sin(p.z + 2.0 * p.x),
          p.z * (1.0 + 0.05 * s)};
}

Outcome run(unsigned threads, bool deforming, std::uint64_t shuffle, std::size_t count, int steps) {
  const MeshData mesh = scene();
  Environment environment(mesh, Threads{threads});
  Particles particles;
  Random random(4);
  environment.add(particles, test::random_points(count, {0, 0, 0}, {7, 6, 8}, random));
  std::vector<Vec3> velocities(particles.size());
  for (Vec3& v : velocities) v = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
  std::vector<std::uint32_t> name = test::permutation(particles.size(), random);
  if (shuffle == 0) std::sort(name.begin(), name.end());
  particles.reorder(name);
  std::vector<Vec3> shuffled;
  for (const std::uint32_t n : name) shuffled.push_back(velocities[n]);
  velocities = shuffled;
  std::vector<ParticleStatus> statuses(particles.size(), ParticleStatus::alive);
  const WallResponses responses({WallResponseKind::reflect, 0.9, 0.1});

  Outcome outcome;
  std::vector<Vec3> targets(particles.size());
  for (int step = 1; step <= steps; ++step) {
    for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = particles[i].position + velocities[i] * 0.2;
    if (deforming) {
      const auto next = environment.next_positions();
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = deformed(mesh.points[i], step);
      environment.move();
    }
    record(outcome, environment.advance(particles, targets, respond_with(responses, velocities, statuses, 0.2)), name);
  }
  EXPECT_EQ(test::check_states(environment, particles), "");
  outcome.states.resize(particles.size());
  outcome.velocities.resize(particles.size());
  for (std::size_t i = 0; i < name.size(); ++i) {
    outcome.states[name[i]] = particles[i];
    outcome.velocities[name[i]] = velocities[i];
  }
  return outcome;
}

void expect_equal(const Outcome& a, const Outcome& b) {
  ASSERT_EQ(a.states.size(), b.states.size());
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    ASSERT_TRUE(test::same_bits(a.states[i], b.states[i])) << "particle " << i;
    ASSERT_EQ(test::bits(a.velocities[i]), test::bits(b.velocities[i])) << "particle " << i;
  }
  EXPECT_EQ(a.contacts, b.contacts);
  EXPECT_EQ(a.counters.orientation.tests, b.counters.orientation.tests);
  EXPECT_EQ(a.counters.orientation.exact, b.counters.orientation.exact);
  EXPECT_EQ(a.counters.histogram, b.counters.histogram);
  EXPECT_EQ(a.counters.forecast_kept, b.counters.forecast_kept);
  EXPECT_EQ(a.counters.steps_split, b.counters.steps_split);
  EXPECT_EQ(a.held, b.held);
}

TEST(Threads, SameBitsForAnyNumberAndOrder) {
  const std::size_t count = full_tier() ? 50000 : 3000;
  const int steps = full_tier() ? 200 : 16;
  for (const bool deforming : {false, true}) {
    const Outcome one = run(1, deforming, 0, count, steps);
    EXPECT_GT(one.contact_count, 1000U);
    if (deforming) EXPECT_GT(one.held, 0U);
    if (deforming) EXPECT_GT(one.counters.steps_split, 0U);
    for (const unsigned threads : {2U, 7U}) expect_equal(one, run(threads, deforming, 0, count, steps));
    expect_equal(one, run(7, deforming, 1, count, steps));
  }
}

}  // namespace dartcast::threads_test
