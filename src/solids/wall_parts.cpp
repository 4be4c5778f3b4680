// The edges and vertices of walls, listed when they are first asked for.
#include "solids/wall_parts.hpp"

#include <algorithm>
#include <tuple>

#include "dartcast/predicates.hpp"

namespace dartcast {

void WallParts::set(std::span<const NearWall> walls) {
  walls_.assign(walls.begin(), walls.end());
  ways_.clear();
  edges_.clear();
  vertices_.clear();
  for (NearWall& w : walls_) {
    MovingTriangle& t = w.corners;
    for (std::size_t k = 0; k < 3; ++k) {
      t.from[k] = flushed(t.from[k]);
      t.to[k] = flushed(t.to[k]);
    }
    ways_.push_back(join(join(way_of(t.from[0], t.to[0]), way_of(t.from[1], t.to[1])), way_of(t.from[2], t.to[2])));
  }
}

std::span<const WallParts::Part> WallParts::edges() {
  if (edges_.empty()) list(2, edges_);
  return edges_;
}

std::span<const WallParts::Part> WallParts::vertices() {
  if (vertices_.empty()) list(1, vertices_);
  return vertices_;
}

// Parts of this many vertices.
void WallParts::list(unsigned size, std::vector<Part>& parts) const {
  for (std::uint32_t w = 0; w < walls_.size(); ++w) {
    const NearWall& wall = walls_[w];
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + size - 1) % 3;
      const auto [low, high] = std::minmax(wall.vertex[k].value, wall.vertex[l].value);
      const MovingTriangle& t = wall.corners;
      parts.push_back({{low, high}, w, k, w, join(way_of(t.from[k], t.to[k]), way_of(t.from[l], t.to[l]))});
    }
  }
  const auto key = [](const Part& p) { return std::tie(p.vertex, p.wall, p.corner); };
  std::sort(parts.begin(), parts.end(), [&](const Part& a, const Part& b) { return key(a) < key(b); });
  const auto same = [](const Part& a, const Part& b) { return a.vertex == b.vertex; };
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    if (same(parts[i], parts[i + 1])) parts[i].beside = parts[i + 1].wall;
  }
  parts.erase(std::unique(parts.begin(), parts.end(), same), parts.end());
}

}  // namespace dartcast
