#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "base/random.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"

namespace dartcast::state_hash_test {

ParticleState some_state() {
  ParticleState s;
  s.put({Cell{1, 12}, 3}, {0.1, -2.0, 3e10});
  s.touching_count = 1;
  s.touching[0] = {Cell{1, 12}, 2};
  return s;
}

std::string hash_of(std::uint64_t id, const ParticleState& s, const Vec3& v, std::uint64_t fate = 0) {
  StateHash h;
  h.add(id, s, v, fate);
  return h.hex();
}

TEST(StateHash, HasThirtyTwoDigitsAndIsZeroForNoParticles) {
  EXPECT_EQ(StateHash().hex(), std::string(32, '0'));
  EXPECT_EQ(hash_of(0, {}, {}).size(), 32U);
  EXPECT_NE(hash_of(0, {}, {}), StateHash().hex());
}

// Each part of a particle counts, down to the last bit.
TEST(StateHash, EveryPartOfAStateCounts) {
  const ParticleState s = some_state();
  const Vec3 v = {1.0, 2.0, 3.0};
  std::set<std::string> hashes = {hash_of(7, s, v), hash_of(8, s, v), hash_of(7, s, v, 1)};
  std::size_t expected = 3;
  const auto expect_new = [&](const ParticleState& changed, const Vec3& velocity) {
    hashes.insert(hash_of(7, changed, velocity));
    EXPECT_EQ(hashes.size(), ++expected);
  };
  for (double Vec3::*c : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    ParticleState moved = s;
    moved.position.*c = std::nextafter(moved.position.*c, 1e300);
    expect_new(moved, v);
    Vec3 faster = v;
    faster.*c = std::nextafter(faster.*c, 1e300);
    expect_new(s, faster);
  }
  ParticleState other = s;
  other.cell = Cell{1, 13};
  expect_new(other, v);
  other = s;
  other.simplex = 4;
  expect_new(other, v);
  other = s;
  other.held = true;
  expect_new(other, v);
  other = s;
  other.touching[0].face = 3;
  expect_new(other, v);
  other = s;
  other.touching_count = 0;
  expect_new(other, v);
}

TEST(StateHash, TheOrderOfAddingDoesNotMatterButWhoIsWhereDoes) {
  ParticleState a = some_state();
  ParticleState b = some_state();
  b.position.x = 5.0;
  StateHash forward, backward, swapped, parts, part;
  forward.add(1, a, {});
  forward.add(2, b, {});
  backward.add(2, b, {});
  backward.add(1, a, {});
  swapped.add(2, a, {});
  swapped.add(1, b, {});
  parts.add(1, a, {});
  part.add(2, b, {});
  parts += part;
  EXPECT_EQ(forward, backward);
  EXPECT_EQ(forward, parts);
  EXPECT_NE(forward, swapped);
}

// Particles that move through obstacles for some steps, in an order and by a number of threads.
std::string walked(const std::vector<std::uint32_t>& order, unsigned threads) {
  BoxOptions box;
  box.cells = {6, 6, 6};
  box.size = {1.0, 1.0, 1.0};
  box.blocked_share = 0.2;
  box.jitter = 0.3;
  Environment environment(generate_box(box), Threads{threads});
  Random random(3);
  std::vector<Vec3> positions;
  while (positions.size() < order.size()) {
    const Vec3 p = {random.uniform(), random.uniform(), random.uniform()};
    if (environment.locate(p).place == Place::free) positions.push_back(p);
  }
  Particles particles;
  environment.add(particles, positions);
  particles.reorder(order);
  for (int step = 0; step < 20; ++step) {
    std::vector<Vec3> targets(particles.size());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      Random own(order[i], static_cast<std::uint64_t>(step));
      targets[i] = particles[i].position + Vec3{own.uniform(-0.2, 0.2), own.uniform(-0.2, 0.2), own.uniform(-0.2, 0.2)};
    }
    environment.advance(particles, targets);
  }
  StateHash hash;
  for (std::size_t i = 0; i < particles.size(); ++i) hash.add(order[i], particles[i], {});
  return hash.hex();
}

TEST(StateHash, IsTheSameForAnyThreadsAndAnyOrderOfParticles) {
  std::vector<std::uint32_t> order(2000);
  std::iota(order.begin(), order.end(), 0U);
  const std::string expected = walked(order, 1);
  EXPECT_EQ(walked(order, 2), expected);
  EXPECT_EQ(walked(order, 7), expected);
  Random random(5);
  for (std::uint32_t i = 1; i < order.size(); ++i) std::swap(order[i], order[random.below(i + 1)]);
  EXPECT_EQ(walked(order, 2), expected);
}

}  // namespace dartcast::state_hash_test
