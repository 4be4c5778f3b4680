// The program dartcast-bench: runs comparisons, and writes their tables and charts.
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/dartcast/limits.hpp"
#include "apps/dartcast/program.hpp"
#include "bench/chart.hpp"
#include "bench/comparison.hpp"
#include "bench/edits.hpp"
#include "bench/latency.hpp"
#include "bench/pages.hpp"
#include "bench/plan.hpp"
#include "bench/rays.hpp"
#include "bench/report.hpp"
#include "bench/run_parts.hpp"
#include "bench/solids.hpp"
#include "bench/spheres.hpp"
#include "dartcast/error.hpp"
#include "dartcast/threads.hpp"

namespace {

namespace bench = dartcast::bench;
using dartcast::app::done;
using dartcast::app::whole_number;

struct BenchArguments {
  bench::PlanOptions plan;
  std::string folder = "bench-out";
  bool json = false;
  bool edits = false;
  bool spheres = false;
  bool solids = false;
  bool rays = false;
  bool latency = false;
  bool runs = false;
  bench::RunPartsOptions run_options;
  std::size_t max_spheres = 100000;
};

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) throw dartcast::Error(fmt::format("{}: cannot be written", file.string()));
}

int run_edits(bool json) {
  std::vector<bench::EditRow> rows;
  for (const std::uint32_t edge : {10U, 100U}) rows.push_back(bench::edit_box(edge, 100000, 10000));
  fmt::print("{}", json ? bench::edits_json(rows) + "\n" : bench::edits_text(rows));
  return done;
}

int run_spheres(const BenchArguments& a) {
  std::vector<bench::SphereRow> rows;
  for (const bool crowded : {false, true}) {
    for (std::size_t count = 1000; count <= a.max_spheres; count *= 10) rows.push_back(bench::heap(count, crowded));
  }
  fmt::print("{}", a.json ? bench::spheres_json(rows) + "\n" : bench::spheres_text(rows));
  return done;
}

int run_solids(const BenchArguments& a) {
  std::vector<bench::SolidRow> rows;
  for (const bool moving : {false, true}) {
    for (const std::size_t across : {10U, 22U, 46U, 100U}) {
      if (a.plan.quick && across > 22) continue;
      rows.push_back(bench::time_edges(across, moving));
    }
  }
  const bench::PairTimes pairs = bench::time_pairs();
  fmt::print("{}", a.json ? bench::solids_json(pairs, rows) + "\n" : bench::solids_text(pairs, rows));
  return done;
}

int run_rays(const BenchArguments& a) {
  std::vector<bench::RayBenchRow> rows;
  for (const std::size_t across : {10U, 46U, 100U}) {
    if (a.plan.quick && across > 46) continue;
    for (const double share : {0.1, 0.01}) rows.push_back(bench::time_rays(across, share));
  }
  fmt::print("{}", a.json ? bench::rays_json(rows) + "\n" : bench::rays_text(rows));
  return done;
}

int run_latency(const BenchArguments& a) {
  bench::LatencyOptions options;
  options.steps = a.plan.steps.value_or(options.steps);
  const bench::Latency latency = bench::measure_latency(options);
  const std::filesystem::path folder = a.folder;
  std::filesystem::create_directories(folder);
  write(folder / "latency.json", bench::latency_json(latency) + "\n");
  write(folder / "latency.svg", bench::latency_svg(latency));
  write(folder / "latency.html", bench::latency_page(latency));
  fmt::print("{}", a.json ? bench::latency_json(latency) + "\n"
                          : fmt::format("{}output: {}\n", bench::latency_text(latency), a.folder));
  return done;
}

