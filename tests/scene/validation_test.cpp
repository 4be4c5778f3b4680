// The scenes of scenes/validation against closed forms and the roots of the laws: docs/validation.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <span>
#include <vector>

#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"
#include "support/tier.hpp"

namespace dartcast::validation_test {

namespace fs = std::filesystem;
using test::expect_near;

constexpr double pi = 3.14159265358979323846;

// The simulation after all steps of the scene. `each`: is called after every step.
template <class Each>
void run(const char* name, Each&& each) {
  const char* const scenes = std::getenv("DARTCAST_SCENES");
  ASSERT_NE(scenes, nullptr);
  const Scene scene = load_scene_files(read_scene(fs::path(scenes) / "validation" / name)).scene;
  Simulation simulation(scene);
  for (std::uint64_t step = 0; step < scene.motion.steps; ++step) {
    simulation.step();
    each(simulation);
  }
}

// Putnam's law by bisection.
double terminal_speed(double d) {
  double low = 0.0;
  double high = 100.0;
  for (int i = 0; i < 200; ++i) {
    const double v = 0.5 * (low + high);
    const double re = v * d * 1.2 / 1.8e-5;
    const double factor = re <= 1000.0 ? 1.0 + std::pow(re, 2.0 / 3.0) / 6.0 : 0.424 * re / 24.0;
    (v * factor * 18.0 * 1.8e-5 / (1000.0 * d * d) < 9.81 * (1.0 - 1.2e-3) ? low : high) = v;
  }
  return low;
}

TEST(Validation, DropsFallAtTheirTerminalSpeed) {
  run("terminal.toml", [](const Simulation& s) {
    if (s.steps() < 400) return;
    ASSERT_EQ(s.particles().size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      const double truth = terminal_speed(s.diameters()[i]);
      EXPECT_NEAR(-s.velocities()[i].z, truth, 1e-4 * truth) << s.diameters()[i];
    }
  });
}

TEST(Validation, DropsStopAtTheDistanceOfStokesAndCunningham) {
  run("stopping.toml", [](const Simulation& s) {
    for (std::size_t i = 0; i < s.particles().size(); ++i) {
      const double d = s.diameters()[i];
      const double kn = 2.0 * 6.6e-8 / d;
      const double tau = 1000.0 * d * d / (18.0 * 1.8e-5) * (1.0 + kn * (1.257 + 0.4 * std::exp(-1.1 / kn)));
      const double t = 1e-3 * static_cast<double>(s.steps());
      EXPECT_NEAR(s.particles()[i].position.x, 0.01 + 10.0 * tau * (1.0 - std::exp(-t / tau)), 1e-13) << d;
    }
  });
}

// In the frame of the drift E x B / B^2 a charge goes around a circle: its corners are on it, whatever the step.
TEST(Validation, ChargesTurnAndDrift) {
  run("gyration.toml", [](const Simulation& s) {
    const std::vector<double> speeds = {0.5, -0.5, 0.0};  // along x, in that frame, at the start
    for (std::size_t i = 0; i < 3; ++i) {
      const double t = 5e-3 * static_cast<double>(s.steps());
      const double turn = 2.0 * s.charges_per_mass()[i];  // rad / s
      const Vec3 centre = {0.2 + 0.5 * t, 0.5 - speeds[i] / turn, 0.0};
      const Vec3& x = s.particles()[i].position;
      EXPECT_NEAR(std::hypot(x.x - centre.x, x.y - centre.y), std::abs(speeds[i] / turn), 1e-12) << i << " " << t;
    }
  });
}

// The mean squares of velocities and ways along an axis, over all three.
struct Spread {
  double velocity = 0.0, way = 0.0;
  Spread(const Simulation& s, const Vec3& start) {
    const double n = 3.0 * static_cast<double>(s.particles().size());
    for (std::size_t i = 0; i < s.particles().size(); ++i) {
      const Vec3 way_of_one = s.particles()[i].position - start;
      way += dot(way_of_one, way_of_one) / n;
      velocity += dot(s.velocities()[i], s.velocities()[i]) / n;
    }
  }
};

constexpr double four_errors = 4.0 * 0.0102;  // sqrt(2 / (3 N)) with N = 6,400

TEST(Validation, ParticlesDiffuseAsSixDT) {
  run("diffusion.toml", [](const Simulation& s) {
    ASSERT_EQ(s.particles().size(), 6400U);
    const double truth = 2.0 * 2e-3 * 1e-2 * static_cast<double>(s.steps());
    EXPECT_NEAR(Spread(s, {0.51, 0.52, 0.53}).way, truth, four_errors * truth) << s.steps();
  });
}

// The steps do not count: the law is that of the whole time.
TEST(Validation, SmallParticlesMoveAsTheirTemperatureSays) {
  run("brownian.toml", [](const Simulation& s) {
    ASSERT_EQ(s.particles().size(), 6400U);
    const double d = 5e-8;
    const double tau = 1000.0 * d * d / (18.0 * 1.8e-5);
    const double thermal = 1.380649e-23 * 293.15 / (1000.0 * 3.14159265358979 / 6.0 * d * d * d);
    const double z = 0.5 * static_cast<double>(s.steps());
    const Spread spread(s, {5.1e-6, 5.2e-6, 5.3e-6});
    const double velocity = thermal * (1.0 - std::exp(-2.0 * z));
    const double way = thermal * tau * tau * (2.0 * z - 3.0 + 4.0 * std::exp(-z) - std::exp(-2.0 * z));
    EXPECT_NEAR(spread.velocity, velocity, four_errors * velocity) << s.steps();
    EXPECT_NEAR(spread.way, way, four_errors * way) << s.steps();
  });
}

// The greatest distance of the sizes' shares from the distribution function, by A. Kolmogorov and N. Smirnov: it is above
// 1.95 / sqrt(n) for one right sample in 1000.
TEST(Validation, SizesHaveTheirDistribution) {
  const auto lognormal = [](double d) { return 0.5 * std::erfc(-std::log(d / 5e-6) / std::log(1.8) / std::sqrt(2.0)); };
  const auto rosin_rammler = [](double d) { return 1.0 - std::exp(-std::pow(d / 5e-6, 2.5)); };
  const auto distance = [](std::vector<double> d, auto&& below, double min, double max) {
    std::sort(d.begin(), d.end());
    double most = 0.0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      const double share = (below(d[i]) - below(min)) / (below(max) - below(min));
      const double n = static_cast<double>(d.size());
      most = std::max(
          {most, std::abs(share - static_cast<double>(i) / n), std::abs(share - static_cast<double>(i + 1) / n)});
    }
    return most;
  };
  run("sizes.toml", [&](const Simulation& s) {
    ASSERT_EQ(s.particles().size(), 10'000U);
    const auto middle = s.diameters().begin() + 5000;
    EXPECT_LT(distance({s.diameters().begin(), middle}, lognormal, 1e-6, 2e-5), 1.95 / std::sqrt(5000.0));
    EXPECT_LT(distance({middle, s.diameters().end()}, rosin_rammler, 1e-6, 1e-5), 1.95 / std::sqrt(5000.0));
  });
}

// Each component of the velocity has the variance 2 k / 3, and the correlation 1 - s / life. The way follows by G. I. Taylor,
// 1921.
TEST(Validation, TurbulenceDispersesAsTaylorSays) {
  run("turbulence.toml", [](const Simulation& s) {
    ASSERT_EQ(s.particles().size(), 6400U);
    const double variance = 2.0 / 3.0 * 0.015;
    const double life = 2.0 * 0.15 * 0.015 / 0.0225;
    const double t = 1e-2 * static_cast<double>(s.steps());
    const Spread spread(s, {0.01, 0.02, 0.03});
    const double way = variance * (t < life ? t * t - t * t * t / (3.0 * life) : life * t - life * life / 3.0);
    EXPECT_NEAR(spread.velocity, variance, four_errors * variance) << s.steps();
    EXPECT_NEAR(spread.way, way, four_errors * way) << s.steps();
  });
}

// The coefficient of dispersion along x, from five windows of 1 s each in which particles start all over the section. The
// variance in one is 2 K - 2 `slow` Pe^2 there: in its beginning they have not yet seen all of the section.
double dispersion(const char* scene, double slow) {
  double sum = 0.0;
  std::vector<Vec3> start;
  run(scene, [&](const Simulation& s) {
    if (s.steps() % 50 != 0) return;
    const std::vector<Vec3> now = s.unwrapped();
    if (start.empty()) {
      start = now;
      return;
    }
    double mean = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double way = now[i].x - start[i].x;
      mean += way / 6400.0;
      square += way * way / 6400.0;
    }
    sum += 0.5 * (square - mean * mean) + slow * 400.0;
    start = now;
  });
  return sum / 5.0;
}

