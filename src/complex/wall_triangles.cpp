// Collects the triangles of walls, then numbers the vertices that they use.
#include <algorithm>

#include "dartcast/walls.hpp"

namespace dartcast {

namespace {

// Replaces numbers of vertices by places in the list of those used.
void number_vertices(WallTriangles& walls, std::size_t vertex_count) {
  constexpr std::uint32_t unused = 0xffffffffU;
  std::vector<std::uint32_t> place(vertex_count, unused);
  for (const auto& triangle : walls.triangles) {
    for (const std::uint32_t v : triangle) place[v] = 0;
  }
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    if (place[v] == unused) continue;
    place[v] = static_cast<std::uint32_t>(walls.vertices.size());
    walls.vertices.emplace_back(v);
  }
  for (auto& triangle : walls.triangles) {
    for (std::uint32_t& v : triangle) v = place[v];
  }
}

}  // namespace

WallTriangles wall_triangles(const CellComplex& complex) {
  const bool is_flat = complex.map().dimension() == 2;
  WallTriangles walls;
  for (const Cell c : complex.map().cells()) {
    const CellView cell = complex.map().view(c);
    if (!cell.is_free()) continue;
    const Shape& shape = cell.shape();
    for (std::uint16_t f = 0; f < shape.face_count(); ++f) {
      if (!cell.is_wall(f)) continue;
      for (std::uint16_t t = 0; t < shape.triangle_count(f); ++t) {
        const auto v = shape.triangle(f, t);
        walls.triangles.push_back(
            {cell.vertex(v[0]).value, cell.vertex(v[1]).value, cell.vertex(v[is_flat ? 1 : 2]).value});
        walls.faces.push_back({c, f});
      }
    }
  }
  number_vertices(walls, complex.positions().size());
  return walls;
}

std::vector<Vec3> WallTriangles::points(std::span<const Vec3> positions) const {
  std::vector<Vec3> out(vertices.size());
  std::transform(vertices.begin(), vertices.end(), out.begin(), [&](Vertex v) { return positions[v.value]; });
  return out;
}

}  // namespace dartcast
