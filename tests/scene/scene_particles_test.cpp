// The keys of groups of particles: where they enter, when, and how fast.
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "dartcast/scene_file.hpp"
#include "support/expectations.hpp"

namespace dartcast::scene_particles_test {

TEST(SceneParticles, InletsAreRead) {
  const Scene s = parse_scene(R"(
[environment]
generator = "box"
[[particles]]
inlet = "xmin"
rate = 5
profile = "flux"
waveform = { times = [0, 0.5], factors = [0, 2], period = 1 }
[[particles]]
cone = { at = [1, 2, 3], axis = [0, 1, 0], inner = 5, outer = 20, speed = 3 }
bursts = { times = [0, 0.25], count = 40 }
[[particles]]
count = 2
velocity = "field"
[motion]
field = "U"
sample = ["p", "T"]
)",
                              "scene.toml");
  const auto& flux = std::get<InletParticles>(s.particles[0].source);
  EXPECT_EQ(flux.profile, InletProfile::flux);
  EXPECT_EQ(flux.waveform.times, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(flux.waveform.factors, (std::vector<double>{0, 2}));
  EXPECT_EQ(flux.waveform.period, 1.0);
  EXPECT_FALSE(flux.cone.has_value());
  const auto& spray = std::get<InletParticles>(s.particles[1].source);
  ASSERT_TRUE(spray.cone.has_value());
  EXPECT_EQ(spray.cone->at, (Vec3{1, 2, 3}));
  EXPECT_EQ(spray.cone->axis, (Vec3{0, 1, 0}));
  EXPECT_EQ(spray.cone->inner, 5.0);
  EXPECT_EQ(spray.cone->outer, 20.0);
  EXPECT_EQ(spray.cone->speed, 3.0);
  EXPECT_EQ(spray.burst_times, (std::vector<double>{0, 0.25}));
  EXPECT_EQ(spray.burst_count, 40U);
  EXPECT_EQ(spray.rate, 0.0);
  EXPECT_FALSE(s.particles[1].with_field);
  EXPECT_TRUE(s.particles[2].with_field);
  EXPECT_EQ(s.motion.sample, (std::vector<std::string>{"p", "T"}));
}

TEST(SceneParticles, MistakesAreNamedWithLineAndRemedy) {
  const auto expect_error = [](const std::string& text, const char* line, const char* word) {
    SCOPED_TRACE(text);
    const std::string place = std::string("scene.toml:") + line;
    test::expect_parts(test::error_text([&] { static_cast<void>(parse_scene(text, "scene.toml")); }),
                       {place.c_str(), word});
  };
  const std::string box = "[environment]\ngenerator = 'box'\n";
  expect_error(box + "[[particles]]\ncount = 1\nvelocity = 'field'\n", "5:", "needs a field");
  expect_error(box + "[[particles]]\ncount = 1\nvelocity = 'flow'\n", "5:", "field");
  const std::string field = "[motion]\nfield = 'U'\n";
  expect_error(box + field + "[[particles]]\ninlet = 'a'\nrate = 1\nprofile = 'flux'\nvelocity = [1, 0, 0]\n",
               "9:", "leave velocity out");
  expect_error(box + "[[particles]]\ncount = 1\nprofile = 'flux'\n", "5:", "belongs to an inlet");
  expect_error(box + "[[particles]]\ninlet = 'a'\nrate = 1\nwaveform = { times = [0], factors = [] }\n",
               "6:", "0 factors for 1 times");
  expect_error(box + "[[particles]]\ninlet = 'a'\nbursts = { times = [0] }\n", "5:", "count");
  expect_error(box + "[[particles]]\ncone = { at = [0, 0, 0], inner = 5, speed = 1 }\nrate = 1\n", "4:", "outer");
  expect_error(box + "[[particles]]\ncone = { speed = 1 }\nrate = 1\n", "4:", "at");
}

}  // namespace dartcast::scene_particles_test
