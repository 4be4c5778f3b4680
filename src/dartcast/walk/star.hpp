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
  [[nodiscard]] bool has(Vertex v) const {
    return std::find(vertex.begin(), vertex.begin() + count, v) != vertex.begin() + count;
  }
};

namespace detail {

// The simplices found so far, each once, in order. Stars have some tens of simplices: then all stays on the stack.
class FoundSimplices {
 public:
  void add(SimplexId s) {
    if (count_ < near_.size()) {
      if (std::find(near_.begin(), near_.begin() + count_, s) != near_.begin() + count_) return;
      near_[count_++] = s;
      return;
    }
    if (seen_.empty()) {
      for (const SimplexId known : near_) seen_.insert(key(known));
    }
    if (!seen_.insert(key(s)).second) return;
    far_.push_back(s);
    ++count_;
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] SimplexId operator[](std::size_t i) const {
    return i < near_.size() ? near_[i] : far_[i - near_.size()];
  }

 private:
  static std::uint64_t key(SimplexId s) { return (std::uint64_t{s.cell.value} << 16U) | s.simplex; }

  std::array<SimplexId, 64> near_;
  std::size_t count_ = 0;
  std::vector<SimplexId> far_;
  std::unordered_set<std::uint64_t> seen_;  // of all, once they are many
};

}  // namespace detail

/// Goes through the simplices around `feature` that are reached from `start` (one of them) through facets that hold the
/// feature and are no walls. Calls on_simplex(SimplexId, CellView, ImplicitSimplex) for each, start first, and
/// on_wall(SimplexId, CellView, ImplicitSimplex, facet) for each wall facet that holds the feature; either ends the
/// search by returning false. Purely combinatorial: no coordinate is read. Cost: linear in the star.
template <class OnSimplex, class OnWall>
void search_star(const Map& map, SimplexId start, const Feature& feature, OnSimplex&& on_simplex, OnWall&& on_wall) {
  detail::FoundSimplices found;
  found.add(start);
  for (std::size_t next = 0; next < found.size(); ++next) {
    const SimplexId id = found[next];
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
      found.add(pass(map, id, cell, across).simplex);
    }
  }
}

}  // namespace dartcast
