// Divides a plane domain between rings into triangles or convex cells.
#include "dartcast/decompose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <tuple>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "mesh/merge_convex.hpp"
#include "mesh/planar_triangulation.hpp"
#include "mesh/polyhedron.hpp"

namespace dartcast {
namespace {

using detail::PlanarTriangulation;
constexpr std::uint32_t none = PlanarTriangulation::none;
constexpr std::int32_t inside_tag = 1;
constexpr std::int32_t outside_tag = 2;

void check(const DecomposeOptions& o) {
  if (!(std::isfinite(o.margin) && o.margin > 0)) {
    throw InvalidArgument(fmt::format("decompose: margin is {}; it must be a positive number", o.margin));
  }
  if (o.max_corners < 3 || o.max_corners > polyhedron_limit) {
    throw InvalidArgument(
        fmt::format("decompose: max_corners is {}; it must be 3 to {}", o.max_corners, polyhedron_limit));
  }
}

/// The points of all rings, one ring after another. Edge i starts at point i.
class Drawing {
 public:
  explicit Drawing(std::span<const Ring> rings) : rings_(rings) {
    for (const Ring& ring : rings) {
      std::transform(ring.points.begin(), ring.points.end(), std::back_inserter(points_), flushed);
      ends_.push_back(points_.size());
      if (points_.size() >= std::size_t{1} << 28U) throw InvalidArgument("decompose: 2^28 points or more");
    }
    if (rings.empty()) throw InvalidArgument("decompose: no rings");
  }

  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(points_.size()); }
  [[nodiscard]] std::size_t ring_of(std::uint32_t point) const {
    return static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), point) - ends_.begin());
  }
  [[nodiscard]] std::uint32_t first_of(std::size_t ring) const {
    return ring == 0 ? 0 : static_cast<std::uint32_t>(ends_[ring - 1]);
  }
  [[nodiscard]] std::uint32_t end_of(std::size_t ring) const { return static_cast<std::uint32_t>(ends_[ring]); }

  /// Calls visit(edge, its end, ring) for all edges.
  template <class Visit>
  void for_each_edge(Visit&& visit) const {
    for (std::size_t r = 0; r < rings_.size(); ++r) {
      for (std::uint32_t p = first_of(r); p < end_of(r); ++p) {
        visit(p, p + 1 < end_of(r) ? p + 1 : first_of(r), r);
      }
    }
  }

  [[nodiscard]] std::string ring_name(std::size_t ring) const {
    const std::string& name = rings_[ring].name;
    return name.empty() ? fmt::format("ring {}", ring) : fmt::format("ring {} (\"{}\")", ring, name);
  }
  [[nodiscard]] std::string point_name(std::uint32_t point) const {
    const std::size_t ring = ring_of(point);
    const Vec3& p = points_[point];
    return fmt::format("point {} ({}, {}) of {}", point - first_of(ring), p.x, p.y, ring_name(ring));
  }
  [[nodiscard]] std::string edge_name(std::uint32_t edge) const {
    const std::size_t ring = ring_of(edge);
    const std::uint32_t first = first_of(ring);
    const std::uint32_t end = edge + 1 < end_of(ring) ? edge + 1 : first;
    const Vec3& p = points_[edge];
    const Vec3& q = points_[end];
    return fmt::format("the edge from point {} ({}, {}) to point {} ({}, {}) of {}", edge - first, p.x, p.y,
                       end - first, q.x, q.y, ring_name(ring));
  }

 private:
  std::span<const Ring> rings_;
  std::vector<Vec3> points_;
  std::vector<std::size_t> ends_;
};

