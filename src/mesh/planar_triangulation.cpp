// An incremental Delaunay triangulation: points, then segments by flips.
#include "mesh/planar_triangulation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "dartcast/predicates.hpp"

namespace dartcast::detail {
namespace {

/// Place on a Hilbert curve through a square of 2^bits a side.
std::uint64_t hilbert(std::uint32_t x, std::uint32_t y, unsigned bits) {
  std::uint64_t place = 0;
  for (std::uint32_t side = 1U << (bits - 1); side > 0; side >>= 1U) {
    const bool right = (x & side) != 0;
    const bool up = (y & side) != 0;
    place = 4 * place + (right ? (up ? 2 : 3) : (up ? 1 : 0));
    if (up) continue;
    if (right) {
      x = ~x;
      y = ~y;
    }
    std::swap(x, y);
  }
  return place;
}

}  // namespace

PlanarTriangulation::PlanarTriangulation(std::span<const Vec3> points) : points_(points), at_(points.size(), none) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const Vec3 size = points[n - 2] - points[n - 4];
  unit_ = std::ldexp(1.0, -std::ilogb(std::max(size.x, size.y)));
  origin_.reserve(std::size_t{6} * n);
  twin_.reserve(origin_.capacity());
  segment_.reserve(origin_.capacity());
  set_triangle(0, n - 4, n - 3, n - 2);
  set_triangle(1, n - 4, n - 2, n - 1);
  link(2, 3, none);
  std::uint32_t last = 0;
  for (const std::uint32_t p : order_of_insertion()) last = insert_point(p, last);
  now_.assign(origin_.size(), none);
}