// Sir Geoffrey Taylor, 1953; R. Aris, 1956; both at Pe = 20, over pairs of patches. The sampling error is 0.8%. The tube
// belongs to the full tier. Under sanitizers other tests cross pairs in less time.
TEST(Validation, FlowsDisperseAsTaylorAndArisSay) {
  if (test::sanitized()) return;
  const double channel = 1.0 + 400.0 * 2.0 / 105.0;
  EXPECT_NEAR(dispersion("channel.toml", 2.0 / 1050.0), channel, 0.03 * channel);
  if (!test::full_tier()) return;
  const double tube = 1.0 + 400.0 / 48.0;
  EXPECT_NEAR(dispersion("wedge.toml", 1.0 / 720.0), tube, 0.03 * tube);
}

// (6 / pi^2) sum n^-2 exp(-n^2 pi^2 D t / R^2) with D = R = 1: particles that start everywhere in the ball.
TEST(Validation, AnAbsorbingBallKeepsAsManyAsTheSeriesSays) {
  run("absorption.toml", [](const Simulation& s) {
    double truth = 0.0;
    for (int n = 1; n < 60; ++n)
      truth += 6.0 / (pi * pi * n * n) * std::exp(-n * n * pi * pi * 5e-3 * static_cast<double>(s.steps()));
    const double share = static_cast<double>(s.particles().size()) / 3000.0;
    EXPECT_NEAR(share, truth, 4.0 * std::sqrt(truth * (1.0 - truth) / 3000.0)) << s.steps();
  });
}

