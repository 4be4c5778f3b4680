// Bodies and catheters in scenes: their files, their place in the summary, what is refused.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/point_file.hpp"
#include "simulation/bodies_component.hpp"
#include "support/expectations.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::solids_test {

namespace fs = std::filesystem;

const std::string box = R"(
[environment]
generator = "box"
cells = [4, 4, 4]
size = [0.4, 0.4, 0.4]
)";
const std::string barrel = R"(
[[body]]
name = "barrel"
generator = "barrel"
radius = 0.05
bulge = 0.01
height = 0.12
spacing = 0.03
at = [0.2, 0.2, 0.2]
)";
const std::string catheter = R"(
[[catheter]]
name = "line"
entry = [0.05, 0.2, 0.2]
direction = [1.0, 0.0, 0.0]
length = 0.2
spacing = 0.01
camera = 0.02
moves = [{ until = 0.2, push = 0.5 }]
)";
const std::string motion = R"(
[motion]
dt = 0.01
steps = 20
gravity = [0.0, 0.0, -9.81]
[output]
every = 10
)";

Summary run(const std::string& text, const fs::path& folder = {}) {
  RunOptions options;
  options.folder = folder;
  options.audit = true;
  return run_scene(parse_scene(text, "test.toml"), options);
}

std::size_t line_count(const fs::path& path) {
  std::ifstream file(path);
  std::size_t count = 0;
  for (std::string line; std::getline(file, line);) ++count;
  return count;
}

TEST(SolidsInScenes, WriteSeriesTablesAndSummary) {
  const test::Folder folder;
  const Summary summary = run(box + barrel + catheter + motion, folder / "out");
  for (const char* name : {"body_barrel", "surface_barrel", "catheter_line", "camera_line"}) {
    EXPECT_TRUE(fs::exists(folder / "out" / (std::string(name) + ".pvd"))) << name;
    for (const char* step : {"_000000.vtp", "_000010.vtp", "_000020.vtp"})
      EXPECT_TRUE(fs::exists(folder / "out" / (name + std::string(step)))) << name << step;
  }
  EXPECT_EQ(line_count(folder / "out" / "bodies.csv"), 21U);
  EXPECT_EQ(line_count(folder / "out" / "catheters.csv"), 21U);
  ASSERT_EQ(summary.bodies.size(), 1U);
  EXPECT_EQ(read_points(folder / "out" / "body_barrel_000020.vtp").points.size(), summary.bodies[0].particles);
  const std::size_t points = read_points(folder / "out" / "catheter_line_000020.vtp").points.size();
  EXPECT_GE(points, 10U);
  EXPECT_LE(points, 12U);  // 0.1 m by 0.01, and the entry
  const auto json = nlohmann::json::parse(std::ifstream(folder / "out" / "summary.json"));
  EXPECT_EQ(json["bodies"][0]["name"], "barrel");
  EXPECT_FALSE(json["bodies"][0]["gone"]);
  EXPECT_NEAR(json["catheters"][0]["inserted"], 0.1, 1e-9);
  EXPECT_LE(json["catheters"][0]["worst_segment"], 0.01);
  EXPECT_EQ(summary.audit->failed, 0U);
  EXPECT_GE(summary.audit->checked, 20U * summary.bodies[0].particles);
}

// A second run in the folder, without them, leaves none of their files behind.
TEST(SolidsInScenes, TheirFilesAreThoseOfARun) {
  const test::Folder folder;
  run(box + barrel + catheter + motion, folder / "out");
  run(box + motion, folder / "out");
  for (const auto& entry : fs::directory_iterator(folder / "out")) {
    const std::string name = entry.path().filename();
    EXPECT_EQ(name.find("barrel"), std::string::npos) << name;
    EXPECT_EQ(name.find("line"), std::string::npos) << name;
    EXPECT_FALSE(name == "bodies.csv" || name == "catheters.csv") << name;
  }
}

TEST(SolidsInScenes, BodiesFallAsTheyShould) {
  const Summary summary = run(box + barrel + motion);
  EXPECT_NEAR(summary.bodies[0].centre.z, 0.2 - 0.5 * 9.81 * 0.2 * 0.2, 0.13);  // it meets the floor
  EXPECT_GT(summary.bodies[0].centre.z, 0.05 - 2.0 * 0.01);  // squeezed by its speed over its frequency, 1 / dt
  const Summary free = run(box + barrel + "[motion]\ndt = 0.001\nsteps = 100\ngravity = [0.0, 0.0, -9.81]\n");
  EXPECT_NEAR(free.bodies[0].centre.z, 0.2 - 0.5 * 9.81 * 0.1 * 0.1, 1e-3);
}

// With [collisions], spheres lie on a body, and bodies rebound from each other as the scene says.
TEST(SolidsInScenes, SpheresAndBodiesMeet) {
  const std::string text = box + barrel + R"(
velocity = [0.0, 0.0, -2.0]
mass = 0.01
[[particles]]
count = 60
radius = 0.02
[motion]
dt = 0.002
steps = 30
[output]
every = 0
)";
  const Summary apart = run(text);
  const Summary together = run(text + "[collisions]\n");
  EXPECT_NE(apart.bodies[0].centre, together.bodies[0].centre);
  EXPECT_NEAR(apart.bodies[0].energy.kinetic, 0.02, 1e-3);
  EXPECT_LT(together.bodies[0].energy.kinetic, 0.015);
  EXPECT_EQ(together.audit->failed, 0U);
}

std::string refusal(const std::string& text) {
  return test::error_text([&] { run(text); });
}

TEST(SolidsInScenes, ThreadsDoNotMatter) {
  const auto hash = [](unsigned threads) {
    RunOptions options;
    options.threads = {threads};
    return run_scene(parse_scene(box + barrel + catheter + motion, "test.toml"), options).state_hash;
  };
  EXPECT_EQ(hash(1), hash(2));
  EXPECT_EQ(hash(1), hash(5));
}

TEST(SolidsInScenes, WhatHasNoPlaceIsRefusedByName) {
  const std::string outside = refusal(box + barrel + "velocity = [0.0, 0.0, 0.0]\nscale = 4.0\n" + motion);
  EXPECT_NE(outside.find("body \"barrel\""), std::string::npos) << outside;
  EXPECT_NE(outside.find("in no free cell"), std::string::npos) << outside;
  const std::string missing = refusal(box + "[[body]]\nsurface = 'none.stl'\nspacing = 0.1\n" + motion);
  EXPECT_NE(missing.find("body \"body1\""), std::string::npos) << missing;
  EXPECT_NE(missing.find("none.stl"), std::string::npos) << missing;
  const std::string entry =
      refusal(box + "[[catheter]]\nentry = [9.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n" + motion);
  EXPECT_NE(entry.find("catheter \"catheter1\""), std::string::npos) << entry;
}

}  // namespace dartcast::solids_test
