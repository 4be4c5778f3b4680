// Draws a frame as SVG, in a parallel projection.
#include "report/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

namespace dartcast {

namespace {

constexpr double picture_width = 800.0;
constexpr double picture_height = 480.0;
constexpr double picture_margin = 12.0;
constexpr std::size_t most_particles = 1000;
constexpr std::size_t most_edges = 6000;

using PicturePoint = std::array<double, 2>;

PicturePoint projected(const RecordedPoint& p, std::uint32_t dimension) {
  const double x = p[0];
  const double y = p[1];
  const double z = p[2];
  if (dimension == 2) return {x, -y};
  return {0.82 * x + 0.57 * y, 0.24 * x - 0.34 * y - 0.91 * z};  // from the side, and from above a little
}

// From projected coordinates to the page.
struct PageFit {
  double scale = 1.0;
  PicturePoint offset{};

  [[nodiscard]] PicturePoint operator()(const PicturePoint& p) const {
    return {p[0] * scale + offset[0], p[1] * scale + offset[1]};
  }
};

PageFit fit_of(const std::vector<PicturePoint>& points) {
  if (points.empty()) return {};
  PicturePoint low = points.front();
  PicturePoint high = low;
  for (const PicturePoint& p : points) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  const double size_x = std::max(high[0] - low[0], 1e-300);
  const double size_y = std::max(high[1] - low[1], 1e-300);
  const double scale =
      std::min((picture_width - 2.0 * picture_margin) / size_x, (picture_height - 2.0 * picture_margin) / size_y);
  return {scale,
          {0.5 * (picture_width - scale * (low[0] + high[0])), 0.5 * (picture_height - scale * (low[1] + high[1]))}};
}

}  // namespace

std::string picture_of(const RecordedFrame& frame, const RecordedWalls& walls, std::uint32_t dimension) {
  const std::vector<RecordedPoint>& wall_points = frame.wall_points.empty() ? walls.points : frame.wall_points;
  std::vector<PicturePoint> points;
  for (const auto* list : {&wall_points, &frame.positions}) {
    for (const RecordedPoint& p : *list) points.push_back(projected(p, dimension));
  }
  const PageFit fit = fit_of(points);
  std::string path;
  const std::size_t faces = walls.patches.size();
  const std::size_t step = std::max<std::size_t>(walls.corners.size() / most_edges, 1);
  for (std::size_t f = 0; f < faces; f += step) {
    const std::size_t first = walls.offsets[f];
    const std::size_t n = walls.offsets[f + 1] - first;
    for (std::size_t k = 0; k < n; ++k) {
      const PicturePoint p = fit(projected(wall_points[walls.corners[first + k]], dimension));
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", k == 0 ? 'M' : 'L', p[0], p[1]);
    }
    if (n > 2) path += 'Z';
  }
  std::string dots;
  for (std::size_t i = 0; i < frame.positions.size();
       i += std::max<std::size_t>(frame.positions.size() / most_particles, 1)) {
    const PicturePoint p = fit(projected(frame.positions[i], dimension));
    fmt::format_to(std::back_inserter(dots), "M{:.1f} {:.1f}h0", p[0], p[1]);
  }
  return fmt::format(
      "<svg class=\"picture\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"The scene at the start\"><path d=\"{}\" "
      "fill=\"none\" stroke=\"var(--line)\" stroke-width=\"0.6\"/><path d=\"{}\" stroke=\"var(--c0)\" "
      "stroke-width=\"3\" "
      "stroke-linecap=\"round\"/></svg>",
      picture_width, picture_height, path, dots);
}

}  // namespace dartcast
