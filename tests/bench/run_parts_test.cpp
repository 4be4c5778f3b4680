// The verbs bench --run and bench --latency: how times are read, put in relation, and written.
#include "bench/run_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/latency.hpp"
#include "dartcast/error.hpp"

namespace dartcast::bench::run_parts_test {

std::string summary(const std::string& version, double detect, double write) {
  return nlohmann::json({{"version", version},
                         {"scene", "vessel"},
                         {"threads", 2},
                         {"steps", 10},
                         {"state_hash", "ab"},
                         {"seconds", {{"detect", detect}, {"write", write}}}})
      .dump();
}

RunPairs three_pairs() {
  RunPairs pairs;
  const double own[] = {1.0, 2.0, 4.0};
  const double other[] = {3.0, 4.0, 40.0};
  for (int i = 0; i < 3; ++i) {
    pairs.own.push_back(read_sample(summary("2", own[i], 0.5), own[i] + 0.75, 9.0));
    pairs.other.push_back(read_sample(summary("1", other[i], 0.0), other[i] + 1.0, 9.0));
  }
  return pairs;
}

TEST(RunParts, TheRestOfTheWallTimeIsOther) {
  const RunSample sample = read_sample(summary("2", 1.5, 0.5), 2.25, 3.0);
  EXPECT_EQ(sample.version, "2");
  EXPECT_EQ(sample.steps, 10U);
  EXPECT_EQ(sample.seconds("detect"), 1.5);
  EXPECT_EQ(sample.seconds("other"), 0.25);
  EXPECT_EQ(sample.seconds("wall"), 2.25);
  EXPECT_EQ(sample.seconds("processor"), 3.0);
  EXPECT_EQ(sample.seconds("deform"), 0.0);
  EXPECT_EQ(read_sample(summary("2", 1.5, 0.5), 1.0, 3.0).seconds("other"), 0.0);  // parts that overlap
  EXPECT_THROW((void)read_sample("no summary", 1.0, 1.0), Error);
  EXPECT_THROW((void)read_sample("{}", 1.0, 1.0), Error);
}

// The ratios of the pairs are 3, 2 and 10; that of the medians is 2.
TEST(RunParts, RatiosAreMediansOverPairs) {
  const RunPairs pairs = three_pairs();
  EXPECT_EQ(median_seconds(pairs.own, "detect"), 2.0);
  EXPECT_EQ(median_ratio(pairs, "detect").value_or(0.0), 3.0);
  EXPECT_FALSE(median_ratio(pairs, "write").has_value());
  RunPairs alone = pairs;
  alone.other.clear();
  EXPECT_FALSE(median_ratio(alone, "detect").has_value());
}

TEST(RunParts, ReportsNameEveryPart) {
  const std::vector<RunPairs> runs = {three_pairs()};
  const auto json = nlohmann::json::parse(runs_json(runs));
  EXPECT_EQ(json["with_output"]["own"]["parts"]["detect"], 2.0);
  EXPECT_EQ(json["with_output"]["against"]["version"], "1");
  EXPECT_EQ(json["with_output"]["ratio"]["detect"], 3.0);
  const std::string text = runs_text(runs);
  const std::string drawing = runs_svg(runs);
  for (const std::string part : {"detect", "write", "other"}) {
    EXPECT_NE(text.find("\n" + part), std::string::npos) << text;
    EXPECT_NE(drawing.find(">" + part + "<"), std::string::npos) << drawing;
  }
  EXPECT_NE(text.find("\ndetect          2.000     73%       4.000    3.00\n"), std::string::npos) << text;
}

TEST(RunParts, ASceneGetsAnotherOutputTable) {
  EXPECT_EQ(with_output_table("seed = 1\n[output]  # as ever\nevery = 20\n[motion]\ndt = 1\n", "every = 0"),
            "seed = 1\n[motion]\ndt = 1\n[output]\nevery = 0\n");
  EXPECT_EQ(with_output_table("seed = 1\n", "every = 0"), "seed = 1\n[output]\nevery = 0\n");
}

TEST(Latency, QuantilesAndBoundsAreOfStepsOfOneKind) {
  Latency latency;
  for (int i = 1; i <= 1000; ++i) latency.steps.push_back({i * 1e-3, false});
  latency.steps.push_back({9.0, true});
  EXPECT_EQ(latency.quantile(false, 0.5), 0.5);
  EXPECT_EQ(latency.quantile(false, 0.999), 0.999);
  EXPECT_EQ(latency.quantile(false, 1.0), 1.0);
  EXPECT_EQ(latency.quantile(true, 0.5), 9.0);
  EXPECT_EQ(latency.longest_step(false), 1000U);
  EXPECT_EQ(latency.longest_step(true), 1001U);
  EXPECT_TRUE(latency.kept());
  latency.steps.push_back({10.5, true});
  EXPECT_EQ(latency.over_bound(true), 1U);
  latency.steps.push_back({5.5, false});
  EXPECT_EQ(latency.over_bound(false), 1U);
  EXPECT_FALSE(latency.kept());
  EXPECT_NE(latency_text(latency).find("bounds: not kept"), std::string::npos);
  EXPECT_EQ(Latency().quantile(true, 0.5), 0.0);
}

TEST(Latency, CutsAreStepsOfTheirOwn) {
  LatencyOptions options;
  options.steps = 25;
  options.cut_every = 10;
  const Latency latency = measure_latency(options);
  EXPECT_EQ(latency.steps.size(), 25U);
  EXPECT_EQ(latency.count(true), 2U);
  EXPECT_TRUE(latency.steps[9].cut && latency.steps[19].cut);
  EXPECT_GT(latency.cells_replaced, 10U);
  EXPECT_NEAR(static_cast<double>(latency.particles), 1000.0, 100.0);
  EXPECT_GT(latency.quantile(true, 0.5), latency.quantile(false, 0.5));
  const auto json = nlohmann::json::parse(latency_json(latency));
  EXPECT_EQ(json["cuts"]["count"], 2);
  EXPECT_EQ(json["cuts"]["ms"].size(), 2U);
  EXPECT_EQ(json["kept"], latency.kept());
  EXPECT_EQ(latency_svg(latency).rfind("<svg ", 0), 0U);
}

}  // namespace dartcast::bench::run_parts_test
