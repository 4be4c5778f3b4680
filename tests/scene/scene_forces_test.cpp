// The keys of forces, random motion, sizes and impacts.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "support/expectations.hpp"
#include "support/scene_text.hpp"

namespace dartcast::scene_forces_test {

using test::box;
using test::expect_error;

TEST(SceneForces, ReadsForcesAndMaterials) {
  const Scene scene = parse_scene(
      box +
          "[fluid]\ndensity = 1.2\nviscosity = 1.8e-5\nmean_free_path = 6.6e-8\n[[particles]]\ncount = 3\ndiameter = "
          "1e-6\n"
          "density = 900.0\ncharge_per_mass = -2.0\ninterception = true\n[motion]\nforces = ['putnam', 'lorentz']\n"
          "electric_field = [1, 2, 3]\nmagnetic_field = [4, 5, 6]\n",
      "scene.toml");
  const ForceOptions& forces = scene.motion.forces;
  EXPECT_EQ(forces.terms, (std::vector{Force::putnam, Force::lorentz}));
  EXPECT_EQ(forces.fluid.density, 1.2);
  EXPECT_EQ(forces.fluid.viscosity, 1.8e-5);
  EXPECT_EQ(forces.fluid.mean_free_path, 6.6e-8);
  EXPECT_EQ(forces.electric_field, (Vec3{1, 2, 3}));
  EXPECT_EQ(forces.magnetic_field, (Vec3{4, 5, 6}));
  const Simulation simulation(scene);
  EXPECT_EQ(simulation.diameters()[2], 1e-6);
  EXPECT_EQ(simulation.densities()[2], 900.0);
  EXPECT_EQ(simulation.charges_per_mass()[2], -2.0);
  EXPECT_EQ(simulation.radii()[2], 5e-7);
}

TEST(SceneForces, ReadsRandomMotionSizesAndImpacts) {
  const Scene scene = parse_scene(
      box +
          "[fluid]\ntemperature = 300\n[[particles]]\ncount = 3\ndiameter = { law = 'rosin-rammler', scale = 2e-6, "
          "exponent = 3, min = 1e-6, max = 5e-6 }\n[[particles]]\ninlet = 'xmin'\nmass_rate = 2.0\ndensity = "
          "5.0\ndiameter "
          "= { law = 'table', diameters = [1, 2], shares = [3, 4] }\n[motion]\ndiffusion = 0.5\nforces = ['brownian']\n"
          "field = 'u'\nsample = ['p', 'k']\nturbulence = { k = 'k', omega = 'w', lagrangian = 0.3 "
          "}\n[contact]\nrestitution "
          "= { speeds = [1, 2], angles = [30], values = [0.5, 0.25] }\nstick_below = 0.125\n[contact.patch.xmax]\n"
          "restitution = 0.75\n",
      "scene.toml");
  const MotionScene& m = scene.motion;
  EXPECT_EQ(m.diffusion, 0.5);
  EXPECT_EQ(m.forces.terms, std::vector{Force::brownian});
  EXPECT_EQ(m.forces.fluid.temperature, 300.0);
  EXPECT_EQ(m.sample, (std::vector<std::string>{"p", "k", "w"}));
  EXPECT_EQ(m.turbulence.k + m.turbulence.epsilon + m.turbulence.omega, "kw");
  EXPECT_EQ(m.turbulence.lagrangian, 0.3);
  const SizeDistribution& some = *scene.particles[0].sizes;
  EXPECT_TRUE(some.law == SizeLaw::rosin_rammler && some.size == 2e-6 && some.spread == 3.0 && some.min == 1e-6 &&
              some.max == 5e-6);
  const SizeDistribution& table = *scene.particles[1].sizes;
  EXPECT_TRUE(table.law == SizeLaw::table && table.diameters == (std::vector{1.0, 2.0}) &&
              table.shares == (std::vector{3.0, 4.0}));
  EXPECT_EQ(std::get<InletParticles>(scene.particles[1].source).mass_rate, 2.0);
  EXPECT_EQ(scene.contact.general.table.values, (std::vector{0.5, 0.25}));
  EXPECT_EQ(scene.contact.general.stick_below, 0.125);
  EXPECT_TRUE(scene.contact.by_patch.at("xmax").table.speeds.empty());
  EXPECT_EQ(scene.contact.by_patch.at("xmax").stick_below, 0.125);
}

TEST(SceneForces, RefusesRandomMotionSizesAndImpactsThatDoNotFit) {
  const auto expect = [](const std::string& text, const char* part) {
    EXPECT_NE(test::error_text([&] { parse_scene(box + text, "scene.toml"); }).find(part), std::string::npos) << text;
  };
  const std::string motion = "[motion]\nturbulence = ";
  expect(motion + "{ k = 'k', omega = 'w' }\n", "needs a field");
  expect(motion + "{ k = 'k' }\nfield = 'u'\n", "epsilon or as omega");
  expect(motion + "{ k = 'k', omega = 'w', epsilon = 'e' }\nfield = 'u'\n", "epsilon or as omega");
  expect(motion + "{ omega = 'w' }\nfield = 'u'\n", "k");
  const std::string group = "[[particles]]\ncount = 3\ndiameter = ";
  expect(group + "{ law = 'normal', mean = 1 }\n", "deviation");
  expect(group + "{ law = 'normal', median = 1, deviation = 1 }\n", "mean");
  expect(group + "{ law = 'table', diameters = [1, 2], shares = [1] }\n", "1 shares for 2 diameters");
  expect("[[particles]]\npositions = 'a.csv'\ndiameter = { law = 'normal', mean = 1, deviation = 1 }\n",
         "give each position its diameter");
  expect("[[particles]]\ninlet = 'xmin'\nrate = 1\nmass_rate = 1\n", "not both");
  expect("[[particles]]\ncount = 1\nmass_rate = 1\n", "belong together");
  expect("[contact]\nrestitution = { speeds = [1], angles = [30], values = [0.5, 0.25] }\n", "2 values for 1 speeds");
}

TEST(SceneForces, RefusesForcesThatDoNotFit) {
  const std::string forces = box + "[motion]\nforces = ['stokes']\n";
  expect_error(forces + "drag = 2.0\n", "5: [motion]", "leave drag out");
  expect_error(box + "[motion]\nforces = ['stoke']\n", "4: [motion]", "\"stoke\" is unknown; there are stokes, ");
  expect_error(box + "[fluid]\nviscosity = 0\n", "4: [fluid]", "more than 0");
  expect_error(box + "[fluid]\nhumidity = 0.3\n", "4: [fluid]", "'humidity' is unknown");
  expect_error(box + "[[particles]]\ncount = 1\nradius = 1.0\ndiameter = 2.0\ninterception = true\n",
               "7: [[particles]]", "leave radius out");
  EXPECT_THROW(Simulation(parse_scene(forces + "[fluid]\nviscosity = 1.0\n[[particles]]\ncount = 1\n", "a.toml")),
               InvalidArgument);
}

}  // namespace dartcast::scene_forces_test
