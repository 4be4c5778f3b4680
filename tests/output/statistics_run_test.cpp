// Runs with statistics: their tables and series, the same for any number of threads and after a resume.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"
#include "support/run_scenes.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::statistics_run_test {

namespace fs = std::filesystem;
using test::plug_flow_text;
using test::statistics_text;

struct CutOff : std::exception {};

std::vector<std::vector<std::string>> rows_of(const fs::path& table) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream text(read_bytes(table));
  for (std::string line; std::getline(text, line);) {
    rows.emplace_back();
    std::istringstream fields(line + ",");
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

class StatisticsRun : public testing::Test {
 protected:
  static Summary run(const std::string& text, const fs::path& to, unsigned threads = 1, bool resume = false,
                     std::optional<std::uint64_t> steps = {}, std::uint64_t cut = 0) {
    RunOptions options;
    options.folder = to;
    options.resume = resume;
    options.steps = steps;
    options.threads = Threads{threads};
    return run_scene(parse_scene(text, "test.toml"), options, [&](std::uint64_t done, std::uint64_t) {
      if (done == cut) throw CutOff();
      return true;
    });
  }

  static std::map<std::string, std::string> files(const fs::path& of) {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::directory_iterator(of)) {
      const std::string name = entry.path().filename();
      if (name != "summary.json" && name != "checkpoint.bin" && name != "report.html")
        result[name] = read_bytes(entry.path());
    }
    return result;
  }

  void expect_same_files() const {
    const auto expected = files(one);
    const auto found = files(two);
    for (const auto& [name, content] : expected) {
      ASSERT_TRUE(found.contains(name)) << name;
      EXPECT_TRUE(found.at(name) == content) << name;
    }
    EXPECT_EQ(found.size(), expected.size());
  }

  static nlohmann::json statistics_of(const fs::path& folder) {
    return nlohmann::json::parse(read_bytes(folder / "summary.json")).at("statistics");
  }

  test::Folder temporary;
  fs::path one = temporary / "one";
  fs::path two = temporary / "two";
};

// 4 m at 2 m/s take 2 s, less the way that an inlet saves: at most 1/64 m.
TEST_F(StatisticsRun, APlugFlowHasTheFluxOfItsInlet) {
  const Summary summary = run(plug_flow_text, one);
  const auto rows = rows_of(one / "planes.csv");
  ASSERT_EQ(rows.size(), 1U + 7 * 2);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"step", "time", "name", "forward", "backward", "flux", "mean_age"}));
  std::uint64_t forward = 0;
  std::uint64_t backward = 0;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const bool middle = rows[r][2] == "middle";
    const double begin = static_cast<double>((r - 1) / 2);
    const double end = std::stod(rows[r][1]);
    EXPECT_NEAR(end, std::min(begin + 1.0, 6.55), 1e-9);
    (middle ? forward : backward) += std::stoull(rows[r][middle ? 3 : 4]);
    EXPECT_EQ(rows[r][middle ? 4 : 3], "0");
    const double expected = std::clamp(end - 2.0, 0.0, end - begin) * 100.0 / (end - begin);
    if (middle) {
      EXPECT_NEAR(std::stod(rows[r][5]), expected, 3.0) << r;
      EXPECT_EQ(rows[r].at(6).empty(), rows[r][3] == "0");
      if (!rows[r][6].empty()) EXPECT_NEAR(std::stod(rows[r][6]), 2.0, 1.0 / 128 + 1e-9);
    }
  }
  const nlohmann::json s = statistics_of(one);
  EXPECT_EQ(s.at("planes").at(0).at("name"), "middle");
  EXPECT_EQ(s.at("planes").at(0).at("forward"), forward);
  EXPECT_EQ(s.at("planes").at(1).at("backward"), backward);
  EXPECT_NEAR(s.at("planes").at(0).at("residence_time").at("mean").get<double>(), 2.0, 1.0 / 128 + 1e-9);
  EXPECT_NEAR(s.at("planes").at(0).at("flux").get<double>(), static_cast<double>(forward) / 6.55, 1e-9);
  EXPECT_EQ(s.at("residence_time").at("escaped").at("xmax").at("count"), summary.totals.escaped);
  EXPECT_EQ(s.at("residence_time").at("escaped").size(), 1U);
  EXPECT_TRUE(s.at("residence_time").at("absorbed").empty());
  EXPECT_EQ(s.at("hits").at("total"), summary.totals.escaped);
  EXPECT_EQ(s.at("hits").at("by_patch").at("xmax"), summary.totals.escaped);
  EXPECT_EQ(s.at("hits").at("ended"), 0);
  const auto crossings = rows_of(one / "crossings.csv");
  EXPECT_EQ(crossings.size(), 1 + forward + backward);
  EXPECT_NE(summary_text(summary).find("planes       middle: "), std::string::npos);
  EXPECT_NE(summary_text(summary).find("escaped at xmax: "), std::string::npos);
  Summary loaded_machine = summary;  // clocks around nothing take time there
  loaded_machine.seconds_solids = 0.01;
  EXPECT_EQ(summary_text(loaded_machine).find("solids"), std::string::npos);
  for (const char* name : {"walls.pvd", "walls_000000.vtp", "walls_000655.vtp", "pathlines.vtp", "pathlines.bin"})
    EXPECT_TRUE(fs::exists(one / name)) << name;
}

