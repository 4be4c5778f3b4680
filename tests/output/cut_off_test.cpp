// Runs that are killed, and disks that are full: the files that remain are whole, and a run goes on from them.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <thread>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/point_file.hpp"
#include "output/run_files.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::cut_off_test {

namespace fs = std::filesystem;

// Frames and a checkpoint at every other step, of a mesh that deforms, with both tables.
const std::string scene_text = R"(
[environment]
generator = "box"
cells = [8, 8, 8]
[[deformation]]
kind = "twist"
amplitude = 0.4
length = 8.0
period = 0.7
[[particles]]
count = 200
velocity = [3.0, 1.0, 0.5]
[[particles]]
inlet = "xmin"
rate = 170.0
velocity = [4.0, 0.5, 0.0]
[[body]]
generator = "barrel"
radius = 0.5
bulge = 0.1
height = 1.0
spacing = 0.3
at = [4.0, 4.0, 2.0]
[motion]
dt = 0.02
steps = 60
gravity = [0.0, 0.0, -5.0]
[contact.patch.xmax]
response = "escape"
[output]
every = 2
contacts = true
)";

Summary run(const fs::path& folder, bool resume, const std::string& text = scene_text) {
  RunOptions options;
  options.folder = folder;
  options.resume = resume;
  options.threads = {1};  // a child process has only the thread that made it
  return run_scene(parse_scene(text, "test.toml"), options);
}

// Runs the scene in a process of its own.
template <class Prepare>
pid_t start(const fs::path& folder, bool resume, Prepare&& prepare) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  int outcome = 2;
  try {
    prepare();
    run(folder, resume);
    outcome = 0;
  } catch (const Error& e) {
    std::ofstream(folder.string() + ".error") << e.what();
    outcome = 1;
  } catch (...) {
  }
  ::_exit(outcome);
}

// Every frame that a list names, and every other one, can be read: with VTK, which does that.
void expect_whole(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path path = entry.path();
    SCOPED_TRACE(path.string());
    if (path.extension() == ".vtp") EXPECT_NO_THROW(read_points(path));
    if (path.extension() == ".vtu") EXPECT_NO_THROW(read_mesh(path));
    if (path.extension() != ".pvd") continue;
    const std::string list = read_bytes(path);
    EXPECT_TRUE(list.ends_with("</VTKFile>\n"));
    const std::string start = "file=\"";
    for (std::size_t at = list.find(start); at != std::string::npos; at = list.find(start, at + 1)) {
      const std::size_t begin = at + start.size();
      EXPECT_TRUE(fs::exists(folder / list.substr(begin, list.find('"', begin) - begin)));
    }
  }
}

void expect_same_folders(const fs::path& whole, const fs::path& found) {
  for (const auto& entry : fs::directory_iterator(whole)) {
    const std::string name = entry.path().filename();
    if (name == "summary.json" || name == "checkpoint.bin" || name.starts_with("report."))
      continue;  // times stand in them
    ASSERT_TRUE(fs::exists(found / name)) << name;
    EXPECT_TRUE(read_bytes(entry.path()) == read_bytes(found / name)) << name;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(found), {}), std::distance(fs::directory_iterator(whole), {}));
}

TEST(CutOff, AKilledRunGoesOnToTheSameEnd) {
  const test::Folder temporary;
  const auto begin = std::chrono::steady_clock::now();
  const Summary whole = run(temporary / "whole", false);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::mt19937 random(7);
  const int runs = test::scaled(20, 200);
  int killed = 0;
  for (int i = 0; i < runs || (killed <= runs / 2 && i < 10 * runs); ++i) {  // other work may change how long runs take
    const fs::path folder = temporary / "run";
    const pid_t child = start(folder, i % 3 != 0, [] {});
    const double wait = seconds * std::uniform_real_distribution<>(0.0, 0.6)(random);
    std::this_thread::sleep_for(std::chrono::duration<double>(wait));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    killed += WIFSIGNALED(status) ? 1 : 0;
    expect_whole(folder);
    if (i % 4 != 3) continue;
    EXPECT_EQ(run(folder, true).state_hash, whole.state_hash);
    expect_whole(folder);
    expect_same_folders(temporary / "whole", folder);
  }
  EXPECT_GT(killed, runs / 2);
}

