// A triangulation of the plane that points and then segments are put into.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::detail {

/// The obstacle of a segment: a point on it, or a segment that it crosses. The other one is `none`.
struct Obstacle {
  std::uint32_t point;
  std::uint32_t segment;
};

/// Triangles in half-edges: triangle t has 3 t, 3 t + 1 and 3 t + 2, counterclockwise. Each starts at its origin and
/// has its triangle to the left. Every triangle is strictly positive at all times, by exact signs; the empty-circle
/// test that makes them well shaped is in doubles. It may be wrong, which affects the shape alone. It ends in any
/// case: a flip for a new point gives that point an edge, and flips for a segment are counted.
///
/// This work is based on C. L. Lawson, "Software for C1 surface interpolation", 1977 (flips); O. Devillers, S. Pion, M.
/// Teillaud, "Walking in a triangulation", 2002; N. Amenta, S. Choi, G. Rote, "Incremental constructions con BRIO",
/// 2003 (the order of points); M. V. Anglada, "An improved incremental algorithm for constructing restricted Delaunay
/// triangulations", 1997 (segments); G. T. Toussaint and D. Avis, "On a convex hull algorithm for polygons and its
/// application to triangulation problems", 1982 (the gap along a segment).
class PlanarTriangulation {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// Triangulates all points, in expected n log n. Preconditions: the last four are the corners of a rectangle,
  /// counterclockwise, and the others lie strictly inside it. No two are equal; all are in the exact range; there are
  /// fewer than 2^28. They are not copied.
  explicit PlanarTriangulation(std::span<const Vec3> points);

  /// Makes the segment from a to b an edge that is never flipped again, with a name (not `none`). If that cannot be,
  /// says why and changes nothing. Cost: the edges it crosses, and about the edges of a. Preconditions: a and b
  /// differ, and are no corners of the rectangle; no other segment has the same ends.
  std::optional<Obstacle> insert_segment(std::uint32_t a, std::uint32_t b, std::uint32_t name);

  [[nodiscard]] std::uint32_t half_edges() const { return static_cast<std::uint32_t>(origin_.size()); }
  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return origin_[h]; }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return origin_[next(h)]; }
  /// The same edge in the triangle across; `none` at the rectangle's sides.
  [[nodiscard]] std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }
  /// The name of the segment that this edge is, or `none`.
  [[nodiscard]] std::uint32_t segment(std::uint32_t h) const { return segment_[h]; }
  /// A half-edge that starts at the point.
  [[nodiscard]] std::uint32_t half_edge_at(std::uint32_t point) const { return at_[point]; }

  static constexpr std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static constexpr std::uint32_t prev(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

 private:
  /// Where a point is: in the triangle, or on one of its edges.
  struct Place {
    std::uint32_t triangle;
    std::uint32_t on_edge;
  };
  /// A half-edge at the border of a gap, in a triangle that is removed, and its replacement.
  struct Side {
    std::uint32_t half_edge;
    std::uint32_t origin;
    std::uint32_t twin;
    std::uint32_t segment;
    std::uint32_t now;
  };
  /// The triangles that a segment crosses, and the sides around them. Those to its left go from its end to its start,
  /// those to its right from its start to its end.
  struct Gap {
    std::vector<std::uint32_t> triangles;
    std::vector<Side> left;
    std::vector<Side> right;
  };

  [[nodiscard]] std::vector<std::uint32_t> order_of_insertion() const;
  [[nodiscard]] Place locate(std::uint32_t point, std::uint32_t start);
  std::uint32_t insert_point(std::uint32_t point, std::uint32_t start);
  void set_triangle(std::uint32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void link(std::uint32_t h, std::uint32_t twin, std::uint32_t segment);
  void flip(std::uint32_t h);
  [[nodiscard]] bool in_circle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const;
  bool flip_if_better(std::uint32_t h);
  void flip_around_point();

  [[nodiscard]] bool is_ahead(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] Side side(std::uint32_t h) const { return {h, origin_[h], twin_[h], segment_[h], none}; }
  std::optional<Obstacle> find_gap(std::uint32_t a, std::uint32_t b, std::uint32_t first);
  std::uint32_t fill(std::vector<Side>& border, std::uint32_t end, std::size_t& used);
  void link_borders();
  void flip_in_gap();

  std::span<const Vec3> points_;
  double unit_;  // a power of two near the rectangle's size over one
  std::vector<std::uint32_t> origin_;
  std::vector<std::uint32_t> twin_;
  std::vector<std::uint32_t> segment_;
  std::vector<std::uint32_t> at_;
  std::vector<std::uint32_t> open_;  // half-edges that may have to be flipped
  std::vector<std::uint32_t> now_;   // per half-edge at the border of the gap: its replacement; else none
  Gap gap_;
  Random random_{1};
};

}  // namespace dartcast::detail
