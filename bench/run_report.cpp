// The time of runs by part: as a table, as JSON, and as a waterfall.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/run_parts.hpp"
#include "bench/svg.hpp"

namespace dartcast::bench {

namespace {

const char* title_of(const RunPairs& pairs) { return pairs.output ? "with output" : "without output"; }

std::string line_of(const RunPairs& pairs, const std::string& part) {
  const double own = median_seconds(pairs.own, part);
  const double share = own / median_seconds(pairs.own, "wall");
  std::string out =
      fmt::format("{:<12}{:>9.3f}{:>8}", part, own, part == "processor" ? "" : fmt::format("{:.0f}%", 100.0 * share));
  if (pairs.other.empty()) return out + "\n";
  out += fmt::format("{:>12.3f}", median_seconds(pairs.other, part));
  const auto ratio = median_ratio(pairs, part);
  return out + fmt::format("{:>8}\n", ratio ? fmt::format("{:.2f}", *ratio) : "");
}

}  // namespace

std::string runs_text(std::span<const RunPairs> runs) {
  const RunSample& first = runs.front().own.front();
  std::string out = fmt::format("{}: {} steps, {} threads, medians of {} runs, seconds\n", first.scene, first.steps,
                                first.threads, runs.front().own.size());
  for (const RunPairs& pairs : runs) {
    out += fmt::format("\n{}\n{:<12}{:>9}{:>8}", title_of(pairs), "part", first.version, "share");
    if (!pairs.other.empty()) out += fmt::format("{:>12}{:>8}", pairs.other.front().version, "ratio");
    out += "\n";
    for (const std::string& part : pairs.parts()) out += line_of(pairs, part);
    out += line_of(pairs, "wall") + line_of(pairs, "processor");
  }
  return out;
}

namespace {

nlohmann::ordered_json medians(std::span<const RunSample> samples, const std::vector<std::string>& parts) {
  nlohmann::ordered_json json = {{"version", samples.front().version},
                                 {"wall", median_seconds(samples, "wall")},
                                 {"processor", median_seconds(samples, "processor")},
                                 {"parts", nlohmann::ordered_json::object()},
                                 {"state_hash", samples.front().state_hash}};
  for (const std::string& part : parts) json["parts"][part] = median_seconds(samples, part);
  return json;
}

nlohmann::ordered_json pairs_json(const RunPairs& pairs) {
  std::vector<std::string> parts = pairs.parts();
  nlohmann::ordered_json json = {{"own", medians(pairs.own, parts)}};
  if (pairs.other.empty()) return json;
  json["against"] = medians(pairs.other, parts);
  json["ratio"] = nlohmann::ordered_json::object();
  parts.insert(parts.begin(), {"wall", "processor"});
  for (const std::string& part : parts) {
    if (const auto ratio = median_ratio(pairs, part)) json["ratio"][part] = *ratio;
  }
  return json;
}

}  // namespace

std::string runs_json(std::span<const RunPairs> runs) {
  const RunSample& first = runs.front().own.front();
  nlohmann::ordered_json json = {{"version", DARTCAST_VERSION},
                                 {"scene", first.scene},
                                 {"steps", first.steps},
                                 {"threads", first.threads},
                                 {"runs", runs.front().own.size()}};
  for (const RunPairs& pairs : runs) json[pairs.output ? "with_output" : "without_output"] = pairs_json(pairs);
  return json.dump(1);
}

namespace {

constexpr double row_height = 24.0;
constexpr double bars_left = 110.0;
constexpr double bars_width = 560.0;
constexpr const char* own_colour = "#c1272d";
constexpr const char* other_colour = "#9a9a9a";

// The bars of one command, below `top`: each starts where the one before it ended.
std::string waterfall_bars(std::span<const RunSample> samples, const std::vector<std::string>& parts, double top,
                           double width_of_second, double bar, const char* colour) {
  std::string out;
  double y = top;
  double start = bars_left;
  for (const std::string& part : parts) {
    const double seconds = median_seconds(samples, part);
    const double width = seconds * width_of_second;
    out += svg::rectangle(start, y, std::max(1.0, width), bar, colour);
    out += svg::text(start + width + 6, y + bar - 1, "start",
                     fmt::format("<tspan font-size=\"11\" fill=\"{}\">{:.2f}</tspan>", colour, seconds));
    start += width;
    y += row_height;
  }
  return out;
}

std::string waterfall(const RunPairs& pairs, double top, double width_of_second) {
  const std::vector<std::string> parts = pairs.parts();
  std::string out = svg::text(20, top - 12, "start",
                              fmt::format("{}: {:.2f} s", title_of(pairs), median_seconds(pairs.own, "wall")) +
                                  (pairs.other.empty() ? std::string()
                                                       : fmt::format(" ({}: {:.2f} s)", pairs.other.front().version,
                                                                     median_seconds(pairs.other, "wall"))));
  const double bar = pairs.other.empty() ? 16.0 : 9.0;
  out += waterfall_bars(pairs.own, parts, top, width_of_second, bar, own_colour);
  if (!pairs.other.empty())
    out += waterfall_bars(pairs.other, parts, top + bar + 1, width_of_second, bar, other_colour);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double y = top + row_height * static_cast<double>(i);
    out += svg::text(bars_left - 10, y + 14, "end", svg::escaped(parts[i]));
  }
  return out;
}

}  // namespace

std::string runs_svg(std::span<const RunPairs> runs) {
  double longest = 0.0;
  for (const RunPairs& pairs : runs) {
    for (const std::vector<RunSample>* samples : {&pairs.own, &pairs.other}) {
      if (!samples->empty()) longest = std::max(longest, median_seconds(*samples, "wall"));
    }
  }
  const RunSample& first = runs.front().own.front();
  std::string content = svg::text(20, 30, "start",
                                  fmt::format("{}, {} steps, {} threads: seconds of a run by part (red: {})",
                                              svg::escaped(first.scene), first.steps, first.threads, first.version));
  double top = 84.0;
  for (const RunPairs& pairs : runs) {
    content += waterfall(pairs, top, bars_width / longest);
    top += row_height * static_cast<double>(pairs.parts().size()) + 50.0;
  }
  return svg::page(760, top - 30, content);
}

}  // namespace dartcast::bench
