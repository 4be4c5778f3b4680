// The benchmark's own parts: competitors against brute force, workloads, and what is written.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/chart.hpp"
#include "bench/comparison.hpp"
#include "bench/figures.hpp"
#include "bench/plan.hpp"
#include "bench/report.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"

namespace dartcast::bench::bench_test {

WorkloadOptions small(Scene scene, bool deforms, std::size_t steps = 40) {
  WorkloadOptions options;
  options.name = "test";
  options.scene = scene;
  options.size = 8;
  options.deforms = deforms;
  options.particles = 100;
  options.steps = steps;
  return options;
}

// Where a segment meets a triangle, as the fraction of its way; none: 2.
double fraction(const Segment& s, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 d = s.to - s.from;
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const double det = dot(u, cross(d, v));
  if (det == 0.0) return 2.0;
  const Vec3 w = s.from - a;
  const double x = dot(w, cross(d, v)) / det;
  const double y = dot(d, cross(w, u)) / det;
  const double t = dot(v, cross(w, u)) / det;
  return x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t >= 0.0 && t <= 1.0 ? t : 2.0;
}

Hit nearest(const Walls& walls, const std::vector<Vec3>& points, const Segment& s) {
  Hit hit;
  for (std::uint32_t i = 0; i < walls.triangles.size(); ++i) {
    const auto& [a, b, c] = walls.triangles[i];
    const double t = fraction(s, points[a], points[b], points[c]);
    if (t < hit.time) hit = {i, t};
  }
  return hit;
}

void expect_as_brute_force(Competitor& competitor, const Walls& walls, const std::vector<Vec3>& points,
                           const std::string& name) {
  Random random(3);
  const auto place = [&] { return Vec3{random.uniform(0, 6), random.uniform(0, 6), random.uniform(0, 6)}; };
  std::vector<Segment> segments(500);  // no multiple of a packet's 16
  for (Segment& s : segments) s = {place(), place()};
  std::vector<Hit> hits(segments.size());
  competitor.cast(segments, hits);
  std::size_t met = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Hit truth = nearest(walls, points, segments[i]);
    met += truth.triangle != Hit::none ? 1 : 0;
    EXPECT_EQ(truth.triangle == Hit::none, hits[i].triangle == Hit::none) << name << ", segment " << i;
    EXPECT_NEAR(truth.time, hits[i].time, 1e-4) << name << ", segment " << i;
  }
  EXPECT_GT(met, 300U);
}

TEST(Competitors, FindWhatBruteForceFindsBeforeAndAfterRefitting) {
  Workload workload(small(Scene::box, true));
  const Walls walls = walls_of(workload.environment().complex());
  std::vector<Vec3> points;
  walls.gather(workload.environment().complex().positions(), points);
  for (const PeerKind& kind : competitor_kinds()) {
    if (kind.name == "paper") continue;  // it follows particles
    for (const bool deforms : {false, true}) {
      const auto competitor = kind.make({workload.environment().complex(), walls, points, {}, deforms});
      expect_as_brute_force(*competitor, walls, points, kind.name);
      if (!deforms) continue;
      std::vector<Vec3> moved = points;
      for (Vec3& p : moved) p = {0.9 * p.x + 0.1 * p.y, p.y, p.z - 0.2 * p.x};
      competitor->write(moved);
      competitor->refit();
      expect_as_brute_force(*competitor, walls, moved, kind.name + " refitted");
    }
  }
}

TEST(Walls, AreThoseOfFreeCells) {
  BoxOptions options;
  options.cells = {3, 3, 3};
  options.size = {3, 3, 3};
  options.blocked_layer = true;
  const Environment environment(generate_box(options));
  const Walls walls = walls_of(environment.complex());
  ASSERT_EQ(walls.triangles.size(), 12U);
  EXPECT_EQ(walls.points.size(), 8U);
  for (std::uint32_t i = 0; i < 12; ++i) EXPECT_EQ(walls.number(walls.names[i]), i);
  std::vector<Vec3> points;
  walls.gather(environment.positions(), points);
  for (const auto& [a, b, c] : walls.triangles) {
    const Vec3 normal = cross(points[b] - points[a], points[c] - points[a]);
    EXPECT_GT(dot(normal, points[a] - Vec3{1.5, 1.5, 1.5}), 0.0) << "counterclockwise seen from outside";
  }
}

std::vector<Vec3> flown(const WorkloadOptions& options) {
  Workload workload(options);
  std::vector<Vec3> track;
  for (std::size_t step = 0; step < options.steps; ++step) {
    workload.aim();
    if (options.deforms) workload.environment().move();
    workload.update_after_edit(workload.environment().advance(workload.particles(), workload.targets()));
    for (const ParticleState& s : workload.particles().states()) track.push_back(s.position);
  }
  EXPECT_EQ(audit(workload.environment().complex(), workload.particles()).failed, 0U);
  return track;
}