void check_points(const Drawing& drawing, std::size_t rings) {
  for (std::size_t r = 0; r < rings; ++r) {
    const std::uint32_t n = drawing.end_of(r) - drawing.first_of(r);
    if (n >= 3) continue;
    throw InvalidMesh(fmt::format("decompose: {} has {} points; it must have 3 or more", drawing.ring_name(r), n));
  }
  for (std::uint32_t i = 0; i < drawing.count(); ++i) {
    const Vec3& p = drawing.points()[i];
    if (!is_finite(p)) throw InvalidMesh(fmt::format("decompose: {} is not finite", drawing.point_name(i)));
    if (p.z != 0.0) {
      throw InvalidMesh(fmt::format("decompose: {} has z = {}; it must be 0", drawing.point_name(i), p.z));
    }
    if (in_exact_range(p)) continue;
    throw InvalidMesh(
        fmt::format("decompose: {} has a coordinate above 2^300: scale the drawing", drawing.point_name(i)));
  }
}

void check_repeats(const Drawing& drawing) {
  const auto& points = drawing.points();
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(points[a].x, points[a].y, a) < std::tie(points[b].x, points[b].y, b);
  });
  const auto twice = std::adjacent_find(order.begin(), order.end(),
                                        [&](std::uint32_t a, std::uint32_t b) { return points[a] == points[b]; });
  if (twice == order.end()) return;
  const std::size_t ring = drawing.ring_of(twice[1]);
  const bool closes = twice[0] == drawing.first_of(ring) && twice[1] + 1 == drawing.end_of(ring);
  throw InvalidMesh(fmt::format(
      "decompose: {} repeats {}; {}", drawing.point_name(twice[1]), drawing.point_name(twice[0]),
      closes ? "a ring closes by itself: leave its last point out" : "rings may not share points, nor pass one twice"));
}

/// The points of the drawing and the corners of a rectangle around them.
std::vector<Vec3> frame(const Drawing& drawing, double margin) {
  std::vector<Vec3> points = drawing.points();
  const auto [left, right] =
      std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto [lowest, highest] =
      std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.y < b.y; });
  const Vec3 low = {left->x, lowest->y, 0.0};
  const Vec3 high = {right->x, highest->y, 0.0};
  const double reach = margin * std::max(high.x - low.x, high.y - low.y);
  const Vec3 a = {low.x - reach, low.y - reach, 0.0};
  const Vec3 b = {high.x + reach, high.y + reach, 0.0};
  if (!(a.x < low.x && a.y < low.y && b.x > high.x && b.y > high.y)) {
    throw InvalidArgument(fmt::format(
        "decompose: margin {} is lost in the rounding of the drawing's coordinates: give a larger one", margin));
  }
  if (!in_exact_range(a) || !in_exact_range(b)) {
    throw InvalidArgument(
        fmt::format("decompose: with margin {}, the rectangle around the drawing has a coordinate "
                    "above 2^300: change it, or scale the drawing",
                    margin));
  }
  points.insert(points.end(), {a, {b.x, a.y, 0.0}, b, {a.x, b.y, 0.0}});
  return points;
}

void insert_edges(PlanarTriangulation& triangles, const Drawing& drawing) {
  drawing.for_each_edge([&](std::uint32_t edge, std::uint32_t end, std::size_t) {
    const auto obstacle = triangles.insert_segment(edge, end, edge);
    if (!obstacle) return;
    if (obstacle->point != none) {
      throw InvalidMesh(fmt::format("decompose: {} lies on {}; rings may not touch or run back over themselves",
                                    drawing.point_name(obstacle->point), drawing.edge_name(edge)));
    }
    throw InvalidMesh(
        fmt::format("decompose: {} crosses {}", drawing.edge_name(edge), drawing.edge_name(obstacle->segment)));
  });
}

/// For each triangle whether it is inside: across an edge of a ring it is the other way. The first corner of the
/// rectangle is outside.
std::vector<std::uint8_t> find_inside(const PlanarTriangulation& triangles, std::uint32_t outer_corner) {
  constexpr std::uint8_t unknown = 2;
  std::vector<std::uint8_t> inside(triangles.half_edges() / 3, unknown);
  std::vector<std::uint32_t> open = {triangles.half_edge_at(outer_corner) / 3};
  inside[open[0]] = 0;
  while (!open.empty()) {
    const std::uint32_t t = open.back();
    open.pop_back();
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t across = triangles.twin(h) / 3;
      if (triangles.twin(h) == none || inside[across] != unknown) continue;
      inside[across] = triangles.segment(h) == none ? inside[t] : inside[t] ^ 1U;
      open.push_back(across);
    }
  }
  return inside;
}

