// Runs whose motion is read from files: they stop at a damaged file, and --resume goes on once it is whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "support/expectations.hpp"
#include "support/meshes.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::frames_run_test {

namespace fs = std::filesystem;

constexpr std::size_t frame_count = 30;

class FramesRun : public testing::Test {
 protected:
  void SetUp() override {
    const MeshData rest = test::cubes(4);
    std::string files, times;
    for (std::size_t k = 0; k < frame_count; ++k) {
      MeshData frame = rest;
      for (Vec3& x : frame.points) x.x += 0.2 * std::sin(0.5 * double(k)) * x.y;
      write_mesh(frame, file(k));
      files += "'" + file(k).string() + "', ";
      times += std::to_string(0.04 * double(k)) + ", ";
    }
    scene =
        "[environment]\nmesh = '" + file(0).string() + "'\n[[deformation]]\nkind = 'frames'\nfiles = [" + files +
        "]\ntimes = [" + times +
        "]\n[[particles]]\ncount = 100\nvelocity = [1.0, 2.0, 3.0]\n[motion]\ndt = 0.02\nsteps = 50\n[output]\nevery "
        "= 10\n";
  }
  fs::path file(std::size_t frame) const { return temporary / ("f" + std::to_string(frame) + ".vtu"); }

  Summary run(const std::string& folder, bool resume = false, std::uint64_t steps = 50) const {
    RunOptions options;
    options.folder = temporary / folder;
    options.resume = resume;
    options.steps = steps;
    return run_scene(parse_scene(scene, temporary / "scene.toml"), options);
  }

  // The scene with all frames in memory.
  std::string hash_with_frames_in_memory() const {
    Scene loaded = load_scene_files(parse_scene(scene, temporary / "scene.toml")).scene;
    DeformationStep& step = loaded.deformation[0].step;
    for (std::size_t k = 0; k < frame_count; ++k) step.frames.push_back(step.reader(k));
    step.reader = {};
    Simulation simulation(loaded);
    while (simulation.steps() < 50) simulation.step();
    return simulation.state_hash().hex();
  }

  test::Folder temporary;
  std::string scene;
};

TEST_F(FramesRun, EndsAsWithFramesInMemory) {
  const Summary whole = run("whole");
  EXPECT_EQ(whole.state_hash, hash_with_frames_in_memory());
  EXPECT_GT(whole.totals.counters.contacts[2], 50U);
  run("parts", false, 23);
  EXPECT_EQ(run("parts", true).state_hash, whole.state_hash);
}

TEST_F(FramesRun, GoesOnOnceADamagedFileIsWhole) {
  const Summary whole = run("whole");
  const std::string content = read_bytes(file(15));
  write_bytes(file(15), content.substr(0, content.size() / 2));
  const std::string error = test::error_text([&] { run("cut"); });
  EXPECT_NE(error.find("frame 15 cannot be read: " + file(15).string()), std::string::npos) << error;
  EXPECT_NE(test::error_text([&] { run("cut", true); }).find("frame 15"), std::string::npos);
  write_bytes(file(15), content);
  EXPECT_EQ(run("cut", true).state_hash, whole.state_hash);
}

}  // namespace dartcast::frames_run_test
