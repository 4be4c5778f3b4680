// settle: puts a rounded point into a free closed simplex, however it was rounded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dartcast/walk/walk.hpp"

namespace dartcast {

/// The plane of a wall's fan triangle: a, b, c counterclockwise seen from the free side, and the unit normal to that
/// side.
struct WallPlane {
  Vec3 a, b, c;
  Vec3 normal;
};

namespace detail {

/// The planes that a point must not be behind.
class WallPlanes {
 public:
  void add(const WallPlane& plane) {
    if (count_ < planes_.size()) planes_[count_++] = plane;
  }

  /// Moves x by `ulps` units in the last place along the inward normal of each plane that it is exactly behind.
  void lift(Vec3& x, double ulps) const {
    for (unsigned i = 0; i < count_; ++i) {
      const WallPlane& w = planes_[i];
      if (orient3d(w.a, w.b, w.c, x) != Sign::negative) continue;
      const double largest = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
      x += w.normal * (ulps * std::max(largest * std::numeric_limits<double>::epsilon(), smallest_magnitude));
    }
  }

  [[nodiscard]] bool none_behind(const Vec3& x) const {
    return std::none_of(planes_.begin(), planes_.begin() + count_,
                        [&](const WallPlane& w) { return orient3d(w.a, w.b, w.c, x) == Sign::negative; });
  }

 private:
  std::array<WallPlane, 8> planes_;
  unsigned count_ = 0;
};

constexpr int lift_tries = 16;

/// Lifts x until it is behind none of the planes; after 16 doublings it is left where it is.
inline void lift_off(const WallPlanes& planes, Vec3& x) {
  for (int k = 0; k < lift_tries && !planes.none_behind(x); ++k) planes.lift(x, std::ldexp(1.0, k));
}

/// A component that is not zero but below the exact range counts as zero; results of arithmetic are passed through
/// this.
inline Vec3 flushed(Vec3 x) {
  const auto flush = [](double& c) {
    if (std::abs(c) < smallest_magnitude) c = 0.0;
  };
  flush(x.x);
  flush(x.y);
  flush(x.z);
  return x;
}

}  // namespace detail

/// The wall triangle of a facet, with its normal (scaled before it is normalised, so that slivers do not underflow).
template <class Positions>
WallPlane wall_plane(const Space<Positions>& space, SimplexId simplex, unsigned facet) {
  const Corners v = space.corners(simplex);
  const auto& f = facet_corners[facet];
  WallPlane plane{v[f[0]], v[f[1]], v[f[2]], {}};
  const auto scaled = [](Vec3 e) {
    const double largest = std::max({std::abs(e.x), std::abs(e.y), std::abs(e.z)});
    return largest > 0.0 ? e * (1.0 / largest) : e;
  };
  const Vec3 n = scaled(cross(scaled(plane.b - plane.a), scaled(plane.c - plane.a)));
  const double length = norm(n);
  plane.normal = length > 0.0 ? n * (1.0 / length) : Vec3{};
  return plane;
}

struct Settled {
  SimplexId simplex;
  Vec3 position;
};

/// Walks from p, which lies in the closed simplex `start`, to x. Where a wall is in the way by rounding, x is lifted
/// off it by one unit in the last place, doubling; after 16 tries the way from p is halved; in the end p is returned.
/// The result lies in the closed simplex returned, which is free and reached from `start` without passing a wall.
template <class Positions>
Settled settle(const Space<Positions>& space, SimplexId start, const Vec3& p, Vec3 x, detail::WallPlanes planes,
               TestCounts& counts) {
  for (int k = 0; k < detail::lift_tries; ++k) {
    x = detail::flushed(x);
    if (x == p) return {start, p};
    const Walk w = walk(space, start, p, x, counts);
    if (w.end == WalkEnd::arrived || w.at_end) return {w.simplex, x};
    if (w.end == WalkEnd::invalid_cell) return {start, p};
    if (planes.none_behind(x)) planes.add(wall_plane(space, w.wall_simplex, w.wall_facet));
    if (planes.none_behind(x)) break;  // a wall that stands in the way, not one that rounding put x behind
    planes.lift(x, std::ldexp(1.0, k));
  }
  constexpr int halvings = 64;
  for (int k = 0; k < halvings; ++k) {
    x = detail::flushed(p + (x - p) * 0.5);
    if (x == p) break;
    const Walk w = walk(space, start, p, x, counts);
    if (w.end == WalkEnd::arrived || w.at_end) return {w.simplex, x};
    if (w.end == WalkEnd::invalid_cell) break;
  }
  return {start, p};
}

}  // namespace dartcast
