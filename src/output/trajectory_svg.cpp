// A trajectory as a drawing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/trajectory.hpp"

namespace dartcast {

namespace {

constexpr double longer_side = 800.0;  // pixels
constexpr double margin_share = 0.08;  // of the longer side of the cells passed
constexpr double dot_radius = 3.0;
constexpr double end_radius = 5.0;
constexpr double letter_offset = 6.0;

constexpr std::string_view svg_style =
    "<style>path{stroke:#999;stroke-width:.7;stroke-linejoin:round}.free{fill:#fff}.passed{fill:#fff3d0}"
    ".blocked{fill:#c4c4c4}polyline{fill:none;stroke-width:2;stroke-linejoin:round}.odd{stroke:#c2410c}"
    ".even{stroke:#1d4ed8}.contact{fill:none;stroke:#b91c1c;stroke-width:2}circle{stroke:#111}.dot{fill:#111}"
    ".start{fill:#fff}.end{fill:#111}text{font:italic 15px serif;fill:#111;stroke:#fff;stroke-width:3;"
    "paint-order:stroke}</style>\n";

// Each once, ascending.
std::vector<Cell> cells_passed(std::span<const TrajectoryPoint> points) {
  std::vector<Cell> cells;
  for (const TrajectoryPoint& p : points) {
    cells.push_back(p.cell);
    if (p.next.valid()) cells.push_back(p.next);
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

// The part of the plane that is drawn, y upwards.
class SvgView {
 public:
  void include(const Vec3& p) {
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), 0.0};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), 0.0};
  }
  void widen() {
    const double margin = margin_share * std::max(high_.x - low_.x, high_.y - low_.y);
    low_ -= Vec3{margin, margin, 0.0};
    high_ += Vec3{margin, margin, 0.0};
  }
  [[nodiscard]] bool overlaps(const SvgView& b) const {
    return low_.x <= b.high_.x && b.low_.x <= high_.x && low_.y <= b.high_.y && b.low_.y <= high_.y;
  }

  // Pixels, `shift` of them beside p.
  [[nodiscard]] double x(const Vec3& p, double shift = 0.0) const { return rounded((p.x - low_.x) * scale() + shift); }
  [[nodiscard]] double y(const Vec3& p, double shift = 0.0) const { return rounded((high_.y - p.y) * scale() + shift); }
  [[nodiscard]] double width() const { return x(high_); }
  [[nodiscard]] double height() const { return y(low_); }

 private:
  [[nodiscard]] double scale() const { return longer_side / std::max(high_.x - low_.x, high_.y - low_.y); }
  static double rounded(double pixels) { return std::round(100.0 * pixels) / 100.0 + 0.0; }  // no -0

  Vec3 low_ = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), 0.0};
  Vec3 high_ = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0.0};
};

// The corners of a polygon, counterclockwise.
std::vector<Vec3> outline_of(const CellComplex& complex, Cell cell) {
  const CellView view = complex.map().view(cell);
  std::vector<Vec3> corners;
  for (std::uint16_t d = 0; d < view.shape().dart_count(); ++d)
    corners.push_back(complex.positions()[view.vertex(view.shape().origin(d)).value]);
  return corners;
}

SvgView svg_box_of(std::span<const Vec3> points) {
  SvgView box;
  for (const Vec3& p : points) box.include(p);
  return box;
}

SvgView view_of(const CellComplex& complex, std::span<const Cell> passed, std::span<const TrajectoryPoint> points) {
  SvgView view;
  for (const Cell cell : passed) {
    for (const Vec3& corner : outline_of(complex, cell)) view.include(corner);
  }
  for (const TrajectoryPoint& p : points) view.include(p.point);
  view.widen();
  return view;
}

void add_outlines(const CellComplex& complex, const SvgView& view, std::span<const Cell> passed, std::string& svg) {
  std::string free, blocked, on_the_way;
  for (const Cell cell : complex.map().cells()) {
    const std::vector<Vec3> outline = outline_of(complex, cell);
    if (!std::all_of(outline.begin(), outline.end(), is_finite) || !view.overlaps(svg_box_of(outline))) continue;
    std::string& path = std::binary_search(passed.begin(), passed.end(), cell) ? on_the_way
                        : complex.map().is_free(cell)                          ? free
                                                                               : blocked;
    char command = 'M';
    for (const Vec3& p : outline) {
      path += fmt::format("{}{} {}", command, view.x(p), view.y(p));
      command = 'L';
    }
    path += "Z";
  }
  svg += fmt::format("<path class=\"free\" d=\"{}\"/>\n<path class=\"passed\" d=\"{}\"/>\n", free, on_the_way);
  svg += fmt::format("<path class=\"blocked\" d=\"{}\"/>\n", blocked);
}

// A polyline between every two crossings, with bends at contacts and targets.
void add_pieces(const SvgView& view, std::span<const TrajectoryPoint> points, std::string& svg) {
  bool odd = true;
  std::string piece;
  const auto end_piece = [&] {
    svg += fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", odd ? "odd" : "even", piece);
    odd = !odd;
    piece.clear();
  };
  for (const TrajectoryPoint& p : points) {
    const std::string at = fmt::format("{},{}", view.x(p.point), view.y(p.point));
    piece += fmt::format("{}{}", piece.empty() ? "" : " ", at);
    if (p.mark != TrajectoryMark::crossing) continue;
    end_piece();
    piece = at;
  }
  end_piece();
}

void add_mark(const CombinatorialMap& map, const SvgView& view, const TrajectoryPoint& p, std::string& svg) {
  svg += fmt::format("<g><title>step {}, t = {}: {}, {}, cell {}", p.step + 1, p.time, name_of(p.mark), name_of(p.kind),
                     map.source(p.cell));
  if (p.next.valid()) svg += fmt::format(" to {}", map.source(p.next));
  svg += "</title>";
  if (p.mark == TrajectoryMark::contact) {
    svg += fmt::format("<path class=\"contact\" d=\"M{} {}l16 16m0 -16l-16 16\"/></g>\n", view.x(p.point, -8.0),
                       view.y(p.point, -8.0));
    return;
  }
  const bool inner = p.mark == TrajectoryMark::crossing || p.mark == TrajectoryMark::target;
  svg += fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>", inner ? "dot" : name_of(p.mark),
                     view.x(p.point), view.y(p.point), inner ? dot_radius : end_radius);
  svg += fmt::format("<text x=\"{}\" y=\"{}\">{}</text></g>\n", view.x(p.point, letter_offset),
                     view.y(p.point, -letter_offset), name_of(p.kind).substr(0, 1));
}

}  // namespace

std::string trajectory_svg(const CellComplex& complex, std::span<const Trace> traces) {
  if (complex.map().dimension() != 2)
    throw InvalidArgument("a trajectory in space cannot be drawn as SVG: write it as .csv instead");
  if (traces.empty()) throw InvalidArgument("there is no trajectory to draw: give it one target or more");
  const std::vector<TrajectoryPoint> points = trajectory_points(traces);
  const std::vector<Cell> passed = cells_passed(points);
  const SvgView view = view_of(complex, passed, points);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<title>A trajectory, cut where it passes from cell to cell</title>\n",
      view.width(), view.height());
  svg += svg_style;
  add_outlines(complex, view, passed, svg);
  add_pieces(view, points, svg);
  for (const TrajectoryPoint& p : points) add_mark(complex.map(), view, p, svg);
  return svg + "</svg>\n";
}

}  // namespace dartcast
