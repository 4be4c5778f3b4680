// Cuts ears off a polygon: corners that are convex and have no other corner in their triangle.
#include "surface/ears.hpp"

#include <algorithm>
#include <cmath>

#include "dartcast/predicates.hpp"

namespace dartcast {
namespace {

/// A polygon as seen along the axis nearest to its normal, counterclockwise.
class SeenPolygon {
 public:
  SeenPolygon(std::span<const Vec3> points, std::span<const std::uint32_t> corners)
      : points_(points), left_(corners.begin(), corners.end()) {
    const Vec3 normal = vector_area(points, corners);
    const Vec3 size = {std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    axis_ = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    turned_ = (axis_ == 0 ? normal.x : (axis_ == 1 ? normal.y : normal.z)) < 0.0;
  }

  [[nodiscard]] std::size_t size() const { return left_.size(); }

  [[nodiscard]] TriangleCorners around(std::size_t i) const {
    const std::size_t n = left_.size();
    return {left_[(i + n - 1) % n], left_[i], left_[(i + 1) % n]};
  }

  [[nodiscard]] bool is_ear(std::size_t i) const {
    const TriangleCorners t = around(i);
    if (turn(t[0], t[1], t[2]) <= 0) return false;
    for (const std::uint32_t p : left_) {
      if (p == t[0] || p == t[1] || p == t[2]) continue;
      if (turn(t[0], t[1], p) >= 0 && turn(t[1], t[2], p) >= 0 && turn(t[2], t[0], p) >= 0) return false;
    }
    return true;
  }

  void cut(std::size_t i) { left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(i)); }

  [[nodiscard]] int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const int sign = static_cast<int>(orient2d(seen(a), seen(b), seen(c)));
    return turned_ ? -sign : sign;
  }

 private:
  [[nodiscard]] Vec3 seen(std::uint32_t p) const {
    const Vec3 x = flushed(points_[p]);
    return axis_ == 0 ? Vec3{x.y, x.z, 0.0} : (axis_ == 1 ? Vec3{x.z, x.x, 0.0} : Vec3{x.x, x.y, 0.0});
  }

  std::span<const Vec3> points_;
  std::vector<std::uint32_t> left_;  // the corners that have not been cut off
  unsigned axis_ = 2;
  bool turned_ = false;
};

}  // namespace

std::vector<TriangleCorners> fan_from(std::span<const std::uint32_t> corners, std::size_t first) {
  const auto at = [&](std::size_t k) { return corners[(first + k) % corners.size()]; };
  std::vector<TriangleCorners> triangles;
  for (std::size_t k = 2; k < corners.size(); ++k) triangles.push_back({at(0), at(k - 1), at(k)});
  return triangles;
}

bool do_not_overlap(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                    std::span<const TriangleCorners> triangles) {
  const SeenPolygon polygon(points, corners);
  return std::all_of(triangles.begin(), triangles.end(),
                     [&](const TriangleCorners& t) { return polygon.turn(t[0], t[1], t[2]) > 0; });
}

Vec3 vector_area(std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  Vec3 sum;
  for (std::size_t k = 2; k < corners.size(); ++k)
    sum += cross(points[corners[k - 1]] - points[corners[0]], points[corners[k]] - points[corners[0]]);
  return sum;
}

std::vector<TriangleCorners> ears(std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  if (corners.size() == 3) return fan_from(corners, 0);
  SeenPolygon polygon(points, corners);
  std::vector<TriangleCorners> triangles;
  while (polygon.size() > 3) {
    std::size_t i = 0;
    while (i < polygon.size() && !polygon.is_ear(i)) ++i;
    if (i == polygon.size()) return fan_from(corners, 0);
    triangles.push_back(polygon.around(i));
    polygon.cut(i);
  }
  triangles.push_back(polygon.around(1));
  return triangles;
}

}  // namespace dartcast
