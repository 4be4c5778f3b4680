// Particles, numbers and options that do not belong here: each is refused in words, and nothing has changed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/spheres.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/particle_checks.hpp"

namespace dartcast::misuse_test {

using test::cubes;
using test::expect_refused;

const std::vector<Vec3> places = {{0.25, 0.5, 0.5}, {1.25, 0.5, 0.5}, {1.25, 1.5, 1.5}, {0.5, 1.5, 0.25}};

Particles added_to(Environment& environment) {
  Particles particles;
  environment.add(particles, places);
  return particles;
}

// --- of another environment

// Every call that is given particles, and what it does with those of another environment of the same mesh.
TEST(OtherEnvironment, ItsParticlesAreRefusedUnchanged) {
  Environment environment(cubes(2));
  Environment equal(cubes(2));
  Environment smaller(cubes(1));
  for (Environment* other : {&equal, &smaller}) {
    Particles particles = added_to(environment);
    const std::vector<ParticleState> before = test::copy_of(particles);
    const std::vector<double> radii(particles.size(), 0.1);
    SphereStepper stepper;
    const auto refuses = [&](const test::Call& call) {
      expect_refused(call, "the particles are of another environment: add() their positions to a new set");
      EXPECT_TRUE(test::same_bits(before, particles));
    };
    refuses([&] { other->advance(particles, places); });
    refuses([&] { other->add(particles, places); });
    refuses([&] { other->add(particles, SimplexId{other->map().cells()[0], 0}, places[0]); });
    refuses([&] { other->update_after_edit(particles); });
    refuses([&] { static_cast<void>(other->trace(particles, 0, places)); });
    refuses([&] { stepper.advance(*other, particles, radii, places); });
    // The remedy.
    Particles anew;
    EXPECT_NO_THROW(other->add(anew, std::vector<Vec3>(places.begin(), places.begin() + 1)));
    EXPECT_NO_THROW(other->advance(anew, std::vector<Vec3>{{0.5, 0.5, 0.5}}));
    EXPECT_NO_THROW(environment.advance(particles, places));
  }
}

TEST(OtherEnvironment, IsRememberedByPartsAndCopiesAndForgottenByEmptySets) {
  Environment environment(cubes(2));
  Environment other(cubes(2));
  const Particles particles = added_to(environment);
  const std::vector<std::uint32_t> some = {2, 0};
  const std::vector<Vec3> targets(2, Vec3{0.5, 0.5, 0.5});
  const std::vector<Weights> weights(particles.size());
  Particles selected = particles.selected(some);
  Particles copy = selected;
  Particles restored = environment.restored(particles.states(), weights).selected(some);
  for (Particles* p : {&selected, &copy, &restored}) {
    expect_refused([&] { other.advance(*p, targets); }, "of another environment");
    EXPECT_NO_THROW(environment.advance(*p, targets));
    p->remove(std::vector<std::uint8_t>(2, 1));
    EXPECT_NO_THROW(other.advance(*p, {}));
    EXPECT_NO_THROW(other.add(*p, targets));
    EXPECT_NO_THROW(other.advance(*p, targets));
    expect_refused([&] { environment.advance(*p, targets); }, "of another environment");
  }
}

// Caches of earlier particles are of no use in the other environment: they might be of the plane.
TEST(OtherEnvironment, TakesAnEmptySetAsANewOne) {
  RectangleOptions o;
  o.cells = {2, 2};
  o.size = {2.0, 2.0};
  Environment plane(generate_rectangle(o));
  Environment space(cubes(2));
  Particles particles = added_to(space);
  for (int i = 0; i < 4; ++i) {
    space.move(std::vector<Vec3>(space.positions().begin(), space.positions().end()));
    space.advance(particles, places);
  }
  particles.remove(std::vector<std::uint8_t>(places.size(), 1));
  const std::vector<Vec3> flat = {{0.25, 0.5, 0.0}, {1.25, 0.5, 0.0}};
  plane.add(particles, flat);
  EXPECT_TRUE(plane.advance(particles, std::vector<Vec3>{flat[1], flat[0]}).contacts.contacts.empty());
  EXPECT_EQ(particles[0].position, flat[1]);
}

TEST(OtherEnvironment, CannotTakeItsPlace) {
  static_assert(!std::is_copy_constructible_v<Environment> && !std::is_move_constructible_v<Environment>);
  static_assert(!std::is_copy_assignable_v<Environment> && !std::is_move_assignable_v<Environment>);
}

// --- indices

class Indices : public testing::Test {
 protected:
  void refuses(const test::Call& call, const std::string& words) {
    expect_refused(call, words);
    EXPECT_TRUE(test::same_bits(before, particles));
  }

