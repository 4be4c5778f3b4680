// Charts of a run.
#include "report/run_charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "report/chart.hpp"
#include "report/summary_file.hpp"

namespace dartcast {

namespace {

namespace fs = std::filesystem;
// stats.csv by columns.
class Steps {
 public:
  explicit Steps(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    if (!std::getline(file, line)) return;
    std::stringstream head(line);
    for (std::string name; std::getline(head, name, ',');) columns_.push_back({name, {}});
    for (std::size_t row = 2; std::getline(file, line); ++row) add(path, row, line);
  }

  [[nodiscard]] std::vector<double> operator[](std::string_view name) const {
    for (const Column& c : columns_) {
      if (c.name == name) return c.values;
    }
    return {};
  }

 private:
  struct Column {
    std::string name;
    std::vector<double> values;
  };

  void add(const fs::path& path, std::size_t row, const std::string& line) {
    const char* at = line.data();
    const char* const end = at + line.size();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      double value = std::nan("");  // an empty field
      const bool empty = at == end || *at == ',';
      const auto [next, error] = empty ? std::from_chars_result{at, {}} : std::from_chars(at, end, value);
      const bool ends_well = i + 1 == columns_.size() ? next == end : next != end && *next == ',';
      if (error != std::errc() || !ends_well)
        throw Error(fmt::format("{}:{}: it is damaged: column {} has no number", path.string(), row, columns_[i].name));
      columns_[i].values.push_back(value);
      at = next + (i + 1 == columns_.size() ? 0 : 1);
    }
  }

  std::vector<Column> columns_;
};

// The sum of a column in each step, of a table with a row per step and solid. Steps count from 1, as in stats.csv.
std::vector<double> contacts_of_solids(const fs::path& path, std::size_t steps, std::string_view column) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return {};
  const auto fields = [](const std::string& row) {
    std::vector<std::string> all;
    std::stringstream in(row);
    for (std::string field; std::getline(in, field, ',');) all.push_back(field);
    return all;
  };
  const std::vector<std::string> names = fields(line);
  const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), column) - names.begin());
  std::vector<double> sums(steps);
  while (std::getline(file, line)) {
    const std::vector<std::string> row = fields(line);
    if (at >= row.size()) continue;
    const double step = std::strtod(row[0].c_str(), nullptr);
    if (step >= 1.0 && step <= static_cast<double>(steps))
      sums[static_cast<std::size_t>(step) - 1] += std::strtod(row[at].c_str(), nullptr);
  }
  return sums;
}

std::vector<double> ratio(const std::vector<double>& a, const std::vector<double>& b, double factor) {
  std::vector<double> out(std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = b[i] > 0.0 ? factor * a[i] / b[i] : std::nan("");
  return out;
}

std::vector<double> summed(std::vector<double> values) {
  for (std::size_t i = 1; i < values.size(); ++i) values[i] += values[i - 1];
  return values;
}

bool has_values(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v) && v != 0.0; });
}

// A chart over time of those series that have values; nothing if none has.
std::string over_time(const std::string& title, const std::string& unit, const std::vector<double>& time,
                      const std::vector<std::pair<std::string, std::vector<double>>>& all) {
  std::vector<ChartSeries> series;
  for (const auto& [name, values] : all) {
    if (has_values(values)) series.push_back({name, time, values});
  }
  if (series.empty()) return {};
  return line_chart({.title = title, .x_label = "time (s)", .y_label = unit}, series);
}

std::string histogram_of_tests(const RunJson& summary) {
  const RunJson histogram = summary.value("/orientation_tests/histogram"_json_pointer, RunJson());
  if (!histogram.is_array()) return {};
  double all = 0.0;
  std::vector<double> shares;
  for (const RunJson& n : histogram) shares.push_back(n.is_number() ? n.get<double>() : 0.0);
  for (const double n : shares) all += n;
  if (!(all > 0.0)) return {};
  for (double& n : shares) n *= 100.0 / all;
  while (shares.size() > 2 && shares.back() < 1e-4) shares.pop_back();
  return histogram_chart({.title = "Orientation tests of a particle in a step",
                          .x_label = "number of tests",
                          .y_label = "% of particle-steps"},
                         0, shares);
}

// Bars of an object of numbers, the greatest first. Where `patches`, they stand for patches, in their order.
std::vector<Bar> bars_of(const RunJson& object, const char* unit, bool patches = false) {
  std::vector<Bar> bars;
  if (!object.is_object()) return bars;
  std::size_t place = 0;
  for (const auto& [name, value] : object.items()) {
    ++place;
    if (!value.is_number() || !(value.get<double>() > 0.0)) continue;
    const std::string label = value.is_number_integer() ? fmt::format("{}{}", value.get<std::uint64_t>(), unit)
                                                        : fmt::format("{:.3g}{}", value.get<double>(), unit);
    bars.push_back({name.empty() ? "no patch" : name, value.get<double>(), label});
    if (patches) bars.back().colour = patch_colour(name.empty() ? 0 : place);
  }
  std::sort(bars.begin(), bars.end(), [](const Bar& a, const Bar& b) { return a.value > b.value; });
  if (bars.size() > 16) bars.resize(16);
  return bars;
}

