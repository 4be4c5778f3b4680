// The parity of the triangles above a point, with a symbolic shift that no triangle's edge can meet.
#include "surface/inside.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast {

namespace {

std::vector<Box> boxes_of(const std::vector<Vec3>& points, const std::vector<SurfaceTriangle>& triangles) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const SurfaceTriangle& t : triangles) boxes.push_back(box_of(points, t));
  return boxes;
}

Sign compare(double a, double b) { return a < b ? Sign::negative : a > b ? Sign::positive : Sign::zero; }

// Sign of orient2d(a, b, x + (e, e^2)): the first of its terms that is not 0. Zero only if a and b are above each
// other.
Sign shifted_side(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Sign s = orient2d(a, b, x);
  if (s != Sign::zero) return s;
  const Sign rise = compare(a.y, b.y);
  return rise != Sign::zero ? rise : compare(b.x, a.x);
}

// Whether the vertical line through the shifted x meets the triangle.
bool under_or_over(const std::array<Vec3, 3>& t, const Vec3& x) {
  const Sign s = shifted_side(t[0], t[1], x);
  return s != Sign::zero && shifted_side(t[1], t[2], x) == s && shifted_side(t[2], t[0], x) == s;
}

Vec3 without(const Vec3& p, int axis) {
  return axis == 0 ? Vec3{p.y, p.z, 0.0} : axis == 1 ? Vec3{p.z, p.x, 0.0} : Vec3{p.x, p.y, 0.0};
}

// Whether x, a point of the triangle's plane, is in the closed triangle. Decided in a projection if the triangle
// has an area.
bool holds_in_plane(const std::array<Vec3, 3>& t, const Vec3& x) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::array<Vec3, 3> flat = {without(t[0], axis), without(t[1], axis), without(t[2], axis)};
    const Sign turn = orient2d(flat[0], flat[1], flat[2]);
    if (turn == Sign::zero) continue;
    const Vec3 y = without(x, axis);
    for (std::size_t i = 0; i < 3; ++i) {
      if (orient2d(flat[i], flat[(i + 1) % 3], y) == -turn) return false;
    }
    return true;
  }
  return false;  // a triangle without area, which surface_triangles() refuses
}

bool in_box(const std::array<Vec3, 3>& t, const Vec3& x) {
  const auto between = [](double a, double b, double c, double v) {
    return std::min({a, b, c}) <= v && v <= std::max({a, b, c});
  };
  return between(t[0].x, t[1].x, t[2].x, x.x) && between(t[0].y, t[1].y, t[2].y, x.y) &&
         between(t[0].z, t[1].z, t[2].z, x.z);
}

std::vector<Vec3> flushed_points(std::vector<Vec3> points) {
  std::transform(points.begin(), points.end(), points.begin(), flushed);
  return points;
}

}  // namespace

InsideTest::InsideTest(const MeshData& surface) : InsideTest(surface.points, surface_triangles(surface)) {
  check_closed(triangles_);
}

InsideTest::InsideTest(std::vector<Vec3> points, std::vector<SurfaceTriangle> triangles)
    : points_(flushed_points(std::move(points))),
      triangles_(std::move(triangles)),
      tree_(boxes_of(points_, triangles_)),
      top_(points_.front().z) {
  for (const Vec3& p : points_) top_ = std::max(top_, p.z);
}

PointSide InsideTest::side(const Vec3& point) const {
  if (!in_exact_range(point)) throw InvalidArgument("inside: a coordinate is not finite, or above 2^300 in magnitude");
  const Vec3 x = flushed(point);
  std::size_t layers = 0;
  bool on = false;
  tree_.query({x, {x.x, x.y, std::max(x.z, top_)}}, [&](std::size_t k) {
    const SurfaceTriangle& c = triangles_[k];
    const std::array<Vec3, 3> t = {points_[c[0]], points_[c[1]], points_[c[2]]};
    const bool crossed = under_or_over(t, x);
    const bool near = in_box(t, x);
    if (!crossed && !near) return true;
    const Sign above = orient3d(t[0], t[1], t[2], x);
    on = near && above == Sign::zero && holds_in_plane(t, x);
    // Counterclockwise from above, x is above the triangle if the determinant is positive.
    const Sign turn = shifted_side(t[0], t[1], x);
    if (crossed && above == -turn) ++layers;
    return !on;
  });
  return on ? PointSide::on : layers % 2 == 1 ? PointSide::inside : PointSide::outside;
}

}  // namespace dartcast
