// The distance by which an edit moved walls and the boundary.
#include "complex/boundary_shift.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "complex/cone_point.hpp"
#include "dartcast/predicates.hpp"
#include "topology/key_table.hpp"

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
      : transaction_(t),
        positions_(positions),
        old_(walls_of(t.map(), t.removed())),
        new_(walls_of(t.map(), t.added())) {
    if (old_.empty() || new_.empty()) return;
    for (std::uint32_t i = 0; i < t.created_count(); ++i) created_[t.created(i).vertex.value] = i;
    list_kept();
    for (std::size_t i = 0; i < old_.size(); ++i) {
      for (const std::uint32_t v : old_[i].corners) at_.emplace_back(v, i);
    }
    std::sort(at_.begin(), at_.end());
  }

  [[nodiscard]] double largest_shift() {
    double largest = 0.0;
    for (const BoundaryWall& wall : new_) {
      if (was_there(wall)) continue;
      find_origins(wall);
      for (const std::size_t i : old_walls_at(origins_)) largest = std::max(largest, between(i, wall));
    }
    return largest;
  }

 private:
  using WallAtVertex = std::pair<std::uint32_t, std::size_t>;

  // The corners of each old wall that the new cells have, too.
  void list_kept() {
    detail::KeyTable kept;
    for (const Cell c : transaction_.added()) {
      for (const std::uint32_t v : transaction_.map().view(c).vertices()) kept[v] = 1;
    }
    kept_of_.reserve(old_.size());
    for (const BoundaryWall& wall : old_) {
      VertexNumbering& of = kept_of_.emplace_back(wall.corners);
      std::erase_if(of, [&](std::uint32_t v) { return kept.find(v) == detail::KeyTable::none; });
    }
  }

  template <class Visit>
  void for_each_old_wall_at(std::uint32_t v, Visit&& visit) const {
    for (auto at = std::lower_bound(at_.begin(), at_.end(), WallAtVertex{v, 0}); at != at_.end() && at->first == v;
         ++at)
      visit(at->second);
  }

  // Each once: most share several vertices with a new wall.
  [[nodiscard]] const std::vector<std::size_t>& old_walls_at(const VertexNumbering& vertices) {
    found_.clear();
    for (const std::uint32_t v : vertices) for_each_old_wall_at(v, [&](std::size_t i) { found_.push_back(i); });
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    return found_;
  }

  [[nodiscard]] bool was_there(const BoundaryWall& wall) const {
    bool found = false;
    for_each_old_wall_at(wall.corners.front(), [&](std::size_t i) { found = found || old_[i] == wall; });
    return found;
  }

  // The older vertices from which the corners of a new wall were made.
  void find_origins(const BoundaryWall& wall) {
    origins_.clear();
    open_ = wall.corners;
    while (!open_.empty()) {
      const std::uint32_t v = open_.back();
      open_.pop_back();
      const std::uint32_t number = created_.find(v);
      if (number != detail::KeyTable::none) {
        const CreatedVertex& made = transaction_.created(number);
        open_.push_back(made.from.value);
        if (made.other != made.from) open_.push_back(made.other.value);
      } else if (!holds(origins_, v)) {
        origins_.push_back(v);
      }
    }
  }

  // Nothing if the new wall, whose origins were found, is neither a part of the old one nor contains it.
  [[nodiscard]] double between(std::size_t old, const BoundaryWall& after) const {
    const BoundaryWall& before = old_[old];
    const bool part =
        std::all_of(origins_.begin(), origins_.end(), [&](std::uint32_t v) { return holds(before.corners, v); });
    if (before.point.valid() || (part && before.corners.size() > 3)) {
      if (const auto t = triangle_around(before)) {
        const BoundaryPlane plane{positions_[(*t)[0]], positions_[(*t)[1]], positions_[(*t)[2]], *t};
        return extent_over(plane, {}, after, positions_);
      }
    }
    if (!part && !is_whole_of(after, old)) return 0.0;
    return extent_over(plane_of(part ? before.corners : after.corners, positions_), before, after, positions_);
  }

  // The triangle of an old wall's fan that has all origins of the new wall, which then lies in it.
  [[nodiscard]] std::optional<std::array<std::uint32_t, 3>> triangle_around(const BoundaryWall& before) const {
    const VertexNumbering& c = before.corners;
    const std::size_t ends = before.point.valid() ? 0 : 1;  // corners at each end that no triangle starts at
    for (std::size_t i = ends; i + ends < c.size(); ++i) {
      const std::array<std::uint32_t, 3> triangle = {before.point.valid() ? before.point.value : c[0], c[i],
                                                     c[i + 1 < c.size() ? i + 1 : 0]};
      const auto in_triangle = [&](std::uint32_t v) {
        return v == triangle[0] || v == triangle[1] || v == triangle[2];
      };
      if (std::all_of(origins_.begin(), origins_.end(), in_triangle)) return triangle;
    }
    return {};
  }

  // Whether the new wall has all corners of the old wall that its cells have kept: at least an edge, in the plane a
  // corner.
  [[nodiscard]] bool is_whole_of(const BoundaryWall& after, std::size_t old) const {
    const VertexNumbering& kept = kept_of_[old];
    return kept.size() >= (old_[old].corners.size() == 2 ? 1 : 2) &&
           std::all_of(kept.begin(), kept.end(), [&](std::uint32_t v) { return holds(after.corners, v); });
  }

  const Transaction& transaction_;
  std::span<const Vec3> positions_;
  std::vector<BoundaryWall> old_;
  std::vector<BoundaryWall> new_;
  detail::KeyTable created_;              // number of a new vertex
  std::vector<VertexNumbering> kept_of_;  // by old wall
  std::vector<WallAtVertex> at_;          // old walls, by their vertices
  VertexNumbering origins_, open_;        // of the new wall in hand
  std::vector<std::size_t> found_;        // old walls at these
};

}  // namespace

double boundary_shift(const Transaction& t, std::span<const Vec3> positions) {
  double largest = BoundaryWalls(t, positions).largest_shift();
  for (const MergedVertex& i : t.merged())
    largest = std::max(largest, norm(positions[i.gone.value] - positions[i.merged_into.value]));
  return largest;
}

}  // namespace dartcast
