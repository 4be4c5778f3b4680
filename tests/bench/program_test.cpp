// The program dartcast-bench as its users see it.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "support/command.hpp"

namespace dartcast::bench::program_test {

namespace fs = std::filesystem;

using test::Result;

class BenchProgram : public test::CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    command = binary;
    binary = fs::path(command).replace_filename("dartcast-bench").string();
  }
  void expect_wrong_usage(const std::string& arguments, const std::string& part) const {
    const Result r = run(arguments);
    EXPECT_EQ(r.status, 2) << arguments << "\n" << r.error;
    EXPECT_EQ(r.error.rfind("dartcast-bench: ", 0), 0U) << r.error;
    EXPECT_NE(r.error.find(part), std::string::npos) << arguments << "\n" << r.error;
  }

  std::string command;
};

// A run against itself: both sides end in the same state.
TEST_F(BenchProgram, RunTakesTheTimeOfEachPart) {
  const Result r = run("--run --steps 5 --repeat 1 -j 1 --json --against '" + command + "'");
  ASSERT_EQ(r.status, 0) << r.error;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json, nlohmann::json::parse(content(folder / "bench-out/run.json")));
  EXPECT_EQ(json["steps"], 5);
  EXPECT_EQ(json["threads"], 1);
  for (const char* kind : {"with_output", "without_output"}) {
    for (const char* part : {"load", "locate", "deform", "detect", "respond", "write", "other"}) {
      EXPECT_TRUE(json[kind]["own"]["parts"].contains(part)) << kind << " " << part;
      EXPECT_TRUE(json[kind]["against"]["parts"].contains(part)) << kind << " " << part;
    }
    EXPECT_GT(json[kind]["own"]["wall"], json[kind]["own"]["parts"]["detect"]);
    EXPECT_EQ(json[kind]["own"]["state_hash"], json["with_output"]["against"]["state_hash"]);
  }
  EXPECT_EQ(content(folder / "bench-out/run.svg").rfind("<svg ", 0), 0U);
  EXPECT_EQ(content(folder / "bench-out/vessel.toml"), content(fs::path(scenes_folder) / "vessel.toml"));
  EXPECT_TRUE(fs::exists(folder / "bench-out/run/own/particles_000000.vtp"));
  EXPECT_FALSE(fs::exists(folder / "bench-out/run_without_output/own/particles_000000.vtp"));
  expect_wrong_usage("box.toml", "--run");
  expect_wrong_usage("--run --against nowhere", "nowhere");
}

TEST_F(BenchProgram, LatencySaysWhetherBoundsWereKept) {
  const Result r = run("--latency --steps 20 -o lat");
  ASSERT_EQ(r.status, 0) << r.error;
  for (const char* word : {"median", "99.9%", "longest", "other steps", "steps with cuts", "bounds: "})
    EXPECT_NE(r.out.find(word), std::string::npos) << r.out;
  EXPECT_EQ(nlohmann::json::parse(content(folder / "lat/latency.json"))["steps"]["count"], 20);
  EXPECT_EQ(content(folder / "lat/latency.svg").rfind("<svg ", 0), 0U);
}

TEST_F(BenchProgram, NumbersHaveLimits) {
  expect_wrong_usage("--steps 0", "--steps: '0' is no whole number from 1 to 1000000");
  expect_wrong_usage("--spheres --most 18446744073709551615", "from 1000 to 100000000");
  expect_wrong_usage("--spheres --most -1", "from 1000 to 100000000");
}

TEST_F(BenchProgram, ItsPageHasItsHelp) {
  const std::string page = content(fs::path(scenes_folder).parent_path() / "docs/benchmark.md");
  std::string help = run("--help").out;
  help.erase(help.find_last_not_of('\n') + 1);
  EXPECT_NE(page.find(help), std::string::npos) << help;
}

}  // namespace dartcast::bench::program_test
