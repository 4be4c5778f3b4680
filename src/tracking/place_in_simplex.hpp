// Places a rounded point in a free closed simplex, however it was rounded.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/elementary.hpp"
#include "tracking/representable_point.hpp"
#include "tracking/walk.hpp"

namespace dartcast {

/// The plane of a wall's fan triangle: a, b, c counterclockwise seen from the free side, and the unit normal to that
/// side. In the plane a line, with the free side on the left of ab; c is b.
struct WallPlane {
  Vec3 a, b, c;
  Vec3 normal;
};

namespace detail {

/// The planes that a point must not be behind. N: as for Space.
template <std::size_t N>
class WallPlanes {
 public:
  void add(const WallPlane& plane) {
    if (count_ < planes_.size()) planes_[count_++] = plane;
  }

  /// Moves x by `distance` along the inward normal of each plane that it is exactly behind.
  void lift(Vec3& x, double distance) const {
    for (unsigned i = 0; i < count_; ++i) {
      const WallPlane& w = planes_[i];
      if (is_behind(w, x)) x += w.normal * distance;
    }
  }

  [[nodiscard]] bool none_behind(const Vec3& x) const {
    return std::none_of(planes_.begin(), planes_.begin() + count_, [&](const WallPlane& w) { return is_behind(w, x); });
  }

 private:
  static bool is_behind(const WallPlane& w, const Vec3& x) {
    return (N == 4 ? orient3d(w.a, w.b, w.c, x) : orient2d(w.a, w.b, x)) == Sign::negative;
  }

