// One stretch of a sphere's way: the first wall that it touches, and the target of the centre.
#include "spheres/sphere_way.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spheres/push_out.hpp"

namespace dartcast::detail {

namespace {

// The walls of one search, the sphere among them.
class Way {
 public:
  /// `nearest`: of each wall at the start.
  Way(const SphereInterval& interval, std::span<const NearWall> walls, std::span<const NearestOnTriangle> nearest)
      : moving_(interval.moving),
        sphere_(interval.sphere),
        walls_(walls),
        nearest_(nearest),
        slack_(touching_slack(sphere_.from, sphere_.radius)) {
    for (const NearestOnTriangle& n : nearest) room_ = std::min(room_, n.distance);
  }

  struct First {
    const NearWall* wall = nullptr;
    SphereTouch touch;
    double earliest = 1.0;  // no wall is touched before
  };

  [[nodiscard]] bool overlaps() const { return room_ < sphere_.radius - slack_; }
  // Shrinks the sphere to the radius that there is room for, so that it can move, but not deeper.
  void shrink() { sphere_.radius = room_; }

  [[nodiscard]] First first() const {
    First first;
    double until = 1.0;
    for (std::size_t k = 0; k < walls_.size(); ++k) {
      const NearWall& w = walls_[k];
      if (!can_reach(w, nearest_[k].distance)) continue;
      const auto touch = first_touch(sphere_, w.corners, slack_, until);
      if (!touch) continue;
      first.earliest = std::min(first.earliest, touch->time);
      if (first.wall != nullptr && touch->contact >= first.touch.contact) continue;
      first.wall = &w;
      first.touch = *touch;
      until = std::min(1.0, touch->contact);
    }
    return first;
  }

  // The mean displacement of the walls that overlap it.
  [[nodiscard]] Vec3 displacement_of_overlaps() const {
    Vec3 sum;
    double count = 0.0;
    for (std::size_t k = 0; k < walls_.size(); ++k) {
      if (!(nearest_[k].distance < sphere_.radius - slack_)) continue;
      const MovingTriangle& corners = walls_[k].corners;
      for (unsigned i = 0; i < 3; ++i) sum += (corners.to[i] - corners.from[i]) * nearest_[k].weights[i];
      count += 1.0;
    }
    return count > 0.0 ? sum * (1.0 / count) : sum;
  }

  // Sets the position of the centre after the first touch.
  void place(const First& first, SphereWay& way) const {
    const double t = first.touch.contact;
    const MovingTriangle& corners = first.wall->corners;
    way.end = WayEnd::contact;
    way.time = first.earliest;
    way.used = t;
    way.face = first.wall->face;
    way.triangle = first.wall->triangle;
    way.target = t == 0.0 ? sphere_.from : sphere_.from + (sphere_.to - sphere_.from) * t;
    if (moving_) {
      std::array<Vec3, 3> then;
      for (unsigned i = 0; i < 3; ++i) then[i] = corners.from[i] + (corners.to[i] - corners.from[i]) * t;
      const NearestOnTriangle touched = nearest_on_triangle(then, way.target);
      for (unsigned i = 0; i < 3; ++i) way.wall_displacement += (corners.to[i] - corners.from[i]) * touched.weights[i];
      way.target += way.wall_displacement * (1.0 - t);
    } else if (first.touch.at_start) {
      return;  // it has the right distance
    }
    const NearestOnTriangle nearest = nearest_on_triangle(corners.to, way.target);
    if (nearest.distance > 0.0) way.target += nearest.normal * (sphere_.radius - nearest.distance);
  }

 private:
  // The distance changes no faster than the centre moves relative to a corner.
  [[nodiscard]] bool can_reach(const NearWall& w, double distance) const {
    const Vec3 own = sphere_.to - sphere_.from;
    double fastest = 0.0;
    for (unsigned i = 0; i < 3; ++i) fastest = std::max(fastest, norm(own - (w.corners.to[i] - w.corners.from[i])));
    return !(distance > (sphere_.radius + slack_ + fastest) * (1.0 + 0x1p-20));
  }

  bool moving_;
  MovingSphere sphere_;
  std::span<const NearWall> walls_;
  std::span<const NearestOnTriangle> nearest_;
  double slack_;
  double room_ = std::numeric_limits<double>::infinity();
};

}  // namespace

SphereWay way_of(const CellComplex& complex, const SphereInterval& interval, NearWalls& near) {
  const MovingSphere& sphere = interval.sphere;
  SphereWay result;
  result.target = sphere.to;
  const auto walls = near.search(complex, interval.cell, sphere, interval.moving);
  if (walls.empty()) return result;
  Way way(interval, walls, near.nearest(sphere.from));
  if (way.overlaps() && !interval.push_out) way.shrink();
  if (way.overlaps()) {
    result.end = WayEnd::overlap;
    if (interval.moving) {
      result.wall_displacement = way.displacement_of_overlaps();
      result.target = sphere.from + result.wall_displacement;
    } else {
      result.target = sphere.from + push_out(complex, interval.cell, sphere.from, sphere.radius, near);
    }
    return result;
  }
  const Way::First first = way.first();
  if (first.wall != nullptr) way.place(first, result);
  return result;
}

}  // namespace dartcast::detail
