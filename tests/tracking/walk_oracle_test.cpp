// Random walks in random scenes, each compared with the oracle: 10^5 particle-steps, 10^7 in the full tier.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/random.hpp"
#include "oracle/checked_scene.hpp"
#include "support/seeds.hpp"

namespace dartcast::test::walk_oracle_test {

constexpr std::uint64_t steps_per_scene = 1000;

// The scene of a seed, warped as much as the cells allow.
std::unique_ptr<CheckedScene> make_valid(oracle::SceneKind kind, std::uint64_t seed) {
  for (double warp = 1.0; warp > 0.05; warp *= 0.5) {
    auto scene = std::make_unique<CheckedScene>(oracle::random_scene(kind, seed, warp));
    if (scene->valid()) return scene;
  }
  return std::make_unique<CheckedScene>(oracle::random_scene(kind, seed, 0.0));
}

class RandomMotion {
 public:
  RandomMotion(const CheckedScene& scene, std::uint64_t seed) : scene_(scene), random_(seed, 3) {}

  // A new particle somewhere in a free simplex, inside or at a corner; the position is exactly in it.
  ParticleState place() {
    const auto& free = scene_.free_simplices();
    while (true) {
      const std::uint32_t s = free[random_.below(static_cast<std::uint32_t>(free.size()))];
      const Vec3 p = random_.below(4) == 0 ? corner(s) : point_in(s);
      if (!scene_.oracle().contains(s, p)) continue;
      ParticleState state;
      state.put(scene_.library_simplex(s), p);
      return state;
    }
  }

  Vec3 target(const ParticleState& state) {
    const auto& points = scene_.oracle().points();
    if (random_.below(8) == 0) return points[random_.below(static_cast<std::uint32_t>(points.size()))];
    const auto v = scene_.complex().corners(state.at());
    if (random_.below(8) == 0) return (v[random_.below(4)] + v[random_.below(4)]) * 0.5;
    const double edge = std::max({norm(v[1] - v[0]), norm(v[2] - v[0]), norm(v[3] - v[0])});
    const double length = edge * std::exp2(random_.uniform(-6.0, 2.0));
    return state.position +
           Vec3{random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0)} * length;
  }

  bool place_again() { return random_.below(16) == 0; }

 private:
  Vec3 corner(std::uint32_t s) {
    return scene_.oracle().points()[scene_.oracle().triangulation().simplices()[s].vertex[random_.below(4)]];
  }
  Vec3 point_in(std::uint32_t s) {
    Vec3 sum;
    double weights = 0.0;
    for (const std::uint32_t v : scene_.oracle().triangulation().simplices()[s].vertex) {
      const double w = random_.uniform();
      sum += scene_.oracle().points()[v] * w;
      weights += w;
    }
    return sum * (1.0 / weights);
  }

  const CheckedScene& scene_;
  Random random_;
};

// Counts of all scenes together, so that a test without contacts fails.
struct Tally {
  std::atomic<std::uint64_t> contacts{0};
  std::atomic<std::uint64_t> with_interior_points{0};
};

// All steps in the scene of a seed; what went wrong first.
std::string walk_scene(oracle::SceneKind kind, std::uint64_t seed, Tally& tally) {
  const auto scene = make_valid(kind, seed);
  if (!scene->valid()) return "the scene is invalid even without a warp";
  tally.with_interior_points += scene->complex().steiner_point_count() > 0 ? 1 : 0;
  RandomMotion motion(*scene, seed);
  ContactList contacts;
  ParticleState state = motion.place();
  for (std::uint64_t i = 0; i < steps_per_scene; ++i) {
    if (motion.place_again()) state = motion.place();
    std::string wrong = scene->check_step(state, motion.target(state), contacts);
    if (!wrong.empty()) return fmt::format("{}, seed {}, step {}: {}", oracle::name_of(kind), seed, i, wrong);
    tally.contacts += contacts.contacts.size();
  }
  return {};
}

struct SliverStep {
  std::uint64_t seed;
  std::uint32_t simplex;
  Vec3 from, to;
};

