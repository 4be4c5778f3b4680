#include "bench/walls.hpp"

#include <algorithm>
#include <utility>

#include "dartcast/walls.hpp"

namespace dartcast::bench {

std::uint32_t Walls::number(const Name& name) const {
  return static_cast<std::uint32_t>(std::lower_bound(names.begin(), names.end(), name) - names.begin());
}

void Walls::gather(std::span<const Vec3> positions, std::vector<Vec3>& out) const {
  out.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = positions[points[i]];
}

Walls walls_of(const CellComplex& complex) {
  WallTriangles all = wall_triangles(complex);
  Walls walls;
  walls.triangles = std::move(all.triangles);
  for (const Vertex v : all.vertices) walls.points.push_back(v.value);
  for (const CellFace face : all.faces) {
    const bool goes_on = !walls.names.empty() && walls.names.back().face == face;
    const int number = goes_on ? walls.names.back().triangle + 1 : 0;
    walls.names.push_back({face, static_cast<std::uint16_t>(number)});
  }
  return walls;
}

}  // namespace dartcast::bench
