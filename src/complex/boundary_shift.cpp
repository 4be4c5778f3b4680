// The distance by which an edit moved walls and the boundary.
#include "complex/boundary_shift.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "complex/cone_point.hpp"
#include "dartcast/predicates.hpp"

namespace dartcast {

namespace {

using VertexNumbering = std::vector<std::uint32_t>;

struct BoundaryWall {
  VertexNumbering corners;  // from the lowest-numbered
  Vertex point;             // Steiner point

  bool operator==(const BoundaryWall&) const = default;
};

std::vector<BoundaryWall> walls_of(const CombinatorialMap& map, std::span<const Cell> cells) {
  std::vector<BoundaryWall> walls;
  for (const Cell c : cells) {
    const CellView v = map.view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      if (!v.is_wall(f)) continue;
      BoundaryWall& wall = walls.emplace_back(BoundaryWall{{}, map.point(CellFace{c, f})});
      for (const std::uint16_t k : v.shape().corners(f)) wall.corners.push_back(v.vertex(k).value);
    }
  }
  return walls;
}

bool holds(const VertexNumbering& numbers, std::uint32_t v) {
  return std::find(numbers.begin(), numbers.end(), v) != numbers.end();
}

struct BoundaryPlane {
  Vec3 a, b, c;
  std::array<std::uint32_t, 3> corners;  // vertices that lie in it, because they define it
};

// The plane through the widest triangle of a fan. In the plane it is upright through an edge.
BoundaryPlane plane_of(const VertexNumbering& corners, std::span<const Vec3> positions) {
  const Vec3 a = positions[corners.front()];
  BoundaryPlane plane{a, a, a, {corners[0], corners[0], corners[0]}};
  if (corners.size() == 2)
    return {
        a, positions[corners[1]], detail::upright(a, positions[corners[1]]).c, {corners[0], corners[1], corners[1]}};
  double widest = 0.0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 b = positions[corners[i]];
    const Vec3 c = positions[corners[i + 1]];
    const double width = norm(cross(b - a, c - a));
    if (!(width > widest)) continue;
    widest = width;
    plane = {a, b, c, {corners[0], corners[i], corners[i + 1]}};
  }
  return plane;
}

// The result is exactly 0 if all points lie in the plane.
double extent_over(const BoundaryPlane& plane, const BoundaryWall& before, const BoundaryWall& after,
                   std::span<const Vec3> positions) {
  const Vec3 normal = cross(plane.b - plane.a, plane.c - plane.a);
  const double length = norm(normal);
  double low = 0.0;
  double high = 0.0;
  const auto add = [&](std::uint32_t v) {
    if (std::find(plane.corners.begin(), plane.corners.end(), v) != plane.corners.end()) return;
    if (orient3d(plane.a, plane.b, plane.c, positions[v]) == Sign::zero) return;
    const double height = dot(normal, positions[v] - plane.a) / length;
    low = std::min(low, height);
    high = std::max(high, height);
  };
  for (const BoundaryWall* wall : {&before, &after}) {
    for (const std::uint32_t v : wall->corners) add(v);
    if (wall->point.valid()) add(wall->point.value);
  }
  return high - low;
}

class BoundaryWalls {
 public:
  BoundaryWalls(const Transaction& t, std::span<const Vec3> positions)
      : positions_(positions), old_(walls_of(t.map(), t.removed())), new_(walls_of(t.map(), t.added())) {
    if (old_.empty() || new_.empty()) return;
    for (std::size_t i = 0; i < t.created_count(); ++i) created_[t.created(i).vertex.value] = t.created(i);
    for (const Cell c : t.added()) {
      for (const std::uint32_t v : t.map().view(c).vertices()) kept_.insert(v);
    }
    for (std::size_t i = 0; i < old_.size(); ++i) {
      for (const std::uint32_t v : old_[i].corners) at_[v].push_back(i);
    }
  }

  [[nodiscard]] double largest_shift() const {
    double largest = 0.0;
    for (const BoundaryWall& wall : new_) {
      if (was_there(wall)) continue;
      const VertexNumbering origins = origins_of(wall);
      for (const std::size_t i : old_walls_at(origins)) largest = std::max(largest, between(old_[i], wall, origins));
    }
    return largest;
  }

 private:
  // Each once: most share several vertices with a new wall.
  [[nodiscard]] std::vector<std::size_t> old_walls_at(const VertexNumbering& vertices) const {
    std::vector<std::size_t> walls;
    for (const std::uint32_t v : vertices) {
      const auto found = at_.find(v);
      if (found != at_.end()) walls.insert(walls.end(), found->second.begin(), found->second.end());
    }
    std::sort(walls.begin(), walls.end());
    walls.erase(std::unique(walls.begin(), walls.end()), walls.end());
    return walls;
  }

  [[nodiscard]] bool was_there(const BoundaryWall& wall) const {
    const auto found = at_.find(wall.corners.front());
    return found != at_.end() &&
           std::any_of(found->second.begin(), found->second.end(), [&](std::size_t i) { return old_[i] == wall; });
  }

  // The older vertices from which the corners of a new wall were made.
  [[nodiscard]] VertexNumbering origins_of(const BoundaryWall& wall) const {
    VertexNumbering origins;
    VertexNumbering open = wall.corners;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      const auto found = created_.find(v);
      if (found != created_.end()) {
        open.push_back(found->second.from.value);
        if (found->second.other != found->second.from) open.push_back(found->second.other.value);
      } else if (!holds(origins, v)) {
        origins.push_back(v);
      }
    }
    return origins;
  }

  // Nothing if the new wall is neither a part of the old one nor contains it.
  [[nodiscard]] double between(const BoundaryWall& before, const BoundaryWall& after,
                               const VertexNumbering& origins) const {
    const bool part =
        std::all_of(origins.begin(), origins.end(), [&](std::uint32_t v) { return holds(before.corners, v); });
    if (!part && !is_whole_of(after, before)) return 0.0;
    return extent_over(plane_of(part ? before.corners : after.corners, positions_), before, after, positions_);
  }

  // Whether the new wall has all corners of the old wall that its cells have kept: at least an edge, in the plane a
  // corner.
  [[nodiscard]] bool is_whole_of(const BoundaryWall& after, const BoundaryWall& before) const {
    const auto kept = [&](std::uint32_t v) { return kept_.count(v) != 0; };
    const std::ptrdiff_t lowest = before.corners.size() == 2 ? 1 : 2;
    return std::count_if(before.corners.begin(), before.corners.end(), kept) >= lowest &&
           std::all_of(before.corners.begin(), before.corners.end(),
                       [&](std::uint32_t v) { return !kept(v) || holds(after.corners, v); });
  }

  std::span<const Vec3> positions_;
  std::vector<BoundaryWall> old_;
  std::vector<BoundaryWall> new_;
  std::unordered_map<std::uint32_t, CreatedVertex> created_;
  std::unordered_set<std::uint32_t> kept_;                          // vertices of the new cells
  std::unordered_map<std::uint32_t, std::vector<std::size_t>> at_;  // old walls of a vertex
};

}  // namespace

double boundary_shift(const Transaction& t, std::span<const Vec3> positions) {
  double largest = BoundaryWalls(t, positions).largest_shift();
  for (const MergedVertex& i : t.merged())
    largest = std::max(largest, norm(positions[i.gone.value] - positions[i.merged_into.value]));
  return largest;
}

}  // namespace dartcast