TEST(Workload, IsTheSameInEveryRun) {
  for (const Scene scene : {Scene::box, Scene::lattice, Scene::squares, Scene::tube, Scene::bar, Scene::vessel}) {
    for (const bool deforms : {false, true}) {
      if (deforms && (scene == Scene::lattice || scene == Scene::tube)) continue;
      const WorkloadOptions options = small(scene, deforms, 20);
      EXPECT_EQ(flown(options), flown(options)) << static_cast<int>(scene) << deforms;
    }
  }
}

TEST(Workload, OnTheLatticeCoordinatesStayExact) {
  for (const Vec3& p : flown(small(Scene::lattice, false, 200))) {
    for (const double x : {p.x, p.y, p.z}) ASSERT_EQ(8.0 * x, std::round(8.0 * x));
  }
}

TEST(Workload, StepsKeepTheirLength) {
  WorkloadOptions options = small(Scene::box, true, 300);
  Workload workload(options);
  double sum = 0.0;
  for (std::size_t step = 0; step < options.steps; ++step) {
    workload.aim();
    for (std::size_t i = 0; i < options.particles; ++i) {
      sum += norm(workload.targets()[i] - workload.particles()[i].position);
    }
    workload.environment().move();
    workload.update_after_edit(workload.environment().advance(workload.particles(), workload.targets()));
  }
  EXPECT_NEAR(sum / static_cast<double>(options.steps * options.particles), 0.1, 0.01);
}

TEST(Comparison, AllAgreeButForRounding) {
  for (const bool deforms : {false, true}) {
    const std::vector<Row> rows = compare(small(Scene::box, deforms, 200), competitor_kinds());
    ASSERT_EQ(rows.size(), 1U);
    const Row& row = rows[0];
    EXPECT_EQ(row.counters.particle_steps, 20000U);
    EXPECT_GT(row.counters.contacts[2], 100U);
    for (const Series& series : row.all_series) {
      EXPECT_EQ(series.step_ns.size(), 200U) << series.name;
      EXPECT_GT(series.quantile_ns(0.0), 0.0) << series.name;
      EXPECT_LE(series.quantile_ns(0.5), series.quantile_ns(0.99)) << series.name;
      if (series.name != "paper") EXPECT_LE(series.disagreements, 10U) << series.name;
    }
  }
}

// Says the same of every segment.
class Constant : public Competitor {
 public:
  explicit Constant(const Hit& hit) : hit_(hit) {}
  void write(std::span<const Vec3> /*points*/) override {}
  void refit() override {}
  void cast(std::span<const Segment> /*segments*/, std::span<Hit> hits) override { std::ranges::fill(hits, hit_); }
  [[nodiscard]] std::uint64_t wrong_cells() const override { return ++asked_; }

 private:
  Hit hit_;
  mutable std::uint64_t asked_ = 6;
};

std::unique_ptr<Competitor> make_self_hit_epsilon(const PeerScene&) { return std::make_unique<Constant>(Hit{}); }
std::unique_ptr<Competitor> make_timid(const PeerScene&) { return std::make_unique<Constant>(Hit{0, 1.0}); }
std::unique_ptr<Competitor> make_lost(const PeerScene&) { return std::make_unique<Constant>(Hit{Hit::failed, 1.0}); }

TEST(Comparison, DistinguishesErrors) {
  const std::vector<PeerKind> kinds = {{"blind", make_self_hit_epsilon, true},
                                       {"timid", make_timid, true},
                                       {"lost", make_lost, true},
                                       {"of space", make_lost}};
  for (const Scene scene : {Scene::squares, Scene::box}) {
    const Row row = compare(small(scene, true, 100), kinds).front();
    ASSERT_EQ(row.all_series.size(), scene == Scene::box ? 5U : 4U) << "only in space";
    const std::uint64_t steps = row.counters.particle_steps;
    const auto& c = row.counters.contacts;
    const std::uint64_t contacts = c[0] + c[1] + c[2];
    ASSERT_GT(contacts, 100U);
    const Series& self_hit_epsilon = row.all_series[1];
    EXPECT_EQ(self_hit_epsilon.through, contacts);
    EXPECT_EQ(self_hit_epsilon.disagreements, contacts);
    EXPECT_EQ(self_hit_epsilon.stopped + self_hit_epsilon.failed, 0U);
    const Series& timid = row.all_series[2];
    EXPECT_EQ(timid.stopped, steps - contacts);
    EXPECT_EQ(timid.through + timid.failed, 0U);
    const Series& lost = row.all_series[3];
    EXPECT_EQ(lost.failed, steps);
    EXPECT_EQ(lost.through + lost.stopped, 0U);
    EXPECT_EQ(lost.wrong_cells, 1U) << "since the first block, which is not counted";
  }
}

TEST(Comparison, TakesTurnsWithThreads) {
  WorkloadOptions options = small(Scene::box, false, 10);
  options.threads = {1, 2};
  options.against_competitors = false;
  const std::vector<Row> rows = compare(options, competitor_kinds());
  ASSERT_EQ(rows.size(), 2U);
  for (const Row& row : rows) {
    ASSERT_EQ(row.all_series.size(), 1U);
    EXPECT_EQ(row.all_series[0].step_ns.size(), 10U);
  }
}

