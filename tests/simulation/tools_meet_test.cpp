// Tools of a scene meet each other: they stop before they cross, on their arcs too. The truth is the angle at which a rod
// comes as near to another as it may, and brute force over all parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/scene.hpp"
#include "dartcast/simulation.hpp"
#include "simulation/rigid_pose.hpp"
#include "solids/audit_solids.hpp"
#include "solids/elements.hpp"
#include "support/meshes.hpp"
#include "support/random_vectors.hpp"
#include "support/tier.hpp"

namespace dartcast::tools_meet_test {

SolidScene line(const std::string& name, const std::vector<Vec3>& points) {
  SolidScene tool;
  tool.name = name;
  tool.shape = points;
  tool.pivot = points[0];
  return tool;
}

Scene scene_of(const std::vector<SolidScene>& tools) {
  Scene scene;
  scene.environment.mesh = test::cubes(4);
  scene.motion.dt = 1.0;
  scene.solids = tools;
  return scene;
}

double angle_of(const Simulation& simulation, std::size_t first) {
  const auto x = simulation.solids()->positions();
  const Vec3 way = x[first + 1] - x[first];
  return std::atan2(way.y, way.x);
}

// A rod that turns towards a peg, which rests or turns about itself.
TEST(ToolsMeet, ARodStopsAtAPeg) {
  constexpr double distance = 0.9;
  for (const double angle : {0.3, 2.7, 6.5}) {
    for (const bool turns : {false, true}) {
      SolidScene rod = line("rod", {{2.0, 2.0, 2.0}, {3.0, 2.0, 2.0}});
      rod.moves = {{1e3, {}, {0.0, 0.0, angle}}};
      const Vec3 at = {2.0 + distance * std::cos(2.0), 2.0 + distance * std::sin(2.0), 1.5};
      SolidScene peg = line("peg", {at, at + Vec3{0.0, 0.0, 1.0}});
      if (turns) peg.moves = {{1e3, {}, {0.0, 0.0, 40.0}}};
      Simulation simulation(scene_of({rod, peg}), Threads{1});
      double time = -1.0;
      for (int s = 0; s < 20; ++s) {
        simulation.step();
        const SolidStep& step = simulation.solids_step();
        EXPECT_EQ(step.made[1], 1.0);
        if (time < 0.0 && !step.meetings.empty()) time = s + step.meetings[0].time_of_impact;
        EXPECT_EQ(simulation.audit().failed, 0U);
      }
      // The rod leaves 2^-10 of its length, the peg that turns as much of its own. A slice's chord is off by half.
      const double kept = turns ? 0x1p-9 : 0x1p-10;
      const double contact = 2.0 - std::asin(kept / distance);
      EXPECT_NEAR(angle_of(simulation, 0), contact, 1e-6) << angle << " " << turns;
      EXPECT_NEAR(time * angle, contact, 0x1p-11 / distance) << angle << " " << turns;
    }
  }
}

// Two rods that turn against each other meet in the middle.
TEST(ToolsMeet, RodsThatCloseMeetInTheMiddle) {
  SolidScene one = line("one", {{2.0, 2.0, 2.0}, {3.0, 2.0, 2.0}});
  SolidScene other = line("other", {{2.0, 2.0, 2.1}, {1.0, 2.0, 1.9}});
  one.moves = {{1e3, {}, {0.0, 0.0, 0.4}}};
  other.moves = {{1e3, {}, {0.0, 0.0, -0.4}}};
  Simulation simulation(scene_of({one, other}), Threads{1});
  for (int s = 0; s < 20; ++s) {
    simulation.step();
    EXPECT_EQ(simulation.audit().failed, 0U);
  }
  const double middle = 2.0 * std::atan(1.0);
  EXPECT_LT(angle_of(simulation, 0), middle);
  EXPECT_GT(angle_of(simulation, 0), middle - 0.02);
  EXPECT_NEAR(angle_of(simulation, 0) + angle_of(simulation, 2), 2.0 * middle, 1e-9) << "both turned as far";
  EXPECT_GT(simulation.solid_summaries()[0].contacts, 5U);
}

TEST(ToolsMeet, OnlyThoseThatMeetStop) {
  SolidScene one = line("one", {{1.0, 2.0, 2.0}, {1.0, 3.0, 2.0}});
  SolidScene other = line("other", {{2.0, 2.5, 1.5}, {2.0, 2.5, 2.5}});
  one.moves = {{1e3, {0.4, 0.0, 0.0}, {}}};
  using Names = std::vector<std::string>;
  for (const auto& [first, second, stops] : {std::tuple<std::optional<Names>, std::optional<Names>, bool>{{}, {}, true},
                                             {Names{"other"}, Names{"one"}, true},
                                             {Names{}, {}, false},
                                             {{}, Names{"other"}, false}}) {
    one.meets = first;
    other.meets = second;
    Simulation simulation(scene_of({one, other}), Threads{1});
    for (int s = 0; s < 4; ++s) simulation.step();
    EXPECT_EQ(simulation.solids()->positions()[0].x < 2.0, stops);
  }
  one.meets = Names{"another"};
  try {
    Simulation simulation(scene_of({one, other}), Threads{1});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(
        std::string(e.what()),
        "solid \"one\": no solid has the name \"another\", which its meets has: give names of the scene's solids");
  }
}

TEST(ToolsMeet, OverlapsAtTheStartAreRefused) {
  const SolidScene one = line("one", {{1.0, 2.0, 2.0}, {3.0, 2.0, 2.0}});
  const SolidScene other = line("other", {{2.0, 1.0, 2.0}, {2.0, 3.0, 2.0}});
  try {
    Simulation simulation(scene_of({one, other}), Threads{1});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(
        std::string(e.what()),
        "solid \"other\": its part with the vertices 0, 1 at (2, 1, 2) overlaps the solid \"one\"; move or turn one of "
        "them, or leave it out of meets");
  }
}

// Bent rods that move and turn at random, far in a step, among walls that rest or move.
TEST(ToolsMeet, NothingIsPierced) {
  Random random(11);
  std::size_t meetings = 0;
  std::size_t turned_far = 0;
  for (int k = 0; k < std::max(4, test::scaled(12, 200)); ++k) {
    std::vector<SolidScene> tools;
    std::vector<SolidElement> elements;
    for (int i = 0; i < 5; ++i) {
      const Vec3 at = {0.6 + 0.7 * i, random.uniform(1.0, 3.0), random.uniform(1.0, 3.0)};
      const auto near = [&](double by) { return at + Vec3{0.1, 1.0, 1.0} * random.uniform(-by, by); };
      SolidScene tool = line("tool" + std::to_string(i), {near(0.1), near(0.8), near(0.8), near(0.8)});
      tool.pivot = at;
      tool.catch_up = i % 2 == 0;
      for (double t = 2.0; t < 9.0; t += 2.0)
        tool.moves.push_back({t, test::random_vector(random, 0.3), test::random_vector(random, i == 4 ? 0.0 : 3.0)});
      tools.push_back(tool);
    }
    Scene scene = scene_of(tools);
    Simulation simulation(scene, Threads{1});
    Simulation same(scene, Threads{3});
    for (Simulation* s : {&simulation, &same}) {
      if (k % 2 == 1) s->pull(std::vector<Vec3>(test::cubes(4).points.size(), {0.2, 0.1, 0.0}), 8.0);
    }
    for (std::uint32_t i = 0; i < 20; ++i) {
      if (i % 4 != 3) elements.push_back({{i, i + 1, i + 1}, 2});
    }
    for (int s = 0; s < 8; ++s) {
      simulation.step();
      const SimulationCheckpoint saved = same.checkpoint();
      same.step();
      if (s > 0) same.restore(saved);
      if (s > 0) same.step();
      ASSERT_EQ(simulation.state_hash(), same.state_hash());
      const auto x = simulation.solids()->positions();
      const auto corners = [&](const SolidElement& e) {
        return std::array{x[e.vertex[0]], x[e.vertex[1]], x[e.vertex[2]]};
      };
      for (const SolidElement& a : elements) {
        for (const SolidElement& b : elements) {
          if (a.vertex[0] / 4 != b.vertex[0] / 4) ASSERT_FALSE(audit_meet(corners(a), corners(b))) << k << " " << s;
        }
      }
      EXPECT_EQ(simulation.audit().failed, 0U) << simulation.audit().first;
      meetings += simulation.solids_step().meetings.size();
      for (std::size_t i = 0; i < 4; ++i) turned_far += simulation.solids_step().made[i] == 1.0 ? 1 : 0;
    }
  }
  EXPECT_GT(meetings, test::sanitized() ? 0U : 5U);
  EXPECT_GT(turned_far, test::sanitized() ? 0U : 30U);
}

}  // namespace dartcast::tools_meet_test