// Files may not grow beyond a size: as on a full disk, writing fails in the middle of one.
TEST(CutOff, AFullDiskIsAnErrorAndLeavesWhatARunGoesOnFrom) {
  const test::Folder temporary;
  const Summary whole = run(temporary / "whole", false);
  for (const rlim_t limit : {100U, 1000U, 3000U, 20000U, 30000U}) {
    SCOPED_TRACE(limit);
    const fs::path folder = temporary / ("run" + std::to_string(limit));
    const pid_t child = start(folder, false, [&] {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit small = {limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &small);
    });
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 1);
    const std::string error = read_bytes(folder.string() + ".error").substr(0, 99);
    EXPECT_TRUE(error.starts_with(folder.string())) << error;  // the file's name
    expect_whole(folder);
    EXPECT_EQ(run(folder, true).state_hash, whole.state_hash);
    expect_same_folders(temporary / "whole", folder);
  }
}

TEST(CutOff, AFolderThatGoesAwayIsAnErrorOfTheNextStep) {
  const test::Folder temporary;
  const fs::path folder = temporary / "run";
  RunOptions options;
  options.folder = folder;
  std::uint64_t reached = 0;
  const auto progress = [&](std::uint64_t done, std::uint64_t) {
    reached = done;
    if (done == 5) fs::rename(folder, temporary / "elsewhere");
    if (done > 6) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return true;
  };
  try {
    run_scene(parse_scene(scene_text, "test.toml"), options, progress);
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(folder.string()), std::string::npos) << e.what();
  }
  EXPECT_LT(reached, 20U);
}

// Remains of files that were being written are removed, by a new run and by one that goes on.
TEST(CutOff, PartsAreRemoved) {
  const test::Folder temporary;
  const fs::path folder = temporary / "run";
  for (const bool resume : {false, true}) {
    fs::create_directories(folder);
    for (const char* name : {"stats.csv.part", "particles_000044.vtp.part", "checkpoint.bin.part"})
      write_bytes(folder / name, "half");
    run(folder, resume);
    for (const auto& entry : fs::directory_iterator(folder)) EXPECT_NE(entry.path().extension(), ".part");
  }
  write_bytes(folder / "mine.part", "mine");
  run(folder, true);
  EXPECT_TRUE(fs::exists(folder / "mine.part"));
}

TEST(OutputCompression, FramesHoldTheSameInEach) {
  const test::Folder temporary;
  run(temporary / "none", false, scene_text + "compression = \"none\"\n");
  std::uintmax_t before = fs::file_size(temporary / "none" / "environment_000010.vtu");
  for (const std::string name : {"fast", "small"}) {
    const fs::path folder = temporary / name;
    run(folder, false, scene_text + "compression = \"" + name + "\"\n");
    for (const auto& entry : fs::directory_iterator(temporary / "none")) {
      const fs::path same = folder / entry.path().filename().string();
      SCOPED_TRACE(same.string());
      if (same.extension() == ".vtu") {
        const MeshData a = read_mesh(entry.path()).mesh;
        const MeshData b = read_mesh(same).mesh;
        EXPECT_EQ(a.points, b.points);
        EXPECT_EQ(a.connectivity, b.connectivity);
      }
      if (same.extension() != ".vtp") continue;
      const PointFile a = read_points(entry.path());
      const PointFile b = read_points(same);
      EXPECT_EQ(a.points, b.points);
      ASSERT_EQ(a.arrays.size(), b.arrays.size());
      for (std::size_t k = 0; k < a.arrays.size(); ++k) EXPECT_EQ(a.arrays[k].values, b.arrays[k].values);
    }
    const std::uintmax_t size = fs::file_size(folder / "environment_000010.vtu");
    EXPECT_LT(size, before);
    before = size;
  }
  run(temporary / "default", false);
  EXPECT_EQ(fs::file_size(temporary / "default" / "environment_000010.vtu"), before);
  EXPECT_EQ(fs::file_size(temporary / "default" / "particles_000010.vtp"),
            fs::file_size(temporary / "none" / "particles_000010.vtp"));
}

TEST(OutputCompression, OtherWordsAreRefused) {
  try {
    (void)parse_scene(scene_text + "compression = 'zip'\n", "test.toml");
    FAIL();
  } catch (const Error& e) {
    for (const char* word : {"compression", "zip", "none", "fast", "small"})
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
}

}  // namespace dartcast::cut_off_test
