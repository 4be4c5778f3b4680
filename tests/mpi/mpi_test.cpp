// Runs under mpirun as a user starts them: equal to those of one process; errors, signals and killed ranks.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/command.hpp"
#include "support/tier.hpp"
#include "support/uncounted.hpp"

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
  [[nodiscard]] std::uint64_t number_of(const std::string& run, const std::string& key) const {
    const std::string text = text_of(run, "summary.json");
    const std::size_t at = text.find("\"" + key + "\": ");
    return at == std::string::npos ? 0 : std::strtoull(text.c_str() + at + key.size() + 4, nullptr, 10);
  }
  // By the system's cmp: tables of the full tier have gigabytes.
  [[nodiscard]] bool are_equal(const std::string& run, const std::string& other, const std::string& file) const {
    const auto quoted = [&](const std::string& of) { return "'" + (folder / of / file).string() + "'"; };
    return std::system(("cmp -s " + quoted(run) + " " + quoted(other)).c_str()) == 0;
  }
  // Several ranks that share the cells count no tests.
  [[nodiscard]] bool are_equal_but_tests(const std::string& run, const std::string& one) const {
    return text_of(run, "stats.csv") == test::uncounted(text_of(one, "stats.csv"));
  }
  // Runs on so many ranks, shared in each of these ways, have the hash and the files of one process.
  void expect_same_runs(const std::string& of, std::uint64_t steps, const std::vector<std::string>& partitions,
                        const std::vector<std::string>& files,
                        const std::vector<unsigned>& numbers_of_ranks = {1, 2, 3, 4}) const {
    const std::string arguments = "run " + of + " --steps " + std::to_string(steps) + " -j 1 -q -o ";
    ASSERT_EQ(run(arguments + "one").status, 0) << of;
    for (const std::string& partition : partitions) {
      for (const unsigned ranks : numbers_of_ranks) {
        const std::string name = of + " by " + partition + " on " + std::to_string(ranks);
        const std::string to = "on" + std::to_string(ranks);
        const test::Result r = shared(ranks, arguments + to + " --partition " + partition);
        ASSERT_EQ(r.status, 0) << name << ": " << r.error;
        EXPECT_EQ(r.error, "") << name;
        EXPECT_EQ(hash_of(to), hash_of("one")) << name;
        for (const std::string& file : files) {
          const bool counted = partition != "cells" || ranks == 1 || file != "stats.csv";
          EXPECT_TRUE(counted ? are_equal(to, "one", file) : are_equal_but_tests(to, "one")) << name << ": " << file;
        }
        fs::remove_all(folder / to);  // of gigabytes in the full tier
      }
    }
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

TEST_F(Mpi, RunsByParticlesAreThoseOfOneProcess) {
  for (const char* name : {"vessel.toml", "bar_deforming.toml", "maze.toml", "surgery.toml", "catheter_left.toml"})
    expect_same_runs(scene(name), test::scaled(50, 400), {"particles"}, {"stats.csv", "report.bin"});
}

TEST_F(Mpi, RunsByCellsAreThoseOfOneProcess) {
  for (const char* name : {"vessel.toml", "bar_deforming.toml", "box.toml"})
    expect_same_runs(scene(name), test::scaled(50, 400), {"cells"}, {"stats.csv"});
}

// Walks that pass whole hexahedra, with ranks between them.
TEST_F(Mpi, RunsOfLongStepsAreThoseOfOneProcess) {
  const fs::path path =
      write("far.toml",
            "[environment]\ngenerator = 'box'\ncells = [24, 12, 12]\nblocked_share = 0.02\n[[particles]]\ncount = "
            "3000\nvelocity = [90.0, 31.0, 17.0]\n[motion]\ndt = 0.1\nsteps = 2000\n[contact]\nrestitution = 1.0\n"
            "[output]\nevery = 1000\ncontacts = true\n");
  expect_same_runs(path.string(), test::scaled(30, 1000), {"particles", "cells"}, {"stats.csv", "contacts.csv"});
  EXPECT_GT(number_of("one", "mean"), 100U);  // tests in a step: 17 in each cell
}

// 10^6 particle-steps a run, on 3 ranks. In the full tier 10^8, on 1 to 4: ten times the particles, ten times the steps.
class MpiMillions : public Mpi {
 protected:
  const std::uint64_t particles = test::scaled(10'000, 100'000);
  const std::uint64_t steps = test::scaled(105, 1'050);
  const std::vector<unsigned> ranks = test::full_tier() ? std::vector<unsigned>{1, 2, 3, 4} : std::vector<unsigned>{3};

  static void replace(std::string& text, const std::string& what, const std::string& by) {
    ASSERT_NE(text.find(what), std::string::npos) << what;
    text.replace(text.find(what), what.size(), by);
  }
  void compare(const std::string& text, const std::vector<std::string>& files) const {
    expect_same_runs(write("millions.toml", text), steps, {"particles", "cells"}, files, ranks);
    EXPECT_GE(number_of("one", "particle_steps"), steps * particles * 96 / 100);
    EXPECT_GE(number_of("one", "total"), particles / 10);  // contacts
    fs::remove_all(folder / "one");
  }
};

TEST_F(MpiMillions, InAVesselWithInletAndOutlets) {
  std::string text = content(fs::path(scenes_folder) / "vessel.toml");
  replace(text, "every = 20", "every = 1000\ncontacts = true");
  replace(text, "count = 10000", "count = " + std::to_string(particles));
  replace(text, "rate = 21000.0", "rate = " + std::to_string(particles * 21 / 10) + ".0");
  compare(text, {"stats.csv", "contacts.csv"});
}

TEST_F(MpiMillions, InBarsAtRestAndDeforming) {
  for (const char* name : {"bar_static.toml", "bar_deforming.toml"}) {
    std::string text = content(fs::path(scenes_folder) / name);
    replace(text, "every = 10", "every = 1000\ncontacts = true");
    replace(text, "count = 1000", "count = " + std::to_string(particles));
    compare(text, {"stats.csv", "contacts.csv"});
  }
}

// Walls that move give particles speed: without losses their steps pass many cells.
TEST_F(MpiMillions, AmongPolyhedraThatTwist) {
  const auto scene = [&](const char* restitution) {
    return "[environment]\ngenerator = 'octahedra'\ncells = [8, 8, 8]\n[[deformation]]\nkind = 'twist'\namplitude = "
           "0.3\n"
           "length = 8.0\nperiod = 2.0\n[[particles]]\nvelocity = [3.0, 1.5, 0.5]\ncount = " +
           std::to_string(particles) + "\n[motion]\ndt = 0.02\nsteps = 2000\n[contact]\nrestitution = " + restitution +
           "\n[output]\nevery = 1000\ncontacts = true\n";
  };
  compare(scene("0.5"), {"stats.csv", "contacts.csv"});
  compare(scene("1.0"), {"stats.csv", "contacts.csv"});
}

// Slides along walls that several parts share. Each particle has a contact in each step: all in one file would be 18 GB.
TEST_F(MpiMillions, AlongWallsThatPartsShare) {
  compare("[environment]\ngenerator = 'box'\ncells = [8, 8, 8]\n[[particles]]\nvelocity = [1.0, 0.5, 0.0]\ncount = " +
              std::to_string(particles) +
              "\n[motion]\ndt = 0.02\nsteps = 2000\ngravity = [0.2, 0.1, -3.0]\n[contact]\nresponse = 'slide'\n"
              "[output]\nevery = 1000\n",
          {"stats.csv"});
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