// Times in cells and ages are counted apart. Those who are there at the end have no age in the summary.
TEST_F(StatisticsRun, TimesInCellsAreAges) {
  std::string text = plug_flow_text;
  text.replace(text.find("2.0, 0.0, 0.0]"), 8, "2.0, 0.3");
  text += "[contact.patch.ymax]\nresponse = \"absorb\"\n";
  const Summary summary = run(text, one);
  double ages = summary.statistics->absorbed_by_edits.sum;
  std::uint64_t left = 0;
  for (const LeaveTotals& l : summary.statistics->left) {
    ages += l.escaped.sum + l.absorbed.sum;
    left += l.escaped.count + l.absorbed.count;
  }
  const auto rows = rows_of(one / "cells.csv");
  ASSERT_EQ(rows.front(), (std::vector<std::string>{"cell", "x", "y", "z", "track_length", "residence", "visits",
                                                    "deposition", "concentration"}));
  double times = 0.0;
  double deposited = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    times += std::stod(rows[i][5]);
    deposited += std::stod(rows[i][7]);
  }
  EXPECT_EQ(deposited, static_cast<double>(summary.totals.absorbed));
  EXPECT_GT(left, 0U);
  EXPECT_LE(ages, times * (1.0 + 1e-9));
  EXPECT_LE(times - ages, static_cast<double>(summary.alive) * summary.statistics->time);
}

TEST_F(StatisticsRun, TheFilesAreTheSameForAnyThreads) {
  run(statistics_text, one, 1);
  run(statistics_text, two, 3);
  expect_same_files();
}

TEST_F(StatisticsRun, ARunCutOffAnywhereEndsAsIfItWereNot) {
  run(statistics_text, one);
  const nlohmann::json whole = statistics_of(one);
  EXPECT_GT(whole.at("hits").at("ended"), 0);
  EXPECT_GT(whole.at("residence_time").at("absorbed_by_edits").at("count"), 0);
  EXPECT_GT(whole.at("planes").at(0).at("backward"), 0);
  for (const std::uint64_t cut : {4U, 17U, 31U, 46U}) {
    EXPECT_THROW(run(statistics_text, two, 1, false, {}, cut), CutOff);
    // Rows behind those that the checkpoint counts on.
    for (const char* name : {"planes.csv", "crossings.csv", "pathlines.bin"}) append_bytes(two / name, "more\n");
    run(statistics_text, two, 2, true);
    expect_same_files();
    EXPECT_EQ(statistics_of(two), whole);
  }
}

TEST_F(StatisticsRun, ResidenceTimesOfBothEndsGoOn) {
  std::string text = plug_flow_text;
  text.replace(text.find("2.0, 0.0, 0.0]"), 8, "2.0, 0.3");
  text += "[contact.patch.ymax]\nresponse = \"absorb\"\n";
  run(text, one);
  const nlohmann::json whole = statistics_of(one);
  EXPECT_GT(whole.at("residence_time").at("absorbed").at("ymax").at("count"), 0);
  EXPECT_GT(whole.at("residence_time").at("escaped").at("xmax").at("count"), 0);
  EXPECT_THROW(run(text, two, 1, false, {}, 633), CutOff);
  run(text, two, 2, true);
  expect_same_files();
  EXPECT_EQ(statistics_of(two), whole);
}

