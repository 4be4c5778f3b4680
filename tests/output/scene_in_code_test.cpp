// Scenes that are built in C++: they run as the same scenes from TOML, can be cancelled, and carry user data.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/point_file.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::scene_in_code_test {

namespace fs = std::filesystem;

const std::string text = R"(
seed = 3
[environment]
generator = "box"
cells = [6, 6, 6]
size = [0.6, 0.6, 0.6]
[[deformation]]
kind = "twist"
amplitude = 0.2
length = 0.6
period = 0.5
[[particles]]
count = 60
radius = 0.01
velocity = [0.5, 0.0, -0.5]
[[particles]]
inlet = "xmin"
rate = 500.0
velocity = [0.5, 0.0, 0.0]
[[body]]
name = "barrel"
generator = "barrel"
radius = 0.05
bulge = 0.01
height = 0.12
spacing = 0.03
at = [0.3, 0.3, 0.3]
[[catheter]]
name = "line"
entry = [0.05, 0.2, 0.2]
direction = [1.0, 0.0, 0.0]
length = 0.2
spacing = 0.01
moves = [{ until = 0.2, push = 0.5 }]
[[event]]
at = 0.05
kind = "carve"
tool = "ball"
point = [0.3, 0.3, 0.55]
radius = 0.05
what = "remove"
stranded = "absorb"
[motion]
dt = 0.005
steps = 30
gravity = [0.0, 0.0, -9.81]
[contact]
restitution = 0.5
[contact.patch.xmax]
response = "escape"
[collisions]
friction = 0.2
[output]
every = 10
)";

Scene in_code() {
  Scene scene;
  scene.name = "test";
  scene.text = text;
  scene.seed = 3;
  BoxOptions box;
  box.cells = {6, 6, 6};
  box.size = {0.6, 0.6, 0.6};
  scene.environment.mesh = generate_box(box);  // the mesh itself
  DeformationStep twist;
  twist.kind = DeformationKind::twist;
  twist.amplitude = 0.2;
  twist.length = 0.6;
  twist.period = 0.5;
  scene.deformation.push_back({twist, {}, {}, {}});
  scene.particles.push_back({RandomParticles{60}, {0.5, 0.0, -0.5}, 0.01, {}});
  scene.particles.push_back({InletParticles{"xmin", 500.0}, {0.5, 0.0, 0.0}, 0.0, {}});
  BodyScene& body = scene.bodies.emplace_back();
  body.name = "barrel";
  BarrelOptions barrel;
  barrel.radius = 0.05;
  barrel.bulge = 0.01;
  barrel.height = 0.12;
  body.surface = generate_barrel(barrel);
  body.sampling.spacing = 0.03;
  body.sampling.seed = 3;
  body.body.radius = 0.015;
  body.at = {0.3, 0.3, 0.3};
  CatheterScene& catheter = scene.catheters.emplace_back();
  catheter.name = "line";
  catheter.options.entry = {0.05, 0.2, 0.2};
  catheter.options.direction = {1.0, 0.0, 0.0};
  catheter.options.length = 0.2;
  catheter.options.spacing = 0.01;
  catheter.moves.push_back({0.2, 0.5, 0.0});
  const Carve carve{capsule_tool({0.3, 0.3, 0.55}, {0.3, 0.3, 0.55}, 0.05), Carving::remove};
  scene.events.push_back({{0.05, carve, OrphanPolicy::absorb}, {}});
  scene.motion.dt = 0.005;
  scene.motion.steps = 30;
  scene.motion.gravity = {0.0, 0.0, -9.81};
  scene.contact.general = Reflect{0.5};
  scene.contact.by_patch["xmax"] = WallResponse{WallResponseKind::escape, 0.5, 0.0};
  scene.collisions = CollisionOptions{.friction = 0.2};
  return scene;
}

TEST(SceneInCode, RunsAsTheSameSceneFromToml) {
  const Summary from_toml = run_scene(parse_scene(text, "test.toml"), {});
  EXPECT_GT(from_toml.totals.injected, 0U);
  EXPECT_EQ(from_toml.surgery->events.size(), 1U);
  EXPECT_GT(from_toml.catheters.at(0).inserted, 0.05);
  Simulation simulation(in_code());
  for (int i = 0; i < 30; ++i) simulation.step();
  EXPECT_EQ(simulation.state_hash().hex(), from_toml.state_hash);
  EXPECT_EQ(run_scene(in_code(), {}).state_hash, from_toml.state_hash);
  EXPECT_EQ(simulation.audit().failed, 0U);
}

