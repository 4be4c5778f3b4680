// Contacts answered in rounds: the same bits as one by one, in every kind of scene, and nothing changed after an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/random.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/particle_checks.hpp"
#include "support/report_words.hpp"
#include "support/stepped_scenes.hpp"
#include "support/tier.hpp"

namespace dartcast::rounds_test {

using test::Answers;
using test::make_scenes;
using test::scattered;
using test::swirled;
using test::words_of;
using Scene = test::SteppedScene;

void expect_equal(const StepReport& rounds, const StepReport& one_by_one) {
  ASSERT_EQ(rounds.contacts.contacts.size(), one_by_one.contacts.contacts.size());
  ASSERT_EQ(rounds.held.size(), one_by_one.held.size());
  ASSERT_EQ(rounds.stopped.size(), one_by_one.stopped.size());
  EXPECT_EQ(words_of(rounds), words_of(one_by_one));
  EXPECT_EQ(words_of(rounds.counters), words_of(one_by_one.counters));
}

// The same answers in rounds. Checks what the contract says of each call.
class InRounds {
 public:
  explicit InRounds(ContactCallback respond) : respond_(std::move(respond)) {}

  RoundCallback callback() {
    last_.clear();
    return [this](const ContactList& contacts, std::span<AfterContact> after) { answer(contacts, after); };
  }
  [[nodiscard]] std::size_t most_rounds() const { return most_rounds_; }
  [[nodiscard]] std::size_t corners() const { return corners_; }

 private:
  void answer(const ContactList& list, std::span<AfterContact> after) {
    ASSERT_EQ(std::this_thread::get_id(), caller_);
    ASSERT_EQ(list.contacts.size(), after.size());
    ASSERT_FALSE(after.empty());
    std::size_t walls = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const Contact& c = list.contacts[i];
      if (i > 0) ASSERT_GT(c.particle, list.contacts[i - 1].particle);
      ASSERT_EQ(test::bits(after[i].displacement), test::bits(Vec3{}));
      ASSERT_FALSE(after[i].along);
      ASSERT_EQ(c.first_wall, walls + c.earlier);
      walls += c.earlier + c.wall_count;
      corners_ += c.together > 0 && c.wall_count > 1 ? 1 : 0;
      after[i] = respond_(c, list.walls_of(c), list.earlier_walls_of(c));
    }
    ASSERT_EQ(walls, list.walls.size());
    expect_next_of(list);
    last_.push_back(list);
    most_rounds_ = std::max(most_rounds_, last_.size());
  }

  // Each contact follows one of the round before: its walls are then earlier ones.
  void expect_next_of(const ContactList& list) const {
    if (last_.empty()) return;
    const ContactList& before = last_.back();
    auto at = before.contacts.begin();
    for (const Contact& c : list.contacts) {
      while (at != before.contacts.end() && at->particle != c.particle) ++at;
      ASSERT_NE(at, before.contacts.end());
      ASSERT_GE(c.time_of_impact, at->time_of_impact);
      ASSERT_EQ(c.earlier, at->earlier + at->wall_count);
    }
  }

  ContactCallback respond_;
  std::thread::id caller_ = std::this_thread::get_id();
  std::vector<ContactList> last_;
  std::size_t most_rounds_ = 0;
  std::size_t corners_ = 0;
};

// The cases that a run has come across: none must be left out.
struct Seen {
  Counters counters;
  std::size_t rounds = 0;
  std::size_t corners = 0;
  std::size_t held = 0;
  std::size_t split_contacts = 0;  // in steps of a scene that splits some
};

// Advances two equal sets side by side.
void run(const Scene& scene, unsigned threads, const StepOptions& options, std::uint64_t seed, Seen& seen) {
  Environment environment(scene.mesh, Threads{threads});
  Random random(seed);
  Particles expected = scattered(environment, scene.mesh, test::scaled<std::size_t>(400, 4000), random);
  Particles particles = expected;
  std::vector<Vec3> targets(particles.size());
  Answers answers(particles.size());
  Answers same_answers(particles.size());
  InRounds in_rounds(std::ref(same_answers));
  const int steps = std::max(6, test::scaled(12, 100));
  for (int step = 1; step <= steps; ++step) {
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const Vec3 v = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      targets[i] = expected[i].position + v * scene.speed;
      if (environment.map().dimension() == 2) targets[i].z = 0.0;
    }
    if (scene.moved) {
      const auto next = environment.next_positions();
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = scene.moved(scene.mesh.points[i], step);
      environment.move();
    }
    answers.start_step();
    same_answers.start_step();
    const StepReport one_by_one = environment.advance(expected, targets, std::ref(answers), options);
    const StepReport rounds = environment.advance_in_rounds(particles, targets, in_rounds.callback(), options);
    ASSERT_NO_FATAL_FAILURE(expect_equal(rounds, one_by_one)) << scene.name << ", step " << step;
    ASSERT_TRUE(test::same_bits(test::copy_of(expected), particles)) << scene.name << ", step " << step;
    ASSERT_TRUE(std::ranges::equal(expected.vertex_numbers(), particles.vertex_numbers()));
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (particles[i].held) ASSERT_EQ(expected.held_weights(i), particles.held_weights(i));
    }
    seen.counters += rounds.counters;
    seen.held += rounds.held.size();
    seen.split_contacts += rounds.counters.steps_split > 0 ? rounds.contacts.contacts.size() : 0;
  }
  seen.rounds = std::max(seen.rounds, in_rounds.most_rounds());
  seen.corners += in_rounds.corners();
}

