// Makes pages of measurements.
#include "bench/pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/report.hpp"
#include "report/chart.hpp"
#include "report/page.hpp"

namespace dartcast::bench {

namespace {

std::string page_of(const std::string& title, const std::string& charts, const std::string& table) {
  Page page;
  page.title = title;
  page.subtitle = "Measured by dartcast-bench";
  page.body = "<section class=\"charts\" aria-label=\"Charts\">\n" + charts +
              "</section>\n<section class=\"wide\"><pre>" + html(table) + "</pre></section>\n";
  return page_html(page);
}

std::string label_of(const std::string& competitor) {
  if (competitor == "bullet") return "Bullet";
  if (competitor == "embree_single") return "Embree";
  if (competitor == "embree_packet") return "Embree, packets";
  if (competitor == "paper") return "the paper's scheme";
  return competitor;
}

struct Axis {
  std::string title;
  const char* label;
  std::function<bool(const Row&)> shows;
  std::function<double(const Row&)> x;
};

// A line for each competitor over the rows that the axis shows.
std::string chart_of(std::span<const Row> rows, const Axis& axis) {
  std::vector<std::pair<double, const Row*>> shown;
  std::vector<std::string> names;
  for (const Row& row : rows) {
    if (row.threads != 1 || row.workload.particles != 1000 || !axis.shows(row)) continue;
    shown.emplace_back(axis.x(row), &row);
    for (const Series& s : row.all_series) {
      if (std::find(names.begin(), names.end(), s.name) == names.end()) names.push_back(s.name);
    }
  }
  std::sort(shown.begin(), shown.end());
  if (shown.size() < 2) return {};
  std::vector<ChartSeries> lines;
  for (const std::string& name : names) {
    ChartSeries line{label_of(name), {}, {}};
    for (const auto& [x, row] : shown) {
      const Series* series = row->series(name);
      if (series == nullptr) continue;
      line.x.push_back(x);
      line.y.push_back(series->ns_per_particle_step(row->workload.particles));
    }
    lines.push_back(std::move(line));
  }
  return line_chart(
      {.title = axis.title, .x_label = axis.label, .y_label = "ns per particle-step", .log_x = true, .log_y = true},
      lines);
}

auto is_workload(const char* name, bool deforms) {
  return [name, deforms](const Row& r) { return r.workload.name == name && r.workload.deforms == deforms; };
}
bool is_tube(const Row& r) { return r.workload.scene == Scene::tube; }
bool is_range(const Row& r, double blocked_share, bool deforms) {
  const WorkloadOptions& w = r.workload;
  return w.name == "W5" && w.scene == Scene::box && w.blocked_share == blocked_share && w.deforms == deforms;
}

}  // namespace

std::string comparison_page(std::span<const Row> rows) {
  const auto cells = [](const Row& r) { return static_cast<double>(r.cells); };
  std::vector<Axis> axes = {
      {"Standing still", "cells of the scene", is_workload("W1", false), cells},
      {"Every vertex moving", "cells of the scene", is_workload("W2", true), cells},
      {"In the plane, standing still", "faces of the scene", is_workload("W6", false), cells},
      {"In the plane, moving", "faces of the scene", is_workload("W6", true), cells},
      {"Faces of a cell", "faces", is_tube, [](const Row& r) { return static_cast<double>(r.workload.size + 2); }}};
  for (const bool deforms : {false, true}) {
    for (const double share : {0.1, 0.01, 0.001}) {
      axes.push_back({fmt::format("Length of a step, {}% blocked, {}", 100.0 * share, deforms ? "moving" : "still"),
                      "cells a step", [=](const Row& r) { return is_range(r, share, deforms); },
                      [](const Row& r) { return r.workload.step_length; }});
    }
  }
  std::string charts;
  for (const Axis& axis : axes) charts += chart_of(rows, axis);
  return page_of("Comparison on this machine", charts, report_text(rows));
}

std::string latency_page(const Latency& latency) {
  ChartSeries steps{"steps", {}, {}};
  ChartSeries cuts{"steps with cuts", {}, {}};
  for (std::size_t i = 0; i < latency.steps.size(); ++i) {
    ChartSeries& series = latency.steps[i].cut ? cuts : steps;
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(latency.steps[i].ms);
  }
  std::vector<ChartSeries> all = {std::move(steps)};
  if (!cuts.x.empty()) all.push_back(std::move(cuts));
  return page_of("Time of each step of a surgical scene",
                 line_chart({.title = "Time of a step", .x_label = "step", .y_label = "ms", .log_y = true}, all),
                 latency_text(latency));
}

}  // namespace dartcast::bench
