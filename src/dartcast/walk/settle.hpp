// settle: puts a rounded point into a free closed simplex, however it was rounded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "dartcast/walk/nearby.hpp"
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

/// The k-th distance to lift x by, which was computed from p: one unit in the last place of the larger of the two,
/// doubling. It is p that tells how large the rounding is: x alone may be next to the origin.
inline double lift_distance(const Vec3& p, const Vec3& x, int k) {
  const double largest =
      std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return std::ldexp(std::max(largest * std::numeric_limits<double>::epsilon(), smallest_magnitude), k);
}

/// Lifts x, computed from p, until it is behind none of the planes; after so many doublings it is left where it is.
inline void lift_off(const WallPlanes& planes, const Vec3& p, Vec3& x, int doublings) {
  for (int k = 0; k < doublings && !planes.none_behind(x); ++k) planes.lift(x, lift_distance(p, x, k));
}

}  // namespace detail

/// The plane of a facet, with its normal (scaled before it is normalised, so that slivers do not underflow).
inline WallPlane facet_plane(const Corners& v, unsigned facet) {
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

constexpr int few_doublings = 6;

/// Whether x lies on a plane across an axis, as three other points do.
inline bool same_level(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  return (a.x == x.x && b.x == x.x && c.x == x.x) || (a.y == x.y && b.y == x.y && c.y == x.y) ||
         (a.z == x.z && b.z == x.z && c.z == x.z);
}

/// The usual contact point: x is on one facet, which lies across an axis, or next to one facet; then it is lifted off
/// that by as little as the filter needs (some tens of units in the last place of the simplex' size). Nothing where the
/// filter proves too little, or would need more than 256 units of the coordinates.
inline std::optional<Vec3> proved_inside(const Corners& v, const Vec3& x) {
  Determinants d(v, x);
  if (d.all_proved_positive()) return x;
  const auto facet = static_cast<unsigned>(std::min_element(d.value.begin(), d.value.end()) - d.value.begin());
  const auto& f = facet_corners[facet];
  const double off = std::exchange(d.value[facet], std::numeric_limits<double>::infinity());
  if (!d.all_proved_positive()) return {};
  if (same_level(v[f[0]], v[f[1]], v[f[2]], x)) return x;
  const Vec3 n = cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]]);
  const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  const Vec3 direction = n * (1.0 / largest);  // squares of n may be out of range
  const double length = norm(direction);
  const double unit = lift_distance(v[f[0]], x, 0);
  const double distance = (2.0 * d.bound - off) / (largest * length) + unit;
  constexpr double most_units = 256.0;
  if (!(distance < most_units * unit)) return {};
  const Vec3 lifted = flushed(x + direction * (distance / length));
  if (!Determinants(v, lifted).all_proved_positive()) return {};
  return lifted;
}

/// Lifts x off the facets of the simplex; nothing where it is not inside then. p tells how large the rounding is.
inline std::optional<Vec3> lifted_inside(const Corners& v, const Vec3& p, Vec3 x) {
  WallPlanes facets;
  for (unsigned i = 0; i < 4; ++i) facets.add(facet_plane(v, i));
  lift_off(facets, p, x, few_doublings);
  x = flushed(x);
  if (!in_closed_simplex(v, x)) return {};
  return x;
}

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
  WallPlanes planes;
  for (int k = 0; k < few_doublings; ++k) {
    TestCounts uncounted;
    const Walk w = walk(space, start, p, x, uncounted);
    if (w.end == WalkEnd::arrived || w.at_end) return Settled{w.simplex, x};
    if (w.end == WalkEnd::invalid_cell) return {};
    if (planes.none_behind(x)) planes.add(facet_plane(space.corners(w.wall_simplex), w.wall_facet));
    if (planes.none_behind(x)) return {};
    planes.lift(x, lift_distance(p, x, k));
    x = flushed(x);
    if (x == p) return {};
  }
  return {};
}

}  // namespace detail

/// Puts x, a point rounded out of the closed simplex `simplex` (with corners v), into a free closed simplex. First it
/// is lifted off the facets that it is behind, one unit in the last place at first, doubling. Where that does not do,
/// it is walked to from a point p of the simplex (its mean, where that is exactly inside; else its corner nearest to x)
/// and lifted off the walls in the way; where these are too close together for that, a double between them is looked
/// for (walk/nearby.hpp); in the end it is p. No wall is passed. Precondition: the simplex is positive, its cell free.
template <class Positions>
Settled settle(const Space<Positions>& space, SimplexId simplex, const Corners& v, const Vec3& rounded) {
  const Vec3 x = detail::flushed(rounded);
  if (detail::in_closed_simplex(v, x)) return {simplex, x};
  Vec3 p = detail::flushed(((v[0] + v[1]) + (v[2] + v[3])) * 0.25);
  if (const auto lifted = detail::lifted_inside(v, p, x)) return {simplex, *lifted};
  if (!detail::in_closed_simplex(v, p)) {
    p = *std::min_element(v.begin(), v.end(),
                          [&](const Vec3& a, const Vec3& b) { return dot(a - x, a - x) < dot(b - x, b - x); });
  }
  if (const auto settled = detail::reached(space, simplex, p, x)) return *settled;
  if (const auto settled = detail::lifted(space, simplex, p, x)) return *settled;
  return {simplex, detail::double_inside(v, x).value_or(p)};
}

}  // namespace dartcast