struct DrawnCell {
  std::uint32_t corners[2];  // the lowest and the one after it: no other cell has these
  std::uint32_t half_edge;   // from one to the other
  bool outside;
};

std::vector<DrawnCell> list_cells(const PlanarTriangulation& triangles, std::span<const std::uint32_t> next,
                                  std::span<const std::uint8_t> inside, bool with_outside) {
  std::vector<DrawnCell> cells;
  std::vector<bool> seen(next.size(), false);
  for (std::uint32_t h = 0; h < next.size(); ++h) {
    if (next[h] == none || seen[h]) continue;
    std::uint32_t lowest = h;
    for (std::uint32_t i = h; !seen[i]; i = next[i]) {
      seen[i] = true;
      if (triangles.origin(i) < triangles.origin(lowest)) lowest = i;
    }
    const bool outside = inside[h / 3] == 0;
    if (outside && !with_outside) continue;
    cells.push_back({{triangles.origin(lowest), triangles.target(lowest)}, lowest, outside});
  }
  std::sort(cells.begin(), cells.end(), [](const DrawnCell& a, const DrawnCell& b) {
    return std::tie(a.outside, a.corners[0], a.corners[1]) < std::tie(b.outside, b.corners[0], b.corners[1]);
  });
  return cells;
}

void add_cells(MeshData& mesh, const PlanarTriangulation& triangles, std::span<const std::uint32_t> next,
               const std::vector<DrawnCell>& cells) {
  std::vector<std::uint32_t> corners;
  for (const DrawnCell& cell : cells) {
    corners.clear();
    std::uint32_t h = cell.half_edge;
    do {
      corners.push_back(triangles.origin(h));
      h = next[h];
    } while (h != cell.half_edge);
    mesh.add_cell(corners.size() == 3   ? CellType::triangle
                  : corners.size() == 4 ? CellType::quadrilateral
                                        : CellType::polygon,
                  corners);
    mesh.free.push_back(cell.outside ? 0 : 1);
    mesh.regions.push_back(cell.outside ? outside_tag : inside_tag);
  }
  mesh.region_names[inside_tag] = "inside";
  if (!cells.empty() && cells.back().outside) mesh.region_names[outside_tag] = "outside";
}

void add_patches(MeshData& mesh, const Drawing& drawing, std::span<const Ring> rings) {
  std::map<std::string, std::int32_t> tags;
  for (const Ring& ring : rings) {
    if (!ring.name.empty()) tags.try_emplace(ring.name, static_cast<std::int32_t>(tags.size()) + 1);
  }
  for (const auto& [name, tag] : tags) mesh.patch_names[tag] = name;
  drawing.for_each_edge([&](std::uint32_t edge, std::uint32_t end, std::size_t ring) {
    const auto found = tags.find(rings[ring].name);
    if (found != tags.end()) mesh.add_patch_face(std::vector<std::uint32_t>{edge, end}, found->second);
  });
}

}  // namespace

MeshData decompose(std::span<const Ring> rings, const DecomposeOptions& options) {
  check(options);
  const Drawing drawing(rings);
  check_points(drawing, rings.size());
  check_repeats(drawing);
  MeshData mesh;
  mesh.points = frame(drawing, options.with_outside ? options.margin : DecomposeOptions{}.margin);
  PlanarTriangulation triangles(mesh.points);
  insert_edges(triangles, drawing);
  const std::vector<std::uint8_t> inside = find_inside(triangles, drawing.count());
  const std::vector<std::uint32_t> next = detail::merge_convex(triangles, mesh.points, options.max_corners);
  add_cells(mesh, triangles, next, list_cells(triangles, next, inside, options.with_outside));
  add_patches(mesh, drawing, rings);
  if (!options.with_outside) mesh.points.resize(drawing.count());
  return mesh;
}

}  // namespace dartcast
