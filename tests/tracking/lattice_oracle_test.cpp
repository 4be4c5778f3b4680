// Degenerate motion on integer lattices: through and along vertices, edges, faces and diagonals, starting or ending on
// them, of length zero, one unit in the last place off, along walls and into them, with states kept through contacts.
// Each step is compared with the oracle: 10^5, 10^7 in the full tier.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "base/random.hpp"
#include "oracle/checked_scene.hpp"
#include "support/seeds.hpp"

namespace dartcast::test::lattice_oracle_test {

constexpr std::uint64_t steps_per_scene = 1000;
constexpr int lattice_kinds = 7;  // all but slivers

// Counts of the steps of all scenes, so that a test without contacts fails.
struct Tally {
  std::array<std::atomic<std::uint64_t>, 3> contacts_of_kind{};
  std::atomic<std::uint64_t> at_start{0};
  std::atomic<std::uint64_t> at_end{0};
  std::atomic<std::uint64_t> without_contact{0};
};

class LatticeMotion {
 public:
  LatticeMotion(const CheckedScene& scene, std::uint64_t seed) : scene_(scene), random_(seed, 4) {}

  // A corner, or the middle of two or four corners: exact, but for some Steiner points.
  ParticleState place() {
    const auto& free = scene_.free_simplices();
    while (true) {
      const std::uint32_t s = free[random_.below(static_cast<std::uint32_t>(free.size()))];
      const Vec3 p = middle(scene_.complex().corners(scene_.library_simplex(s)));
      if (!scene_.oracle().contains(s, p)) continue;
      ParticleState state;
      state.put(scene_.library_simplex(s), p);
      return state;
    }
  }

  Vec3 target(const ParticleState& state, const ContactList& last) {
    Vec3 q = exact_target(state, last);
    if (random_.below(8) == 0) nudge(q);
    return q;
  }

  bool place_again() { return random_.below(12) == 0; }

 private:
  Vec3 exact_target(const ParticleState& state, const ContactList& last) {
    const Vec3& p = state.position;
    const Corners v = scene_.complex().corners(state.at());
    switch (random_.below(9)) {
      case 0: return v[random_.below(4)];
      case 1: return scene_.mesh().points[random_.below(static_cast<std::uint32_t>(scene_.mesh().points.size()))];
      case 2: return middle(v);
      case 3: return p + step();
      case 4: return random_.below(4) == 0 ? p : p + step();
      case 5: return p + 2.0 * (v[random_.below(4)] - p);
      case 6: return p + 4.0 * (middle(v) - p);
      default: return last.contacts.empty() ? p + step() : p + along_wall(last);
    }
  }

  Vec3 middle(const Corners& v) {
    const Vec3 a = v[random_.below(4)];
    const Vec3 b = v[random_.below(4)];
    switch (random_.below(3)) {
      case 0: return a;
      case 1: return (a + b) * 0.5;
      default: return (a + b + v[random_.below(4)] + v[random_.below(4)]) * 0.25;
    }
  }

  double unit() { return static_cast<double>(random_.below(3)) - 1.0; }
  Vec3 direction() { return {unit(), unit(), unit()}; }
  Vec3 step() { return direction() * std::ldexp(0.5, static_cast<int>(random_.below(5))); }

  // Exactly in the plane of a wall touched, mostly; the walls' normals have small integer proportions here.
  Vec3 along_wall(const ContactList& last) {
    const auto walls = last.walls_of(last.contacts.back());
    const Vec3 n = walls[random_.below(static_cast<std::uint32_t>(walls.size()))].normal;
    for (int tries = 0; tries < 10; ++tries) {
      const Vec3 d = direction();
      if (std::abs(dot(d, n)) < 1e-9) return d * std::ldexp(0.5, static_cast<int>(random_.below(5)));
    }
    return step();
  }

  void nudge(Vec3& q) {
    const double towards = random_.below(2) == 0 ? 1e300 : -1e300;
    double* const coordinate[] = {&q.x, &q.y, &q.z};
    double& x = *coordinate[random_.below(3)];
    x = x == 0.0 ? std::copysign(std::numeric_limits<double>::epsilon(), towards) : std::nextafter(x, towards);
  }

  const CheckedScene& scene_;
  Random random_;
};

void count(Tally& tally, const ContactList& contacts) {
  if (contacts.contacts.empty()) {
    ++tally.without_contact;
    return;
  }
  const Contact& c = contacts.contacts[0];
  ++tally.contacts_of_kind[static_cast<std::size_t>(c.kind)];
  if (c.time_of_impact == 0.0) ++tally.at_start;
  if (c.time_of_impact == 1.0) ++tally.at_end;
}

std::string walk_lattice(oracle::SceneKind kind, std::uint64_t seed, Tally& tally) {
  const CheckedScene scene(oracle::lattice_scene(kind, seed));
  if (!scene.valid()) return fmt::format("{}, seed {}: invalid", oracle::name_of(kind), seed);
  LatticeMotion motion(scene, seed);
  ContactList contacts;
  ParticleState state = motion.place();
  for (std::uint64_t i = 0; i < steps_per_scene; ++i) {
    if (motion.place_again()) {
      state = motion.place();
      contacts.clear();
    }
    const Vec3 q = motion.target(state, contacts);
    const std::string wrong = scene.check_step(state, q, contacts);
    if (!wrong.empty()) return fmt::format("{}, seed {}, step {}: {}", oracle::name_of(kind), seed, i, wrong);
    count(tally, contacts);
  }
  return {};
}

class LatticeOracle : public ::testing::TestWithParam<int> {};

TEST_P(LatticeOracle, AgreesOnDegenerateSteps) {
  const auto kind = static_cast<oracle::SceneKind>(GetParam());
  const std::uint64_t scenes = scaled(100'000, 10'000'000) / steps_per_scene / lattice_kinds + 1;
  Tally tally;
  for (const std::string& wrong :
       run_seeds(scenes, [&](std::uint64_t seed) { return walk_lattice(kind, seed, tally); })) {
    ADD_FAILURE() << wrong;
  }
  const std::uint64_t steps = scenes * steps_per_scene;
  EXPECT_GT(tally.without_contact, steps / 10);
  for (const auto& contacts : tally.contacts_of_kind) EXPECT_GT(contacts, steps / 100);
  EXPECT_GT(tally.at_start, steps / 100);
  EXPECT_GT(tally.at_end, steps / 100);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LatticeOracle, ::testing::Range(0, lattice_kinds),
                         [](const auto& kind) { return oracle::name_of(static_cast<oracle::SceneKind>(kind.param)); });

}  // namespace dartcast::test::lattice_oracle_test
