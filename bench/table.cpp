// Rows for people.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "bench/figures.hpp"
#include "bench/report.hpp"

namespace dartcast::bench {

namespace {

std::vector<std::string> series_names(std::span<const Row> rows) {
  std::vector<std::string> names;
  for (const Row& row : rows) {
    for (const Series& series : row.all_series) {
      if (std::find(names.begin(), names.end(), series.name) == names.end()) names.push_back(series.name);
    }
  }
  return names;
}

using Line = std::vector<std::string>;

// Columns as wide as they need be, the first to the left.
std::string aligned(const std::vector<Line>& lines) {
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const Line& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  }
  std::string out;
  for (const Line& line : lines) {
    out += fmt::format("{:<{}}", line[0], widths[0]);
    for (std::size_t c = 1; c < line.size(); ++c) out += fmt::format("   {:>{}}", line[c], widths[c]);
    out += '\n';
  }
  return out;
}

// A line per row, a column per competitor: what `entry` says of it.
template <class Entry>
std::string table(std::span<const Row> rows, const std::string& heading, Entry&& entry) {
  const std::vector<std::string> names = series_names(rows);
  std::vector<Line> lines = {{""}};
  lines[0].insert(lines[0].end(), names.begin(), names.end());
  for (const Row& row : rows) {
    const std::string threads = row.workload.threads.size() > 1 ? fmt::format(", threads: {}", row.threads) : "";
    Line& line = lines.emplace_back(1, title(row.workload) + threads);
    for (const std::string& name : names) {
      const Series* series = row.series(name);
      line.push_back(series == nullptr ? "" : entry(row, *series));
    }
  }
  return fmt::format("\n{}\n{}", heading, aligned(lines));
}

std::string speed(const Row& row, const Series& series) {
  const double ns = series.ns_per_particle_step(row.workload.particles);
  if (&series == row.all_series.data()) return fmt::format("{:.1f}", ns);
  return fmt::format("{:.1f} ({:.2f}x)", ns, ratio_to_dartcast(row, series));
}

std::string steps(const Row& /*row*/, const Series& series) {
  return fmt::format("{:.0f} {:.0f} {:.0f}", series.quantile_ns(0.5) / 1e3, series.quantile_ns(0.99) / 1e3,
                     series.quantile_ns(1.0) / 1e3);
}

std::string answers(const Row& row, const Series& series) {
  if (&series == row.all_series.data()) return fmt::format("of {}", row.counters.particle_steps);
  return fmt::format("{} ({})", series.disagreements, series.at_start);
}

std::string errors(const Row& row, const Series& series) {
  if (&series == row.all_series.data()) return fmt::format("of {}", row.counters.particle_steps);
  return fmt::format("{} {} {} {} {}", series.through, series.stopped,
                     series.disagreements - series.through - series.stopped - series.failed, series.failed,
                     series.wrong_cells);
}

std::string tests(const Row& row, const Series& series) {
  if (series.tests == 0) return "";
  const auto share = [](std::uint64_t a, std::uint64_t b) { return static_cast<double>(a) / static_cast<double>(b); };
  std::string out = fmt::format("{:.2f}", share(series.tests, row.counters.particle_steps));
  if (&series != row.all_series.data()) return out;
  return out +
         fmt::format(" ({:.2g}% exact)", 100.0 * share(row.counters.orientation.exact, row.counters.orientation.tests));
}

}  // namespace

std::string title(const WorkloadOptions& w) {
  std::string out = w.name;
  if (w.scene == Scene::box || w.scene == Scene::lattice) {
    out += fmt::format(", {} cells", std::uint64_t{w.size} * w.size * w.size);
  }
  if (w.scene == Scene::squares) {
    out += fmt::format(", {} faces, {}", std::uint64_t{w.size} * w.size, w.deforms ? "moving" : "still");
  }
  if (w.particles != 1000) out += fmt::format(", {} particles", w.particles);
  if (w.cell_order) out += ", in cell order";
  if (w.scene == Scene::tube) out += fmt::format(", cells of {} faces", w.size + 2);
  if (w.scene == Scene::box && w.name == "W5")
    out += fmt::format(", {}% blocked, {}, steps of {} cells", 100.0 * w.blocked_share, w.deforms ? "moving" : "still",
                       w.step_length);
  return out;
}

std::string report_text(std::span<const Row> rows) {
  std::vector<Row> plane;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(plane),
               [](const Row& row) { return row.workload.scene == Scene::squares; });
  std::string out =
      table(rows, "ns per particle-step, contacts included (and how many times dartcast's it takes)", speed);
  out += table(rows, "one step of all particles, us: median, 99th percentile, longest", steps);
  out += table(rows, "segments answered otherwise than by dartcast (of these: those that start on a wall)", answers);
  if (!plane.empty()) {
    out += table(
        plane,
        "in the plane: through a wall, stopped at none, at another wall or place, in endless loops; in the wrong cell",
        errors);
  }
  out += table(rows, "orientation tests per particle-step", tests);
  out += '\n';
  for (const Figure& figure : figures(rows)) out += fmt::format("{}: {:.2f}\n", figure.text, figure.value);
  return out;
}

}  // namespace dartcast::bench
