// The free simplices around a vertex, an edge or a triangle: those that are reached without passing a wall.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <unordered_set>
#include <vector>

#include "dartcast/geometry/simplex.hpp"
#include "dartcast/map/map.hpp"
#include "dartcast/walk/space.hpp"

namespace dartcast {

/// 1 to 3 vertices: the simplex of the complex in whose interior a point lies.
struct Feature {
  std::array<Vertex, 4> vertex;
  unsigned count = 0;

  void add(Vertex v) { vertex[count++] = v; }
  [[nodiscard]] bool has(Vertex v) const { return std::find(vertex.begin(), vertex.begin() + count, v) != vertex.begin() + count; }
};

namespace detail {

// A set that stays on the stack while it is small, as stars are: some tens of simplices.
class VisitedSimplices {
 public:
  bool insert(SimplexId s) {
    if (!large_.empty()) return large_.insert(key(s)).second;
    const auto end = small_.begin() + count_;
    if (std::find(small_.begin(), end, key(s)) != end) return false;
    if (count_ < small_.size()) {
      small_[count_++] = key(s);
      return true;
    }
    large_.insert(small_.begin(), small_.end());
    return large_.insert(key(s)).second;
  }

 private:
  static std::uint64_t key(SimplexId s) { return (std::uint64_t{s.cell.value} << 16U) | s.simplex; }

  std::array<std::uint64_t, 64> small_;
  unsigned count_ = 0;
  std::unordered_set<std::uint64_t> large_;
};

}  // namespace detail

/// Goes through the simplices around `feature` that are reached from `start` (one of them) through facets that hold the
/// feature and are no walls. Calls on_simplex(SimplexId, CellView, ImplicitSimplex) for each, start first, and
/// on_wall(SimplexId, CellView, ImplicitSimplex, facet) for each wall facet that holds the feature; either ends the search by
/// returning false. Purely combinatorial: no coordinate is read. Cost: linear in the star.
template <class OnSimplex, class OnWall>
void search_star(const Map& map, SimplexId start, const Feature& feature, OnSimplex&& on_simplex, OnWall&& on_wall) {
  detail::VisitedSimplices visited;
  visited.insert(start);
  std::vector<SimplexId> queue = {start};
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const SimplexId id = queue[next];
    const CellView cell = map.view(id.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[id.simplex];
    if (!on_simplex(id, cell, s)) return;
    for (std::uint16_t facet = 0; facet < 4; ++facet) {
      if (feature.has(cell.vertex(s.vertex[facet]))) continue;
      const Across across = s.across[facet];
      if (across.outer() && cell.is_wall(across.face())) {
        if (!on_wall(id, cell, s, facet)) return;
        continue;
      }
      const SimplexId other = pass(map, id, cell, across).simplex;
      if (visited.insert(other)) queue.push_back(other);
    }
  }
}

}  // namespace dartcast
