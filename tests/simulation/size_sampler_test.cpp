// Sizes: against their distribution functions (Kolmogorov and Smirnov) and closed forms of the mean cube.
#include "simulation/size_sampler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"

namespace dartcast::size_sampler_test {

// The share below d, without cuts.
double share_below(const SizeDistribution& s, double d) {
  if (s.law == SizeLaw::rosin_rammler) return 1.0 - std::exp(-std::pow(d / s.size, s.spread));
  const double z = s.law == SizeLaw::normal ? (d - s.size) / s.spread : std::log(d / s.size) / std::log(s.spread);
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

std::vector<SizeDistribution> distributions() {
  return {{SizeLaw::normal, 5e-6, 1e-6},
          {SizeLaw::normal, 5e-6, 4e-6, 2e-6, 7e-6},
          {SizeLaw::lognormal, 5e-6, 1.8},
          {SizeLaw::lognormal, 5e-6, 1.8, 4e-6, 2e-5},
          {SizeLaw::rosin_rammler, 5e-6, 2.5},
          {SizeLaw::rosin_rammler, 5e-6, 0.8, 1e-6, 2e-5},
          {SizeLaw::rosin_rammler, 5e-6, 9.0, 4.9e-6}};
}

// The distance is above 1.95 / sqrt(n) for one right sample in 1000.
TEST(Sizes, HaveTheirDistributionBetweenTheCuts) {
  constexpr std::size_t count = 20'000;
  for (const SizeDistribution& s : distributions()) {
    const SizeSampler sampler(s, 3);
    std::vector<double> drawn;
    double cubes = 0.0;
    double sixth = 0.0;
    for (std::uint64_t id = 0; id < count; ++id) {
      drawn.push_back(sampler.diameter(id));
      const double cube = std::pow(drawn.back(), 3);
      cubes += cube / count;
      sixth += cube * cube / count;
    }
    std::sort(drawn.begin(), drawn.end());
    EXPECT_GE(drawn.front(), s.min);
    EXPECT_LE(drawn.back(), s.max);
    const double low = s.min > 0.0 || s.law == SizeLaw::normal ? share_below(s, s.min) : 0.0;
    const double high = share_below(s, s.max);
    double distance = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double share = (share_below(s, drawn[i]) - low) / (high - low);
      distance = std::max({distance, std::abs(share - static_cast<double>(i) / count),
                           std::abs(share - static_cast<double>(i + 1) / count)});
    }
    EXPECT_LT(distance, 1.95 / std::sqrt(count)) << static_cast<int>(s.law) << " " << s.min;
    EXPECT_NEAR(sampler.mean_cube(), cubes, 4.0 * std::sqrt((sixth - cubes * cubes) / count))
        << static_cast<int>(s.law);
  }
}

TEST(Sizes, MeanCubesAreThoseOfTheClosedForms) {
  const auto expect = [](const SizeDistribution& s, double truth) {
    EXPECT_NEAR(SizeSampler(s, 1).mean_cube(), truth, 1e-6 * truth) << static_cast<int>(s.law) << " " << s.spread;
  };
  expect({SizeLaw::normal, 5.0, 0.5}, 125.0 + 3.0 * 5.0 * 0.25);
  for (const double deviation : {1.1, 1.8, 3.0}) {
    const double l = std::log(deviation);
    expect({SizeLaw::lognormal, 2.0, deviation}, 8.0 * std::exp(4.5 * l * l));
  }
  for (const double exponent : {0.8, 1.0, 2.5, 9.0})
    expect({SizeLaw::rosin_rammler, 2.0, exponent}, 8.0 * std::tgamma(1.0 + 3.0 / exponent));
}

TEST(Sizes, OfATableHaveItsShares) {
  const SizeSampler sampler({.law = SizeLaw::table, .diameters = {1.0, 2.0, 4.0, 8.0}, .shares = {3.0, 0.0, 5.0, 2.0}},
                            1);
  EXPECT_DOUBLE_EQ(sampler.mean_cube(), 0.3 + 0.5 * 64.0 + 0.2 * 512.0);
  std::vector<int> counts(9);
  for (std::uint64_t id = 0; id < 10'000; ++id) ++counts[static_cast<std::size_t>(sampler.diameter(id))];
  EXPECT_EQ(counts[2], 0);
  EXPECT_NEAR(counts[1], 3000, 4 * 46);
  EXPECT_NEAR(counts[4], 5000, 4 * 50);
  EXPECT_NEAR(counts[8], 2000, 4 * 40);
}

TEST(Sizes, RefusesWhatIsOutOfRange) {
  const auto expect = [](const SizeDistribution& s, const char* part) {
    test::expect_refused([&] { const SizeSampler sampler(s, 1); }, part);
  };
  expect({SizeLaw::normal, 0.0, 1.0}, "size must be between");
  expect({SizeLaw::normal, 1.0, 0.0}, "spread must be above 0");
  expect({SizeLaw::lognormal, 1.0, 1.0}, "geometric deviation must be above 1");
  expect({SizeLaw::normal, 1.0, 1.0, -1.0}, "min must not be negative");
  expect({SizeLaw::normal, 1.0, 1.0, 2.0, 2.0}, "max must be above min");
  expect({SizeLaw::normal, 1.0, 0.1, 2.0, 3.0}, "leave 1%");
  expect({SizeLaw::lognormal, 1.0, 1.1, 100.0, 200.0}, "leave 1%");
  expect({SizeLaw::rosin_rammler, 1.0, 3.0, 5.0}, "leave 1%");
  expect({.law = SizeLaw::table}, "a share for each");
  expect({.law = SizeLaw::table, .diameters = {1.0}, .shares = {-1.0}}, "shares must be finite");
  expect({.law = SizeLaw::table, .diameters = {1.0}, .shares = {0.0}}, "a sum above 0");
}

// A scene of a box with one group.
Scene box_with(ParticlesScene group) {
  Scene scene;
  scene.environment.mesh = BoxOptions{.cells = {2, 2, 2}, .size = Vec3{1.0, 1.0, 1.0}};
  scene.motion.dt = 0.1;
  scene.particles = {std::move(group)};
  return scene;
}

// The mass that has entered: exactly for one size, within the sampling error for many.
TEST(Sizes, AMassRateIsKept) {
  ParticlesScene group;
  InletParticles inlet{"xmin"};
  inlet.mass_rate = 3e-9;
  group.source = inlet;
  group.material = {1e-4, 1000.0, 0.0};
  const double mass = 3.14159265358979 / 6.0 * 1000.0 * 1e-12;
  Simulation alike(box_with(group));
  for (int i = 0; i < 100; ++i) alike.step();
  EXPECT_EQ(alike.totals().injected, static_cast<std::uint64_t>(3e-8 / mass));
  group.sizes = SizeDistribution{SizeLaw::lognormal, 2e-5, 1.5, 5e-6, 1e-4};
  group.interception = true;
  Simulation varied(box_with(group));
  for (int i = 0; i < 100; ++i) varied.step();
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < varied.particles().size(); ++i) {
    const double d = varied.diameters()[i];
    EXPECT_EQ(varied.radii()[i], 0.5 * d);
    sum += mass * std::pow(d / 1e-4, 3);
    squares += std::pow(mass * std::pow(d / 1e-4, 3), 2);
  }
  EXPECT_NEAR(sum, 3e-8, 4.0 * std::sqrt(squares));
}

TEST(Sizes, ScenesRefuseThemForSeedsAndMassRatesWithoutMass) {
  ParticlesScene group;
  group.sizes = SizeDistribution{SizeLaw::normal, 1e-3, 1e-4};
  group.source = PlacedParticles{ParticleSeeds{"seeds", {{0.5, 0.5, 0.5}}, {}, {}}};
  test::expect_refused([&] { Simulation simulation(box_with(group)); }, "give each seed its diameter");
  InletParticles inlet{"xmin"};
  inlet.mass_rate = 1.0;
  group.source = inlet;
  test::expect_refused([&] { Simulation simulation(box_with(group)); }, "a diameter and density");
  group.material.density = 1000.0;
  inlet.mass_rate = -1.0;
  group.source = inlet;
  test::expect_refused([&] { Simulation simulation(box_with(group)); }, "mass rate is -1");
}

}  // namespace dartcast::size_sampler_test
