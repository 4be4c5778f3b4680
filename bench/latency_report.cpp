// Latencies as a table, as JSON, and as a drawing.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/latency.hpp"
#include "bench/svg.hpp"

namespace dartcast::bench {

namespace {

double bound_of(bool cut) { return cut ? Latency::cut_bound : Latency::bound; }

nlohmann::ordered_json latency_figures(const Latency& latency, bool cut) {
  return {{"count", latency.count(cut)},
          {"median_ms", latency.quantile(cut, 0.5)},
          {"p999_ms", latency.quantile(cut, 0.999)},
          {"longest_ms", latency.quantile(cut, 1.0)},
          {"longest_step", latency.longest_step(cut)},
          {"bound_ms", bound_of(cut)},
          {"over_bound", latency.over_bound(cut)}};
}

}  // namespace

std::string latency_text(const Latency& latency) {
  std::string out = fmt::format(
      "a vessel of {} cells that deforms, {} particles, a catheter, a body; one thread; ms of processor time\n\n"
      "{:<15} {:>7} {:>8} {:>8} {:>8} {:>6} {:>6}\n",
      latency.cells, latency.particles, "", "count", "median", "99.9%", "longest", "bound", "over");
  for (const bool cut : {false, true}) {
    out +=
        fmt::format("{:<15} {:>7} {:>8.2f} {:>8.2f} {:>8.2f} {:>6.0f} {:>6}\n", cut ? "steps with cuts" : "other steps",
                    latency.count(cut), latency.quantile(cut, 0.5), latency.quantile(cut, 0.999),
                    latency.quantile(cut, 1.0), bound_of(cut), latency.over_bound(cut));
  }
  return out + fmt::format("a cut replaces {} cells\nbounds: {}\n", latency.cells_replaced,
                           latency.kept() ? "kept" : "not kept");
}

std::string latency_json(const Latency& latency) {
  nlohmann::ordered_json json = {{"version", DARTCAST_VERSION},
                                 {"cells", latency.cells},
                                 {"particles", latency.particles},
                                 {"cells_replaced_by_a_cut", latency.cells_replaced},
                                 {"steps", latency_figures(latency, false)},
                                 {"cuts", latency_figures(latency, true)},
                                 {"kept", latency.kept()}};
  json["cuts"]["ms"] = nlohmann::ordered_json::array();
  for (const StepTime& step : latency.steps) {
    if (step.cut) json["cuts"]["ms"].push_back(step.ms);
  }
  return json.dump(1);
}

namespace {

constexpr svg::Frame latency_frame = {860, 400, 70, 820, 60, 340};

// Times on a logarithmic axis, steps on a linear one.
struct LatencyAxes {
  double low = 0.1;
  double high = 20.0;
  std::size_t steps = 1;

  [[nodiscard]] double x(std::size_t step) const {
    return latency_frame.left +
           (latency_frame.right - latency_frame.left) * static_cast<double>(step) / static_cast<double>(steps);
  }
  [[nodiscard]] double y(double ms) const {
    const double share = std::log(std::max(ms, low) / low) / std::log(high / low);
    return latency_frame.bottom - (latency_frame.bottom - latency_frame.top) * share;
  }
};

LatencyAxes axes_for(const Latency& latency) {
  LatencyAxes axes;
  axes.steps = std::max<std::size_t>(1, latency.steps.size());
  for (const StepTime& step : latency.steps) axes.high = std::max(axes.high, 1.2 * step.ms);
  return axes;
}

std::string grid(const LatencyAxes& axes) {
  std::string out;
  for (const double ms : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
    if (ms > axes.high) continue;
    const bool is_bound = ms == Latency::bound || ms == Latency::cut_bound;
    out += svg::line(latency_frame.left, axes.y(ms), latency_frame.right, axes.y(ms), is_bound ? "#888888" : "#e4e4e4");
    out += svg::text(latency_frame.left - 8, axes.y(ms) + 5, "end", fmt::format("{}", ms));
  }
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const auto step = static_cast<std::size_t>(share * static_cast<double>(axes.steps));
    out += svg::text(axes.x(step), latency_frame.bottom + 22, "middle", fmt::format("{}", step));
  }
  return out + svg::text((latency_frame.left + latency_frame.right) / 2, latency_frame.bottom + 44, "middle", "step");
}

// A bar for each column of pixels: from the shortest of its steps to the longest.
std::string bars(const Latency& latency, const LatencyAxes& axes) {
  constexpr std::size_t columns = 375;
  std::string out;
  const std::size_t count = latency.steps.size();
  for (std::size_t i = 0; i < columns; ++i) {
    double shortest = INFINITY;
    double longest = 0.0;
    for (std::size_t k = i * count / columns; k < (i + 1) * count / columns; ++k) {
      if (latency.steps[k].cut) continue;
      shortest = std::min(shortest, latency.steps[k].ms);
      longest = std::max(longest, latency.steps[k].ms);
    }
    if (longest == 0.0) continue;
    const double high = axes.y(longest);
    out += svg::rectangle(axes.x(i * count / columns), high, 2.0, std::max(1.0, axes.y(shortest) - high), "#1f6fb4");
  }
  return out;
}

std::string cuts(const Latency& latency, const LatencyAxes& axes) {
  std::string out;
  for (std::size_t i = 0; i < latency.steps.size(); ++i) {
    if (!latency.steps[i].cut) continue;
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"#c1272d\"/>\n", axes.x(i),
                       axes.y(latency.steps[i].ms));
  }
  return out;
}

}  // namespace

std::string latency_svg(const Latency& latency) {
  const LatencyAxes axes = axes_for(latency);
  return svg::page(
      latency_frame.width, latency_frame.height,
      svg::text(latency_frame.left, 32, "start", "ms of a step; red: with a cut; grey: the bounds of 5 and 10 ms") +
          grid(axes) + bars(latency, axes) + cuts(latency, axes));
}

}  // namespace dartcast::bench
