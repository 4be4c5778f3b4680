// Random walks in random scenes, each compared with the oracle: 10^5 particle-steps, 10^7 in the full tier.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "dartcast/base/random.hpp"
#include "walk/checked_scene.hpp"
#include "walk/seeds.hpp"

namespace dartcast::test {
namespace {

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
  State place() {
    const auto& free = scene_.free_simplices();
    while (true) {
      const std::uint32_t s = free[random_.below(static_cast<std::uint32_t>(free.size()))];
      const Vec3 p = random_.below(4) == 0 ? corner(s) : point_in(s);
      if (!scene_.oracle().contains(s, p)) continue;
      State state;
      state.put(scene_.library_simplex(s), p);
      return state;
    }
  }

  Vec3 target(const State& state) {
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

// What all scenes together had, so that a test that meets nothing fails.
struct Tally {
  std::atomic<std::uint64_t> contacts{0};
  std::atomic<std::uint64_t> with_interior_points{0};
};

// All steps in the scene of a seed; what went wrong first.
std::string walk_scene(oracle::SceneKind kind, std::uint64_t seed, Tally& tally) {
  const auto scene = make_valid(kind, seed);
  if (!scene->valid()) return "the scene is invalid even without a warp";
  tally.with_interior_points += scene->complex().interior_point_count() > 0 ? 1 : 0;
  RandomMotion motion(*scene, seed);
  ContactList contacts;
  State state = motion.place();
  for (std::uint64_t i = 0; i < steps_per_scene; ++i) {
    if (motion.place_again()) state = motion.place();
    std::string wrong = scene->check_step(state, motion.target(state), contacts);
    if (!wrong.empty()) return fmt::format("{}, seed {}, step {}: {}", oracle::name_of(kind), seed, i, wrong);
    tally.contacts += contacts.contacts.size();
  }
  return {};
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

INSTANTIATE_TEST_SUITE_P(Scenes, WalkOracle, ::testing::Range(0, oracle::scene_kinds),
                         [](const auto& kind) { return oracle::name_of(static_cast<oracle::SceneKind>(kind.param)); });

}  // namespace
}  // namespace dartcast::test
