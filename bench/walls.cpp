#include "bench/walls.hpp"

#include <algorithm>

namespace dartcast::bench {

namespace {

// Replaces positions' numbers by indices into the list of those used.
void compact(Walls& walls, std::size_t position_count) {
  constexpr std::uint32_t unused = 0xffffffffU;
  std::vector<std::uint32_t> index(position_count, unused);
  for (const auto& triangle : walls.triangles) {
    for (const std::uint32_t v : triangle) index[v] = 0;
  }
  for (std::uint32_t v = 0; v < position_count; ++v) {
    if (index[v] == unused) continue;
    index[v] = static_cast<std::uint32_t>(walls.points.size());
    walls.points.push_back(v);
  }
  for (auto& triangle : walls.triangles) {
    for (std::uint32_t& v : triangle) v = index[v];
  }
}

}  // namespace

std::uint32_t Walls::number(const Name& name) const {
  return static_cast<std::uint32_t>(std::lower_bound(names.begin(), names.end(), name) - names.begin());
}

void Walls::gather(std::span<const Vec3> positions, std::vector<Vec3>& out) const {
  out.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = positions[points[i]];
}

Walls walls_of(const CellComplex& complex) {
  Walls walls;
  for (const Cell c : complex.map().cells()) {
    const CellView cell = complex.map().view(c);
    if (!cell.is_free()) continue;
    const Shape& shape = cell.shape();
    for (std::uint16_t f = 0; f < shape.face_count(); ++f) {
      if (!cell.is_wall(f)) continue;
      for (std::uint16_t t = 0; t < shape.triangle_count(f); ++t) {
        const auto v = shape.triangle(f, t);
        walls.triangles.push_back({cell.vertex(v[0]).value, cell.vertex(v[1]).value, cell.vertex(v[2]).value});
        walls.names.push_back({{c, f}, t});
      }
    }
  }
  compact(walls, complex.positions().size());
  return walls;
}

}  // namespace dartcast::bench