TEST(Rounds, GiveTheBitsOfAnswersOneByOne) {
  Seen seen;
  for (const Scene& scene : make_scenes()) {
    for (const unsigned threads : {1U, 2U, 4U}) {
      StepOptions options;
      options.max_contacts = threads == 1 ? 16 : threads == 2 ? 3 : 1;
      options.tolerance = threads == 2 ? 0.005 : 0.05;
      options.max_slices = threads == 4 ? 3 : 256;
      run(scene, threads, options, threads, seen);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_EQ(seen.rounds, 16U);
  EXPECT_GT(seen.counters.unfinished, 100U);
  EXPECT_GT(seen.counters.steps_split, 100U);
  EXPECT_GT(seen.split_contacts, 100U);
  EXPECT_GT(seen.held, 0U);
  EXPECT_GT(seen.corners, 0U);
  for (const std::uint64_t contacts : seen.counters.contacts) EXPECT_GT(contacts, 0U);
}

// The library's own response, with velocities, and particles that stick or are absorbed.
TEST(Rounds, TakeTheLibrarysResponses) {
  const MeshData mesh = make_scenes()[2].mesh;
  Environment environment(mesh);
  Random random(3);
  Particles expected = scattered(environment, mesh, 500, random);
  Particles particles = expected;
  WallResponses responses(Reflect{0.8, 0.1});
  responses.set(Patch{1}, Absorb{});
  std::vector<Vec3> velocities(particles.size());
  for (Vec3& v : velocities) v = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  std::vector<Vec3> same_velocities = velocities;
  std::vector<ParticleStatus> statuses(particles.size());
  std::vector<ParticleStatus> same_fates = statuses;
  for (int step = 1; step <= 10; ++step) {
    std::vector<Vec3> targets = test::positions_of(particles);
    for (std::size_t i = 0; i < targets.size(); ++i) targets[i] += velocities[i] * 2.0;
    const auto next = environment.next_positions();
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = swirled(mesh.points[i], step);
    environment.move();
    InRounds in_rounds(respond_with(responses, same_velocities, same_fates, 2.0));
    const StepReport one_by_one =
        environment.advance(expected, targets, respond_with(responses, velocities, statuses, 2.0));
    const StepReport rounds = environment.advance_in_rounds(particles, targets, in_rounds.callback());
    ASSERT_NO_FATAL_FAILURE(expect_equal(rounds, one_by_one));
    ASSERT_TRUE(test::same_bits(test::copy_of(expected), particles));
    ASSERT_EQ(velocities, same_velocities);
    ASSERT_EQ(statuses, same_fates);
  }
}

// --- stopping

TEST(Rounds, AnEmptyFunctionStopsAsInAdvance) {
  const Scene scene = make_scenes()[1];
  Environment environment(scene.mesh);
  Random random(5);
  Particles expected = scattered(environment, scene.mesh, 300, random);
  Particles particles = expected;
  const std::vector<Vec3> targets(particles.size(), Vec3{9, 9, 9});
  const StepReport one_by_one = environment.advance(expected, targets);
  const StepReport rounds = environment.advance_in_rounds(particles, targets, {});
  EXPECT_GT(rounds.stopped.size(), 200U);
  expect_equal(rounds, one_by_one);
  EXPECT_TRUE(test::same_bits(test::copy_of(expected), particles));
}

// A slab of thickness 1 whose floor rises by 0.5: a particle without an answer is carried by it.
TEST(Rounds, AParticleWithoutAnAnswerStaysAtTheWallThatMoves) {
  const MeshData mesh = test::cubes(1, CellType::hexahedron);
  Environment environment(mesh);
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.75}, {0.25, 0.5, 0.9}});
  std::vector<Vec3> risen = mesh.points;
  for (Vec3& p : risen) p.z = p.z == 0.0 ? 0.5 : p.z;
  environment.move(risen);
  int rounds = 0;
  const StepReport report = environment.advance_in_rounds(
      particles, std::vector<Vec3>{{0.5, 0.5, -1.0}, {0.25, 0.5, 0.8}},
      [&](const ContactList& contacts, std::span<AfterContact>) {
        ++rounds;
        ASSERT_EQ(contacts.contacts.size(), 1U);
        EXPECT_EQ(contacts.contacts[0].particle, 0U);
        EXPECT_EQ(contacts.walls_of(contacts.contacts[0]).front().normal, (Vec3{0, 0, 1}));
      });
  EXPECT_EQ(rounds, 1);
  EXPECT_NEAR(particles[0].position.z, 0.5, 1e-12);
  EXPECT_EQ(particles[1].position, (Vec3{0.25, 0.5, 0.8}));
  EXPECT_EQ(report.contacts.contacts.size(), 1U);
  EXPECT_TRUE(report.stopped.empty());
}

