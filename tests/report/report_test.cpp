// Reports of runs: their data against the simulation and contacts.csv, resumed runs, hostile recordings, limits.
#include "dartcast/report.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/file_write.hpp"
#include "report/chart.hpp"
#include "report/encode.hpp"
#include "report/page_reader.hpp"

namespace dartcast::report_test {

namespace fs = std::filesystem;
using test::PageReader;

// Particles come in and leave, walls move, a cut opens cells.
const std::string busy = R"(
[environment]
generator = "box"
type = "tetrahedron"
cells = [6, 4, 4]
blocked_layer = true
[[deformation]]
kind = "twist"
amplitude = 0.3
axis = [1.0, 0.0, 0.0]
centre = [3.0, 2.0, 2.0]
length = 6.0
period = 0.7
[[particles]]
count = 120
velocity = [3.0, 0.5, -0.5]
[[particles]]
count = 9
radius = 0.05
velocity = [1.0, 1.5, 0.5]
[motion]
dt = 0.02
steps = 40
[[event]]
at = 0.3
kind = "cut"
surface = "disc"
point = [3.0, 2.0, 1.0]
normal = [1.0, 0.0, 0.0]
radius = 1.2
width = 0.4
[contact]
response = "reflect"
[statistics]
hits = true
[output]
every = 4
contacts = true
)";

// Particles come through a wall all the time.
const std::string injecting = R"(
[environment]
generator = "box"
cells = [4, 4, 4]
[[particles]]
count = 7
velocity = [0.1, 0.0, 0.0]
[[particles]]
inlet = "xmin"
rate = 60.0
velocity = [1.0, 0.1, 0.0]
[motion]
dt = 0.05
steps = 40
[output]
every = 4
)";

// More patches than a byte can number.
const std::string many_patches = R"(
[environment]
generator = "maze"
rooms = [12, 12]
patches = { angle = 30 }
[[particles]]
count = 400
velocity = [2.0, 1.3, 0.0]
[motion]
dt = 0.1
steps = 20
[contact]
response = "reflect"
[output]
every = 10
contacts = true
)";

class Report : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("dartcast_report_" + std::to_string(::getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  Summary run(const std::string& text, const std::string& name, RunOptions options = {},
              const Progress& progress = {}) const {
    options.folder = folder / name;
    return run_scene(parse_scene(text, "scene.toml"), options, progress);
  }
  [[nodiscard]] PageReader page(const std::string& name) const { return PageReader(report_file(folder / name)); }

  fs::path folder;
};

std::string without(std::string text, const std::string& part) {
  text.erase(text.find(part), part.size());
  return text;
}

// Each frame against a simulation of the same scene that takes the same steps.
TEST_F(Report, ParticlesAreWhereTheSimulationHasThem) {
  run(busy, "a");
  const PageReader report = page("a");
  Simulation simulation(load_scene_files(parse_scene(busy, "scene.toml")).scene);
  const auto count = report.meta["particles"]["count"].get<std::size_t>();
  ASSERT_EQ(count, 129U);
  const auto ids = report.block<std::uint32_t>(report.meta["particles"]["id"]);
  const auto first = report.block<std::uint16_t>(report.meta["particles"]["first"]);
  const auto last = report.block<std::uint16_t>(report.meta["particles"]["last"]);
  const auto radii = report.block<float>(report.meta["particles"]["radius"]);
  const auto positions = report.series<std::uint16_t>(report.meta["particles"]["position"], 3 * count);
  const auto speeds = report.series<std::uint8_t>(report.meta["particles"]["speed"], count);
  const double fastest = report.meta["particles"]["speed"]["max"];
  ASSERT_EQ(report.meta["frames"].size(), 11U);
  for (std::size_t k = 0; k < 11; ++k) {
    while (simulation.steps() < report.meta["frames"][k]["step"]) simulation.step();
    EXPECT_NEAR(report.meta["frames"][k]["time"].get<double>(), simulation.time(), 1e-12);
    std::size_t alive = 0;
    for (std::size_t slot = 0; slot < count; ++slot) alive += first[slot] <= k && k <= last[slot] ? 1 : 0;
    EXPECT_EQ(alive, simulation.particles().size());
    for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
      const auto slot =
          static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), simulation.ids()[i]) - ids.begin());
      ASSERT_EQ(ids[slot], simulation.ids()[i]);
      const auto x = report.position(&positions[3 * (k * count + slot)]);
      const Vec3 truth = simulation.particles()[i].position;
      EXPECT_NEAR(x[0], truth.x, report.tolerance());
      EXPECT_NEAR(x[1], truth.y, report.tolerance());
      EXPECT_NEAR(x[2], truth.z, report.tolerance());
      EXPECT_NEAR(speeds[k * count + slot] / 255.0 * fastest, norm(simulation.velocities()[i]), fastest * 0.51 / 255.0);
      EXPECT_FLOAT_EQ(radii[slot], static_cast<float>(simulation.radii()[i]));
    }
  }
}