// Two flows that cross, 4 s from xmin to xmax, and 2 s from ymin to ymax.
TEST_F(StatisticsRun, ResidenceTimesByInletAndOutlet) {
  const std::string text = R"(
[environment]
generator = "box"
cells = [8, 2, 2]
[[particles]]
inlet = "xmin"
rate = 100.0
velocity = [2.0, 0.0, 0.0]
[[particles]]
inlet = "ymin"
rate = 50.0
velocity = [0.0, 1.0, 0.0]
[motion]
dt = 0.01
steps = 600
[contact]
response = "escape"
[statistics]
residence = true
classes = { of = "group" }
cells = { quantities = ["residence", "momentum"], every = 200 }
)";
  run(text, one);
  const nlohmann::json all = statistics_of(one).at("residence_time");
  ASSERT_EQ(all.at("by_class").size(), 2U);
  EXPECT_EQ(all.at("by_class").at(0).at("escaped").at("xmax"), all.at("escaped").at("xmax"));
  EXPECT_EQ(all.at("by_class").at(1).at("escaped").at("ymax"), all.at("escaped").at("ymax"));
  EXPECT_EQ(all.at("by_class").at(1).at("escaped").size(), 1U);
  EXPECT_NEAR(all.at("escaped").at("ymax").at("mean").get<double>(), 2.0, 0.02);
  const auto rows = rows_of(one / "residence.csv");
  EXPECT_EQ(rows[0], (std::vector<std::string>{"left", "patch", "class", "time", "count", "density", "washout"}));
  double share = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i][1] != "xmax" || rows[i][2] != "0") continue;
    EXPECT_EQ(std::stod(rows[i][6]) == 1.0, share == 0.0);
    share += std::stod(rows[i][5]) * 0.08;
    EXPECT_EQ(std::stod(rows[i][4]) > 0.0, std::abs(std::stod(rows[i][3]) - 3.98) < 0.081);
  }
  EXPECT_NEAR(share, 1.0, 1e-12);
  const auto cells = rows_of(one / "cells.csv");
  EXPECT_EQ(cells[0], (std::vector<std::string>{"cell", "x", "y", "z", "residence", "momentum_x", "momentum_y",
                                                "momentum_z", "residence_group_0", "momentum_group_0_x",
                                                "momentum_group_0_y", "momentum_group_0_z", "residence_group_1",
                                                "momentum_group_1_x", "momentum_group_1_y", "momentum_group_1_z"}));
  double times = 0.0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    times += std::stod(cells[i][12]);
    EXPECT_NEAR(std::stod(cells[i][4]), std::stod(cells[i][8]) + std::stod(cells[i][12]), 1e-12);
  }
  EXPECT_NEAR(times, 2.0 * 50.0 * 2.0, 2.0);  // the last two seconds; 100 particles
  EXPECT_THROW(run(text, two, 1, false, {}, 433), CutOff);
  run(text, two, 2, true);
  expect_same_files();
}

// The rows of a last, shorter interval and the pathlines are taken back.
TEST_F(StatisticsRun, AFinishedRunGoesOnToMoreSteps) {
  run(statistics_text, one);
  run(statistics_text, two, 1, false, 25);
  EXPECT_EQ(rows_of(two / "planes.csv").size(), 1U + 3);
  run(statistics_text, two, 1, true, 47);
  expect_same_files();
  EXPECT_EQ(statistics_of(two), statistics_of(one));
  run(statistics_text, two, 1, true, 47);  // nothing left to do
  expect_same_files();
}

TEST_F(StatisticsRun, WithoutTheTableNothingIsWritten) {
  const std::string text = plug_flow_text.substr(0, plug_flow_text.find("[statistics]")) + "[output]\nevery = 100\n";
  run(plug_flow_text, one);
  const Summary with = run(plug_flow_text, two);
  const Summary without = run(text, two);  // removes the earlier run's files
  EXPECT_EQ(with.state_hash, without.state_hash);
  for (const auto& [name, content] : files(two)) {
    for (const char* part : {"walls", "planes", "crossings", "pathlines"})
      EXPECT_EQ(name.find(part), std::string::npos) << name;
  }
  EXPECT_FALSE(nlohmann::json::parse(read_bytes(two / "summary.json")).contains("statistics"));
}

}  // namespace dartcast::statistics_run_test