// Contacts between walls at angles of 1e-9 to 1e-17, where few doubles are inside. They were put back by up to 1e11
// units in the last place.
constexpr std::array sliver_steps = {
    SliverStep{115,
               69,
               {0x1.9cc1d0257faefp+1, 0x1.ff58387481ad1p+1, 0x1.7d85b126a02bep+2},
               {0x1.fd1e9036e7c38p+0, 0x1.00f21500335cep+2, 0x1.3fd63f6c23f33p+2}},
    SliverStep{
        254, 25, {0x1.8e0eee30d151cp+1, 0x1.2ca236ac7776cp+1, 0x1.6550e02061c43p-2}, {0x1.8p+2, 0x0p+0, 0x1.8p+2}},
    SliverStep{361,
               25,
               {0x1.d91a54d220d02p+0, 0x1.c966db67aba8fp-1, 0x1.aa59bda67adfbp+1},
               {0x1.de43ca4bb3752p-1, -0x1.73c274d7761aap-2, 0x1.1de8dba427826p+1}},
    SliverStep{406,
               86,
               {0x1.258b22c959c44p+2, 0x1.06fc32b1e3dcep+2, 0x1.5ae5b684c175cp+0},
               {0x1.1e5e5b580d8dfp+1, 0x1.78bd60c0439eep+2, 0x1.047f3e86bff77p+2}},
    SliverStep{444, 60, {0x1.49d308749c8b2p+0, 0x1.5274c21c9e4aep+2, 0x1.515ae4021afa8p+1}, {0x0p+0, 0x0p+0, 0x1p+2}},
    SliverStep{462, 17, {0x1.08984872962a2p+2, 0x1.13090e52c5477p-3, 0x1.70ce9e18b72efp+0}, {0x0p+0, 0x1p+1, 0x0p+0}},
    SliverStep{633,
               46,
               {0x1.0ab9926800632p+2, 0x1.09c395eb6706cp+2, 0x1.115796d83cd74p+2},
               {0x1.6b7a07af72215p+1, 0x1.fc294d9a9600fp+0, 0x1.012838a441d12p+2}},
    SliverStep{642,
               44,
               {0x1.e112d9412d978p+1, 0x1p+2, 0x1.51db50cf23ffep+1},
               {0x1.e48fb9ccf29b6p+1, 0x1.f5ec43df23366p+1, 0x1.49ddeef860287p+1}},
    SliverStep{664,
               46,
               {0x1.ae3c328f80214p+1, 0x1.6c2b0e448d9ddp+1, 0x1.fffffffe90bb8p+1},
               {0x1.a39999635c926p+1, 0x1.c3ad6583ab32dp+1, 0x1.fffffffe60f64p+1}},
    SliverStep{817,
               69,
               {0x1.ee4893d8a8859p+1, 0x1.87ecc248a5d14p+2, 0x1.07f6783aee8dap+2},
               {0x1.f07d7f086176p+0, 0x1.8af0cfb8fee18p+2, 0x1.790ff36bf0bb6p+1}},
    SliverStep{953,
               69,
               {0x1.d25420145f6edp+0, 0x1.8adc801d0f052p+2, 0x1.8c837ed669bfp+1},
               {0x1.bd11f68061689p+0, 0x1.8c1adedb97c1fp+2, 0x1.82a57af431974p+1}}};

TEST(SliverContacts, KeepsContactsBetweenWallsAtSmallAnglesInPlace) {
  for (const SliverStep& step : sliver_steps) {
    const auto scene = make_valid(oracle::SceneKind::slivers, step.seed);
    ASSERT_TRUE(scene->valid()) << step.seed;
    ASSERT_TRUE(scene->oracle().contains(step.simplex, step.from)) << step.seed;
    ParticleState state;
    state.put(scene->library_simplex(step.simplex), step.from);
    ContactList contacts;
    EXPECT_EQ(scene->check_step(state, step.to, contacts), "") << step.seed;
    EXPECT_EQ(contacts.contacts.size(), 1U) << step.seed;
  }
}

class WalkOracle : public ::testing::TestWithParam<int> {};

TEST_P(WalkOracle, AgreesOnRandomWalks) {
  const auto kind = static_cast<oracle::SceneKind>(GetParam());
  const std::uint64_t scenes = scaled(100'000, 10'000'000) / steps_per_scene / oracle::scene_kinds + 1;
  Tally tally;
  for (const std::string& wrong :
       run_seeds(scenes, [&](std::uint64_t seed) { return walk_scene(kind, seed, tally); })) {
    ADD_FAILURE() << wrong;
  }
  EXPECT_GT(tally.contacts, scenes * steps_per_scene / 10);
  const bool some_have_them = kind == oracle::SceneKind::hexahedra || kind == oracle::SceneKind::flat_corners;
  if (some_have_them && scenes >= 10) {  // not in the few scenes that sanitizers get
    EXPECT_GT(tally.with_interior_points, 0U);
  }
}

// Steps that once ended on walls that they did not meet: at vertices and edges of cells with flat corners.
TEST(WalkOracleSeeds, FlatCornersDoNotJoinWallsThatAreApart) {
  Tally tally;
  for (const std::uint64_t seed : {60U, 93U, 111U, 120U, 139U, 152U}) {
    EXPECT_EQ(walk_scene(oracle::SceneKind::flat_corners, seed, tally), "");
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, WalkOracle, ::testing::Range(0, oracle::scene_kinds),
                         [](const auto& kind) { return oracle::name_of(static_cast<oracle::SceneKind>(kind.param)); });

}  // namespace dartcast::test::walk_oracle_test
