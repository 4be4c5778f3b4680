// Draws charts: axes with round numbers, lines, bars.
#include "report/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

namespace dartcast {

namespace {

constexpr double chart_width = 520.0;
constexpr double chart_height = 280.0;
constexpr double chart_left = 62.0;
constexpr double chart_right = 508.0;
constexpr double chart_top = 34.0;
constexpr double chart_bottom = 232.0;
constexpr std::size_t most_points = 600;  // of a line: more than its pixels

std::string text(double x, double y, const char* anchor, std::string_view content, const char* kind = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" class=\"{}\">{}</text>", x, y, anchor, kind,
                     html(content));
}

// "1,200", "0.05", "2e-06".
std::string number(double v) {
  if (v == 0.0) return "0";
  const double size = std::abs(v);
  if (size < 1e-3 || size >= 1e9) return fmt::format("{:.3g}", v);
  if (size < 1e4) return fmt::format("{:.4g}", v);
  std::string digits = fmt::format("{:.0f}", v);
  for (std::size_t i = digits.size(); i > 3 + (v < 0 ? 1U : 0U); i -= 3) digits.insert(i - 3, ",");
  return digits;
}

// An axis: a range of values, where they lie on the page, and round numbers in it.
class Axis {
 public:
  Axis(double low, double high, bool log, double from, double to) : log_(log), from_(from), to_(to) {
    if (log_) {
      low_ = std::floor(std::log10(low));
      high_ = std::max(std::ceil(std::log10(high)), low_ + 1.0);
      for (double e = low_; e <= high_; ++e) ticks_.push_back(std::pow(10.0, e));
      return;
    }
    if (!(high > low)) high = low + std::max(std::abs(low) * 1e-3, 1e-12);
    const double rough = (high - low) / 5.0;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = power * (rough / power > 5.0   ? 10.0
                                 : rough / power > 2.0 ? 5.0
                                 : rough / power > 1.0 ? 2.0
                                                       : 1.0);
    low_ = std::floor(low / step) * step;
    high_ = std::ceil(high / step) * step;
    const auto count = static_cast<int>(std::lround((high_ - low_) / step));
    for (int i = 0; i <= count; ++i) ticks_.push_back(std::abs(low_ + i * step) < step * 1e-6 ? 0.0 : low_ + i * step);
  }

  [[nodiscard]] double at(double v) const {
    const double x = log_ ? std::log10(v) : v;
    return from_ + (to_ - from_) * std::clamp((x - low_) / (high_ - low_), 0.0, 1.0);
  }
  [[nodiscard]] const std::vector<double>& ticks() const { return ticks_; }

 private:
  bool log_;
  double from_;
  double to_;
  double low_ = 0.0;
  double high_ = 1.0;
  std::vector<double> ticks_;
};

std::string figure(const Chart& chart, double tall, const std::string& content) {
  return fmt::format(
      "<figure class=\"chart\"><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}{}</svg></figure>\n",
      chart_width, tall, html(chart.title), text(8.0, 18.0, "start", chart.title, "title"), content);
}

std::string grid(const Chart& chart, const Axis& x, const Axis& y) {
  std::string out;
  for (const double v : y.ticks()) {
    out += fmt::format("<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>", chart_left, y.at(v), chart_right);
    out += text(chart_left - 6.0, y.at(v) + 4.0, "end", number(v));
  }
  for (const double v : x.ticks()) {
    out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {}v4\"/>", x.at(v), chart_bottom);
    out += text(x.at(v), chart_bottom + 18.0, "middle", number(v));
  }
  out += fmt::format("<path class=\"axis\" d=\"M{} {}H{}\"/>", chart_left, chart_bottom, chart_right);
  out += text(chart_right, chart_bottom + 38.0, "end", chart.x_label);  // the legend stands on the left
  return out + text(chart_right, 18.0, "end", chart.y_label);
}

struct ChartRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

bool is_shown(const Chart& chart, double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && (!chart.log_x || x > 0.0) && (!chart.log_y || y > 0.0);
}

// The points of a line. If many lie in one place, the lowest and the highest are kept.
std::string path_of(const Chart& chart, const ChartSeries& s, const Axis& x, const Axis& y) {
  std::string path;
  const auto add = [&](std::size_t i) {
    if (is_shown(chart, s.x[i], s.y[i]))
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x.at(s.x[i]), y.at(s.y[i]));
  };
  const std::size_t n = std::min(s.x.size(), s.y.size());
  const std::size_t bucket = std::max<std::size_t>(2 * n / most_points, 1);
  for (std::size_t i = 0; i < n; i += bucket) {
    const auto begin = s.y.begin() + static_cast<std::ptrdiff_t>(i);
    const auto [low, high] =
        std::minmax_element(begin, s.y.begin() + static_cast<std::ptrdiff_t>(std::min(i + bucket, n)));
    const auto a = static_cast<std::size_t>(low - s.y.begin());
    const auto b = static_cast<std::size_t>(high - s.y.begin());
    add(std::min(a, b));
    if (a != b) add(std::max(a, b));
  }
  return path;
}