// Frames are four steps apart, and particles come at each: the time in the scene counts from the step of their coming.
TEST_F(Report, KnowsWhenEachParticleCame) {
  run(injecting, "a");
  run(injecting, "b", {}, [](std::uint64_t done, std::uint64_t) { return done < 18; });
  RunOptions rest;
  rest.resume = true;
  run(injecting, "b", rest);
  Simulation simulation(load_scene_files(parse_scene(injecting, "scene.toml")).scene);
  std::map<std::uint64_t, double> came;
  for (const std::uint64_t id : simulation.ids()) came[id] = 0.0;
  while (simulation.steps() < 40) {
    const double before = simulation.time();
    simulation.step();
    for (const std::uint64_t id : simulation.ids()) came.try_emplace(id, before);
  }
  for (const char* name : {"a", "b"}) {
    const PageReader report = page(name);
    const auto ids = report.block<std::uint32_t>(report.meta["particles"]["id"]);
    const auto start = report.block<float>(report.meta["particles"]["start"]);
    std::size_t between = 0;
    for (std::size_t slot = 0; slot < ids.size(); ++slot) {
      EXPECT_FLOAT_EQ(start[slot], static_cast<float>(came.at(ids[slot]))) << name << ", particle " << ids[slot];
      const double in_frames = came.at(ids[slot]) / report.meta["frames"][1]["time"].get<double>();
      between += std::abs(in_frames - std::round(in_frames)) > 0.1 ? 1 : 0;
    }
    EXPECT_GT(between, 10U);
  }
}

struct Row {
  double time;
  std::string kind;
  std::string patch;
  std::array<double, 3> x;
};

