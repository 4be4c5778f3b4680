// Merges triangles into convex cells, across the longest edges first.
#include "mesh/merge_convex.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "dartcast/predicates.hpp"

namespace dartcast::detail {
namespace {

constexpr std::uint32_t none = PlanarTriangulation::none;

/// Edges that may be taken out, one half-edge of each, longest first.
std::vector<std::uint32_t> longest_first(const PlanarTriangulation& triangles, std::span<const Vec3> points) {
  std::vector<std::pair<double, std::uint32_t>> edges;
  for (std::uint32_t h = 0; h < triangles.half_edges(); ++h) {
    const std::uint32_t t = triangles.twin(h);
    if (t == none || t < h || triangles.segment(h) != none) continue;
    const Vec3 along = points[triangles.target(h)] - points[triangles.origin(h)];
    edges.emplace_back(-dot(along, along), h);
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> order;
  order.reserve(edges.size());
  for (const auto& [length, h] : edges) order.push_back(h);
  return order;
}

/// Cells as rings of half-edges; each is known by one of its triangles, which knows how many corners it has.
class Cells {
 public:
  explicit Cells(const PlanarTriangulation& triangles)
      : next_(triangles.half_edges()), prev_(next_.size()), parent_(next_.size() / 3), corners_(parent_.size(), 3) {
    for (std::uint32_t h = 0; h < next_.size(); ++h) {
      next_[h] = PlanarTriangulation::next(h);
      prev_[h] = PlanarTriangulation::prev(h);
    }
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  [[nodiscard]] std::uint32_t next(std::uint32_t h) const { return next_[h]; }
  [[nodiscard]] std::uint32_t prev(std::uint32_t h) const { return prev_[h]; }

  [[nodiscard]] std::uint32_t corners_without(std::uint32_t h, std::uint32_t t) {
    return corners_[cell_of(h)] + corners_[cell_of(t)] - 2;
  }

  void take_out(std::uint32_t h, std::uint32_t t) {
    const std::uint32_t corners = corners_without(h, t);
    parent_[cell_of(t)] = cell_of(h);
    corners_[cell_of(h)] = corners;
    join(prev_[h], next_[t]);
    join(prev_[t], next_[h]);
    next_[h] = next_[t] = none;
  }

  std::vector<std::uint32_t> take() { return std::move(next_); }

 private:
  std::uint32_t cell_of(std::uint32_t h) {
    std::uint32_t t = h / 3;
    for (; parent_[t] != t; t = parent_[t]) parent_[t] = parent_[parent_[t]];
    return t;
  }
  void join(std::uint32_t first, std::uint32_t second) {
    next_[first] = second;
    prev_[second] = first;
  }

  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> prev_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

// The union of two strictly convex cells is strictly convex if it is so at both ends of their common edge. Then
// all triangles of corners are positive, for a fan from any corner. Angles at corners only grow, so one look at each
// edge is enough.
std::vector<std::uint32_t> merge_convex(const PlanarTriangulation& triangles, std::span<const Vec3> points,
                                        std::uint32_t max_corners) {
  Cells cells(triangles);
  const auto turns_left = [&](std::uint32_t first, std::uint32_t second) {
    return orient2d(points[triangles.origin(first)], points[triangles.origin(second)],
                    points[triangles.target(second)]) == Sign::positive;
  };
  for (const std::uint32_t h : longest_first(triangles, points)) {
    const std::uint32_t t = triangles.twin(h);
    if (cells.corners_without(h, t) > max_corners) continue;
    if (turns_left(cells.prev(h), cells.next(t)) && turns_left(cells.prev(t), cells.next(h))) cells.take_out(h, t);
  }
  return cells.take();
}

}  // namespace dartcast::detail
