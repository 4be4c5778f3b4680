// Vertices that were moved too far, and values that a repair of cells must not change.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/validity.hpp"

namespace dartcast::test {

/// Moves some vertices; the others stay.
inline void displace(CellComplex& complex, const std::vector<std::pair<Vertex, Vec3>>& moves) {
  const auto next = complex.next_positions();
  std::copy_n(complex.positions().begin(), next.size(), next.begin());
  for (const auto& [v, by] : moves) next[v.value] += by;
  complex.commit_positions();
}

inline std::vector<Cell> invalid_cells(const CellComplex& complex) {
  std::vector<Cell> cells;
  for (const InvalidCell& c : check_validity(complex, Threads{1}, 1000000).first) cells.push_back(c.cell);
  return cells;
}

/// Vertices of no wall (nor of the boundary).
inline std::vector<Vertex> inner_vertices(const CombinatorialMap& map) {
  std::vector<Vertex> inner;
  for (std::uint32_t v = 0; v < map.vertex_count(); ++v) {
    if (map.is_vertex(Vertex(v)) && !map.may_touch_wall(Vertex(v))) inner.emplace_back(v);
  }
  return inner;
}

/// All that a wall is: seen from the free side, corners with their coordinates, patch.
inline std::multiset<std::string> walls(const CellComplex& complex) {
  std::multiset<std::string> walls;
  const CombinatorialMap& map = complex.map();
  for (const Cell c : map.cells()) {
    const CellView v = map.view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      if (!v.is_wall(f)) continue;
      std::string text = v.is_free() ? "free" : "blocked";
      for (const std::uint16_t k : v.shape().corners(f)) {
        const Vec3 x = complex.positions()[v.vertex(k).value];
        text += " " + std::to_string(v.vertex(k).value) + " " + std::to_string(x.x) + " " + std::to_string(x.y) + " " +
                std::to_string(x.z);
      }
      walls.insert(text + " " + std::to_string(map.patch(CellFace{c, f}).value));
    }
  }
  return walls;
}

/// In the plane where that is the dimension.
inline Vec3 random_displacement(Random& random, double size, unsigned dimension = 3) {
  const auto one = [&] { return (random.uniform() * 2.0 - 1.0) * size; };
  const double x = one();
  const double y = one();
  return {x, y, dimension == 2 ? 0.0 : one()};
}

}  // namespace dartcast::test