std::map<std::uint64_t, std::vector<Row>> contacts_of(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::map<std::uint64_t, std::vector<Row>> by_id;
  while (std::getline(file, line)) {
    std::stringstream in(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    by_id[std::stoull(cells[2])].push_back(
        {std::stod(cells[1]), cells[3], cells[4], {std::stod(cells[6]), std::stod(cells[7]), std::stod(cells[8])}});
  }
  return by_id;
}

// The largest number that a contact has for its patch.
std::uint16_t expect_contacts_of_the_table(const Summary& summary, const PageReader& report, const fs::path& table) {
  const auto truth = contacts_of(table);
  const auto ids = report.block<std::uint32_t>(report.meta["particles"]["id"]);
  const auto offset = report.block<std::uint32_t>(report.meta["contacts"]["offset"]);
  const auto time = report.block<float>(report.meta["contacts"]["time"]);
  const auto patch = report.block<std::uint16_t>(report.meta["contacts"]["patch"]);
  const auto kind = report.block<std::uint8_t>(report.meta["contacts"]["kind"]);
  const auto point = report.block<std::uint16_t>(report.meta["contacts"]["point"]);
  const std::vector<std::string> kinds = {"vertex", "edge", "face"};
  const auto& counted = summary.totals.counters.contacts;
  EXPECT_EQ(time.size(), counted[0] + counted[1] + counted[2]);
  EXPECT_EQ(offset.back(), time.size());
  EXPECT_GT(time.size(), 100U);
  for (std::size_t slot = 0; slot < ids.size(); ++slot) {
    const auto found = truth.find(ids[slot]);
    const std::size_t n = found == truth.end() ? 0 : found->second.size();
    EXPECT_EQ(offset[slot + 1] - offset[slot], n);
    for (std::size_t i = 0; i < std::min<std::size_t>(n, offset[slot + 1] - offset[slot]); ++i) {
      const Row& row = found->second[i];
      const std::size_t at = offset[slot] + i;
      EXPECT_NEAR(time[at], row.time, 1e-6);
      EXPECT_EQ(kinds[kind[at]], row.kind);
      EXPECT_EQ(report.meta["patches"][patch[at] - 1U], row.patch);
      const auto x = report.position(&point[3 * at]);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(x[k], row.x[k], report.tolerance());
    }
  }
  return *std::max_element(patch.begin(), patch.end());
}

TEST_F(Report, ContactsAreThoseOfTheTable) {
  for (const std::string& scene : {busy, many_patches}) {
    const std::string name = scene == busy ? "a" : "b";
    const Summary summary = run(scene, name);
    const auto largest = expect_contacts_of_the_table(summary, page(name), folder / name / "contacts.csv");
    EXPECT_EQ(largest > 256, scene == many_patches);
  }
}

// Walls after the last edit: their points, patches and hits.
TEST_F(Report, WallsAreThoseOfTheSimulation) {
  run(busy, "a");
  const PageReader report = page("a");
  Simulation simulation(load_scene_files(parse_scene(busy, "scene.toml")).scene);
  while (simulation.steps() < 40) simulation.step();
  ASSERT_EQ(report.meta["walls"].size(), 2U);
  EXPECT_EQ(report.meta["walls"][1]["first"], 4);  // the cut comes at 0.3 s, the next frame is that of step 16
  ASSERT_EQ(report.meta["events"].size(), 1U);
  EXPECT_EQ(report.meta["events"][0]["text"].get<std::string>().substr(0, 5), "cut: ");
  const nlohmann::json& walls = report.meta["walls"][1];
  const auto corners = report.block<std::uint32_t>(walls["corners"]);
  const auto patches = report.block<std::uint16_t>(walls["face_patch"]);
  const auto face = report.block<std::uint32_t>(walls["face"]);
  const auto polygons = walls["polygons"].get<std::size_t>();
  const auto hits = report.series<std::uint16_t>(walls["hits"], polygons);
  ASSERT_EQ(walls["hits"]["per"], 1);
  const auto points = walls["points"].get<std::size_t>();
  const auto positions = report.series<std::uint16_t>(walls["position"], 3 * points);
  const auto frames = positions.size() / (3 * points);
  ASSERT_EQ(frames, 11U - 4U);
  ASSERT_EQ(hits.size(), frames * polygons);
  for (std::size_t i = polygons; i < hits.size(); ++i) EXPECT_GE(hits[i], hits[i - polygons]);  // they grow
  const CombinatorialMap& map = simulation.environment().map();
  std::size_t triangle = 0;
  for (const Cell c : map.cells()) {
    const CellView view = map.view(c);
    for (std::uint16_t f = 0; view.is_free() && f < view.shape().face_count(); ++f) {
      if (!view.is_wall(f)) continue;
      const std::size_t n = view.shape().corners(f).size();
      for (std::size_t t = 2; t < n; ++t, ++triangle) {
        ASSERT_LT(triangle, patches.size());
        EXPECT_EQ(patches[triangle], map.patch({c, f}).value);
        EXPECT_EQ(hits[(frames - 1) * polygons + face[triangle]], simulation.statistics().hits.of({c, f}));
        const std::size_t fan[] = {0, t - 1, t};
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3& truth = simulation.environment().positions()[view.vertex(view.shape().corners(f)[fan[k]]).value];
          const auto x = report.position(&positions[3 * ((frames - 1) * points + corners[3 * triangle + k])]);
          EXPECT_NEAR(x[0], truth.x, report.tolerance());
          EXPECT_NEAR(x[1], truth.y, report.tolerance());
          EXPECT_NEAR(x[2], truth.z, report.tolerance());
        }
      }
    }
  }
  EXPECT_EQ(triangle, patches.size());
}

// Hits are counted by the report itself where the scene keeps none.
TEST_F(Report, ARunThatWasCutOffGivesTheSameReport) {
  const std::string text = without(busy, "[statistics]\nhits = true\n");
  run(text, "whole");
  for (const std::uint64_t at : {3U, 13U, 16U, 31U}) {
    const std::string name = "cut" + std::to_string(at);
    EXPECT_TRUE(run(text, name, {}, [&](std::uint64_t done, std::uint64_t) { return done < at; }).cancelled);
    EXPECT_TRUE(fs::exists(report_file(folder / name)));
    RunOptions resume;
    resume.resume = true;
    run(text, name, resume);
    const PageReader one = page("whole");
    const PageReader other = page(name);
    EXPECT_EQ(one.meta, other.meta) << at;
    for (std::size_t b = 0; one.text.find("id=\"b" + std::to_string(b) + "\"") != std::string::npos; ++b)
      EXPECT_EQ(one.block<std::uint8_t>(b), other.block<std::uint8_t>(b)) << at << ", block " << b;
  }
}