TEST(Series, MediansAndQuantiles) {
  Series series;
  for (int i = 1; i <= 100; ++i) series.step_ns.push_back(i);  // 50 blocks with the means 1.5, 3.5 ... 99.5
  EXPECT_DOUBLE_EQ(series.ns_per_particle_step(1), 51.5);
  EXPECT_DOUBLE_EQ(series.mean_ns_per_particle_step(10), 5.05);
  EXPECT_DOUBLE_EQ(series.quantile_ns(0.5), 50.0);
  EXPECT_DOUBLE_EQ(series.quantile_ns(0.99), 99.0);
  EXPECT_DOUBLE_EQ(series.quantile_ns(1.0), 100.0);
}

// Blocks of 20 steps would have means of 145 and 190, and 190 for their median.
TEST(Series, BlocksAreWholePeriodsOfTheLattice) {
  Series series;
  for (int i = 0; i < 1000; ++i) series.step_ns.push_back(i % 8 < 2 ? 480.0 : 30.0);
  EXPECT_DOUBLE_EQ(series.ns_per_particle_step(1), 142.5);
}

// Every tag is closed by its own, in turn.
bool well_formed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return false;
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag.front() == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
  }
  return open.empty() && xml.starts_with("<svg ");
}

TEST(Report, SaysTheSameInAllForms) {
  std::vector<Row> rows;
  for (const bool deforms : {false, true}) {
    WorkloadOptions options = small(Scene::box, deforms, 5);
    options.name = deforms ? "W2" : "W1";
    options.particles = 1000;
    rows.push_back(compare(options, competitor_kinds()).front());
  }
  const auto json = nlohmann::json::parse(report_json(rows));
  ASSERT_EQ(json["rows"].size(), 2U);
  EXPECT_EQ(json["rows"][0]["workload"], "W1");
  EXPECT_EQ(json["rows"][1]["deforms"], true);
  for (const auto& row : json["rows"]) {
    EXPECT_EQ(row["ns_per_particle_step"].size(), 1 + competitor_kinds().size());
    EXPECT_EQ(row["disagreements"].size(), competitor_kinds().size());
    EXPECT_GT(row["orientation_tests_per_particle_step"]["dartcast"], 4.0);
  }
  const std::string csv = report_csv(rows);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'),
            1 + 2 * static_cast<std::ptrdiff_t>(1 + competitor_kinds().size()));
  const std::string text = report_text(rows);
  EXPECT_NE(text.find("W1, 512 cells"), std::string::npos);
  const std::string svg = chart_svg(rows);
  EXPECT_TRUE(well_formed(svg)) << svg;
  EXPECT_NE(svg.find("dartcast"), std::string::npos);
  EXPECT_TRUE(well_formed(chart_svg({})));
}

TEST(Report, SaysWhatWentWrongInThePlane) {
  std::vector<Row> rows;
  for (const bool deforms : {false, true}) {
    for (const std::uint32_t size : {32U, 1000U}) {
      WorkloadOptions options = small(Scene::squares, deforms, 5);
      options.name = "W6";
      rows.push_back(compare(options, competitor_kinds()).front());
      rows.back().workload.size = size;
      rows.back().workload.particles = 1000;
    }
  }
  rows[3].all_series[1].disagreements = 100;
  rows[3].all_series[1].through = 10;
  rows[3].all_series[1].stopped = 20;
  rows[3].all_series[1].failed = 30;
  rows[3].all_series[1].wrong_cells = 50;
  const std::string text = report_text(rows);
  EXPECT_NE(text.find("W6, 1000000 faces, moving"), std::string::npos);
  EXPECT_NE(text.find("10 20 40 30 50"), std::string::npos) << text;
  const auto json = nlohmann::json::parse(report_json(rows));
  EXPECT_EQ(json["rows"][3]["passed_through_wall"]["paper"], 10);
  EXPECT_EQ(json["rows"][3]["stopped_at_no_wall"]["paper"], 20);
  EXPECT_EQ(json["rows"][3]["wrong_cell"]["paper"], 50);
  for (const char* key : {"growth_plane_still_dartcast", "growth_plane_moving_paper"})
    EXPECT_GT(json["figures"][key], 0.0) << key;
  EXPECT_TRUE(well_formed(plane_chart_svg(rows)));
  EXPECT_NE(plane_chart_svg(rows).find("faces of the scene"), std::string::npos);
  EXPECT_EQ(plane_chart_svg(rows).find("Bullet"), std::string::npos);
}

TEST(Plan, QuickAndFull) {
  EXPECT_EQ(plan({.quick = true, .only = {}, .steps = {}}).size(), 4U);
  const auto all = plan({.quick = false, .only = {}, .steps = 7});
  EXPECT_EQ(all.front().name, "W3") << "threads are capped once Embree has been used";
  for (const WorkloadOptions& w : all) EXPECT_EQ(w.steps, 7U);
  EXPECT_EQ(plan({.quick = false, .only = {"W4"}, .steps = {}}).size(), 1U);
  EXPECT_THROW(plan({.quick = false, .only = {"W9"}, .steps = {}}), InvalidArgument);
}

}  // namespace dartcast::bench::bench_test