TEST(Rounds, AreNotAskedForWithoutContacts) {
  Environment environment(test::cubes(2));
  Particles particles;
  const RoundCallback never = [](const ContactList&, std::span<AfterContact>) { FAIL(); };
  EXPECT_EQ(environment.advance_in_rounds(particles, {}, never).counters.particle_steps, 0U);
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}});
  environment.advance_in_rounds(particles, std::vector<Vec3>{{1.5, 0.5, 0.5}}, never);
  EXPECT_EQ(particles[0].position, (Vec3{1.5, 0.5, 0.5}));
}

// Straight on into the wall at each contact: the last one allowed says so, and the next one is not asked about.
TEST(Rounds, EndAtTheLastContactAllowed) {
  Environment environment(test::cubes(1));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}});
  StepOptions options;
  options.max_contacts = 3;
  std::vector<bool> last;
  const StepReport report = environment.advance_in_rounds(
      particles, std::vector<Vec3>{{2.0, 0.5, 0.5}},
      [&](const ContactList& contacts, std::span<AfterContact> after) {
        last.push_back(contacts.contacts.at(0).last);
        after[0].displacement = contacts.contacts[0].unused;
      },
      options);
  EXPECT_EQ(last, (std::vector<bool>{false, false, true}));
  EXPECT_EQ(report.contacts.contacts.size(), 4U);
  EXPECT_EQ(report.counters.unfinished, 1U);
  ASSERT_EQ(report.stopped.size(), 1U);
  EXPECT_NEAR(report.stopped[0].unused.x, 1.0, 1e-12);
}

// --- errors

struct Stop : std::runtime_error {
  Stop() : std::runtime_error("stop") {}
};

// The round `bad` throws, or has a displacement that is none. The particles then take the step as if nothing had been.
TEST(Rounds, LeaveParticlesAsTheyWereAfterAnError) {
  for (const bool throws : {true, false}) {
    for (const int bad : {1, 2, 4}) {
      const Scene scene = make_scenes()[1];
      Environment environment(scene.mesh, Threads{2});
      Random random(7);
      Particles expected = scattered(environment, scene.mesh, 300, random);
      Particles particles = expected;
      for (int step = 1; step <= 4; ++step) {
        std::vector<Vec3> targets = test::positions_of(particles);
        for (Vec3& q : targets) q += {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
        const auto next = environment.next_positions();
        for (std::size_t i = 0; i < next.size(); ++i) next[i] = swirled(scene.mesh.points[i], step);
        environment.move();
        Answers answers(particles.size());
        InRounds in_rounds(std::ref(answers));
        const RoundCallback good = in_rounds.callback();
        int round = 0;
        const RoundCallback fails = [&](const ContactList& contacts, std::span<AfterContact> after) {
          good(contacts, after);
          if (++round < bad) return;
          if (throws) throw Stop();
          after.back().displacement.y = std::numeric_limits<double>::quiet_NaN();
        };
        const auto call = [&] { environment.advance_in_rounds(particles, targets, fails); };
        if (throws)
          EXPECT_THROW(call(), Stop);
        else
          test::expect_refused(call, "returned a displacement that is not finite");
        ASSERT_EQ(round, bad);
        ASSERT_TRUE(test::same_bits(test::copy_of(expected), particles));
        answers.start_step();
        const StepReport rounds = environment.advance_in_rounds(particles, targets, in_rounds.callback());
        answers.start_step();
        ASSERT_NO_FATAL_FAILURE(expect_equal(rounds, environment.advance(expected, targets, std::ref(answers))));
        ASSERT_TRUE(test::same_bits(test::copy_of(expected), particles));
      }
    }
  }
}

TEST(Rounds, RefuseWhatAdvanceRefuses) {
  Environment environment(test::cubes(2));
  Particles particles;
  environment.add(particles, std::vector<Vec3>{{0.5, 0.5, 0.5}});
  const RoundCallback respond = [](const ContactList&, std::span<AfterContact>) {};
  test::expect_refused([&] { environment.advance_in_rounds(particles, {}, respond); },
                       "advance_in_rounds: 0 targets for 1 particles");
  StepOptions options;
  options.max_contacts = 0;
  test::expect_refused([&] { environment.advance_in_rounds(particles, std::vector<Vec3>(1), respond, options); },
                       "advance_in_rounds: max_contacts is 0");
  const std::vector<Vec3> bad = {{std::nan(""), 0, 0}};
  test::expect_refused([&] { environment.advance_in_rounds(particles, bad, respond); }, "the target of particle 0");
  Environment other(test::cubes(2));
  test::expect_refused([&] { other.advance_in_rounds(particles, std::vector<Vec3>(1), respond); },
                       "of another environment");
  EXPECT_EQ(particles[0].position, (Vec3{0.5, 0.5, 0.5}));
}

}  // namespace dartcast::rounds_test
