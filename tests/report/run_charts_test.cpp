// The charts of a run, from tables in its folder.
#include "report/run_charts.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace dartcast::run_charts_test {

namespace fs = std::filesystem;

class RunCharts : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "run_charts";
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write("stats.csv", "step,time\n1,0.1\n2,0.2\n3,0.3\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  [[nodiscard]] bool shows(const std::string& text) const {
    return run_charts(folder_).find(text) != std::string::npos;
  }

  fs::path folder_;
};

// A table has a row for each step and solid: the chart has their sums.
TEST_F(RunCharts, ContactsOfSolids) {
  const std::string title = "Contacts of bodies, catheters and solids";
  EXPECT_FALSE(shows(title));
  write("bodies.csv", "step,time,name,contacts\n1,0.1,a,0\n1,0.1,b,0\n2,0.2,a,0\n");
  EXPECT_FALSE(shows(title));
  write("bodies.csv", "step,time,name,contacts\n1,0.1,a,2\n1,0.1,b,3\n2,0.2,a,40\n3,0.3,a,0\n");
  EXPECT_TRUE(shows(title));
  write("catheters.csv", "step,time,name,contacts,at_walls\n1,0.1,left,999,7\n");
  const std::string all = run_charts(folder_);
  EXPECT_NE(all.find(">catheters<"), std::string::npos) << all;
  EXPECT_EQ(all.find(">solids<"), std::string::npos);
}

// A row that a crash cut off is no reason for a run without charts.
TEST_F(RunCharts, RowsThatAreCutOff) {
  write("solids.csv", "step,time,name,contacts\n1,0.1,a,2\n2,0.2,a,5\n3,0.3");
  EXPECT_TRUE(shows("Contacts of bodies, catheters and solids"));
}

TEST_F(RunCharts, ResidenceTimes) {
  EXPECT_FALSE(shows("Washout"));
  write("summary.json", R"({"statistics": {"residence_time": {"escaped": {"out": {"count": 4, "mean": 0.3, "bin": 0.2,
    "histogram": [0, 3, 1, 0]}, "none": {"count": 0}}, "absorbed": {"wall": {"count": 2, "bin": 0.1, "histogram": [2]}}}}})");
  const std::string all = run_charts(folder_);
  EXPECT_NE(all.find("Residence times"), std::string::npos) << all;
  EXPECT_NE(all.find("Washout"), std::string::npos);
  EXPECT_NE(all.find(">escaped at out<"), std::string::npos) << all;
  EXPECT_NE(all.find(">absorbed at wall<"), std::string::npos);
  EXPECT_EQ(all.find(">escaped at none<"), std::string::npos);
}

}  // namespace dartcast::run_charts_test