// The share that comes as far as this in a laminar flow, by P. G. Gormley and M. Kennedy, 1949. `far`: pi D z / Q.
double penetration(double far) {
  if (far < 0.02) return 1.0 - 2.56 * std::pow(far, 2.0 / 3.0) + 1.2 * far + 0.177 * std::pow(far, 4.0 / 3.0);
  return 0.819 * std::exp(-3.657 * far) + 0.097 * std::exp(-22.3 * far) + 0.032 * std::exp(-57.0 * far);
}

TEST(Validation, ATubeLetsThroughWhatGormleyAndKennedySay) {
  run("penetration.toml", [](const Simulation& s) {
    if (s.steps() < 800) return;
    const std::span<const ParticleStatus> all = s.statuses();
    EXPECT_EQ(std::count(all.begin(), all.end(), ParticleStatus::alive), 0);
    for (double z = 1.0; z <= 20.0; ++z) {
      const auto before = [&](const ParticleState& p) { return p.position.z < z; };
      const std::span<const ParticleState> stuck = s.particles().states();
      const double share = 1.0 - static_cast<double>(std::count_if(stuck.begin(), stuck.end(), before)) / 6000.0;
      const double truth = penetration(0.0125 * z);
      EXPECT_NEAR(share, truth, 4.0 * std::sqrt(truth * (1.0 - truth) / 6000.0)) << z;
    }
  });
}

// The equation of M. R. Maxey and J. J. Riley, 1983, without history and weight, from rest: with k the ratio of densities,
// (1 + k / 2) dv/dt = (u - v) / tau + (3 k / 2) du/dt.
TEST(Validation, ParticlesOscillateWithTheirFluid) {
  run("oscillation.toml", [](const Simulation& s) {
    ASSERT_EQ(s.particles().size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const double density = std::vector<double>{2650.0, 1000.0, 100.0}[i];
      const double k = 1000.0 / density;
      const double tau = density * 1e-6 / (18.0 * 1e-3);
      const std::complex<double> turn(0.0, 2.0 * pi / 0.5);
      const std::complex<double> response = (1.0 / tau + 1.5 * k * turn) / (1.0 / tau + (1.0 + 0.5 * k) * turn);
      const double t = 2.5e-3 * static_cast<double>(s.steps());
      const double truth =
          (response * std::exp(turn * t)).real() - response.real() * std::exp(-t / (tau * (1.0 + 0.5 * k)));
      EXPECT_NEAR(s.velocities()[i].x / 1e-3, truth, 5e-4) << density << " " << t;
    }
  });
}

