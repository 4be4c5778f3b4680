// Runs under mpirun as a user starts them: equal to those of one process; errors, signals and killed ranks.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>

#include "support/command.hpp"
#include "support/tier.hpp"

namespace dartcast::mpi_test {

namespace fs = std::filesystem;

class Mpi : public test::CommandTest {
 protected:
  // "mpirun -n 3 dartcast run ..." in the test's folder.
  [[nodiscard]] test::Result shared(unsigned ranks, const std::string& arguments) const {
    return run_program(std::getenv("DARTCAST_MPIEXEC"),
                       "-n " + std::to_string(ranks) + " '" + binary + "' " + arguments);
  }
  [[nodiscard]] std::string text_of(const std::string& run, const std::string& file) const {
    return content(folder / run / file);
  }
  [[nodiscard]] std::string hash_of(const std::string& run) const {
    const std::string text = text_of(run, "summary.json");
    const std::size_t at = text.find("\"state_hash\"");
    return at == std::string::npos ? "no hash in " + run : text.substr(at, 50);
  }
  // The lines that the command itself has printed: a launcher has its own.
  static std::string own_lines(const std::string& error) {
    std::string lines;
    std::istringstream text(error);
    for (std::string line; std::getline(text, line);)
      if (line.starts_with("dartcast: ")) lines += line + "\n";
    return lines;
  }
  [[nodiscard]] fs::path long_scene() const {
    return write(
        "long.toml",
        "[environment]\ngenerator = 'box'\ncells = [10, 10, 10]\n[[particles]]\ncount = 5000\nvelocity = [3.0, 1.0, "
        "0.5]\n[motion]\ndt = 0.01\nsteps = 100000\n[output]\nevery = 20\n");
  }
  void wait_for(const fs::path& path) const {
    for (int i = 0; i < 6000 && !fs::exists(path); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(fs::exists(path)) << path;
  }
};

TEST_F(Mpi, RunsAreThoseOfOneProcess) {
  const std::string steps = std::to_string(test::scaled(50, 400));
  for (const char* name : {"vessel.toml", "bar_deforming.toml", "maze.toml", "surgery.toml", "catheter_left.toml"}) {
    const std::string arguments = "run " + scene(name) + " --steps " + steps + " -j 1 -q -o ";
    ASSERT_EQ(run(arguments + "one").status, 0) << name;
    for (const unsigned ranks : {1U, 2U, 3U, 4U}) {
      const std::string to = "on" + std::to_string(ranks);
      const test::Result r = shared(ranks, arguments + to);
      ASSERT_EQ(r.status, 0) << name << ": " << r.error;
      EXPECT_EQ(r.error, "") << name;
      EXPECT_EQ(hash_of(to), hash_of("one")) << name << " on " << ranks;
      EXPECT_EQ(text_of(to, "stats.csv"), text_of("one", "stats.csv")) << name << " on " << ranks;
      EXPECT_EQ(text_of(to, "report.bin"), text_of("one", "report.bin")) << name << " on " << ranks;
    }
  }
}

TEST_F(Mpi, RunsByCellsAreThoseOfOneProcess) {
  const std::string steps = std::to_string(test::scaled(50, 400));
  for (const char* name : {"vessel.toml", "bar_deforming.toml", "box.toml"}) {
    const std::string arguments = "run " + scene(name) + " --steps " + steps + " -j 1 -q -o ";
    ASSERT_EQ(run(arguments + "one").status, 0) << name;
    for (const unsigned ranks : {1U, 2U, 3U, 4U}) {
      const std::string to = "on" + std::to_string(ranks);
      const test::Result r = shared(ranks, arguments + to + " --partition cells");
      ASSERT_EQ(r.status, 0) << name << ": " << r.error;
      EXPECT_EQ(hash_of(to), hash_of("one")) << name << " on " << ranks;
      EXPECT_EQ(text_of(to, "stats.csv"), text_of("one", "stats.csv")) << name << " on " << ranks;
    }
  }
}

TEST_F(Mpi, AnErrorIsOneLineWithItsRank) {
  const test::Result r = shared(3, "run no_such_scene.toml");
  EXPECT_EQ(r.status, 1);
  EXPECT_EQ(r.out, "");
  EXPECT_EQ(own_lines(r.error), "dartcast: rank 0: no_such_scene.toml: the scene cannot be read; check the path\n");
}

// All of a run's time is bounded here: a rank that waits for another one would end by the test's own time.
TEST_F(Mpi, AKilledRankEndsTheRunAndOthersGoOn) {
  const std::string name = long_scene().string();
  std::thread killer([&] {
    wait_for(folder / "killed" / "particles_000200.pvtp");
    const std::string kill = "pkill -9 -n -f 'run " + name + " -q -j 1 -o killed$'";
    EXPECT_EQ(std::system(kill.c_str()), 0);
  });
  const test::Result r = shared(3, "run " + name + " -q -j 1 -o killed");
  killer.join();
  EXPECT_NE(r.status, 0);
  const std::string stats = text_of("killed", "stats.csv");
  const std::string last = stats.substr(stats.rfind('\n', stats.size() - 2) + 1);
  const std::string steps = std::to_string(std::strtoul(last.c_str(), nullptr, 10) + 200);
  const test::Result resumed = shared(2, "run " + name + " -q -j 1 -o killed --resume --steps " + steps);
  ASSERT_EQ(resumed.status, 0) << resumed.error;
  ASSERT_EQ(run("run " + name + " -q -j 1 -o whole --steps " + steps).status, 0);
  EXPECT_EQ(hash_of("killed"), hash_of("whole"));
  EXPECT_EQ(text_of("killed", "stats.csv"), text_of("whole", "stats.csv"));
}

}  // namespace dartcast::mpi_test