/// Rounds of twice as many points each, at random, so that few triangles are made in vain, whatever the points. Within
/// a round along a curve, so that the way from one to the next is short.
std::vector<std::uint32_t> PlanarTriangulation::order_of_insertion() const {
  constexpr unsigned bits = 29;
  const auto n = static_cast<std::uint32_t>(points_.size()) - 4;
  const Vec3 low = points_[n];
  const Vec3 size = points_[n + 2] - low;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed;
  Random random(2);
  for (std::uint32_t p = 0; p < n; ++p) {
    // The last round has half of all points, the one before a quarter: 30 rounds are enough.
    const auto round = 29 - static_cast<std::uint64_t>(std::min(29, std::countr_zero(random.next())));
    const Vec3 u = (points_[p] - low) * unit_;
    const double scale = std::ldexp(1.0, bits) / (std::max(size.x, size.y) * unit_);
    const auto grid = [&](double x) { return static_cast<std::uint32_t>(std::min(x * scale, 0x1p+29 - 1)); };
    keyed.emplace_back(round << (2 * bits) | hilbert(grid(u.x), grid(u.y), bits), p);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> order;
  order.reserve(n);
  for (const auto& [key, p] : keyed) order.push_back(p);
  return order;
}

/// A walk that may not be led in a circle: the edge to look at first is drawn.
PlanarTriangulation::Place PlanarTriangulation::locate(std::uint32_t point, std::uint32_t start) {
  const Vec3& p = points_[point];
  std::uint32_t h = 3 * start + random_.below(3);
  std::uint32_t on_edge = none;
  for (unsigned passed = 0; passed < 3;) {
    const Sign side = orient2d(points_[origin(h)], points_[target(h)], p);
    if (side == Sign::negative) {
      h = 3 * (twin_[h] / 3) + random_.below(3);
      on_edge = none;
      passed = 0;
      continue;
    }
    if (side == Sign::zero) on_edge = h;
    h = next(h);
    ++passed;
  }
  return {h / 3, on_edge};
}

/// Returns a triangle at the point.
std::uint32_t PlanarTriangulation::insert_point(std::uint32_t point, std::uint32_t start) {
  const Place place = locate(point, start);
  const std::uint32_t sides[3] = {3 * place.triangle, 3 * place.triangle + 1, 3 * place.triangle + 2};
  const std::uint32_t corner[3] = {origin_[sides[0]], origin_[sides[1]], origin_[sides[2]]};
  const std::uint32_t across[3] = {twin_[sides[0]], twin_[sides[1]], twin_[sides[2]]};
  const std::uint32_t fresh = half_edges() / 3;
  const std::uint32_t triangle[3] = {place.triangle, fresh, fresh + 1};
  for (unsigned k = 0; k < 3; ++k) set_triangle(triangle[k], corner[k], corner[(k + 1) % 3], point);
  for (unsigned k = 0; k < 3; ++k) {
    link(3 * triangle[k], across[k], none);
    link(3 * triangle[k] + 1, 3 * triangle[(k + 1) % 3] + 2, none);
  }
  for (unsigned k = 0; k < 3; ++k) {
    const std::uint32_t h = 3 * triangle[k];
    if (place.on_edge == sides[k]) {  // its triangle is flat
      open_.push_back(prev(across[k]));
      flip(h);
    }
    open_.push_back(h);
  }
  flip_around_point();
  return at_[point] / 3;
}

void PlanarTriangulation::set_triangle(std::uint32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (3 * t == half_edges()) {
    origin_.resize(origin_.size() + 3);
    twin_.resize(origin_.size(), none);
    segment_.resize(origin_.size(), none);
  }
  const std::uint32_t corners[3] = {a, b, c};
  for (std::uint32_t k = 0; k < 3; ++k) {
    origin_[3 * t + k] = corners[k];
    at_[corners[k]] = 3 * t + k;
  }
}

void PlanarTriangulation::link(std::uint32_t h, std::uint32_t twin, std::uint32_t segment) {
  twin_[h] = twin;
  segment_[h] = segment;
  if (twin == none) return;
  twin_[twin] = h;
  segment_[twin] = segment;
}

/// From triangles a b c (h from a to b) and b a d to c a d (h from a to d) and d b c (the twin from b to c). The corner
/// c, opposite to h before, is then opposite to the two outer edges of a d b.
void PlanarTriangulation::flip(std::uint32_t h) {
  const std::uint32_t t = twin_[h];
  const std::uint32_t h1 = next(h);
  const std::uint32_t t1 = next(t);
  const std::uint32_t c = origin_[prev(h)];
  const std::uint32_t d = origin_[prev(t)];
  at_[origin_[h]] = h;
  at_[origin_[t]] = t;
  const std::uint32_t beyond_h = twin_[t1];
  const std::uint32_t beyond_t = twin_[h1];
  link(h, beyond_h, segment_[t1]);
  link(t, beyond_t, segment_[h1]);
  link(h1, t1, none);
  origin_[h1] = d;
  origin_[t1] = c;
}

/// Whether d seems to be inside the circle through a, b and c, counterclockwise.
bool PlanarTriangulation::in_circle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
  const Vec3 u = (points_[a] - points_[d]) * unit_;
  const Vec3 v = (points_[b] - points_[d]) * unit_;
  const Vec3 w = (points_[c] - points_[d]) * unit_;
  return dot(u, u) * (v.x * w.y - v.y * w.x) + dot(v, v) * (w.x * u.y - w.y * u.x) +
             dot(w, w) * (u.x * v.y - u.y * v.x) >
         0.0;
}

/// Flips the edge if it is no segment, if its triangles seem better the other way, and if these are positive.
bool PlanarTriangulation::flip_if_better(std::uint32_t h) {
  const std::uint32_t t = twin_[h];
  if (t == none || segment_[h] != none) return false;
  const std::uint32_t a = origin_[h];
  const std::uint32_t b = origin_[t];
  const std::uint32_t c = origin_[prev(h)];
  const std::uint32_t d = origin_[prev(t)];
  if (!in_circle(a, b, c, d)) return false;
  if (orient2d(points_[c], points_[a], points_[d]) != Sign::positive) return false;
  if (orient2d(points_[d], points_[b], points_[c]) != Sign::positive) return false;
  flip(h);
  return true;
}

/// Open are edges opposite to a new point, and so are those that a flip opens: each flip gives it an edge more.
void PlanarTriangulation::flip_around_point() {
  while (!open_.empty()) {
    const std::uint32_t h = open_.back();
    const std::uint32_t t = twin_[h];
    open_.pop_back();
    if (!flip_if_better(h)) continue;
    open_.push_back(h);
    open_.push_back(prev(t));
  }
}

}  // namespace dartcast::detail
