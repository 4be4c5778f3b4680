// Steps that are recorded, written, read and taken again. (The soak does so with every kind of cell.)
#include "dartcast/replay.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <vector>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "environment/watched_step.hpp"
#include "support/expectations.hpp"
#include "support/particle_checks.hpp"
#include "tracking/walk.hpp"

namespace dartcast::replay_test {

namespace {

struct Scene {
  explicit Scene(std::uint32_t n = 6) : environment(box(n)) {
    Random random(7);
    std::vector<Vec3> places;
    for (int i = 0; i < 40; ++i) places.push_back({random.uniform(0, n), random.uniform(0, n), random.uniform(0, n)});
    environment.add(particles, places);
    for (std::size_t i = 0; i < particles.size(); ++i)
      targets.push_back(particles[i].position +
                        Vec3{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)});
  }
  static MeshData box(std::uint32_t n) {
    BoxOptions o;
    o.cells = {n, n, n};
    o.size = {double(n), double(n), double(n)};
    return generate_box(o);
  }
  void bend() {
    std::vector<Vec3> next(environment.positions().begin(), environment.positions().end());
    for (Vec3& p : next) p += Vec3{0.1 * p.y, 0.05 * p.z, -0.1 * p.x};
    environment.move(next);
  }

  Environment environment;
  Particles particles;
  std::vector<Vec3> targets;
};

AfterContact bounce(const Contact& c, std::span<const WallHit> walls, std::span<const WallHit>) {
  return {c.unused - 2.0 * dot(c.unused, walls[0].normal) * walls[0].normal};
}

}  // namespace

TEST(Replay, TakesAStepAgainToTheSameBits) {
  for (const bool moves : {false, true}) {
    Scene s;
    if (moves) s.bend();
    const Particles before = s.particles;
    s.environment.advance(s.particles, s.targets, bounce);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const StepReplay step = s.environment.record(before, i, s.targets[i], bounce);
      const std::string text = replay_text(step);
      const StepReplay again = replay_of_text(text);
      EXPECT_EQ(replay_text(again), text);
      const ReplayResult result = replay(again);
      EXPECT_EQ(result.wrong, "") << i;
      EXPECT_EQ(result.contacts.contacts.size(), step.answers.size()) << i;
      ASSERT_FALSE(result.cut) << i;
      EXPECT_EQ(test::bits(result.state.position), test::bits(s.particles[i].position)) << i;
    }
  }
}

TEST(Replay, HasOnlyTheCellsAround) {
  Scene s(20);
  const StepReplay step = s.environment.record(s.particles, 0, s.particles[0].position + Vec3{0.1, 0.1, 0.1});
  EXPECT_LE(step.mesh.cell_count(), 64U);
  EXPECT_LT(replay_text(step).size(), 20000U);
}

TEST(Replay, SaysWhereTheFileHasNoCells) {
  Scene s(20);
  StepReplay step = s.environment.record(s.particles, 0, s.particles[0].position);
  step.target = step.state.position + Vec3{9.0, 0.0, 0.0};
  EXPECT_TRUE(replay(step).cut);
}

TEST(Replay, ComesWithAWalkThatDoesNotEnd) {
  Scene s;
  Space<Stored> space = current_space(s.environment.complex());
  space.simplex_count = 1;  // so that any longer walk seems to have no end
  const Vec3 to = {5.5, 5.4, 5.3};
  TestCounts counts;
  try {
    walk(space, s.particles[0].at(), s.particles[0].position, to, counts);
    FAIL();
  } catch (const InternalError& e) {
    ASSERT_TRUE(e.replay());
    EXPECT_NE(std::string(e.what()).find("meets more simplices than there are"), std::string::npos) << e.what();
    const ReplayResult result = replay(*e.replay());
    EXPECT_EQ(result.wrong, "");
    EXPECT_EQ(test::bits(result.state.position), test::bits(to));
  }
}

TEST(Replay, TheHookGetsTheStepOfAParticleThatFailsTheAudit) {
  Scene s;
  std::vector<StepReplay> got;
  s.environment.set_replay_hook([&](const StepReplay& step) { got.push_back(step); });
  const Particles before = s.particles;
  s.environment.advance(s.particles, s.targets, bounce);
  EXPECT_TRUE(got.empty());
  WatchedStep watched(s.environment, before, s.targets, {}, false);
  std::vector<ParticleState> states(s.particles.states().begin(), s.particles.states().end());
  states[3].position.x += 2.0;
  watched.check(states, std::vector<Weights>(states.size()));
  ASSERT_EQ(got.size(), 1U);
  EXPECT_NE(got[0].reason.find("outside its simplex"), std::string::npos) << got[0].reason;
  EXPECT_EQ(test::bits(*got[0].end), test::bits(states[3].position));
  EXPECT_EQ(replay(got[0]).wrong, "") << "the step itself is right";
}

TEST(Replay, AHookChangesNoBits) {
  Scene plain, watched;
  watched.environment.set_replay_hook([](const StepReplay&) {});
  for (Scene* s : {&plain, &watched}) {
    s->bend();
    s->environment.advance(s->particles, s->targets, bounce);
    std::vector<Vec3> back;
    for (std::size_t i = 0; i < s->particles.size(); ++i) back.push_back(s->targets[i] * 0.5);
    s->environment.advance_in_rounds(s->particles, back, [](const ContactList& list, std::span<AfterContact> after) {
      for (std::size_t i = 0; i < after.size(); ++i)
        after[i] = bounce(list.contacts[i], list.walls_of(list.contacts[i]), {});
    });
  }
  EXPECT_TRUE(test::same_bits(test::copy_of(plain.particles), watched.particles));
}

TEST(Replay, FilesThatAreNoneAreRefusedByName) {
  const auto file = std::filesystem::path(testing::TempDir()) / "replay.json";
  Scene s;
  write_replay(s.environment.record(s.particles, 0, s.targets[0]), file);
  EXPECT_EQ(replay(read_replay(file)).wrong, "");
  const std::string good = replay_text(s.environment.record(s.particles, 0, s.targets[0]));
  const auto refused = [&](const std::string& text, const std::string& reason) {
    std::ofstream(file) << text;
    test::expect_parts(test::error_text([&] { read_replay(file); }), {reason.c_str()});
  };
  refused("", "replay.json: this is no replay");
  refused("[]", "replay.json");
  refused("{\"kind\": \"dartcast replay 1\"}", "reason");
  std::string text = good;
  text.replace(text.find("hexahedron"), 10, "icosahedro");
  refused(text, "there is no type of cell 'icosahedro'");
  // A state that fits no cells is refused when the step is taken.
  StepReplay bad = replay_of_text(good);
  bad.state.cell = Cell{5000};
  EXPECT_THROW(replay(bad), InvalidArgument);
  bad = replay_of_text(good);
  bad.mesh.connectivity[0] = 60000;
  EXPECT_THROW(replay(bad), InvalidMesh);
}

}  // namespace dartcast::replay_test