  Environment environment = Environment(cubes(2));
  Particles particles = added_to(environment);
  const std::vector<ParticleState> before = test::copy_of(particles);
};

TEST_F(Indices, ThatNameNoParticle) {
  for (const std::uint32_t bad : {4U, 5U, 0x80000000U, 0xffffffffU}) {
    const std::vector<std::uint32_t> which = {1, bad, 0, 2};
    const std::string words = "index " + std::to_string(bad) + " (number 1 of 4) names none of the 4 particles";
    refuses([&] { static_cast<void>(particles.selected(which)); }, "selected: " + words);
    refuses([&] { particles.replace(which, particles); }, "replace: " + words);
    refuses([&] { particles.reorder(which); }, "reorder: " + words);
    refuses([&] { static_cast<void>(environment.trace(particles, bad, places)); }, "there is no particle");
  }
  refuses([&] { static_cast<void>(Particles().selected(std::vector<std::uint32_t>{0})); }, "none of the 0 particles");
}

TEST_F(Indices, ThatAreTooManyOrTooFew) {
  for (const std::size_t size : {0U, 1U, 3U, 5U}) {
    const std::vector<std::uint32_t> which(size);
    refuses([&] { particles.reorder(which); }, std::to_string(size) + " indices for 4 particles");
    refuses([&] { particles.replace(which, particles); }, std::to_string(size) + " indices for 4 particles");
    refuses([&] { particles.remove(std::vector<std::uint8_t>(size)); },
            std::to_string(size) + " marks for 4 particles");
  }
}

TEST_F(Indices, ThatAreNoPermutation) {
  refuses([&] { particles.reorder(std::vector<std::uint32_t>{0, 1, 2, 2}); }, "names particle 2 twice");
}

TEST_F(Indices, OfParticlesThatDoNotFit) {
  Environment other(cubes(2));
  const Particles strangers = added_to(other);
  const std::vector<std::uint32_t> which = {0, 1, 2, 3};
  refuses([&] { particles.replace(which, strangers); }, "of another environment");
  Particles ahead = particles;
  environment.move(std::vector<Vec3>(environment.positions().begin(), environment.positions().end()));
  environment.advance(ahead, places);
  refuses([&] { particles.replace(which, ahead); }, "call advance() with both after each move");
  environment.advance(particles, places);
  EXPECT_NO_THROW(particles.replace(which, ahead));
}

// Names of simplices as an attacker would choose them.
TEST_F(Indices, OfSimplicesThatAreNone) {
  const Cell good = environment.map().cells()[0];
  for (const std::uint32_t cell : {0xffffffffU, 0x1fffffffU, 0x2000001bU, 0x20000100U, 0x80000000U, 0xe0000000U,
                                   good.value + 8U, good.value ^ 0x20000000U}) {
    for (const std::uint16_t simplex : std::vector<std::uint16_t>{0, 1, 0xffff})
      EXPECT_FALSE(environment.add(particles, SimplexId{Cell(cell), simplex}, places[0])) << std::hex << cell;
  }
  const auto count = environment.map().shape(good).simplices().size();
  for (const std::size_t simplex : {count, count + 1, std::size_t{999}, std::size_t{0xffff}})
    EXPECT_FALSE(environment.add(particles, SimplexId{good, static_cast<std::uint16_t>(simplex)}, places[0]));
  EXPECT_TRUE(test::same_bits(before, particles));
}

// --- options

TEST(StepOptionsRefused, WithoutAContact) {
  Environment environment(cubes(2));
  Particles particles = added_to(environment);
  const std::vector<ParticleState> before = test::copy_of(particles);
  const std::vector<double> radii(particles.size(), 0.1);
  StepOptions options;
  options.max_contacts = 0;
  SphereStepper stepper;
  const std::string words = "max_contacts is 0: it must be at least 1";
  const ContactCallback respond = [](const Contact&, auto, auto) { return AfterContact{}; };
  for (const ContactCallback& r : {ContactCallback{}, respond}) {
    expect_refused([&] { environment.advance(particles, places, r, options); }, words);
    expect_refused([&] { static_cast<void>(environment.trace(particles, 0, places, r, options)); }, words);
    expect_refused([&] { stepper.advance(environment, particles, radii, places, r, options); }, words);
    expect_refused([&] { environment.advance(particles, places, r, options); }, words);
  }
  Particles nobody;
  expect_refused([&] { environment.advance(nobody, {}, {}, options); }, words);
  EXPECT_TRUE(test::same_bits(before, particles));
}

// --- threads

TEST(ThreadsRefused, WhereThereAreTooMany) {
  EXPECT_THROW(Environment(cubes(1), Threads{100'000}), InvalidArgument);
  Environment environment(cubes(1), Threads{2});
  EXPECT_THROW(environment.set_threads({100'000}), InvalidArgument);
  EXPECT_EQ(environment.threads().count, 2U);
}

// --- moved from

// The caches that a set keeps beside its states must move with them.
TEST(MovedFrom, ASetOfParticlesIsEmpty) {
  Environment environment(cubes(2));
  for (int kind = 0; kind < 3; ++kind) {  // nothing is kept, corners, coordinates
    Particles first = added_to(environment);
    const auto step = [&](Particles& particles) {
      if (kind == 1)
        environment.move(std::vector<Vec3>(environment.positions().begin(), environment.positions().end()));
      environment.advance(particles, places);
    };
    for (int i = 0; i < 3 && kind > 0; ++i) step(first);
    const Particles second = std::move(first);
    // NOLINTBEGIN(bugprone-use-after-move): it is what is tested
    EXPECT_EQ(first.size(), 0U);
    const std::vector<Vec3> reversed(places.rbegin(), places.rend());
    environment.add(first, reversed);
    step(first);
    for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(first[i].position, places[i]) << kind;
    // NOLINTEND(bugprone-use-after-move)
    EXPECT_EQ(test::check_states(environment, first), "");
  }
}

TEST(SphereStepper, IsAsNewOnceItWasMovedFrom) {
  Environment environment(cubes(2));
  Particles particles = added_to(environment);
  const std::vector<double> radii(particles.size(), 0.1);
  SphereStepper first;
  first.advance(environment, particles, radii, places);
  SphereStepper second = std::move(first);
  const std::vector<Vec3> out(particles.size(), Vec3{2.5, 0.5, 0.5});
  Particles by_first = particles;
  // NOLINTNEXTLINE(bugprone-use-after-move): it is what is tested
  const SphereReport report = first.advance(environment, by_first, radii, out);
  EXPECT_FALSE(report.step.contacts.contacts.empty());
  second.advance(environment, particles, radii, out);
  EXPECT_TRUE(test::same_bits(test::copy_of(particles), by_first));
}

}  // namespace dartcast::misuse_test