// Charts of the particles that left: the density of their residence times, and the share that stays longer, by patch.
std::string charts_of_residence(const RunJson& summary) {
  const RunJson all = summary.value("/statistics/residence_time"_json_pointer, RunJson::object());
  std::vector<ChartSeries> densities;
  std::vector<ChartSeries> washouts;
  for (const char* kind : {"escaped", "absorbed"}) {
    const RunJson by_patch = all.value(kind, RunJson::object());
    for (const auto& [patch, times] : by_patch.items()) {
      const RunJson histogram = times.value("histogram", RunJson());
      const auto number = [](const RunJson& value) { return value.is_number() ? value.get<double>() : 0.0; };
      const double bin = number(times.value("bin", RunJson()));
      const double count = number(times.value("count", RunJson()));
      if (!histogram.is_array() || !(bin > 0.0) || !(count > 0.0)) continue;
      ChartSeries density{fmt::format("{} at {}", kind, patch.empty() ? "no patch" : patch), {}, {}};
      ChartSeries washout = density;
      double left = count;
      for (std::size_t i = 0; i < histogram.size() && left > 0.0; ++i) {
        const double n = number(histogram[i]);
        density.x.push_back((static_cast<double>(i) + 0.5) * bin);
        density.y.push_back(n / (count * bin));
        washout.x.push_back(static_cast<double>(i) * bin);
        washout.y.push_back(left / count);
        left -= n;
      }
      densities.push_back(std::move(density));
      washouts.push_back(std::move(washout));
    }
  }
  if (densities.empty()) return {};
  return line_chart({.title = "Residence times", .x_label = "time in the scene (s)", .y_label = "density (1/s)"},
                    densities) +
         line_chart({.title = "Washout", .x_label = "time in the scene (s)", .y_label = "share that stays longer"},
                    washouts);
}

}  // namespace

std::string scene_name(const fs::path& folder) {
  const RunJson name = run_summary(folder).value("scene", RunJson());
  if (name.is_string() && !name.get<std::string>().empty()) return name.get<std::string>();
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

std::string run_charts(const fs::path& folder) {
  const RunJson summary = run_summary(folder);
  const Steps steps(folder / "stats.csv");
  const std::vector<double> time = steps["time"];
  std::string out;
  out += over_time("Particles", "particles", time,
                   {{"alive", steps["alive"]},
                    {"injected", summed(steps["injected"])},
                    {"escaped", summed(steps["escaped"])},
                    {"absorbed", summed(steps["absorbed"])},
                    {"held", steps["held"]}});
  out += over_time("Contacts", "contacts in a step", time, {{"contacts", steps["contacts"]}});
  out += bar_chart({.title = "Contacts by patch"},
                   bars_of(summary.value("/contacts/by_patch"_json_pointer, RunJson()), "", true));
  out += charts_of_residence(summary);
  const auto of_solids = [&](const char* table, const char* column) {
    return contacts_of_solids(folder / table, time.size(), column);
  };
  out += over_time("Contacts of bodies, catheters and solids", "contacts at the end of a step", time,
                   {{"bodies", of_solids("bodies.csv", "contacts")},
                    {"catheters", of_solids("catheters.csv", "at_walls")},
                    {"solids", of_solids("solids.csv", "contacts")}});
  const RunJson unit = summary.value("energy_unit", RunJson());
  out += over_time("Energy", unit.is_string() ? unit.get<std::string>() : "", time,
                   {{"kinetic", steps["kinetic_energy"]}, {"potential", steps["potential_energy"]}});
  return out;
}

std::string method_charts(const fs::path& folder) {
  const RunJson summary = run_summary(folder);
  const Steps steps(folder / "stats.csv");
  const std::vector<double> time = steps["time"];
  const std::vector<double> alive = steps["alive"];
  std::string out;
  out += histogram_of_tests(summary);
  out += over_time("Orientation tests over time", "tests per particle", time,
                   {{"all", ratio(steps["orientation_tests"], alive, 1.0)}});
  out += over_time("Forecasts kept", "% of particles", time,
                   {{"kept", ratio(steps["forecast_kept"], alive, 100.0)},
                    {"updated by deformation", ratio(steps["updated_by_deformation"], alive, 100.0)}});
  out += bar_chart({.title = "Seconds of the run, by part"}, bars_of(summary.value("seconds", RunJson()), " s"));
  return out;
}

}  // namespace dartcast
