// Numbers at the ends of what doubles can hold: refused in words where they are given, or taken without a NaN.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/events.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "dynamics/sphere_pairs.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"

namespace dartcast::ranges_test {

using test::cubes;
using test::expect_refused;

constexpr double infinity = std::numeric_limits<double>::infinity();

SimulationOptions colliding(double density = 1000.0) {
  SimulationOptions o;
  o.dt = 0.1;
  o.collisions = CollisionOptions{};
  o.collisions->density = density;
  return o;
}

TEST(FlowRanges, RadiiThatOverflow) {
  Environment environment(cubes(3));
  Simulation simulation(environment, colliding());
  for (const double radius : {1e308, 1e307, 1e300, 1e90, 0x1.1p+100, infinity, std::nan(""), -1.0}) {
    const std::string words = " is " + fmt::format("{}", radius) + ": it must be between 0 and 2^100";
    expect_refused([&] { simulation.add_random(2, {1, 0, 0}, radius); }, words);
    expect_refused([&] { simulation.add(std::vector<Vec3>{{1.5, 1.5, 1.5}}, {1, 0, 0}, radius); }, words);
    expect_refused([&] { simulation.add_inlet(Patch{1}, 10.0, {1, 0, 0}, radius); }, words);
    SphereStepper stepper;
    Particles particles;
    environment.add(particles, std::vector<Vec3>{{1.5, 1.5, 1.5}});
    expect_refused([&] { stepper.advance(environment, particles, std::vector<double>{radius}, std::vector<Vec3>(1)); },
                   words);
  }
  EXPECT_EQ(simulation.particles().size(), 0U);
}

TEST(FlowRanges, RadiiAndDensitiesAtTheEnds) {
  for (const double radius : {1e-310, 1e-105, 0x1p-100, 0x1p+100}) {
    for (const double density : {0x1p-100, 1000.0, 0x1p+100}) {
      Environment environment(cubes(3));
      Simulation simulation(environment, colliding(density));
      simulation.add_random(3, {1, 0, 0}, radius);
      for (int i = 0; i < 3; ++i) simulation.step();
      for (const ParticleState& s : simulation.particles().states()) EXPECT_TRUE(is_finite(s.position));
      for (const Vec3& v : simulation.velocities()) EXPECT_TRUE(is_finite(v)) << radius << ", " << density;
    }
  }
}

TEST(FlowRanges, Options) {
  Environment environment(cubes(2));
  const auto refused = [&](const std::function<void(SimulationOptions&)>& spoil, const std::string& words) {
    SimulationOptions o = colliding();
    spoil(o);
    expect_refused([&] { const Simulation simulation(environment, o); }, words);
  };
  for (const double bad : {0.0, -1.0, 1e-320, 1e-200, 1e40, infinity, std::nan("")}) {
    refused([&](SimulationOptions& o) { o.dt = bad; }, "dt is " + fmt::format("{}", bad));
    refused([&](SimulationOptions& o) { o.collisions->density = bad; }, "density is " + fmt::format("{}", bad));
  }
  refused([](SimulationOptions& o) { o.step.max_contacts = 0; }, "max_contacts");
  refused([](SimulationOptions& o) { o.step.max_slices = 0; }, "max_slices");
  refused([](SimulationOptions& o) { o.step.tolerance = std::nan(""); }, "tolerance");
}

TEST(FlowRanges, RatesOfInlets) {
  Environment environment(cubes(2));
  Simulation simulation(environment, colliding());
  for (const double rate : {1e300, 1e30, 0x1p+40, infinity, std::nan(""), -1.0})
    expect_refused([&] { simulation.add_inlet(Patch{1}, rate, {1, 0, 0}); }, "rate is " + fmt::format("{}", rate));
  simulation.step();
  EXPECT_EQ(simulation.particles().size(), 0U);
}

TEST(FlowRanges, SpeedsThatOverflow) {
  for (const double speed : {1e308, 1e300}) {
    Environment environment(cubes(2));
    Simulation simulation(environment, colliding());
    simulation.add_random(2, {speed, 0, 0}, 0.1);
    EXPECT_THROW(simulation.step(), InvalidArgument);
  }
}

TEST(FlowRanges, BodiesAndSubsteps) {
  Environment environment(cubes(2));
  SimulationOptions o = colliding();
  o.substeps = 2;
  Simulation simulation(environment, o);
  expect_refused([&] { simulation.add_body(std::vector<Vec3>{{0.5, 0.5, 0.5}}, {}); }, "substeps must be 1");
}

TEST(PairRanges, SpheresThatReachTooFar) {
  PairFinder finder;
  for (const double far : {1e308, 1e305, infinity, std::nan("")}) {
    for (int which = 0; which < 3; ++which) {
      std::vector<SphereMotion> spheres(3, SphereMotion{{1, 1, 1}, {0, 0, 0}, 0.5});
      if (which == 0) spheres[1].radius = far;
      if (which == 1) spheres[1].displacement.y = far;
      if (which == 2) spheres[1].centre.z = -far;
      if (which == 0 && std::isnan(far)) continue;  // has no contacts, as one without a radius
      expect_refused([&] { finder.find(spheres); }, "sphere 1 ");
    }
  }
  std::vector<SphereMotion> large(2, SphereMotion{{0x1p+300, 1, 1}, {0x1p+300, 0, 0}, 0x1p+300});
  EXPECT_EQ(finder.find(large).size(), 1U);
}

TEST(SurgeryRanges, TimesOfEvents) {
  Environment environment(cubes(2));
  SimulationOptions o;
  o.dt = 1e-3;
  Simulation simulation(environment, o);
  for (const double at : {-1.0, 1e300, 1e17, infinity, std::nan("")}) {
    const std::vector<Event> events = {{0.0, Ligature{}}, {at, Ligature{}}};
    expect_refused([&] { simulation.set_events(events); }, "event 2 (ligature): its time is " + fmt::format("{}", at));
  }
}

}  // namespace dartcast::ranges_test
