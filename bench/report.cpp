#include "bench/report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/competitors.hpp"
#include "bench/figures.hpp"

namespace dartcast::bench {

namespace {

using Json = nlohmann::ordered_json;

double per_step(const Row& row, std::uint64_t count) {
  return static_cast<double>(count) / static_cast<double>(row.counters.particle_steps);
}

std::uint64_t contacts(const Row& row) {
  return row.counters.contacts[0] + row.counters.contacts[1] + row.counters.contacts[2];
}

Json workload_json(const Row& row) {
  const WorkloadOptions& w = row.workload;
  Json json = {{"workload", w.name}, {"cells", row.cells}, {"deforms", w.deforms}};
  if (w.scene == Scene::tube) json["faces_of_a_cell"] = w.size + 2;
  json["particles"] = w.particles;
  if (w.name == "W3") json["order"] = w.cell_order ? "cell" : "random";
  if (w.scene == Scene::box || w.scene == Scene::squares || w.scene == Scene::tube)
    json["step_length_in_cells"] = w.step_length;
  if (w.scene == Scene::box || w.scene == Scene::squares) json["blocked_share"] = w.blocked_share;
  json["steps"] = row.all_series[0].step_ns.size();
  json["threads"] = row.threads;
  if (w.against_competitors) json["wall_triangles"] = row.wall_triangles;
  return json;
}

Json row_json(const Row& row) {
  Json json = workload_json(row);
  for (const Series& series : row.all_series) {
    json["ns_per_particle_step"][series.name] = series.ns_per_particle_step(row.workload.particles);
    json["mean_ns_per_particle_step"][series.name] = series.mean_ns_per_particle_step(row.workload.particles);
    json["step_us"][series.name] = {{"median", series.quantile_ns(0.5) / 1e3},
                                    {"p99", series.quantile_ns(0.99) / 1e3},
                                    {"longest", series.quantile_ns(1.0) / 1e3}};
    if (series.tests > 0) json["orientation_tests_per_particle_step"][series.name] = per_step(row, series.tests);
    if (&series == row.all_series.data()) continue;
    json["ratio"][series.name] = ratio_to_dartcast(row, series);
    json["disagreements"][series.name] = series.disagreements;
    json["disagreements_at_start"][series.name] = series.at_start;
    json["passed_through_wall"][series.name] = series.through;
    json["stopped_at_no_wall"][series.name] = series.stopped;
    if (row.workload.scene == Scene::squares) json["wrong_cell"][series.name] = series.wrong_cells;
    if (series.failed > 0) json["failed"][series.name] = series.failed;
  }
  if (const Series* best = best_of_embree(row)) json["ratio"]["embree_best"] = ratio_to_dartcast(row, *best);
  const TestCounts& tests = row.counters.orientation;
  if (tests.tests > 0) json["exact_share"] = static_cast<double>(tests.exact) / static_cast<double>(tests.tests);
  json["contacts_per_particle_step"] = per_step(row, contacts(row));
  return json;
}

}  // namespace

std::string report_json(std::span<const Row> rows) {
  Json json = {{"version", DARTCAST_VERSION}, {"left_out", left_out()}, {"rows", Json::array()}};
  for (const Row& row : rows) json["rows"].push_back(row_json(row));
  json["figures"] = Json::object();
  for (const Figure& figure : figures(rows)) json["figures"][figure.key] = figure.value;
  return json.dump(1);
}

std::string report_csv(std::span<const Row> rows) {
  std::string out =
      "workload,cells,deforms,faces_of_a_cell,particles,order,step_length_in_cells,blocked_share,steps,threads,"
      "competitor,"
      "ns_per_particle_step,mean_ns_per_particle_step,step_us_median,step_us_p99,step_us_longest,"
      "orientation_tests_per_particle_step,disagreements,disagreements_at_start,failed,passed_through_wall,stopped_at_"
      "no_wall,wrong_cell\n";
  for (const Row& row : rows) {
    const WorkloadOptions& w = row.workload;
    for (const Series& series : row.all_series) {
      out += fmt::format(
          "{},{},{:d},{},{},{},{},{},{},{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.3f},{},{},{},{},{},{}\n", w.name,
          row.cells, w.deforms, w.scene == Scene::tube ? fmt::to_string(w.size + 2) : "", w.particles,
          w.cell_order ? "cell" : "random", w.step_length, w.blocked_share, series.step_ns.size(), row.threads,
          series.name, series.ns_per_particle_step(w.particles), series.mean_ns_per_particle_step(w.particles),
          series.quantile_ns(0.5) / 1e3, series.quantile_ns(0.99) / 1e3, series.quantile_ns(1.0) / 1e3,
          per_step(row, series.tests), series.disagreements, series.at_start, series.failed, series.through,
          series.stopped, series.wrong_cells);
    }
  }
  return out;
}

}  // namespace dartcast::bench