  std::array<WallPlane, 8> planes_;
  unsigned count_ = 0;
};

/// The k-th distance to lift x, which was computed from p. It is one unit in the last place of the larger of the two,
/// doubled k times. The size of p shows how large the rounding is: x alone may be next to the origin.
inline double lift_distance(const Vec3& p, const Vec3& x, int k) {
  const double largest =
      std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return std::ldexp(std::max(largest * std::numeric_limits<double>::epsilon(), smallest_magnitude), k);
}

/// Lifts x, computed from p, until it is behind none of the planes; after so many doublings it stays where it is.
template <std::size_t N>
void lift_off(const WallPlanes<N>& planes, const Vec3& p, Vec3& x, int doublings) {
  for (int k = 0; k < doublings && !planes.none_behind(x); ++k) planes.lift(x, lift_distance(p, x, k));
}

}  // namespace detail

/// A vector over a power of two, so that its square neither under- nor overflows.
inline Vec3 scaled_to_one(const Vec3& x) {
  const double largest = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return largest > 0.0 && largest <= std::numeric_limits<double>::max() ? x * std::ldexp(1.0, -std::ilogb(largest)) : x;
}

/// Zero if the vector is zero or not finite.
inline Vec3 unit_of(const Vec3& x) {
  const Vec3 scaled = scaled_to_one(x);
  const double square = dot(scaled, scaled);
  return square > 0.0 && square < 16.0 ? scaled * (1.0 / std::sqrt(square)) : Vec3{};
}

namespace detail {

/// The normal of a facet that is very small or large, or has no area in doubles. Vectors are scaled by powers of two,
/// so that the bits are the same; what cancels in a thin triangle is then taken exactly.
inline Vec3 unusual_normal(const Corners& v, unsigned facet) {
  const auto& f = facet_corners[facet];
  const Vec3 a = flushed(v[f[0]]);
  const Vec3 b = flushed(v[f[1]]);
  const Vec3 c = flushed(v[f[2]]);
  const Vec3 n = unit_of(cross(scaled_to_one(b - a), scaled_to_one(c - a)));
  if (n != Vec3{} || !in_exact_range(a) || !in_exact_range(b) || !in_exact_range(c)) return n;
  const auto twice_area = [&](double Vec3::*x, double Vec3::*y) {
    const auto flat = [&](const Vec3& p) { return Vec3{p.*x, p.*y, 0.0}; };
    return orient2d_value(flat(a), flat(b), flat(c));
  };
  return unit_of({twice_area(&Vec3::y, &Vec3::z), twice_area(&Vec3::z, &Vec3::x), twice_area(&Vec3::x, &Vec3::y)});
}

}  // namespace detail

/// A facet's unit normal to the inside; 0 if it has no area, or a corner outside the exact range.
inline Vec3 facet_normal(const Corners& v, unsigned facet) {
  const auto& f = facet_corners[facet];
  const Vec3 b = v[f[1]] - v[f[0]];
  const Vec3 c = v[f[2]] - v[f[0]];
  const Vec3 n = cross(b, c);
  const double square = dot(n, n);
  // Then flushed coordinates change n by less than 2^-299 2^74, which is 2^-75 of it.
  const bool usual = square > 0x1p-300 && dot(b, b) < 0x1p+140 && dot(c, c) < 0x1p+140;
  return usual ? n * (1.0 / std::sqrt(square)) : detail::unusual_normal(v, facet);
}
inline Vec3 facet_normal(const PlaneCorners& v, unsigned facet) {
  const auto& f = plane_facet_corners[facet];
  const Vec3 along = flushed(v[f[1]]) - flushed(v[f[0]]);
  const Vec3 n = {-along.y, along.x, 0.0};
  const double length = hypotenuse(n.x, n.y);
  const bool has_length = length > 0.0 && length <= std::numeric_limits<double>::max();
  return has_length ? Vec3{n.x / length, n.y / length, 0.0} : Vec3{};
}

/// The plane of a facet, with its normal.
inline WallPlane facet_plane(const Corners& v, unsigned facet) {
  const auto& f = facet_corners[facet];
  return {v[f[0]], v[f[1]], v[f[2]], facet_normal(v, facet)};
}
inline WallPlane facet_plane(const PlaneCorners& v, unsigned facet) {
  const auto& f = plane_facet_corners[facet];
  return {v[f[0]], v[f[1]], v[f[1]], facet_normal(v, facet)};
}

/// The plane as decisions see its corners.
inline WallPlane flushed_plane(WallPlane plane) {
  for (Vec3* corner : {&plane.a, &plane.b, &plane.c}) *corner = flushed(*corner);
  return plane;
}

struct SimplexPlacement {
  SimplexId simplex;
  Vec3 position;
};

namespace detail {

constexpr int early_doublings = 6;
constexpr double max_units = 256.0;  // of the coordinates

/// Whether a corner's coordinate is x's, as decisions see it.
inline bool is_level(double corner, double x) {
  return corner == x || (x == 0.0 && std::abs(corner) < smallest_magnitude);
}

/// Whether a facet lies across an axis, and x on its plane.
inline bool on_level_facet(const Corners& v, unsigned facet, const Vec3& x) {
  const auto& [a, b, c] = facet_corners[facet];
  return (is_level(v[a].x, x.x) && is_level(v[b].x, x.x) && is_level(v[c].x, x.x)) ||
         (is_level(v[a].y, x.y) && is_level(v[b].y, x.y) && is_level(v[c].y, x.y)) ||
         (is_level(v[a].z, x.z) && is_level(v[b].z, x.z) && is_level(v[c].z, x.z));
}
inline bool on_level_facet(const PlaneCorners& v, unsigned facet, const Vec3& x) {
  const auto& [a, b] = plane_facet_corners[facet];
  return (is_level(v[a].x, x.x) && is_level(v[b].x, x.x)) || (is_level(v[a].y, x.y) && is_level(v[b].y, x.y));
}

/// For the usual contact point: x is on one facet, which lies across an axis, or next to one facet. In the second case
/// x is lifted off the facet by as little as the filter needs (some tens of units in the last place of the simplex'
/// size). Nothing if the filter proves too little, or would need more than 256 units of the coordinates.
template <std::size_t N>
std::optional<Vec3> proved_inside(const std::array<Vec3, N>& v, const Vec3& x) {
  Determinants d(v, x);
  if (d.all_positive_in_range()) return x;
  const auto facet = static_cast<unsigned>(std::min_element(d.value.begin(), d.value.end()) - d.value.begin());
  const double off = std::exchange(d.value[facet], std::numeric_limits<double>::infinity());
  if (!d.all_positive_in_range()) return {};
  if (on_level_facet(v, facet, x)) return x;
  const Vec3 n = facet_gradient(v, facet);
  const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  const Vec3 direction = n * (1.0 / largest);  // squares of n may be out of range
  const double length = norm(direction);
  const double unit = lift_distance(v[facet_corner<N>(facet, 0)], x, 0);
  const double distance = (2.0 * d.error() - off) / (largest * length) + unit;
  if (!(distance < max_units * unit)) return {};
  const Vec3 lifted = flushed(x + direction * (distance / length));
  const Determinants there(v, lifted);
  if (there.all_proved_positive() || (in_exact_range(lifted) && there.all_positive_in_range())) return lifted;
  return {};
}

/// Nearest to x of the corners and of p, a point of the simplex.
template <std::size_t N>
Vec3 nearest_known(const std::array<Vec3, N>& v, const Vec3& p, const Vec3& x) {
  Vec3 nearest = p;
  for (const Vec3& corner : v) {
    if (norm(corner - x) < norm(nearest - x)) nearest = flushed(corner);
  }
  return nearest;
}

template <std::size_t N>
Vec3 nearest_corner(const std::array<Vec3, N>& v, const Vec3& x) {
  return nearest_known(v, flushed(v[0]), x);
}

/// Whether x is as near to a corner as lifting may move it. At the corner its signs are simple, and all walls of the
/// vertex are met at once.
inline bool is_rounded_off(const Vec3& corner, const Vec3& x) {
  const Vec3 d = corner - x;
  const double off = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  return off <= lift_distance(corner, x, early_doublings - 1);
}

inline Vec3 mean_of(const Corners& v) { return ((v[0] + v[1]) + (v[2] + v[3])) * 0.25; }
inline Vec3 mean_of(const PlaneCorners& v) { return (v[0] + v[1] + v[2]) * (1.0 / 3.0); }

/// Lifts x off the facets of the simplex; nothing if it is not inside then. p shows how large the rounding is.
template <std::size_t N>
std::optional<Vec3> lifted_inside(const std::array<Vec3, N>& v, const Vec3& p, Vec3 x) {
  WallPlanes<N> facets;
  for (unsigned i = 0; i < N; ++i) facets.add(facet_plane(v, i));
  lift_off(facets, p, x, early_doublings);
  x = flushed(x);
  if (!in_closed_simplex(v, x)) return {};
  return x;
}

/// Walks from p to x; nothing if x is not reached.
template <class Positions, std::size_t N>
std::optional<SimplexPlacement> reached(const Space<Positions, N>& space, SimplexId start, const Vec3& p,
                                        const Vec3& x) {
  if (x == p) return SimplexPlacement{start, p};
  TestCounts uncounted;
  const Walk w = walk(space, start, p, x, uncounted);
  if (w.end == WalkEnd::arrived || w.at_end) return SimplexPlacement{w.simplex, x};
  return {};
}

/// Lifts x off the walls in the way from p, one unit in the last place at first, doubling; nothing if that fails.
template <class Positions, std::size_t N>
std::optional<SimplexPlacement> lifted(const Space<Positions, N>& space, SimplexId start, const Vec3& p, Vec3 x) {
  WallPlanes<N> planes;
  for (int k = 0; k < early_doublings; ++k) {
    TestCounts uncounted;
    const Walk w = walk(space, start, p, x, uncounted);
    if (w.end == WalkEnd::arrived || w.at_end) return SimplexPlacement{w.simplex, x};
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

/// Puts x, a point rounded out of the closed simplex `simplex` (with corners v), into a free closed simplex. These are
/// tried in order:
/// 1. Lift x off the facets that it is behind, one unit in the last place at first, doubling.
/// 2. Walk to x from a point p of the simplex, and lift x off the walls in the way. This p is the mean of the corners
///    if that is exactly inside, else the corner nearest to x.
/// 3. If the walls are too close together for that, search a double between them
///    (tracking/representable_point.hpp).
/// 4. Take p or the corner nearest to x.
/// No wall is passed. Precondition: the simplex is positive, its cell free.
template <class Positions, std::size_t N>
SimplexPlacement place_in_simplex(const Space<Positions, N>& space, SimplexId simplex, const std::array<Vec3, N>& v,
                                  const Vec3& rounded) {
  const Vec3 x = flushed(rounded);
  if (detail::in_closed_simplex(v, x)) return {simplex, x};
  Vec3 p = flushed(detail::mean_of(v));
  if (const auto lifted = detail::lifted_inside(v, p, x)) return {simplex, *lifted};
  if (!detail::in_closed_simplex(v, p)) p = detail::nearest_corner(v, x);
  if (!in_exact_range(x)) return {simplex, detail::nearest_known(v, p, x)};
  if (const auto placed = detail::reached(space, simplex, p, x)) return *placed;
  if (const auto placed = detail::lifted(space, simplex, p, x)) return *placed;
  if (const auto found = detail::representable_inside(v, x)) return {simplex, *found};
  return {simplex, detail::nearest_known(v, p, x)};
}

/// The same in a complex as it is now, of space or of the plane.
inline SimplexPlacement place_in_simplex(const CellComplex& complex, SimplexId simplex, const Vec3& rounded) {
  const auto in = [&](const auto& space) { return place_in_simplex(space, simplex, space.corners(simplex), rounded); };
  return complex.map().dimension() == 2 ? in(current_space<3>(complex)) : in(current_space(complex));
}

}  // namespace dartcast
