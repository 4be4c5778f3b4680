#include "bench/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/svg.hpp"

namespace dartcast::bench {

namespace {

constexpr svg::Frame chart_frame = {860, 560, 80, 640, 56, 490};

struct Style {
  const char* name;
  const char* label;
  const char* colour;
};
constexpr std::array<Style, 5> styles = {{{"dartcast", "dartcast", "#c1272d"},
                                          {"bullet", "Bullet", "#1f6fb4"},
                                          {"embree_single", "Embree, single", "#2a8a4a"},
                                          {"embree_packet", "Embree, packets of 16", "#8a5fb0"},
                                          {"paper", "the paper's scheme", "#7a7a7a"}}};

struct Point {
  double cells;
  double ns;
};

// Decades of the axes, and where values lie on the page.
struct Axes {
  int x_low = 3, x_high = 7;
  int y_low = 1, y_high = 3;

  [[nodiscard]] double x(double cells) const {
    return chart_frame.left + (chart_frame.right - chart_frame.left) * (std::log10(cells) - x_low) / (x_high - x_low);
  }
  [[nodiscard]] double y(double ns) const {
    return chart_frame.bottom - (chart_frame.bottom - chart_frame.top) * (std::log10(ns) - y_low) / (y_high - y_low);
  }
};

// The content of a drawing.
struct Content {
  const char* still;   // workloads
  const char* moving;  // may have the same name
  const char* title;
  const char* unit;  // of the axis below
  int x_high;
};
constexpr Content in_space = {"W1", "W2",
                              "1,000 particles in a box of n hexahedra, a tenth of a cell a step, one thread",
                              "cells of the scene", 7};
constexpr Content in_plane = {"W6", "W6", "1,000 particles among n squares, a tenth of a square a step, one thread",
                              "faces of the scene", 6};

std::vector<Point> points_of(std::span<const Row> rows, const Content& content, bool deforms, const char* name) {
  const char* workload = deforms ? content.moving : content.still;
  std::vector<Point> points;
  for (const Row& row : rows) {
    const Series* series = row.series(name);
    if (row.workload.name != workload || row.workload.deforms != deforms) continue;
    if (row.workload.particles != 1000 || series == nullptr) continue;
    points.push_back({static_cast<double>(row.cells), series->ns_per_particle_step(row.workload.particles)});
  }
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.cells < b.cells; });
  return points;
}

Axes axes_for(std::span<const Row> rows, const Content& content) {
  Axes axes;
  axes.x_high = content.x_high;
  for (const Style& style : styles) {
    for (const bool deforms : {false, true}) {
      for (const Point& p : points_of(rows, content, deforms, style.name)) {
        axes.y_low = std::min(axes.y_low, static_cast<int>(std::floor(std::log10(p.ns))));
        axes.y_high = std::max(axes.y_high, static_cast<int>(std::ceil(std::log10(p.ns))));
      }
    }
  }
  return axes;
}

std::string power(int exponent) { return fmt::format("10<tspan dy=\"-6\" font-size=\"10\">{}</tspan>", exponent); }

std::string grid(const Axes& axes, const char* unit) {
  std::string out;
  for (int e = axes.x_low; e <= axes.x_high; ++e) {
    const double x = axes.x(std::pow(10.0, e));
    out += svg::line(x, chart_frame.top, x, chart_frame.bottom, "#d0d0d0") +
           svg::text(x, chart_frame.bottom + 22, "middle", power(e));
  }
  for (int e = axes.y_low; e <= axes.y_high; ++e) {
    const double y = axes.y(std::pow(10.0, e));
    out += svg::line(chart_frame.left, y, chart_frame.right, y, "#d0d0d0") +
           svg::text(chart_frame.left - 10, y + 5, "end", power(e));
    for (int k = 2; k < 10 && e < axes.y_high; ++k) {
      const double minor = axes.y(k * std::pow(10.0, e));
      out += svg::line(chart_frame.left, minor, chart_frame.right, minor, "#f0f0f0");
    }
  }
  out += svg::text((chart_frame.left + chart_frame.right) / 2, chart_frame.bottom + 52, "middle", unit);
  out += fmt::format(
      "<text transform=\"translate(24 {:.1f}) rotate(-90)\" text-anchor=\"middle\">"
      "ns per particle-step</text>\n",
      (chart_frame.top + chart_frame.bottom) / 2);
  return out;
}

std::string curve(const Axes& axes, const std::vector<Point>& points, const Style& style, bool deforms) {
  std::string path;
  std::string marks;
  for (const Point& p : points) {
    path += fmt::format("{:.1f},{:.1f} ", axes.x(p.cells), axes.y(p.ns));
    marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" stroke=\"{}\" stroke-width=\"2\"/>\n",
                         axes.x(p.cells), axes.y(p.ns), deforms ? "white" : style.colour, style.colour);
  }
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", path, style.colour,
                     deforms ? " stroke-dasharray=\"7 4\"" : "") +
         marks;
}

std::string legend(const std::vector<Style>& shown) {
  std::string out;
  double y = chart_frame.top + 16;
  for (const Style& style : shown) {
    out += svg::rectangle(chart_frame.right + 24, y - 10, 22, 10, style.colour);
    out += svg::text(chart_frame.right + 54, y, "start", style.label);
    y += 24;
  }
  y += 8;
  for (const bool deforms : {false, true}) {
    out += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#222\" stroke-width=\"2\"{}/>\n",
        chart_frame.right + 20, y - 5, chart_frame.right + 50, y - 5, deforms ? " stroke-dasharray=\"7 4\"" : "");
    out += svg::text(chart_frame.right + 54, y, "start", deforms ? "every vertex moving" : "standing still");
    y += 24;
  }
  return out;
}

std::string draw(std::span<const Row> rows, const Content& content) {
  const Axes axes = axes_for(rows, content);
  std::string curves;
  std::vector<Style> shown;
  for (const Style& style : styles) {
    const std::vector<Point> still = points_of(rows, content, false, style.name);
    const std::vector<Point> moving = points_of(rows, content, true, style.name);
    if (still.empty() && moving.empty()) continue;
    shown.push_back(style);
    curves += curve(axes, still, style, false) + curve(axes, moving, style, true);
  }
  return svg::page(
      chart_frame.width, chart_frame.height,
      svg::text(chart_frame.left, 32, "start", content.title) + grid(axes, content.unit) + curves + legend(shown));
}

}  // namespace

std::string chart_svg(std::span<const Row> rows) { return draw(rows, in_space); }
std::string plane_chart_svg(std::span<const Row> rows) { return draw(rows, in_plane); }

}  // namespace dartcast::bench