// The share that a horizontal tube takes, by J. Pich, 1972. `far`: 3 w z / (8 R U), w the speed of sinking. Then all
// particles that have entered are stuck or have left.
TEST(Validation, ATubeTakesWhatSinksAsPichSays) {
  run("settling.toml", [](const Simulation& s) {
    if (s.steps() < 800) return;
    const std::span<const ParticleStatus> all = s.statuses();
    EXPECT_EQ(std::count(all.begin(), all.end(), ParticleStatus::alive), 0);
    const auto stuck = static_cast<std::uint64_t>(std::count(all.begin(), all.end(), ParticleStatus::stuck));
    EXPECT_EQ(s.totals().injected, 3000U);
    EXPECT_EQ(s.totals().escaped + stuck, s.totals().injected);
    for (double z = 1.0; z <= 20.0; ++z) {
      const auto before = [&](const ParticleState& p) { return p.position.z < z; };
      const std::span<const ParticleState> states = s.particles().states();
      const double share = static_cast<double>(std::count_if(states.begin(), states.end(), before)) / 3000.0;
      const double far = 3.0 * 0.02 * z / 8.0;
      const double root = std::cbrt(far);
      const double truth = 2.0 / pi * ((2.0 * far - root) * std::sqrt(1.0 - root * root) + std::asin(root));
      EXPECT_NEAR(share, truth, 4.0 * std::sqrt(truth * (1.0 - truth) / 3000.0)) << z;
    }
  });
}

// Chi-squared of the numbers in 60 parts of the tube, against their volumes.
TEST(Validation, AUniformCloudStaysUniformInAPulsingTube) {
  run("uniform.toml", [](const Simulation& s) {
    if (s.steps() % 25 != 0) return;
    const CellComplex& complex = s.environment().complex();
    std::vector<double> volume(60);
    std::vector<double> count(60);
    const auto part = [&](Cell c) { return complex.map().source(c) / 15; };
    for (const Cell c : complex.map().cells()) {
      for (std::uint16_t i = 0; i < complex.map().shape(c).simplices().size(); ++i) {
        const Corners v = complex.corners({c, i});
        volume[part(c)] += dot(v[1] - v[0], cross(v[2] - v[0], v[3] - v[0]));
      }
    }
    for (const ParticleState& p : s.particles().states()) ++count[part(p.cell)];
    const double all = std::accumulate(volume.begin(), volume.end(), 0.0);
    double chi = 0.0;
    for (std::size_t i = 0; i < 60; ++i) {
      const double expected = 10'000.0 * volume[i] / all;
      chi += (count[i] - expected) * (count[i] - expected) / expected;
    }
    EXPECT_NEAR(chi, 59.0, 4.0 * std::sqrt(2.0 * 59.0)) << s.steps();
  });
}

// D. Y. H. Pui, F. Romay-Novas, B. Y. H. Liu, 1987, for laminar flow. From St = 0.3 on a flow on a coarse mesh is within 0.06,
// and two sampling errors here.
TEST(Validation, ABendTakesTheDropsThatPuiFound) {
  const std::vector<double> stokes = {0.1, 0.2, 0.3, 0.5, 0.8};
  run("bend.toml", [&](const Simulation& s) {
    if (s.steps() < 400) return;
    std::vector<double> share(stokes.size());
    for (std::size_t i = 0; i < s.particles().size(); ++i) {
      const Vec3& x = s.particles()[i].position;
      if (s.statuses()[i] != ParticleStatus::stuck || x.z < 0.0 || x.x < -5.6 * 2.5e-3) continue;
      const double d = s.diameters()[i];
      const double st = 1000.0 * d * d * 3.0 / (18.0 * 1.8e-5 * 2.5e-3);
      const auto group = std::lower_bound(stokes.begin(), stokes.end(), 0.99 * st);
      share[static_cast<std::size_t>(group - stokes.begin())] += 1.0 / 800.0;
    }
    for (std::size_t i = 0; i < stokes.size(); ++i) {
      const double x = stokes[i] / 0.171;
      const double truth = 1.0 - std::pow(1.0 + std::pow(x, 0.452 * x + 2.242), -2.0 / pi);
      const double error = std::sqrt(share[i] * (1.0 - share[i]) / 800.0);
      EXPECT_NEAR(share[i], truth, (stokes[i] < 0.3 ? 0.15 : 0.06) + 2.0 * error) << stokes[i];
    }
  });
}

}  // namespace dartcast::validation_test
