// settle: puts a rounded point into a free closed simplex, however it was rounded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

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

  /// Moves x by `distance` along the inward normal of each plane that it is exactly behind.
  void lift(Vec3& x, double distance) const {
    for (unsigned i = 0; i < count_; ++i) {
      const WallPlane& w = planes_[i];
      if (orient3d(w.a, w.b, w.c, x) == Sign::negative) x += w.normal * distance;
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

/// The k-th distance to lift x by, which was computed from p: one unit in the last place of the larger of the two,
/// doubling. It is p that tells how large the rounding is: x alone may be next to the origin.
inline double lift_distance(const Vec3& p, const Vec3& x, int k) {
  const double largest =
      std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return std::ldexp(std::max(largest * std::numeric_limits<double>::epsilon(), smallest_magnitude), k);
}

/// Lifts x, computed from p, until it is behind none of the planes; after 16 doublings it is left where it is.
inline void lift_off(const WallPlanes& planes, const Vec3& p, Vec3& x) {
  for (int k = 0; k < lift_tries && !planes.none_behind(x); ++k) planes.lift(x, lift_distance(p, x, k));
}

/// Whether x lies in the closed simplex; exact. Precondition: the simplex is positive.
inline bool in_closed_simplex(const Corners& v, const Vec3& x) {
  const Determinants d(v, x);
  std::uint64_t exact = 0;
  for (unsigned i = 0; i < 4; ++i) {
    const Sign s = sign_of(d, i, v, x, exact);
    if (s == Sign::negative || s == Sign::undecidable) return false;
  }
  return true;
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

namespace detail {

/// Walks from p to x; nothing where x is not reached.
template <class Positions>
std::optional<Settled> reached(const Space<Positions>& space, SimplexId start, const Vec3& p, const Vec3& x) {
  if (x == p) return Settled{start, p};
  TestCounts uncounted;
  const Walk w = walk(space, start, p, x, uncounted);
  if (w.end == WalkEnd::arrived || w.at_end) return Settled{w.simplex, x};
  return {};
}

/// Lifts x off the walls in the way from p, one unit in the last place at first, doubling; nothing where that does not
/// do.
template <class Positions>
std::optional<Settled> lifted(const Space<Positions>& space, SimplexId start, const Vec3& p, Vec3 x) {
  constexpr int tries = 6;
  WallPlanes planes;
  for (int k = 0; k < tries; ++k) {
    TestCounts uncounted;
    const Walk w = walk(space, start, p, x, uncounted);
    if (w.end == WalkEnd::arrived || w.at_end) return Settled{w.simplex, x};
    if (w.end == WalkEnd::invalid_cell) return {};
    if (planes.none_behind(x)) planes.add(wall_plane(space, w.wall_simplex, w.wall_facet));
    if (planes.none_behind(x)) return {};
    planes.lift(x, lift_distance(p, x, k));
    x = flushed(x);
    if (x == p) return {};
  }
  return {};
}

}  // namespace detail

/// Puts x, a point rounded out of the closed simplex `simplex`, into a free closed simplex: from a point p of the
/// simplex (its mean, where that is exactly inside; else its corner nearest to x) it walks to x. Where a wall is in the
/// way by rounding, x is lifted off it; where several walls are too close together for that, x is drawn back towards p
/// by a unit in the last place of the way, doubling; in the end it is p. No wall is passed. Precondition: the simplex
/// is positive, its cell free.
template <class Positions>
Settled settle(const Space<Positions>& space, SimplexId simplex, const Vec3& rounded) {
  const Corners v = space.corners(simplex);
  const Vec3 x = detail::flushed(rounded);
  if (detail::in_closed_simplex(v, x)) return {simplex, x};
  Vec3 p = detail::flushed(((v[0] + v[1]) + (v[2] + v[3])) * 0.25);
  if (!detail::in_closed_simplex(v, p)) {
    p = *std::min_element(v.begin(), v.end(),
                          [&](const Vec3& a, const Vec3& b) { return dot(a - x, a - x) < dot(b - x, b - x); });
  }
  if (const auto settled = detail::reached(space, simplex, p, x)) return *settled;
  if (const auto settled = detail::lifted(space, simplex, p, x)) return *settled;
  constexpr int digits = std::numeric_limits<double>::digits;
  for (int k = digits; k > 0; --k) {
    const Vec3 back = detail::flushed(x + (p - x) * std::ldexp(1.0, -k));
    if (const auto settled = detail::reached(space, simplex, p, back)) return *settled;
  }
  return {simplex, p};
}

}  // namespace dartcast
