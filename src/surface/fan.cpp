// The fan of triangles around a vertex, up to the walls.
#include "surface/fan.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "surface/unfold.hpp"

namespace dartcast::detail {

namespace {

FanCorner fan_corner(const Surface& surface, SimplexId triangle, unsigned corner) {
  const auto v = surface.corners(triangle);
  return {triangle, corner, angle_at_base(unfold(v[corner], v[(corner + 1) % 3], v[(corner + 2) % 3]))};
}

// The next triangle around the vertex; nothing behind a wall. Both triangles run counterclockwise: an edge that starts
// at the vertex in one of them ends at the vertex in the other.
std::optional<FanCorner> next_corner(const Surface& surface, const FanCorner& at, FanWalls walls,
                                     bool counterclockwise) {
  const AcrossEdge across = surface.across(at.triangle, (at.corner + (counterclockwise ? 1 : 2)) % 3);
  if (!across.triangle.valid() || (across.wall && walls == FanWalls::end)) return {};
  return fan_corner(surface, across.triangle, (across.edge + (counterclockwise ? 1 : 2)) % 3);
}

bool same_corner(const FanCorner& a, const FanCorner& b) { return a.triangle == b.triangle && a.corner == b.corner; }

}  // namespace

std::pair<FanCorner, double> Fan::at(double angle) const {
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    if (angle <= corners[i].angle) return {corners[i], std::max(angle, 0.0)};
    angle -= corners[i].angle;
  }
  return {corners.back(), std::clamp(angle, 0.0, corners.back().angle)};
}

Fan fan_of(const Surface& surface, SimplexId triangle, unsigned corner, FanWalls walls) {
  Fan fan;
  fan.corners.push_back(fan_corner(surface, triangle, corner));
  const FanCorner start = fan.corners.front();
  const auto following = [&](const FanCorner& at, bool left) { return next_corner(surface, at, walls, left); };
  auto next = following(start, true);
  for (; next && !same_corner(*next, start); next = following(*next, true)) fan.corners.push_back(*next);
  fan.closed = next.has_value();
  if (!fan.closed) {
    std::vector<FanCorner> right;
    for (next = following(start, false); next; next = following(*next, false)) {
      right.push_back(*next);
      fan.before += next->angle;
    }
    fan.own = right.size();
    fan.corners.insert(fan.corners.begin(), right.rbegin(), right.rend());
  }
  for (const FanCorner& c : fan.corners) fan.total += c.angle;
  return fan;
}

}  // namespace dartcast::detail
