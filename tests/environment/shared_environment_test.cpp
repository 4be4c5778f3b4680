// A shared environment against one of the whole mesh, through its public calls alone.
#include "dartcast/shared_environment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/response.hpp"
#include "support/stepped_scenes.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::shared_environment_test {

BoxOptions box() {
  BoxOptions options;
  options.cells = {9, 6, 6};
  options.size = {9.0, 6.0, 6.0};
  options.blocked_layer = true;
  options.jitter = 0.2;
  return options;
}

std::vector<Vec3> start(std::size_t count) {
  Random random(4);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({random.uniform(0.5, 9.5), random.uniform(0.5, 5.5), random.uniform(0.5, 5.5)});
  return points;
}

Vec3 way(std::uint64_t id, int step) {
  Random random(id, static_cast<std::uint64_t>(step));
  return {random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9)};
}

// Back along the way: a rebound that looks at nothing but the contact.
AfterContact back(const Contact& c, std::span<const WallHit>, std::span<const WallHit>) {
  return {-0.5 * c.unused, false};
}

struct Seen {
  std::map<std::uint64_t, std::pair<Vec3, Cell>> particles;
  std::map<std::uint64_t, double> data;
  std::uint64_t contacts = 0;
};

Seen step_alone(const ContactCallback& respond, std::size_t count) {
  Environment environment(generate_box(box()));
  Particles particles;
  environment.add(particles, start(count));
  Seen seen;
  std::vector<double> data(particles.size());
  for (int s = 0; s < 12; ++s) {
    std::vector<Vec3> x = generate_box(box()).points;
    for (Vec3& p : x) p = test::sheared(p, s);
    environment.move(x);
    std::vector<Vec3> targets;
    for (std::size_t i = 0; i < particles.size(); ++i) targets.push_back(particles[i].position + way(i, s));
    const StepReport report = environment.advance(particles, targets, respond);
    seen.contacts += report.contacts.contacts.size();
    for (const Contact& c : report.contacts.contacts) data[c.particle] += 1.0;
  }
  for (std::size_t i = 0; i < particles.size(); ++i) {
    seen.particles[i] = {particles[i].position, particles[i].cell};
    seen.data[i] = data[i];
  }
  return seen;
}

Seen step_shared(unsigned count, const ContactCallback& respond, std::size_t points) {
  Seen seen;
  std::mutex mutex;
  test::on_ranks(count, [&](Ranks& ranks) {
    SharedEnvironment environment(box_part(box(), count, ranks.rank()), ranks, Threads{1});
    SharedParticles particles(1);
    environment.add(particles, start(points));
    std::uint64_t contacts = 0;
    std::map<std::uint64_t, double> met;
    for (int s = 0; s < 12; ++s) {
      std::vector<Vec3> x = environment.part().mesh.points;
      for (Vec3& p : x) p = test::sheared(p, s);
      environment.move(x);
      std::vector<Vec3> targets;
      for (std::size_t i = 0; i < particles.size(); ++i)
        targets.push_back(particles.particles()[i].position + way(particles.ids()[i], s));
      const SharedStep step = environment.advance(particles, targets, respond);
      contacts += step.contact_ids.size();
      const std::lock_guard lock(mutex);
      for (const std::uint64_t id : step.contact_ids) seen.data[id] += 1.0;
    }
    EXPECT_EQ(environment.audit(particles).failed, 0U);
    EXPECT_EQ(environment.audit(particles).checked, environment.count(particles));
    const std::lock_guard lock(mutex);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const ParticleState& p = particles.particles()[i];
      EXPECT_TRUE(seen.particles.emplace(particles.ids()[i], std::pair{p.position, environment.whole(p.cell)}).second);
    }
    seen.contacts += contacts;
  });
  for (const auto& [id, unused] : seen.particles) seen.data.try_emplace(id, 0.0);
  return seen;
}

TEST(SharedEnvironment, StepsAsOneOfTheWholeMesh) {
  for (const ContactCallback& respond : {ContactCallback(back), ContactCallback()}) {
    const Seen alone = step_alone(respond, 400);
    EXPECT_GT(alone.contacts, 100U);
    for (const unsigned ranks : {1U, 2U, 3U, 8U}) {
      const Seen shared = step_shared(ranks, respond, 400);
      EXPECT_EQ(shared.particles, alone.particles) << ranks;
      EXPECT_EQ(shared.data, alone.data) << ranks;
      EXPECT_EQ(shared.contacts, alone.contacts) << ranks;
    }
  }
}

// Numbers stay with their particle on its way, and so do places with positions.
TEST(SharedEnvironment, DataGoAlong) {
  test::on_ranks(4, [&](Ranks& ranks) {
    SharedEnvironment environment(box_part(box(), 4, ranks.rank()), ranks, Threads{1});
    SharedParticles particles(2);
    const std::vector<Place> places = environment.add(
        particles, std::vector<Vec3>{{0.5, 3.0, 3.0}, {4.0, 3.0, 3.0}, {-1.0, 0.0, 0.0}, {5.0, 3.0, 3.0}});
    EXPECT_EQ(places, (std::vector{Place::blocked, Place::free, Place::outside, Place::free}));
    EXPECT_EQ(environment.count(particles), 2U);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      particles.user_data(i)[0] = 10.0 + static_cast<double>(particles.ids()[i]);
      particles.user_data(i)[1] = -particles.user_data(i)[0];
    }
    std::uint64_t left = 0;
    for (int s = 0; s < 8; ++s) {
      std::vector<Vec3> targets;
      for (std::size_t i = 0; i < particles.size(); ++i) {
        const double x = particles.ids()[i] == 0 ? 1.0 : -1.0;
        targets.push_back(particles.particles()[i].position + Vec3{s < 4 ? x : -x, 0.1, 0.0});
      }
      left += environment.advance(particles, targets).left;
      for (std::size_t i = 0; i < particles.size(); ++i) {
        EXPECT_EQ(particles.user_data(i)[0], 10.0 + static_cast<double>(particles.ids()[i]));
        EXPECT_EQ(particles.user_data(i)[1], -particles.user_data(i)[0]);
      }
    }
    SharedParticles copy = particles;
    SharedParticles moved = std::move(copy);
    copy = particles;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      copy.user_data(i)[0] = 0.0;
      EXPECT_EQ(moved.user_data(i)[0], particles.user_data(i)[0]);
    }
    ranks.sum({&left, 1});
    EXPECT_GE(left, 2U);
    EXPECT_EQ(environment.count(particles), 2U);
  });
}

TEST(SharedEnvironment, RefusesPartsOfOthers) {
  const auto made = [](const BoxOptions& second, bool swapped) {
    test::on_ranks(2, [&](Ranks& ranks) {
      const std::uint32_t part = swapped ? 1 - ranks.rank() : ranks.rank();
      SharedEnvironment(box_part(ranks.rank() == 0 ? box() : second, 2, part), ranks, Threads{1});
    });
  };
  EXPECT_THROW(made(box(), true), InvalidArgument);
  BoxOptions other = box();
  other.origin.x = 1.0;
  EXPECT_THROW(made(other, false), InvalidMesh);
  made(box(), false);
}

}  // namespace dartcast::shared_environment_test