TEST(SceneInCode, GoesOnFromACheckpoint) {
  const Scene scene = in_code();
  Simulation whole(scene);
  for (int i = 0; i < 17; ++i) whole.step();
  const SimulationCheckpoint saved = whole.checkpoint();
  Simulation resumed(scene, saved);
  EXPECT_EQ(resumed.state_hash(), whole.state_hash());
  for (int i = 0; i < 13; ++i) {
    whole.step();
    resumed.step();
  }
  EXPECT_EQ(resumed.state_hash(), whole.state_hash());
  EXPECT_EQ(resumed.event_log().events.size(), 1U);
}

TEST(SceneInCode, FilesMustBeReadFirst) {
  Scene scene = in_code();
  scene.environment.mesh = fs::path("none.vtu");
  EXPECT_THROW(Simulation{scene}, InvalidArgument);
  scene = in_code();
  scene.particles.push_back({PlacedParticles{fs::path("none.csv")}, {}, 0.0, {}});
  EXPECT_THROW(Simulation{scene}, InvalidArgument);
  scene = in_code();
  scene.bodies.front().surface = fs::path("none.stl");
  EXPECT_THROW(Simulation{scene}, Error);
}

TEST(SceneInCode, SeedsInMemoryAreAsThoseOfAFile) {
  Scene scene = in_code();
  scene.particles.resize(1);
  scene.particles[0].source = PlacedParticles{ParticleSeeds{"seeds", {{0.1, 0.1, 0.1}}, {{0.0, 1.0, 0.0}}, {0.02}}};
  Simulation simulation(scene);
  ASSERT_EQ(simulation.particles().size(), 1U);
  EXPECT_EQ(simulation.velocities()[0], (Vec3{0.0, 1.0, 0.0}));
  EXPECT_EQ(simulation.radii()[0], 0.02);
  scene.particles[0].source = PlacedParticles{ParticleSeeds{"seeds", {{9.0, 0.1, 0.1}}, {}, {}}};
  try {
    const Simulation outside(scene);
    FAIL() << "the position is outside";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "seeds: position 0 (counted from 0) is outside the mesh; move or remove it");
  }
}

// A run that is cancelled leaves a folder that is complete up to there, and can be resumed to the same end.
TEST(SceneInCode, ARunCanBeCancelledBetweenSteps) {
  const test::Folder folder;
  RunOptions options;
  options.folder = folder / "out";
  const auto until = [](std::uint64_t last) {
    return [last](std::uint64_t done, std::uint64_t) { return done < last; };
  };
  const Summary cancelled = run_scene(in_code(), options, until(13));
  EXPECT_TRUE(cancelled.cancelled);
  EXPECT_EQ(cancelled.steps, 13U);
  const auto json = nlohmann::json::parse(std::ifstream(options.folder / "summary.json"));
  EXPECT_EQ(json["steps"], 13);
  EXPECT_EQ(json["cancelled"], true);
  EXPECT_EQ(read_points(options.folder / "particles_000013.vtp").points.size(), cancelled.alive);
  EXPECT_NE(read_bytes(options.folder / "particles.pvd").find("particles_000013.vtp"), std::string::npos);

  options.resume = true;
  const Summary resumed = run_scene(in_code(), options);
  const Summary whole = run_scene(in_code(), {});
  EXPECT_FALSE(resumed.cancelled);
  EXPECT_EQ(resumed.state_hash, whole.state_hash);
  EXPECT_FALSE(nlohmann::json::parse(summary_json(resumed)).contains("cancelled"));
  EXPECT_FALSE(fs::exists(options.folder / "particles_000013.vtp"));
  EXPECT_FALSE(run_scene(in_code(), {}, until(30)).cancelled);  // after the last step there is nothing to cancel
}

TEST(SceneInCode, UserDataIsWrittenWithFramesAndResumed) {
  const test::Folder folder;
  RunOptions options;
  options.folder = folder / "out";
  Scene scene = in_code();
  scene.user_data = {"dose", "kind_of_cell"};
  scene.particles[0].user_data = {1.5, 7.0};
  run_scene(scene, options, [](std::uint64_t done, std::uint64_t) { return done < 10; });
  options.resume = true;
  const Summary summary = run_scene(scene, options);
  const PointFile frame = read_points(options.folder / "particles_000030.vtp");
  ASSERT_EQ(frame.points.size(), summary.alive);
  const auto array = [&](const std::string& name) {
    return *std::find_if(frame.arrays.begin(), frame.arrays.end(), [&](const DataArray& a) { return a.name == name; });
  };
  const DataArray ids = array("id");
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    EXPECT_EQ(array("dose").values[i], ids.values[i] < 60.0 ? 1.5 : 0.0);
    EXPECT_EQ(array("kind_of_cell").values[i], ids.values[i] < 60.0 ? 7.0 : 0.0);
  }
}

}  // namespace dartcast::scene_in_code_test
