// Inserts segments into a triangulation of the plane: removes the triangles that they cross, and fills both sides of
// the gap.
#include <algorithm>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "mesh/planar_triangulation.hpp"

namespace dartcast::detail {

std::optional<Obstacle> PlanarTriangulation::insert_segment(std::uint32_t a, std::uint32_t b, std::uint32_t name) {
  std::uint32_t h = at_[a];
  for (;; h = twin_[prev(h)]) {  // it is found before the first comes back: directions around a point are covered
    const std::uint32_t u = target(h);
    if (u == b) {
      link(h, twin_[h], name);
      return std::nullopt;
    }
    const Sign s = orient2d(points_[a], points_[b], points_[u]);
    if (s == Sign::zero && is_ahead(a, b, u)) return Obstacle{u, none};
    if (s != Sign::negative) continue;
    if (orient2d(points_[a], points_[b], points_[origin_[prev(h)]]) == Sign::positive) break;
  }
  if (const auto obstacle = find_gap(a, b, next(h))) return obstacle;
  std::size_t used = 0;
  const std::uint32_t left = fill(gap_.left, a, used);
  const std::uint32_t right = fill(gap_.right, b, used);
  link_borders();
  link(left, right, name);
  flip_in_gap();
  return std::nullopt;
}

/// Whether a point c on the line through a and b is on b's side of a.
bool PlanarTriangulation::is_ahead(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const Vec3& p = points_[a];
  const Vec3& q = points_[b];
  const Vec3& r = points_[c];
  return p.x != q.x ? (q.x > p.x) == (r.x > p.x) : (q.y > p.y) == (r.y > p.y);
}

/// `first`: the edge that the segment from a to b crosses first, from right to left, in the triangle at a.
std::optional<Obstacle> PlanarTriangulation::find_gap(std::uint32_t a, std::uint32_t b, std::uint32_t first) {
  gap_.triangles.assign(1, first / 3);
  gap_.right.assign(1, side(prev(first)));
  gap_.left.assign(1, side(next(first)));
  for (std::uint32_t h = first;;) {
    if (segment_[h] != none) return Obstacle{none, segment_[h]};
    const std::uint32_t t = twin_[h];
    const std::uint32_t apex = origin_[prev(t)];
    gap_.triangles.push_back(t / 3);
    const Sign s = apex == b ? Sign::zero : orient2d(points_[a], points_[b], points_[apex]);
    if (s == Sign::zero && apex != b) return Obstacle{apex, none};
    if (s != Sign::negative) gap_.left.push_back(side(prev(t)));
    if (s != Sign::positive) gap_.right.push_back(side(next(t)));
    if (s == Sign::zero) break;
    h = s == Sign::positive ? next(t) : prev(t);
  }
  std::reverse(gap_.left.begin(), gap_.left.end());
  return std::nullopt;
}

/// Cuts off convex corners, each as soon as it is one, until nothing is left between the border and the segment.
/// Returns the half-edge along the segment. Every point of the border is seen from the segment. So this ends (Toussaint
/// and Avis). The triangles are positive and fit together in a disc. So they cannot overlap either, even if the border
/// runs along both sides of an edge.
std::uint32_t PlanarTriangulation::fill(std::vector<Side>& border, std::uint32_t end, std::size_t& used) {
  struct Corner {
    std::uint32_t point;
    Side* border;  // the edge to it from the corner before: of the border, or of a triangle just made
    std::uint32_t across;
  };
  const auto attach = [&](std::uint32_t h, const Corner& corner) {
    if (corner.border != nullptr) {
      corner.border->now = h;
    } else {
      link(h, corner.across, none);
    }
  };
  std::vector<Corner> corners = {{border[0].origin, nullptr, none}};
  for (std::size_t i = 0; i < border.size(); ++i) {
    Corner c{i + 1 < border.size() ? border[i + 1].origin : end, &border[i], none};
    while (corners.size() > 1 && orient2d(points_[corners[corners.size() - 2].point], points_[corners.back().point],
                                          points_[c.point]) == Sign::positive) {
      const Corner top = corners.back();
      corners.pop_back();
      const std::uint32_t t = gap_.triangles[used++];
      set_triangle(t, corners.back().point, top.point, c.point);
      attach(3 * t, top);
      attach(3 * t + 1, c);
      c = {c.point, nullptr, 3 * t + 2};
    }
    corners.push_back(c);
  }
  if (corners.size() != 2) throw InternalError("the gap along a segment could not be filled");
  return corners.back().across;
}

void PlanarTriangulation::link_borders() {
  for (const auto* border : {&gap_.left, &gap_.right}) {
    for (const Side& s : *border) now_[s.half_edge] = s.now;
  }
  for (const auto* border : {&gap_.left, &gap_.right}) {
    for (const Side& s : *border) {
      const bool both_sides = s.twin != none && now_[s.twin] != none;
      link(s.now, both_sides ? now_[s.twin] : s.twin, s.segment);
    }
  }
  for (const auto* border : {&gap_.left, &gap_.right}) {
    for (const Side& s : *border) now_[s.half_edge] = none;
  }
}

/// A wrong sign of the empty-circle test might lead in a circle: flips are counted.
void PlanarTriangulation::flip_in_gap() {
  std::size_t flips = 8 * gap_.triangles.size();
  for (const std::uint32_t t : gap_.triangles) open_.insert(open_.end(), {3 * t, 3 * t + 1, 3 * t + 2});
  while (!open_.empty()) {
    const std::uint32_t h = open_.back();
    open_.pop_back();
    if (flips == 0 || !flip_if_better(h)) continue;
    --flips;
    const std::uint32_t t = twin_[next(h)];
    open_.insert(open_.end(), {h, prev(h), next(t), prev(t)});
  }
}

}  // namespace dartcast::detail