int run_comparison(const BenchArguments& a) {
  const std::vector<bench::WorkloadOptions> plan = bench::plan(a.plan);
  std::filesystem::create_directories(a.folder);
  const std::vector<bench::PeerKind> kinds = bench::competitor_kinds();
  for (const std::string& name : bench::left_out()) fmt::print(stderr, "left out: {}\n", name);
  std::vector<bench::Row> rows;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    fmt::print(stderr, "[{}/{}] {}\n", i + 1, plan.size(), bench::title(plan[i]));
    for (bench::Row& row : bench::compare(plan[i], kinds)) rows.push_back(std::move(row));
  }
  const std::filesystem::path folder = a.folder;
  write(folder / "bench.json", bench::report_json(rows) + "\n");
  write(folder / "bench.csv", bench::report_csv(rows));
  write(folder / "bench.svg", bench::chart_svg(rows));
  write(folder / "bench_plane.svg", bench::plane_chart_svg(rows));
  write(folder / "bench.html", bench::comparison_page(rows));
  if (a.json) {
    fmt::print("{}\n", bench::report_json(rows));
  } else {
    fmt::print("{}\noutput: {}\n", bench::report_text(rows), folder.string());
  }
  return done;
}

int run_runs(const BenchArguments& a) {
  bench::RunPartsOptions options = a.run_options;
  options.command = std::filesystem::read_symlink("/proc/self/exe").replace_filename("dartcast");
  options.folder = a.folder;
  options.steps = a.plan.steps;
  const std::vector<bench::RunPairs> runs = bench::measure_runs(options);
  write(options.folder / "run.json", bench::runs_json(runs) + "\n");
  write(options.folder / "run.svg", bench::runs_svg(runs));
  fmt::print("{}",
             a.json ? bench::runs_json(runs) + "\n" : fmt::format("{}output: {}\n", bench::runs_text(runs), a.folder));
  return done;
}

int run(const BenchArguments& a) {
  if (a.edits) return run_edits(a.json);
  if (a.spheres) return run_spheres(a);
  if (a.solids) return run_solids(a);
  if (a.rays) return run_rays(a);
  if (a.latency) return run_latency(a);
  if (a.runs) return run_runs(a);
  return run_comparison(a);
}

void add_run_options(CLI::App& app, BenchArguments& a) {
  bench::RunPartsOptions& options = a.run_options;
  CLI::Option* runs = app.add_flag("--run", a.runs, "the time of the demo by part, and nothing else");
  app.add_option("SCENE", options.scene, "with --run: a scene in TOML, instead of the demo")->needs(runs);
  app.add_option("--against", options.against, "with --run: the command of another build, which runs in turn with this")
      ->needs(runs)
      ->check(CLI::ExistingFile);
  app.add_option("--repeat", options.repeat, "with --run: runs of each command (3)")
      ->needs(runs)
      ->transform(whole_number(1, 1000));
  app.add_option("-j,--threads", options.threads, "with --run: threads (all the machine has)")
      ->needs(runs)
      ->transform(whole_number(1, dartcast::max_threads()));
}

void add_options(CLI::App& app, BenchArguments& a) {
  app.add_flag("--quick", a.plan.quick, "the main figures only, in under two minutes");
  app.add_option("--only", a.plan.only, "workloads to run, as in W1,W3 (all)")->delimiter(',');
  app.add_option("--steps", a.plan.steps, "steps of a workload or scene at most (its own number)")
      ->transform(whole_number(1, 1000000));
  app.add_option("-o,--output", a.folder, "folder for tables and drawings (bench-out)")->take_last();
  app.add_flag("--json", a.json, "print one JSON object, and nothing else");
  app.add_flag("--edits", a.edits, "edits per second at 10^3 and 10^6 cells, and nothing else");
  app.add_flag("--spheres", a.spheres, "what colliding spheres cost, 10^3 and more, and nothing else");
  app.add_flag("--solids", a.solids, "what edges among walls cost, 10^3 to 10^6 cells, and nothing else");
  app.add_flag("--rays", a.rays, "what rays cost, 10^3 to 10^6 cells, and nothing else");
  app.add_option("--most", a.max_spheres, "with --spheres: their largest number (1000 to 10^8; 100000)")
      ->transform(whole_number(1000, 100000000));
  app.add_flag("--latency", a.latency, "the time of single steps of a surgical scene, and nothing else");
  add_run_options(app, a);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares with bounding volume hierarchies on this machine.", "dartcast-bench");
  BenchArguments arguments;
  int status = done;
  add_options(app, arguments);
  app.callback([&] { status = run(arguments); });
  return dartcast::app::run_program(app, argc, argv, status);
}