TEST_F(Report, HitsAreTheSameByEitherCount) {
  run(busy, "counted");
  run(without(busy, "[statistics]\nhits = true\n"), "own");
  const nlohmann::json counted = page("counted").meta["walls"].back()["hits"];
  EXPECT_EQ(counted, page("own").meta["walls"].back()["hits"]);
  EXPECT_GT(counted["max"], 0);
}

// The page opens after the last change of the scene, and says which way is down.
TEST_F(Report, OpensOnATellingFrame) {
  run(busy, "a");
  run(injecting, "b");
  const nlohmann::json changed = page("a").meta;
  const double cut = changed["events"][0]["time"];
  EXPECT_GE(changed["frames"][changed["opening"].get<std::size_t>()]["time"].get<double>(), cut);
  EXPECT_EQ(changed["gravity"], nlohmann::json({0.0, 0.0, 0.0}));
  // Particles come in all the time: the start shows seven of them.
  EXPECT_GT(page("b").meta["opening"], 0);
}

TEST_F(Report, SaysWhatCameOut) {
  const Summary summary = run(injecting, "a");
  const std::string text = page("a").text;
  const auto says = [&](const std::string& part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(says("7 particles, and " + std::to_string(summary.totals.injected) +
                   " that came in later, moved for 2 s (40 steps)"));
  EXPECT_TRUE(says("dartcast run scene.toml --steps 40"));
  EXPECT_TRUE(says("State hash " + summary.state_hash));
  EXPECT_TRUE(says("rate = 60.0"));  // the scene's text
  EXPECT_LT(text.find("What became of the particles"), text.find("<summary>Method"));
  EXPECT_GT(text.find("Orientation tests over time"), text.find("<summary>Method"));
}

TEST_F(Report, TheStateDoesNotDependOnIt) {
  const Summary with = run(busy, "a");
  const Summary none = run(busy + "report = false\n", "b");
  EXPECT_EQ(with.state_hash, none.state_hash);
  EXPECT_TRUE(with.report.has_value());
  EXPECT_FALSE(none.report.has_value());
  EXPECT_FALSE(fs::exists(folder / "b" / "report.bin"));
  EXPECT_FALSE(fs::exists(report_file(folder / "b")));
  EXPECT_THROW(write_report(folder / "b"), Error);
}

TEST_F(Report, LimitsAreKeptAndSaid) {
  run(busy, "a");
  const ReportSummary few = write_report(folder / "a", {7, 3});
  EXPECT_EQ(few.particles, 7U);
  EXPECT_EQ(few.frames, 3U);
  EXPECT_EQ(few.notes.size(), 2U);
  EXPECT_EQ(page("a").meta["frames"][2]["step"], 40);
  EXPECT_EQ(page("a").meta["frames"][0]["step"], 0);
  const ReportSummary whole = write_report(folder / "a");
  EXPECT_TRUE(whole.notes.empty());
  const ReportSummary small = write_report(folder / "a", {.bytes = whole.bytes - 1});
  EXPECT_LT(small.bytes, whole.bytes);
  EXPECT_LT(small.frames, whole.frames);
  EXPECT_GE(small.notes.size(), 2U);
  EXPECT_THROW(write_report(folder / "a", {0, 3}), InvalidArgument);
  EXPECT_THROW(write_report(folder / "a", {3, 0}), InvalidArgument);
  EXPECT_THROW(write_report(folder / "a", {3, 65536}), InvalidArgument);
}

// More contacts than a page takes: the note says how many there are, with their digits in groups.
TEST_F(Report, ContactsThatAreLeftOutAreCounted) {
  const Summary summary =
      run("[environment]\ngenerator = 'box'\n[[particles]]\ncount = 2000\nvelocity = [90.0, 0.0, 0.0]\n[motion]\n"
          "dt = 0.1\nsteps = 15\n[contact]\nresponse = 'reflect'\nrestitution = 1.0\n",
          "a");
  const auto& kinds = summary.totals.counters.contacts;
  const std::uint64_t all = kinds[0] + kinds[1] + kinds[2];
  ASSERT_GT(all, 250'000U);
  ASSERT_LT(all, 500'000U);
  ASSERT_EQ(summary.report->notes.size(), 1U);
  EXPECT_EQ(summary.report->notes.front(),
            fmt::format("Of {},{:03} contacts, the report has those of one particle in 2.", all / 1000, all % 1000));
}

// A recording that was cut off or changed is read as far as it makes sense, or refused: nothing worse.
TEST_F(Report, HostileRecordingsAreRefusedOrRead) {
  run(busy, "a");
  const fs::path path = folder / "a" / "report.bin";
  const std::string good = read_bytes(path);
  const char* sanitized = std::getenv("DARTCAST_SANITIZED");
  const bool is_full = std::getenv("DARTCAST_FULL") != nullptr;
  const int mutants = is_full ? 20000 : sanitized != nullptr ? 60 : 300;
  std::mt19937_64 random(1);
  int refused = 0;
  for (int i = 0; i < mutants; ++i) {
    std::string bad = good;
    if (i % 3 == 0) bad.resize(random() % good.size());
    for (std::uint64_t k = 0; i % 3 != 0 && k < 1 + random() % 4; ++k) {
      const std::size_t at = random() % (i % 3 == 1 ? 2000 : bad.size());
      bad[at] = static_cast<char>(random());
    }
    write_bytes(path, bad);
    try {
      write_report(folder / "a", {20, 4});
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, mutants / 10);
}

TEST_F(Report, TextsCannotBreakThePage) {
  Scene scene = parse_scene(busy, "scene.toml");
  scene.name = "</script><b>\"'&\x01\xff";
  RunOptions options;
  options.folder = folder / "a";
  run_scene(scene, options);
  const PageReader report = page("a");
  EXPECT_EQ(report.text.find("<b>"), std::string::npos);
  EXPECT_NE(report.text.find("<title>&lt;/script&gt;&lt;b&gt;&quot;'&amp;\xef\xbf\xbd\xef\xbf\xbd</title>"),
            std::string::npos);
}

TEST(ReportText, IsHtmlAndUtf8) {
  EXPECT_EQ(html("a<b>&\"\n"), "a&lt;b&gt;&amp;&quot;\n");
  EXPECT_EQ(html("\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80"), "\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80");
  EXPECT_EQ(html("\xc3"), "\xef\xbf\xbd");                                  // cut off
  EXPECT_EQ(html("\xc0\xaf"), "\xef\xbf\xbd\xef\xbf\xbd");                  // too long a form of "/"
  EXPECT_EQ(html("\xed\xa0\x80"), "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");  // half of a pair
}

TEST(ReportText, IsBase64) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");  // RFC 4648, section 10
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(ReportCharts, ShowNothingOfNothing) {
  EXPECT_EQ(line_chart({.title = "t"}, {}), "");
  EXPECT_EQ(line_chart({.title = "t"}, {{"s", {1.0}, {std::nan("")}}}), "");
  EXPECT_EQ(bar_chart({.title = "t"}, {}), "");
  EXPECT_EQ(histogram_chart({.title = "t"}, 0, {}), "");
}

// Patch 0 is no patch. No two patches have one colour, however many there are.
TEST(ReportCharts, EachPatchHasItsColour) {
  std::set<std::string> colours;
  for (std::size_t patch = 0; patch < 40; ++patch) colours.insert(patch_colour(patch));
  EXPECT_EQ(colours.size(), 40U);
  EXPECT_EQ(patch_colour(0), "var(--line)");
  EXPECT_EQ(patch_colour(2), "var(--c0)");
  EXPECT_EQ(patch_colour(10), "color-mix(in srgb,var(--c0) 75%,var(--c5))");
  const std::string bars = bar_chart({.title = "t"}, {{"a", 2.0, "2", patch_colour(3)}, {"b", 1.0, "1"}});
  EXPECT_NE(bars.find("fill=\"var(--c1)\"><title>a: 2<"), std::string::npos) << bars;
  EXPECT_NE(bars.find("fill=\"var(--c0)\"><title>b: 1<"), std::string::npos) << bars;
}

// A line of a million points keeps its peak.
TEST(ReportCharts, ThinLinesOutAndKeepPeaks) {
  ChartSeries series{"s", {}, {}};
  for (int i = 0; i < 1'000'000; ++i) {
    series.x.push_back(i);
    series.y.push_back(i == 777'777 ? 100.0 : 1.0);
  }
  const std::string svg = line_chart({.title = "t"}, {series});
  EXPECT_LT(svg.size(), 40'000U);
  EXPECT_NE(svg.find(" 34.0"), std::string::npos);  // the top of the chart
}

}  // namespace dartcast::report_test