std::string legend(const std::vector<ChartSeries>& series) {
  std::string out;
  double x = chart_left;
  for (std::size_t i = 0; i < series.size(); ++i) {
    out += fmt::format("<path d=\"M{:.1f} {}h16\" stroke=\"var(--c{})\" stroke-width=\"3\"/>", x, chart_height - 7.0,
                       i % 8);
    out += text(x + 21.0, chart_height - 3.0, "start", series[i].name);
    x += 34.0 + 6.6 * static_cast<double>(series[i].name.size());
  }
  return out;
}

}  // namespace

std::string line_chart(const Chart& chart, const std::vector<ChartSeries>& series) {
  ChartRange xs;
  ChartRange ys;
  if (!chart.log_y) ys.add(0.0);
  for (const ChartSeries& s : series) {
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      if (!is_shown(chart, s.x[i], s.y[i])) continue;
      xs.add(s.x[i]);
      ys.add(s.y[i]);
    }
  }
  if (!(xs.low <= xs.high)) return {};
  const Axis x(xs.low, xs.high, chart.log_x, chart_left, chart_right);
  const Axis y(ys.low, ys.high, chart.log_y, chart_bottom, chart_top);
  std::string lines;
  for (std::size_t i = 0; i < series.size(); ++i) {
    lines +=
        fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"var(--c{})\" stroke-width=\"1.8\"><title>{}</title></path>",
                    path_of(chart, series[i], x, y), i % 8, html(series[i].name));
  }
  return figure(chart, chart_height, grid(chart, x, y) + lines + (series.size() > 1 ? legend(series) : std::string()));
}

std::string patch_colour(std::size_t patch) {
  if (patch == 0) return "var(--line)";
  static constexpr std::array<int, 8> order = {6, 0, 1, 2, 3, 4, 5, 7};
  const std::size_t round = (patch - 1) / order.size();
  const int colour = order[(patch - 1) % order.size()];
  const int other = order[(patch - 1 + 5 * round) % order.size()];
  if (colour == other) return fmt::format("var(--c{})", colour);
  return fmt::format("color-mix(in srgb,var(--c{}) 75%,var(--c{}))", colour, other);
}

std::string bar_chart(const Chart& chart, const std::vector<Bar>& bars) {
  constexpr double row = 24.0;
  constexpr double names = 150.0;
  constexpr double values = 110.0;
  double most = 0.0;
  for (const Bar& b : bars) most = std::max(most, b.value);
  std::string out;
  double y = 34.0;
  for (const Bar& b : bars) {
    const double length = most > 0.0 ? (chart_width - names - values) * b.value / most : 0.0;
    out += text(names - 8.0, y + 15.0, "end", b.name.size() > 22 ? b.name.substr(0, 21) + "…" : b.name);
    out += fmt::format(
        "<rect x=\"{}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"16\" fill=\"{}\"><title>{}</title></rect>", names,
        y + 2.0, std::max(length, b.value > 0.0 ? 1.0 : 0.0), b.colour, html(b.name + ": " + b.label));
    out += text(names + length + 7.0, y + 15.0, "start", b.label);
    y += row;
  }
  return bars.empty() ? std::string() : figure(chart, y + 8.0, out);
}

std::string histogram_chart(const Chart& chart, std::size_t first, const std::vector<double>& values) {
  if (values.empty()) return {};
  const double most = *std::max_element(values.begin(), values.end());
  const auto begin = static_cast<double>(first);
  const Axis x(begin, begin + static_cast<double>(values.size()) - 0.5, false, chart_left, chart_right);
  const Axis y(0.0, most, false, chart_bottom, chart_top);
  std::string out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > 0.0)) continue;
    const double at = begin + static_cast<double>(i);
    const double high = std::min(y.at(values[i]), chart_bottom - 1.0);
    out += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"var(--c0)\"><title>{}: "
        "{}</title></rect>",
        x.at(at - 0.4), high, x.at(at + 0.4) - x.at(at - 0.4), chart_bottom - high, number(at), number(values[i]));
  }
  return figure(chart, chart_height, grid(chart, x, y) + out);
}

}  // namespace dartcast
